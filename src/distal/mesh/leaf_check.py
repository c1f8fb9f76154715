"""Check that a mesh shows every leaf of its shape, in each copy; divide cells where it does not.

Input: a mesh and the shape that it was made from. Output: the mesh, divided where triangles were
missing, and what is still missing. The places that are demanded do not depend on how the mesh was
made (``leaf_places``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, NoReturn

import numpy as np

from distal.mesh.bridges import bridges_of
from distal.mesh.cell_tree import HALVES, Divided
from distal.mesh.dividing import divided, tree_of
from distal.mesh.element_grid import to_nearest
from distal.mesh.extract import Extent, Extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import keys_of
from distal.mesh.leaf_places import LeafRows, LeafSearch, joined
from distal.mesh.leaf_spacing import LEAST_WALL
from distal.mesh.refusals import shown_place
from distal.mesh.solid import Floats
from distal.mesh.tree_topology import Tree
from distal.polygons.whole_numbers import sorted_keys
from distal.scene.lowering.placed_leaves import PlacedLeaf
from distal.scene.tree.errors import refuse

# A place that is farther from the mesh than so many times the tolerance, and the largest error that
# was measured, is missing; a nearer one is an error.
MISSING: Final = 2.0
_MOST_ROUNDS: Final = 8
# The share of a box's side that cells get: a bore as wide as the box has a sample inside.
_SHARE: Final = 1.0 / math.sqrt(3.0)
_MOST_CELLS: Final = 40_000  # that are divided for leaves
# The corners and the middle of a box, from its middle.
_AROUND: Final = np.concatenate([HALVES - 0.5, np.zeros((1, 3))])


@dataclass(frozen=True, slots=True)
class MissingLeaf:
    """A leaf that has surface where a mesh or an outline has none.

    Attributes:
        leaf: The leaf.
        place: A place of its surface.
        width: About how wide it is there, at most.
        count: How many places are missing.
    """

    leaf: PlacedLeaf
    place: Floats
    width: float
    count: int


@dataclass(frozen=True, slots=True)
class LeafCheck:
    """What was found.

    Attributes:
        leaves: How many leaves were looked for.
        places: How many places of them were compared with the mesh.
        missing: What is missing.
        error: The largest distance of a place that is not missing.
        error_at: Where it is; None if no place was compared.
        unchecked: Leaves that were not looked for (``LeafSearch.unchecked``).
        coarse: Leaves that are thinner than the distance of the places.
        bridges: Where two surfaces may be joined, of shape (n, 3): not to would take too
            many cells.
    """

    leaves: int
    places: int
    missing: Sequence[MissingLeaf]
    error: float
    error_at: tuple[float, ...] | None
    unchecked: Sequence[PlacedLeaf]
    coarse: Sequence[PlacedLeaf]
    bridges: Floats | None = None

    def report(self) -> dict[str, Any]:
        """Return what a report says about it."""
        names = [leaf.text for leaf in self.unchecked]
        return {"count": self.leaves, "places": self.places, "unchecked": names}

    def warnings(self) -> list[str]:
        """Return what is not certain, in words."""
        said = [
            f"{leaf.text} is thin in too many places: not all of them were looked up"
            for leaf in self.coarse
        ]
        if self.bridges is not None and len(self.bridges):
            where = shown_place(self.bridges[0])
            said.append(f"two surfaces may be joined across a narrow gap or wall at {where}")
        return said


def refuse_missing(missing: Sequence[MissingLeaf], result: str, hint: str) -> NoReturn:
    """Refuse a result that does not show a leaf of its shape.

    Args:
        missing: What is missing.
        result: What it is missing in: "mesh", "outline".
        hint: What to write instead; ``{width}`` is how wide the leaf is.

    Raises:
        SceneValueError: Always.
    """
    first = missing[0]
    leaf, others = first.leaf.leaf, len(missing) - 1
    more = f", and so {'is 1 other' if others == 1 else f'are {others} others'}" if others else ""
    where = ", ".join(f"{number:.4g}" for number in first.place)
    refuse(
        f"{first.leaf.text} is missing in the {result} at ({where}){more}: it is thinner than "
        f"{first.width:.2g} there",
        hint.format(width=f"{first.width:.2g}"),
        leaf.place,
    )


def with_all_leaves(
    kernels: FieldKernels,
    extent: Extent,
    found: Extracted,
    tolerance: float,
    watch: Callable[[float], None],
) -> tuple[Extracted, LeafCheck]:
    """Return a mesh with cells divided where a leaf had no triangles, and what is still missing.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        found: The mesh.
        tolerance: How far it may be from the surface, in scene units.
        watch: Called with the share of the work that is done.

    Raises:
        MeshProblem: A value is no number.
    """
    watch(1.0)
    search = LeafSearch(kernels, extent.low, extent.high, extent.slopes, tolerance)
    rows = search.places()
    watch(1.0)
    away = distances(rows, found.made.points[found.made.triangles], MISSING * tolerance)
    most = _MOST_CELLS + _halved(found.tree)
    for number in range(_MOST_ROUNDS + 1):
        watch(1.0)
        far = away > tolerance
        some = rows.some(far)
        # What is still far has its cells halved once more in each round.
        some = replace(some, side=some.side * 0.5**number)
        tree = tree_of(kernels, found)
        bridges = bridges_of(kernels, found, LEAST_WALL * tolerance)
        place = np.concatenate([some.place, bridges.place])
        cells = _cells_at(tree, place, np.concatenate([some.side, bridges.gap]))
        halved = _halved(tree.with_divided(cells))
        if halved == _halved(tree) or halved > most or number == _MOST_ROUNDS:
            break
        found = divided(
            kernels,
            extent,
            replace(found, tree=tree),
            tolerance,
            lambda share: watch(1.0),
            also=cells,
        )
        rows = joined([rows, search.finer(rows.some(far))], rows.place.shape[1])
        away = distances(rows, found.made.points[found.made.triangles], MISSING * tolerance)
    limit = _limit(found, tolerance)
    far = away > limit
    if far.any() and limit > MISSING * tolerance:
        away[far] = distances(rows.some(far), found.made.points[found.made.triangles], limit)
    check = result_of(search, rows, away, limit)
    return found, replace(check, bridges=bridges.place) if halved > most else check


def _limit(found: Extracted, tolerance: float) -> float:
    """Return how far a place may be from a mesh whose errors are reported."""
    return MISSING * max(tolerance, found.error, found.corner.distance)


def distances(rows: LeafRows, corners: Floats, reach: float) -> Floats:
    """Return how far places are from triangles or lines that face as the leaf does there.

    Args:
        rows: The places.
        corners: The corners of the triangles or lines.
        reach: Places that are farther may be infinitely far.
    """
    if not len(corners):
        return np.full(len(rows), np.inf)
    return to_nearest(corners, rows.place, reach, rows.outward)


def result_of(search: LeafSearch, rows: LeafRows, away: Floats, limit: float) -> LeafCheck:
    """Return what a comparison found.

    Args:
        search: The search that found the places.
        rows: The places.
        away: How far each is from the mesh or the outline.
        limit: A place that is farther is missing.
    """
    gone = away > limit
    missing = []
    for number in np.unique(rows.leaf[gone]):
        own = np.flatnonzero(gone & (rows.leaf == number))
        first = own[np.argmin(rows.side[own])]
        leaf = search.leaves[int(number)]
        width = float(rows.side[first])
        missing.append(MissingLeaf(leaf, rows.place[first], width, len(own)))
    near = np.where(gone, 0.0, away)
    worst = int(np.argmax(near)) if len(near) else 0
    return LeafCheck(
        leaves=len(search.leaves),
        places=len(rows),
        missing=missing,
        error=float(near[worst]) if len(near) else 0.0,
        error_at=tuple(rows.place[worst].tolist()) if len(near) else None,
        unchecked=search.unchecked,
        coarse=[search.leaves[number] for number in sorted(search.coarse)],
    )


def _halved(tree: Tree | None) -> int:
    """Return how many cells of a tree are divided that are not joined."""
    return 0 if tree is None else sum(len(keys) for keys in tree.divided[tree.base :])


def _cells_at(tree: Tree, place: Floats, width: Floats) -> Divided:
    """Return the keys of the cells to divide at boxes around places, by level.

    Args:
        tree: The cells.
        place: The places, of shape (n, 3).
        width: The sides of the boxes.
    """
    lattice = tree.values.lattice
    found = []
    for level in range(tree.levels):
        side = lattice.step * (1 << tree.levels >> level)
        large = width * _SHARE < side
        if level < tree.base or not large.any():
            found.append(np.empty(0, np.int64))
            continue
        near = place[large, None] + _AROUND * width[large, None, None]
        cells = np.floor((near.reshape(-1, 3) - lattice.origin) / side).astype(np.int64)
        found.append(sorted_keys(keys_of(cells)))
    return tuple(found)
