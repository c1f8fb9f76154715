"""How far a mesh is from the surface, measured both ways, and what it misses.

Input: a mesh's triangles and the shape's kernels. Output: distances and places. Distances are of
first order: the value divided by the length of the gradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC3, Type
from distal.mesh import arithmetic, face_arithmetic, triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice, keys_of
from distal.mesh.parallel import parallel_map, slices_of
from distal.mesh.pieces import distances, turns
from distal.mesh.places import Roots
from distal.mesh.solid import Floats, Integers
from distal.mesh.topology import Topology
from distal.mesh.triangulate import Triangles
from distal.polygons.whole_numbers import sorted_keys

# Gaps and walls that are narrower, as a share of the shape's size, are not looked for: files hold 7
# digits, and measured extents, by which parts are put on each other, are not more exact.
NARROWEST: Final = 1e-6
SAMPLES: Final = 7  # points of each triangle, besides its corners
_AT_ONCE: Final = 1 << 16
_CUT: Final = 1e-3  # cells
# How far from points their sides are looked at, in tolerances, and how much farther each time.
_FIRST_OFF: Final = 0.25
_LAST_OFF: Final = 8.0
_NEXT_OFF: Final = 1.25
_CLOSE: Final = 1e-3
_ALIKE: Final = 0.9  # the least share of one value in another that counts as equal
_IN_FACE: Final = 0.5  # of where its sides are looked at: how far a point of a face is from it
# The most lattice points that are followed to a surface that the mesh does not have.
_MOST_FOLLOWED: Final = 1 << 14
# The most roots that are compared with more triangles than those around their own edge.
_MOST_SEARCHED: Final = 1 << 12
_RINGS: Final = 2
# A lost place that is farther than so many cells from all cells of the mesh is a lost part.
CELLS_AROUND: Final = 2


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Measured distances between a mesh and the surface, in scene units.

    Attributes:
        largest: The largest distance from a point of the mesh to the surface.
        mean: The mean of these distances.
        place: Where the largest one is.
        from_surface: The largest distance from a root on an edge of the lattice to the mesh.
        at_points: The largest distance of a corner of a triangle.
        cut: How many corners of triangles are off the surface by more than a thousandth of a cell:
            there, a crease or a corner is cut.
    """

    largest: float
    mean: float
    place: tuple[float, float, float]
    from_surface: float
    at_points: float
    cut: int


@dataclass(frozen=True, slots=True)
class Misses:
    """The same distances one by one: they say which cells are too large.

    Attributes:
        triangles: The largest distance of each triangle from the surface.
        points: The distance of each point.
        roots: The distance of each root to the triangles around its edge.
        turns: How much the surface turns within each triangle, as a share of what it may, squared.
    """

    triangles: Floats
    points: Floats
    roots: Floats
    turns: Floats

    def excess(self, tolerance: float, turn: float = 1.0) -> Floats:
        """Return the distances of triangles; where a turn exceeds what it may be by more, that.

        As a distance does, the square of a turn falls with the square of the length of a cell.

        Args:
            tolerance: The distance that counts as much as a turn that is just small enough.
            turn: The square of a turn that is, as a share of what it may be.
        """
        return np.maximum(self.triangles, tolerance / turn * self.turns)


@dataclass(frozen=True, slots=True)
class CutCorner:
    """A corner of the surface that the mesh cuts.

    Attributes:
        distance: How far it is from the nearest point of the mesh, at most; 0 if none is cut.
        place: Where it is.
    """

    distance: float
    place: tuple[float, float, float]


