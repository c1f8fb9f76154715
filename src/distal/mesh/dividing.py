"""Divide cells where a mesh is not within its tolerance.

Input: a mesh, and the distances that were measured. Output: a mesh whose cells are halved, as often
as needed, only where an error is too large or a corner is cut.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final, Literal, TypeAlias

import numpy as np

from distal.mesh.cell_tree import Divided, leaves_of, together, widened
from distal.mesh.extract import Extent, Extracted, completed
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import keys_of, position
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.tree_topology import (
    Tree,
    changes,
    settled,
    topology_of_changes,
    topology_of_tree,
)
from distal.polygons.whole_numbers import sorted_keys

Joined: TypeAlias = Literal["measured", "good", "replaced"]
# Errors of a fractal do not fall where its cells are divided: this ends with so many halves, or
# with as many as there are undivided cells.
_MOST_HALVES: Final = 1_000_000
# After a division the surroundings of the cells are measured, unless they are more than this share
# of all; in the end all is.
_MOST_OF_WHOLE: Final = 0.4
# Cells beside those that are too large that are divided with them, in each round. Where large cells
# meet small ones along a crease, an error may move by a cell in each round.
_RINGS: Final = (0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5)
# So does a turn along an edge of constant radius. From the fifth round on it may be a seventh more
# than it should: this is the square.
_TURNS: Final = (1.0, 1.0, 1.0, 1.0, 1.3)


def _unwatched(share: float) -> None:
    """Report nothing: how much is left is not known."""


def divided(
    kernels: FieldKernels,
    extent: Extent,
    found: Extracted,
    tolerance: float,
    watch: Callable[[float], None],
    angle: float = math.inf,
    *,
    joined_only: bool = False,
    also: Divided = (),
) -> Extracted:
    """Return a mesh with smaller cells where one is not within the tolerance.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        found: The mesh.
        tolerance: How far it may be from the surface, in scene units.
        watch: Called with the share of the work that is done.
        angle: How much the surface may turn within a triangle, in radians.
        joined_only: Whether no cells are divided but those that were joined.
        also: Other cells to divide, by level, however many there are.

    Raises:
        MeshProblem: A value is no number.
    """
    tree = tree_of(kernels, found)
    lattice, looked_at = tree.values.lattice, found.looked_at
    coarse = _some(_too_large(found, tree, tolerance), tree, joined_only=joined_only)
    if _too_many(tree, coarse):
        coarse = ()
    if also:
        coarse = together(coarse, also) if coarse else also
    for number, rings in enumerate(_RINGS):
        turn = _TURNS[min(number, len(_TURNS) - 1)]
        if not coarse:
            break
        before = tree.divided
        tree = settled(tree.with_divided(_with_rings(coarse, tree, rings)), before)
        changed = changes(tree, before)
        part = topology_of_changes(tree, changed, _MOST_OF_WHOLE)
        coarse = ()
        # Cells that only a suspicion divides may have no surface in them. Then edges at the rim of
        # the part are all there is: they count for nothing, and may have no segments.
        if part is not None and part[1].any():
            topology, certain = part
            near = _near_cells(looked_at.suspected, tree, changed)
            seen = replace(looked_at, suspected=looked_at.suspected[near])
            made = completed(kernels, extent, lattice, topology, seen, tolerance, _unwatched, angle)
            # Beyond the part there are no triangles, and what is there counts for nothing.
            made = made.with_suspected(_near_cells(made.looked_at.suspected, tree, changed))
            coarse = _too_large(made, tree, tolerance, certain, turn)
            coarse = _some(coarse, tree, joined_only=joined_only)
        if not coarse or number == len(_RINGS) - 1 or _too_many(tree, coarse):
            topology, tree = topology_of_tree(tree)
            given = lattice, topology, looked_at, tolerance
            made = completed(kernels, extent, *given, _unwatched, angle)
            found = replace(made, tree=tree)
            coarse = _too_large(found, tree, tolerance, turn=turn)
            coarse = _some(coarse, tree, joined_only=joined_only)
            if _too_many(tree, coarse):
                break
        watch((number + 1) / len(_RINGS))
    return found


def tree_of(kernels: FieldKernels, found: Extracted) -> Tree:
    """Return the cells of a mesh."""
    if found.tree is not None:
        return found.tree
    return Tree.of_equal_cells(kernels, found.lattice, keys_of(found.looked_at.surface))


def _too_many(tree: Tree, coarse: Divided) -> bool:
    """Return whether there would be too many halves if more cells were divided."""
    halved = sum(len(keys) for keys in (*tree.divided[tree.base :], *coarse))
    return 8 * halved > max(_MOST_HALVES, len(tree.surface))


def _some(coarse: Divided, tree: Tree, *, joined_only: bool) -> Divided:
    """Return the cells to divide, without those that are not joined if so asked; () for none."""
    if joined_only:
        coarse = tuple(keys if level < tree.base else keys[:0] for level, keys in enumerate(coarse))
    return coarse if any(len(keys) for keys in coarse) else ()


def _with_rings(coarse: Divided, tree: Tree, rings: int) -> Divided:
    """Return cells and those beside them that the surface may pass through."""
    if not rings:
        return coarse
    leaves = leaves_of(tree.surface, tree.divided, tree.levels, tree.base)
    found = []
    for level, keys in enumerate(coarse):
        own = leaves.key[leaves.of_level(level)]
        found.append(own[position(own, widened(keys, rings)) >= 0])
    return tuple(found)


def _near_cells(places: Floats, tree: Tree, changed: Divided) -> Bools:
    """Return which places are in cells or beside them."""
    lattice = tree.values.lattice
    near = np.zeros(len(places), np.bool_)
    for level, keys in enumerate(changed):
        side = lattice.step * (1 << tree.levels >> level)
        cells = keys_of(np.floor((places - lattice.origin) / side).astype(np.int64))
        near |= position(cells, widened(keys)) >= 0
    return near


def _too_large(
    found: Extracted,
    tree: Tree,
    tolerance: float,
    certain: Bools | None = None,
    turn: float = 1.0,
) -> Divided:
    """Return the keys of the cells to divide, by level.

    Args:
        found: The mesh.
        tree: Its cells.
        tolerance: How far the mesh may be from the surface.
        certain: The edges that count; None for all.
        turn: How much the surface may turn, as for ``Misses.excess``.
    """
    topology, made, misses = found.topology, found.made, found.misses
    corners = misses.points[made.triangles].max(axis=1)
    edges = misses.roots > tolerance
    edges[made.edge[np.maximum(misses.excess(tolerance, turn), corners) > tolerance]] = True
    far = edges if certain is None else edges & certain
    far_points = np.zeros(len(topology.points.size), np.bool_)
    far_points[topology.edges.around[far]] = True
    size = topology.points.size[far_points]
    level = tree.base + np.round(np.log2(topology.unit / size)).astype(np.int64)
    keys = keys_of(topology.points.cell[far_points] // size[:, None])
    tips = found.looked_at.suspected[np.isfinite(found.nearest) & (found.nearest > tolerance)]
    return tuple(
        sorted_keys(np.concatenate([keys[level == number], more]))
        for number, more in enumerate(_leaves_at(tips, tree))
    )


def _leaves_at(places: Floats, tree: Tree) -> Divided:
    """Return the keys of the cells that contain places and are not divided, by level."""
    found = []
    lattice = tree.values.lattice
    for level, keys in enumerate(tree.divided):
        side = lattice.step * (1 << tree.levels >> level)
        cells = keys_of(np.floor((places - lattice.origin) / side).astype(np.int64))
        known = position(cells, keys) >= 0
        found.append(cells[~known])
        places = places[known]
    return tuple(found)


def bad_share(found: Extracted, tolerance: float, joined: Joined = "measured") -> float:
    """Return the share of the surface that is too far from its triangles.

    A triangle of a joined cell counts as many times as those that it replaces.

    Args:
        found: The mesh.
        tolerance: How far it may be from the surface.
        joined: How triangles of joined cells count: as they are, as if they were good, or about as
            those that they replace, by an error that is quadratic in the length of a cell.
    """
    weights = _weights(found)
    misses = found.misses.excess(tolerance)
    if joined == "good":
        misses = np.where(weights > 1, 0.0, misses)
    elif joined == "replaced":
        misses = misses / weights
    return float(((misses > tolerance) * weights).sum() / weights.sum())


def typical_error(found: Extracted, tolerance: float) -> float:
    """Return the error that all but a tenth of the surface stays below, joined ones as replaced."""
    weights = _weights(found)
    misses = np.repeat(found.misses.excess(tolerance) / weights, weights)
    return float(np.quantile(misses, 0.9)) if len(misses) else math.inf


def _weights(found: Extracted) -> Integers:
    size = found.topology.edges.size[found.made.edge]
    return np.maximum(size // found.topology.unit, 1) ** 2
