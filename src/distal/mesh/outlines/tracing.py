"""Trace the outline of a flat shape within a tolerance.

Input: a shape's kernels, its box and a tolerance. Output: closed polylines, how far they are from
the edge, and what they miss. A coarse outline comes first; its measured error gives the next
spacing. Points that are not needed are then left out, within what is left of the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.accuracy import OutlineAccuracy, along_lines, from_points, thin_places
from distal.mesh.outlines.crossings import crossing_lines
from distal.mesh.outlines.loops import pieces_of
from distal.mesh.outlines.places import nearby, places_of, polylines
from distal.mesh.outlines.simplify import kept_points
from distal.mesh.outlines.tiles import (
    Bools,
    FlatExtent,
    Floats,
    Integers,
    TileLattice,
    Watch,
    edge_cells,
)

# The first outline has this many cells along the largest side of the box.
FIRST_CELLS: Final = 64
# The most tiles that are sampled; 40,000 have 2.6 million cells.
MOST_TILES: Final = 40_000
# Thin parts make the spacing finer up to this many tiles.
_TILES_FOR_THIN: Final = 4_000
_MOST_ROUNDS: Final = 12
# The share of the tolerance for the lattice, and for points that are left out.
_TRACED: Final = 0.4
_LEFT_OUT: Final = 0.5
# A next round is this much finer than the error needs.
_AIM: Final = 0.87
_COARSEST_STEP: Final = 0.9
_FINEST_STEP: Final = 0.2
# Points are rounded to this share of the box, so that crossings are exact in integers.
UNIT: Final = 2.0**-28


@dataclass(frozen=True, slots=True)
class TracedOutline:
    """An outline at one spacing.

    Attributes:
        step: The length of a cell, in scene units.
        sampled: How many tiles were sampled.
        cells: How many cells the edge passes through.
        loops: Points of each closed polyline, of shape (n, 2).
        corners: Which of them are corners of the shape.
        accuracy: How far they are from the edge.
        cut: How far the corner that is cut most is from the outline.
        cut_at: Where the outline cuts it.
        thin: Points of parts and gaps that are missing, of shape (n, 2).
        steepest: The largest gradient at a root.
        steepest_at: Where it is.
        crossings: How many pairs of lines meet.
    """

    step: float
    sampled: int
    cells: int
    loops: list[Floats]
    corners: list[Bools]
    accuracy: OutlineAccuracy
    cut: float
    cut_at: tuple[float, ...]
    thin: Floats
    steepest: float
    steepest_at: Floats
    crossings: int = 0

    @property
    def error(self) -> OutlineAccuracy:
        """The largest distance between outline and edge."""
        return self.accuracy.or_worse(OutlineAccuracy(self.cut, self.cut_at))


@dataclass(frozen=True, slots=True)
class NoOutline:
    """No outline: no sign changes at this spacing.

    Attributes:
        step: The length of a cell, in scene units.
        sampled: How many tiles were sampled.
        thin: Points of an edge that passes between the points of the lattice.
    """

    step: float
    sampled: int
    thin: Floats


@dataclass(frozen=True, slots=True)
class TooManyTiles:
    """The tolerance needs too many cells.

    Attributes:
        tolerance: The tolerance that is possible, about.
        points: About how many points the outline would have before any are left out.
    """

    tolerance: float
    points: float


def traced(
    kernels: FieldKernels,
    extent: FlatExtent,
    tolerance: float,
    watch: Watch,
    coarsest: float = math.inf,
) -> TracedOutline | NoOutline | TooManyTiles:
    """Return an outline within the tolerance, or what prevents it.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        tolerance: How far the outline may be from the edge, in scene units.
        watch: Called with the share of the work that is done.
        coarsest: The longest cells that are taken.

    Raises:
        MeshProblem: The shape has no outline.
    """
    step, done = min(extent.size / FIRST_CELLS, coarsest), 0.0
    for _round in range(_MOST_ROUNDS):
        share = 0.4 * (1.0 - done)

        def inner(part: float, base: float = done, share: float = share) -> None:
            watch(base + share * part)

        found = _at_spacing(kernels, extent, step, inner)
        done += share
        following = _next_step(found, tolerance)
        if following is None:
            break
        tiles = found.sampled * found.step / following
        if tiles > MOST_TILES and isinstance(found, TracedOutline):
            possible = found.error.largest * found.sampled / MOST_TILES / _TRACED
            return TooManyTiles(2.0 * possible, 2.0 * found.cells * found.step / following)
        step = following
    return found if isinstance(found, NoOutline) else _simplified(kernels, extent, found, tolerance)


def _at_spacing(
    kernels: FieldKernels, extent: FlatExtent, step: float, watch: Watch
) -> TracedOutline | NoOutline:
    lattice = TileLattice.over(extent, step)
    cells = edge_cells(kernels, lattice, extent, 2 * MOST_TILES, lambda share: watch(0.5 * share))
    thin = thin_places(kernels, cells.suspected, step)
    if not len(cells.cells):
        return NoOutline(step, cells.sampled, thin)
    pieces = pieces_of(kernels, lattice, cells)
    places = places_of(kernels, lattice, cells, pieces)
    watch(0.8)
    loops, corners = polylines(places, pieces.loops)
    a, b = lines_of(loops)
    # Samples in a cell are at most a diagonal from its roots, whatever the values' gradient says.
    accuracy = along_lines(kernels, a, b, np.ones(len(a), np.int64))
    accuracy = replace(accuracy, largest=min(accuracy.largest, 1.5 * step))
    # A tip between the points of the lattice belongs to the outline beside it, whose error it is.
    tips = nearby(lattice, cells, pieces, places, thin)
    near = np.isfinite(tips)
    cuts = np.concatenate([places.cut, tips[near]])
    cut = int(np.argmax(cuts))
    cut_at = np.concatenate([places.points, thin[near]])[cut]
    return TracedOutline(
        step=step,
        sampled=cells.sampled,
        cells=len(cells.cells),
        loops=loops,
        corners=corners,
        accuracy=accuracy,
        cut=float(cuts[cut]),
        cut_at=tuple(cut_at.tolist()),
        thin=thin[~near],
        steepest=places.steepest,
        steepest_at=places.steepest_at,
    )


def lines_of(loops: list[Floats]) -> tuple[Floats, Floats]:
    """Return both ends of all lines of closed polylines."""
    ends = [np.roll(loop, -1, axis=0) for loop in loops]
    return np.concatenate(loops), np.concatenate(ends)


def _next_step(found: TracedOutline | NoOutline, tolerance: float) -> float | None:
    """Return the next spacing; None if this outline is as wanted."""
    if len(found.thin) or isinstance(found, NoOutline):
        finer = 2 * found.sampled <= _TILES_FOR_THIN and found.sampled > 0
        if finer:
            return found.step / 2.0
    if isinstance(found, NoOutline):
        return None
    wanted = _TRACED * tolerance
    if max(found.accuracy.largest, found.cut) <= wanted:
        return None
    # The error of a smooth edge falls with the square of the spacing, that of a cut corner with it.
    factor = math.sqrt(wanted / max(found.accuracy.largest, wanted))
    factor = _AIM * min(factor, wanted / max(found.cut, wanted))
    return found.step * min(max(factor, _FINEST_STEP), _COARSEST_STEP)


def _simplified(
    kernels: FieldKernels, extent: FlatExtent, found: TracedOutline, tolerance: float
) -> TracedOutline:
    """Return the outline with rounded points, without those that are not needed.

    Args:
        kernels: The shape.
        extent: Its box.
        found: The outline.
        tolerance: How far it may be from the edge.
    """
    middle, unit = (extent.low + extent.high) * 0.5, UNIT * extent.size
    whole = [np.rint((loop - middle) / unit).astype(np.int64) for loop in found.loops]
    distance = _LEFT_OUT * tolerance
    for _attempt in range(4):
        kept = kept_points(found.loops, found.corners, distance)
        rounded = [loop[rows] for loop, rows in zip(whole, kept, strict=True)]
        if not len(crossing_lines(rounded)):
            loops = [loop * unit + middle for loop in rounded]
            accuracy = _of_kept(kernels, found.loops, loops, kept)
            if max(accuracy.largest, found.cut) <= tolerance:
                return _with(found, loops, kept, accuracy)
        distance *= 0.25
    every = [np.arange(len(loop)) for loop in found.loops]
    loops = [loop * unit + middle for loop in whole]
    crossings = len(crossing_lines(whole))
    return replace(_with(found, loops, every, found.accuracy), crossings=crossings)


def _with(
    found: TracedOutline, loops: list[Floats], kept: list[Integers], accuracy: OutlineAccuracy
) -> TracedOutline:
    corners = [corner[rows] for corner, rows in zip(found.corners, kept, strict=True)]
    return replace(found, loops=loops, corners=corners, accuracy=accuracy)


def _of_kept(
    kernels: FieldKernels, before: list[Floats], loops: list[Floats], kept: list[Integers]
) -> OutlineAccuracy:
    """Return how far an outline is from the edge, and from all points that were on it.

    Args:
        kernels: The shape.
        before: The points of the outline with all points.
        loops: The points that stay.
        kept: Their indices.
    """
    counts, starts = [], 0
    points, line = [], []
    for loop, rows in zip(before, kept, strict=True):
        steps = (np.roll(rows, -1) - rows) % len(loop)
        counts.append(steps)
        points.append(np.roll(loop, -rows[0], axis=0))
        line.append(np.repeat(np.arange(len(rows)), steps) + starts)
        starts += len(rows)
    a, b = lines_of(loops)
    rows = np.concatenate(line)
    back = from_points(np.concatenate(points), a[rows], b[rows])
    return along_lines(kernels, a, b, np.concatenate(counts)).or_worse(back)