def measured(
    kernels: FieldKernels,
    made: Triangles,
    roots: Roots,
    topology: Topology,
    step: float,
    tolerance: float,
    angle: float,
) -> tuple[Accuracy, Floats, Misses]:
    """Return the accuracy of a mesh, the normals at its points, and each distance.

    Args:
        kernels: The shape.
        made: The mesh.
        roots: The roots on edges of the lattice.
        topology: What belongs together.
        step: The length of a cell.
        tolerance: How far the mesh may be from the surface.
        angle: How much the surface may turn within a triangle, in radians; infinite for any angle.
    """
    at_points, normals = kernels.call(
        arithmetic.distance_and_normal,
        made.points,
        np.full(len(made.points), step),
        types=[("p", VEC3), ("step", FLOAT)],
    )
    at_points = np.maximum(at_points, _inside(kernels, made.points, normals, tolerance))
    # Those of joined cells are measured in pieces as long as undivided cells.
    counts = np.maximum(topology.edges.size[made.edge] // topology.unit, 1)
    found = distances(kernels, made.points, made.triangles, counts)
    misses, largest, place = found.largest, float(found.largest.max()), found.place

    def from_roots(rows: slice) -> Floats:
        a, b, c = (made.points[made.triangles[rows, i]] for i in range(3))
        root = roots.places[made.edge[rows]]
        found: Floats = rows_of(triangle_arithmetic.distance_to_triangle, root, a, b, c)
        return found

    back = np.concatenate(parallel_map(from_roots, slices_of(len(misses))))
    own = np.zeros(len(roots.places))
    runs_of = first_of_runs(made)
    own[made.edge[runs_of]] = np.minimum.reduceat(back, runs_of)
    from_surface = _from_surface(made, roots, topology, own, max(largest, float(at_points.max())))
    worst_point = float(at_points.max())
    if worst_point > largest:
        x, y, z = made.points[int(np.argmax(at_points))].tolist()
        largest, place = worst_point, (x, y, z)
    cut = int((at_points > _CUT * step).sum())
    turned = turns(kernels, made.points, made.triangles, counts, misses, tolerance, angle)
    accuracy = Accuracy(largest, found.mean, place, from_surface, worst_point, cut)
    return accuracy, normals, Misses(misses, at_points, own, turned)


def _inside(kernels: FieldKernels, points: Floats, normals: Floats, tolerance: float) -> Floats:
    """Return how far points on faces inside of a solid are from its surface, about; 0 for others.

    Values there are 0 in the face, and grow or fall alike to both sides.

    Args:
        kernels: The shape.
        points: The points of a mesh.
        normals: The normals there.
        tolerance: How far the mesh may be from the surface.
    """

    def value(places: Floats) -> Floats:
        found: Floats = kernels.call(arithmetic.distance_value, places, types=[("p", VEC3)])
        return found

    def alike(rows: Integers, off: float) -> Integers:
        way = off * normals[rows]
        ahead, behind = value(points[rows] + way), value(points[rows] - way)
        less, more = np.sort(np.abs([ahead, behind]), axis=0)
        found: Integers = rows[(ahead * behind > 0.0) & (less > _ALIKE * more) & (less > 0.5 * off)]
        return found

    away, off = np.zeros(len(points)), _FIRST_OFF * tolerance
    rows = alike(alike(np.arange(len(points)), off), _CLOSE * tolerance)  # no slit
    rows = rows[np.abs(value(points[rows])) < _IN_FACE * _CLOSE * tolerance]  # not in a thin wall
    # At a knife edge, too, both sides are alike; but there the face ends.
    first = np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=1)])
    for way in (first, np.cross(normals, first), -first, np.cross(first, normals)):
        rows = rows[np.abs(value(points[rows] + off * way[rows])) < (1.0 - _ALIKE) * off]
    while len(rows) and off < _LAST_OFF * tolerance:
        off *= _NEXT_OFF
        away[rows] = off
        rows = alike(rows, off)
    return away


def _from_surface(
    made: Triangles, roots: Roots, topology: Topology, own: Floats, known: float
) -> float:
    """Return the largest distance from a root to the mesh.

    A root is compared with the triangles around its edge. Where these are farther away than the
    error that is known already, those of neighboring edges are looked at, and of their neighbors.

    Args:
        made: The mesh.
        roots: The roots.
        topology: What belongs together.
        own: The distance of each root to the triangles around its edge.
        known: The error that is known.
    """
    far = np.argsort(-own, kind="stable")
    far = far[: int((own > known).sum())]
    rest = float(own[far[_MOST_SEARCHED]]) if len(far) > _MOST_SEARCHED else known
    nearest = own.copy()
    far = far[:_MOST_SEARCHED]
    count = np.bincount(made.edge, minlength=len(own))
    first = np.cumsum(count) - count
    root, edge = far, far
    for _ in range(_RINGS):
        if not len(root):
            break
        root, edge = _with_neighbors(topology, root, edge)
        of, triangle = runs(root, first[edge], count[edge])
        a, b, c = (made.points[made.triangles[triangle, i]] for i in range(3))
        distance = rows_of(triangle_arithmetic.distance_to_triangle, roots.places[of], a, b, c)
        np.minimum.at(nearest, of, distance)
        still = nearest[root] > known
        root, edge = root[still], edge[still]
    return max(float(nearest[far].max(initial=0.0)), min(rest, float(own.max())))


def _with_neighbors(
    topology: Topology, root: Integers, edge: Integers
) -> tuple[Integers, Integers]:
    """Return each root with the edges that share a point with one of its edges, itself included.

    Args:
        topology: What belongs together.
        root: The roots; one may be there several times.
        edge: An edge of each.
    """
    points = topology.points
    uses = np.diff(points.first, append=len(points.edges))
    around = topology.edges.around[edge].reshape(-1)
    owner, row = runs(np.repeat(root, 4), points.first[around], uses[around])
    count = len(topology.edges.around)
    pairs = sorted_keys(owner * count + points.edges[row])
    return pairs // count, pairs % count


