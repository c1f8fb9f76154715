"""Points along a curve, at equal distances.

Input: a polyline, or a Python function of a number from 0 to 1. Output: points and tangents as
NumPy arrays. Does not depend on shapes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import Span
from distal.ir.types import VEC3
from distal.lang.source_places import author_place
from distal.scene.points.requests import positive, whole_number
from distal.scene.tree.columns import column, rows_of
from distal.scene.tree.conversion import Asked, Number, number
from distal.scene.tree.errors import refuse, refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Points, Vector

Floats: TypeAlias = NDArray[np.float64]
# A curve as a function of a number from 0 (its start) to 1 (its end).
CurveFunction: TypeAlias = Callable[[float], Any]

# Pieces by which the length of a function's curve is measured: for a circle, the length is then
# 1e-7 of itself too small.
PIECES: Final = 4096
# Half of the difference of t by which a tangent is measured.
STEP: Final = 1e-4
# A curve whose ends are nearer than this fraction of its length is closed.
CLOSED: Final = 1e-6


def points_along(
    curve: CurveFunction | Points, count: int | None = None, *, spacing: float | None = None
) -> tuple[Floats, Floats]:
    """Return points at equal distances along a curve, and the tangents there.

    An open curve has a point at either end. A closed one, whose end is its start, has no second
    point there.

    Args:
        curve: An (n, 3) array of the corners of a polyline, or a function of t, from 0 at the start
            to 1 at the end, that returns a point.
        count: Number of points.
        spacing: Distance from point to point along the curve, instead of ``count``; it is changed a
            little so that the curve is divided evenly.

    Returns:
        Two (n, 3) arrays: the points, and the tangents, of length 1, towards the end.

    Raises:
        SceneTypeError: The curve is neither points nor a function that returns points.
        SceneValueError: The curve has no length, or not exactly one of count and spacing is given.
    """
    place = author_place()
    if callable(curve):
        return _along_function(curve, count, spacing, place)
    return _along_polyline(curve, count, spacing, place)


def circle_path(
    radius: float = 1.0, center: Vector = (0.0, 0.0, 0.0), normal: Vector = (0.0, 1.0, 0.0)
) -> CurveFunction:
    """Return a circle as a curve for ``points_along``.

    Seen from the end of the normal, it runs counterclockwise.

    Args:
        radius: Radius of the circle.
        center: Its middle.
        normal: Direction perpendicular to its plane.

    Raises:
        SceneValueError: The radius is not above 0, or the normal is zero.
    """
    place = author_place()
    size = positive(radius, "radius of circle_path", place)
    middle = _vector(center, "center", "circle_path", place)
    up = _vector(normal, "normal", "circle_path", place)
    length = float(np.linalg.norm(up))
    if length == 0.0:
        refuse("'normal of circle_path' has no direction: it is zero", place=place)
    up /= length
    # Any direction perpendicular to the normal; for the y axis it is z, so that the next is x.
    side = np.cross(up, (0.0, 1.0, 0.0) if abs(up[1]) < 0.9 else (-1.0, 0.0, 0.0))
    side *= size / np.linalg.norm(side)
    other = np.cross(up, side)

    def circle(t: float) -> Floats:
        angle = math.tau * t
        made: Floats = middle + math.cos(angle) * side + math.sin(angle) * other
        return made

    return circle


def helix_path(radius: float = 1.0, height: float = 1.0, turns: float = 1.0) -> CurveFunction:
    """Return a helix about the y axis, from y = 0 upwards, as a curve for ``points_along``.

    Args:
        radius: Distance from the axis.
        height: Height of the whole helix.
        turns: Number of turns; negative for a left-handed helix.

    Raises:
        SceneValueError: The radius is not above 0.
    """
    place = author_place()
    size = positive(radius, "radius of helix_path", place)

    def helix(t: float) -> tuple[float, float, float]:
        angle = math.tau * turns * t
        return size * math.sin(angle), height * t, size * math.cos(angle)

    return helix


def _vector(value: Any, name: str, what: str, place: Span | None) -> Floats:
    made: Number = number(value, Asked(name, what, VEC3, place=place))
    return np.array(made.plain, dtype=np.float64)


def _along_polyline(
    corners: Any, count: int | None, spacing: float | None, place: Span | None
) -> tuple[Floats, Floats]:
    asked = Asked("curve", "points_along", VEC3, place=place)
    known = column(rows_of(corners, asked), asked)
    points = np.array([made.plain for made in known], dtype=np.float64)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1) if len(steps) else np.zeros(0)
    kept = lengths > 0.0
    starts, steps, lengths = points[:-1][kept], steps[kept], lengths[kept]
    reached = np.concatenate(([0.0], np.cumsum(lengths)))
    distances = _distances(points[0], points[-1], float(reached[-1]), count, spacing, place)
    piece = np.clip(np.searchsorted(reached, distances, side="right") - 1, 0, len(starts) - 1)
    share = (distances - reached[piece]) / lengths[piece]
    return starts[piece] + share[:, None] * steps[piece], steps[piece] / lengths[piece, None]


def _along_function(
    curve: CurveFunction, count: int | None, spacing: float | None, place: Span | None
) -> tuple[Floats, Floats]:
    at = np.linspace(0.0, 1.0, PIECES + 1)
    dense = evaluated(curve, at, place)
    lengths = np.linalg.norm(np.diff(dense, axis=0), axis=1)
    reached = np.concatenate(([0.0], np.cumsum(lengths)))
    distances = _distances(dense[0], dense[-1], float(reached[-1]), count, spacing, place)
    ts = np.interp(distances, reached, at)
    # The derivative of the parabola through three points; at an end, all of them are on one side.
    middle = np.clip(ts, STEP, 1.0 - STEP)
    before, at_middle, after = (
        evaluated(curve, middle + step, place) for step in (-STEP, 0.0, STEP)
    )
    chord = 0.5 * (after - before)
    bend = after - 2.0 * at_middle + before
    tangents = chord + ((ts - middle) / STEP)[:, None] * bend
    # Where a curve starts with no speed, the parabola has no direction there.
    slow = (tangents * chord).sum(axis=1) < 0.1 * (chord * chord).sum(axis=1)
    tangents[slow] = chord[slow]
    size = np.linalg.norm(tangents, axis=1)
    if not size.all():
        still = ts[np.argmin(size)]
        refuse(
            f"the curve has no direction at t = {still:.6g}: it does not move there", None, place
        )
    return evaluated(curve, ts, place), tangents / size[:, None]


def evaluated(curve: CurveFunction, at: Floats, place: Span | None) -> Floats:
    """Return the points of a function's curve.

    Args:
        curve: The function.
        at: The numbers at which it is evaluated.
        place: The author's line.

    Raises:
        SceneTypeError: It returns something else than three numbers.
        SceneValueError: A point is not finite.
    """
    rows = []
    for t in at.tolist():
        point = curve(t)
        try:
            x, y, z = map(float, point)
        except (TypeError, ValueError):
            refuse_kind(
                f"a curve returns three numbers, not {point!r:.60} as at t = {t:.6g}",
                "lambda t: (cos(tau * t), 0.0, sin(tau * t))",
                place,
            )
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
            refuse(f"the curve is not finite at t = {t:.6g}: {(x, y, z)}", None, place)
        rows.append((x, y, z))
    return np.array(rows, dtype=np.float64)


def _distances(
    start: Floats,
    end: Floats,
    length: float,
    count: int | None,
    spacing: float | None,
    place: Span | None,
) -> Floats:
    """Return the distances along a curve at which points lie.

    Args:
        start: The first point of the curve.
        end: The last point.
        length: The length of the curve.
        count: Number of points, or None.
        spacing: Distance between points, or None.
        place: The author's line.
    """
    if length == 0.0:
        refuse("the curve has no length", "two different points or more", place)
    closed = float(np.linalg.norm(end - start)) <= CLOSED * length
    if (count is None) == (spacing is None):
        refuse("points_along takes either count or spacing", "points_along(curve, 20)", place)
    if spacing is not None:
        step = positive(spacing, "spacing of points_along", place)
        pieces = max(round(length / step), 1)
        number_of = pieces if closed else pieces + 1
    else:
        number_of = whole_number(count, "count of points_along", place)
        pieces = number_of if closed else max(number_of - 1, 1)
    whole_number(number_of, "the number of points of points_along", place)
    made: Floats = np.minimum(np.arange(number_of) * (length / pieces), length)
    return made
