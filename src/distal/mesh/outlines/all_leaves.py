"""Trace an outline that shows every leaf of its shape.

Input: a shape's kernels, its box and a tolerance. Output: an outline whose cells are as small as
the leaves that were missing need, and what is still missing (``mesh.leaf_check``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from distal.mesh.bricks import Slopes
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_check import MISSING, LeafCheck, distances, result_of
from distal.mesh.leaf_places import LeafSearch, joined
from distal.mesh.outlines.tiles import FlatExtent, Floats, Watch
from distal.mesh.outlines.tracing import (
    MOST_TILES,
    NoOutline,
    TooManyTiles,
    TracedOutline,
    lines_of,
    traced,
)

_MOST_ROUNDS: Final = 8
# The share of a box's side that cells get: what is as wide as the box has samples inside.
_SHARE: Final = 0.7


@dataclass(frozen=True, slots=True)
class WholeOutline:
    """An outline, and what was compared with it."""

    outline: TracedOutline
    leaves: LeafCheck


def traced_with_leaves(
    kernels: FieldKernels, extent: FlatExtent, tolerance: float, watch: Watch
) -> WholeOutline | NoOutline | TooManyTiles:
    """Return an outline within the tolerance that shows all leaves, or what prevents it.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        tolerance: How far the outline may be from the edge, in scene units.
        watch: Called with the share of the work that is done.

    Raises:
        MeshProblem: The shape has no outline.
    """
    found = traced(kernels, extent, tolerance, watch)
    if isinstance(found, TooManyTiles) or (isinstance(found, NoOutline) and not found.sampled):
        return found
    slopes = Slopes(extent.slope, extent.divisor)
    search = LeafSearch(kernels, extent.low, extent.high, slopes, tolerance)
    rows = search.places()
    for _ in range(_MOST_ROUNDS):
        limit, lines = _compared(found, tolerance)
        away = distances(rows, lines, limit)
        far = away > tolerance
        step = float(rows.side[far].min(initial=np.inf)) * _SHARE
        if not far.any() or found.sampled * found.step / step > MOST_TILES:
            break
        finer = traced(kernels, extent, tolerance, watch, coarsest=min(step, found.step / 2.0))
        if isinstance(finer, TooManyTiles):
            break
        found = finer
        rows = joined([rows, search.finer(rows.some(far))], 2)
    limit, lines = _compared(found, tolerance)
    check = result_of(search, rows, distances(rows, lines, limit), limit)
    if isinstance(found, TracedOutline):
        return WholeOutline(found, check)
    return found


def _compared(found: TracedOutline | NoOutline, tolerance: float) -> tuple[float, Floats]:
    """Return how far a place may be from an outline, and the ends of its lines."""
    if isinstance(found, NoOutline):
        return MISSING * tolerance, np.empty((0, 2, 2))
    limit = MISSING * max(tolerance, found.error.largest)
    return limit, np.stack(lines_of(found.loops), axis=1)
