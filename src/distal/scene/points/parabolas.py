"""A curve given by a formula as parabolas that follow it within a tolerance.

Input: a Python function of a number. Output: the points of quadratic Bézier curves, and the largest
distance that was measured between them and the function's curve. Does not depend on shapes.

A piece of the curve is replaced by two parabolas that have its ends and, at the ends, its
directions, so neighbors join smoothly. A piece that is too far from the curve at one of the
measured places is halved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from distal.diagnostics import Span
from distal.scene.points.curves import CLOSED, CurveFunction, Floats, evaluated
from distal.scene.tree.errors import refuse

# Places in each piece where it is compared with the curve.
PLACES: Final = 16
# The most pieces, of two parabolas each: each takes time at every point of a picture.
MOST_PIECES: Final = 512
# Pieces before any is halved, so that no wave of a formula is between two places.
FIRST_PIECES: Final = 8
# Half of the difference of t, as a fraction of the whole, by which a velocity is measured.
STEP: Final = 1e-4
# Directions at the two ends of a closed curve that differ by less than this are one direction.
SMOOTH: Final = 1e-2


@dataclass(frozen=True, slots=True)
class Parabolas:
    """The parabolas of a curve.

    Attributes:
        points: The start, then a control point and an end for each, (2 n + 1, 3).
        error: The largest measured distance from the formula's curve.
        closed: Whether the end is the start.
    """

    points: Floats
    error: float
    closed: bool


def parabolas_of(
    function: CurveFunction,
    start: float,
    end: float,
    tolerance: Callable[[float], float],
    place: Span | None,
) -> Parabolas:
    """Return parabolas that follow the curve of a function.

    Args:
        function: Returns the point at a number.
        start: The number at the start.
        end: The number at the end.
        tolerance: Returns the largest allowed distance for the size of the curve.
        place: The author's line.

    Raises:
        SceneTypeError: The function returns something else than three numbers.
        SceneValueError: A point is not finite, the curve has no length, or it needs too many
            pieces.
    """
    known = _Formula(function, start, end, place)
    ends = [known.at(t) for t in np.linspace(0.0, 1.0, FIRST_PIECES + 1)]
    size = float(np.ptp(np.array([e.point for e in ends]), axis=0).max())
    if size == 0.0:
        refuse("the curve has no length", "a formula that moves the point", place)
    if known.is_smooth(ends[0], ends[-1], size):
        ends[-1] = _CurveEnd(1.0, ends[0].point, ends[0].velocity)
    allowed = tolerance(size)
    waiting = [*pairwise(ends)][::-1]
    points, worst, count = [ends[0].point], 0.0, 0
    while waiting:
        a, b = waiting.pop()
        piece = _piece(a, b)
        error = known.error(a.t, b.t, piece)
        if error > allowed:
            if count + len(waiting) >= MOST_PIECES:
                refuse(
                    f"the curve needs more than {MOST_PIECES} pieces to be within {allowed:.3g}",
                    "allow more: tolerance=…, or cut the curve in two",
                    place,
                )
            middle = known.at(0.5 * (a.t + b.t))
            waiting += [(middle, b), (a, middle)]
            continue
        worst, count = max(worst, error), count + 1
        points.extend(piece[1:])
    return Parabolas(
        np.array(points), worst, bool(np.linalg.norm(points[-1] - points[0]) <= CLOSED * size)
    )


@dataclass(frozen=True, slots=True)
class _CurveEnd:
    """An end of a piece: where it is on the curve, its point, its velocity."""

    t: float
    point: Floats
    velocity: Floats


def _piece(a: _CurveEnd, b: _CurveEnd) -> list[Floats]:
    """Return the five points of the two parabolas between two ends."""
    span = b.t - a.t
    first = a.point + 0.25 * span * a.velocity
    second = b.point - 0.25 * span * b.velocity
    return [a.point, first, 0.5 * (first + second), second, b.point]


class _Formula:
    """A function on the numbers from 0 to 1, whose velocities are measured."""

    def __init__(
        self, function: CurveFunction, start: float, end: float, place: Span | None
    ) -> None:
        self._function, self._start, self._end, self._place = function, start, end, place

    def points(self, at: Floats) -> Floats:
        """Return points of the curve."""
        places = self._start + (self._end - self._start) * at
        return evaluated(self._function, places, self._place)

    def at(self, t: float) -> _CurveEnd:
        """Return the point and the velocity: that of the parabola through three points near it."""
        middle = min(max(t, STEP), 1.0 - STEP)
        before, here, after, own = self.points(np.array([middle - STEP, middle, middle + STEP, t]))
        bend = (after - 2.0 * here + before) * ((t - middle) / STEP)
        return _CurveEnd(t, own, (0.5 * (after - before) + bend) / STEP)

    def error(self, start: float, end: float, piece: list[Floats]) -> float:
        """Return the largest distance from the curve at the measured places of a piece."""
        shares = (np.arange(PLACES) + 0.5) / PLACES
        true = self.points(start + (end - start) * shares)
        u = 2.0 * shares
        half = np.minimum(u.astype(int), 1)
        u = (u - half)[:, None]
        p = np.array(piece)
        a, c, b = (p[2 * half + i] for i in range(3))
        found = (1.0 - u) ** 2 * a + 2.0 * u * (1.0 - u) * c + u**2 * b
        return float(np.linalg.norm(found - true, axis=1).max())

    def is_smooth(self, first: _CurveEnd, last: _CurveEnd, size: float) -> bool:
        """Return whether the curve is closed, with one velocity where its ends meet."""
        if np.linalg.norm(first.point - last.point) > CLOSED * size:
            return False
        larger = max(np.linalg.norm(first.velocity), np.linalg.norm(last.velocity))
        return bool(np.linalg.norm(first.velocity - last.velocity) <= SMOOTH * larger)
