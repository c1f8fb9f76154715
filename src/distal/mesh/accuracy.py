"""How far a mesh is from the surface, measured both ways, and what it misses.

Input: a mesh's triangles and the shape's kernels. Output: distances and places. Distances are of
first order: the value divided by the length of the gradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from distal.ir.types import FLOAT, VEC3
from distal.mesh import arithmetic, triangle_arithmetic
from distal.mesh.kernels import FieldKernels, rows_of
from distal.mesh.lattice import Lattice, keys_of, position
from distal.mesh.places import Roots
from distal.mesh.solid import Floats, Integers
from distal.mesh.topology import Topology
from distal.mesh.triangulate import Triangles

SAMPLES: Final = 7  # points of each triangle, besides its corners
_AT_ONCE: Final = 1 << 16
_CUT: Final = 1e-3  # cells
# The most lattice points that are followed to a surface that the mesh does not have.
_MOST_FOLLOWED: Final = 1 << 14
# The most roots that are compared with more triangles than those around their own edge.
_MOST_SEARCHED: Final = 1 << 12
_RINGS: Final = 2
_AROUND: Final = 2  # cells; a lost place that is farther from all cells of the mesh is a lost part


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
class CutCorner:
    """A corner of the surface that the mesh cuts.

    Attributes:
        distance: How far it is from the nearest point of the mesh, at most; 0 if none is cut.
        place: Where it is.
    """

    distance: float
    place: tuple[float, float, float]


def measured(
    kernels: FieldKernels, made: Triangles, roots: Roots, topology: Topology, step: float
) -> tuple[Accuracy, Floats]:
    """Return the accuracy of a mesh, and the normals at its points.

    Args:
        kernels: The shape.
        made: The mesh.
        roots: The roots on edges of the lattice.
        topology: What belongs together.
        step: The length of a cell.
    """
    at_points, normals = kernels.call(
        arithmetic.distance_and_normal,
        made.points,
        np.full(len(made.points), step),
        types=[("p", VEC3), ("step", FLOAT)],
    )
    corners = made.points[made.triangles]
    largest, total, place = 0.0, 0.0, made.points[int(np.argmax(at_points))]
    back = np.empty(len(corners))
    for start in range(0, len(corners), _AT_ONCE):
        rows = slice(start, start + _AT_ONCE)
        a, b, c = (corners[rows, i] for i in range(3))
        found = kernels.call(
            arithmetic.largest_miss, a, b, c, types=[(name, VEC3) for name in "abc"]
        )
        worst = int(np.argmax(found[:, 0]))
        total += float(found[:, 1].sum())
        if found[worst, 0] > largest:
            largest, place = float(found[worst, 0]), corners[start + worst].mean(axis=0)
        root = roots.places[made.edge[rows]]
        back[rows] = rows_of(triangle_arithmetic.distance_to_triangle, root, a, b, c)
    own = np.minimum.reduceat(back, first_of_runs(made))
    from_surface = _from_surface(made, roots, topology, own, max(largest, float(at_points.max())))
    worst_point = float(at_points.max())
    if worst_point > largest:
        largest, place = worst_point, made.points[int(np.argmax(at_points))]
    x, y, z = (float(number) for number in place)
    mean = total / len(corners)
    cut = int((at_points > _CUT * step).sum())
    return Accuracy(largest, mean, (x, y, z), from_surface, worst_point, cut), normals


def _from_surface(
    made: Triangles, roots: Roots, topology: Topology, own: Floats, known: float
) -> float:
    """Return the largest distance from a root to the mesh.

    A root is compared with the triangles around its edge. Where these are farther away than the
    error that is known already, those of neighbouring edges are looked at, and of their neighbours.

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
    first = first_of_runs(made)
    count = np.diff(first, append=len(made.edge))
    root, edge = far, far
    for _ in range(_RINGS):
        if not len(root):
            break
        root, edge = _with_neighbours(topology, root, edge)
        of, triangle = runs(root, first[edge], count[edge])
        a, b, c = (made.points[made.triangles[triangle, i]] for i in range(3))
        distance = rows_of(triangle_arithmetic.distance_to_triangle, roots.places[of], a, b, c)
        np.minimum.at(nearest, of, distance)
        still = nearest[root] > known
        root, edge = root[still], edge[still]
    return max(float(nearest[far].max(initial=0.0)), min(rest, float(own.max())))


def _with_neighbours(
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
    pairs = np.unique(owner * count + points.edges[row])
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


def lost_places(kernels: FieldKernels, suspicious: Floats, step: float) -> Floats:
    """Return points of the surface where the mesh has none, of shape (n, 3).

    Args:
        kernels: The shape.
        suspicious: Lattice points close to the surface whose cells have no change of sign.
        step: The length of a cell.
    """
    if not len(suspicious):
        return suspicious
    some = suspicious[:: -(-len(suspicious) // _MOST_FOLLOWED)]
    reach = np.full(len(some), step)
    found, places = kernels.call(
        arithmetic.lost_surface, some, reach, types=[("p", VEC3), ("reach", FLOAT)]
    )
    lost: Floats = places[found]
    return lost


def split_lost(
    lattice: Lattice, topology: Topology, places: Floats, lost: Floats
) -> tuple[Floats, CutCorner]:
    """Return the lost places that are apart from the mesh, and the worst of the others.

    A corner that ends between lattice points is close to the mesh: it is cut, but no part is lost.

    Args:
        lattice: The lattice.
        topology: The points of its cells.
        places: Where they are.
        lost: Points of the surface that the mesh does not have.
    """
    if not len(lost):
        return lost, CutCorner(0.0, (0.0, 0.0, 0.0))
    keys, row = np.unique(keys_of(topology.points.cell), return_index=True)
    home = np.floor((lost - lattice.origin) / lattice.step).astype(np.int64)
    nearest = np.full(len(lost), np.inf)
    around = range(-_AROUND, _AROUND + 1)
    for step in product(around, repeat=3):
        at = position(keys_of(home + np.array(step)), keys)
        found = np.flatnonzero(at >= 0)
        if len(found):
            ends = lost[found], places[row[at[found]]]
            distance = rows_of(triangle_arithmetic.between, *ends)
            nearest[found] = np.minimum(nearest[found], distance)
    apart = np.isinf(nearest)
    nearest[apart] = 0.0
    worst = int(np.argmax(nearest))
    x, y, z = lost[worst].tolist()
    return lost[apart], CutCorner(float(nearest[worst]), (x, y, z))