def runs(owner: Integers, first: Integers, count: Integers) -> tuple[Integers, Integers]:
    """Return for each member of runs of numbers its owner and itself.

    Args:
        owner: The owner of each run.
        first: The first number of each run.
        count: How many numbers it has.
    """
    before = np.cumsum(count) - count
    within = np.arange(int(count.sum())) - np.repeat(before, count)
    return np.repeat(owner, count), np.repeat(first, count) + within


def first_of_runs(made: Triangles) -> Integers:
    """Return where the triangles of each edge begin; they are sorted by edge."""
    return np.flatnonzero(np.diff(made.edge, prepend=-1))


def lost_places(kernels: FieldKernels, suspicious: Floats, step: float, size: float) -> Floats:
    """Return points of the surface where the mesh has none, of shape (n, 3).

    Args:
        kernels: The shape.
        suspicious: Lattice points close to the surface whose cells have no change of sign.
        step: The length of a cell.
        size: The largest side of the shape's box.
    """
    if not len(suspicious):
        return suspicious
    some = suspicious[:: -(-len(suspicious) // _MOST_FOLLOWED)]
    lengths = [np.full(len(some), length) for length in (step, NARROWEST * size)]
    types: list[tuple[str, Type]] = [("p", VEC3), ("reach", FLOAT), ("narrow", FLOAT)]
    found, places = kernels.call(face_arithmetic.lost_surface, some, *lengths, types=types)
    lost: Floats = places[found]
    return lost


def split_lost(
    lattice: Lattice, topology: Topology, places: Floats, lost: Floats, surface: Integers
) -> tuple[Floats, Floats]:
    """Return the lost places that are apart from the mesh, and how far the others are from it.

    A corner that ends between lattice points is close to the mesh: it is cut, but no part is lost.

    Args:
        lattice: The lattice.
        topology: The points of its cells.
        places: Where they are.
        lost: Points of the surface that the mesh does not have.
        surface: The undivided cells that the surface passes through, in the order of their keys.

    Returns:
        The places that are apart, of shape (n, 3), and the distance of every place to the nearest
        point of the mesh, or what it can be at most; infinite for those that are apart.
    """
    if not len(lost):
        return lost, np.empty(0)
    unit = topology.unit
    side = lattice.step * unit
    home = np.floor((lost - lattice.origin) / side).astype(np.int64)
    cells = topology.points.cell // unit
    large = np.flatnonzero(topology.points.size > unit)
    cells[large] = np.floor((places[large] - lattice.origin) / side).astype(np.int64)
    keys = keys_of(cells)
    order = np.argsort(keys, kind="stable")
    of, row = _around(home, keys[order])
    row = order[row]
    nearest = np.full(len(lost), np.inf)
    for start in range(0, len(of), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        distance = rows_of(triangle_arithmetic.between, lost[of[some]], places[row[some]])
        np.minimum.at(nearest, of[some], distance)
    far = np.flatnonzero(np.isinf(nearest))
    if len(large) and len(far):
        # The mesh is close, but its points are far away: they are of larger cells.
        of, _ = _around(home[far], keys_of(surface))
        nearest[far[of]] = (
            float(topology.points.size.max() + CELLS_AROUND * unit) * 2.0 * lattice.step
        )
    return lost[np.isinf(nearest)], nearest


def _around(home: Integers, keys: Integers) -> tuple[Integers, Integers]:
    """Return the pairs of cells and rows of other cells that are close to them.

    Args:
        home: The cells, of shape (n, 3).
        keys: The keys of the others, sorted.
    """
    found = []
    around = range(-CELLS_AROUND, CELLS_AROUND + 1)
    for x, y in product(around, repeat=2):
        # Cells along z have keys in a row.
        first = np.searchsorted(keys, keys_of(home + np.array((x, y, -CELLS_AROUND))))
        last = np.searchsorted(keys, keys_of(home + np.array((x, y, CELLS_AROUND))), side="right")
        found.append(runs(np.arange(len(home)), first, last - first))
    return np.concatenate([of for of, _ in found]), np.concatenate([row for _, row in found])


def worst_corner(lost: Floats, nearest: Floats) -> CutCorner:
    """Return the cut corner that is farthest from the mesh."""
    nearest = np.where(np.isinf(nearest), 0.0, nearest)
    if not nearest.any():
        return CutCorner(0.0, (0.0, 0.0, 0.0))
    worst = int(np.argmax(nearest))
    x, y, z = lost[worst].tolist()
    return CutCorner(float(nearest[worst]), (x, y, z))
