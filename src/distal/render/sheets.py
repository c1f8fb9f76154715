"""Thickness for what has no inside, as seen from the eye.

Input: a value of a sheet, a line or an estimate of a distance, and where it is seen from. Output: a
value that is negative within a part of a pixel around it. Rays meet a surface only where the sign
of the distance changes (``segment``), so without thickness they would pass.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import ENDLESS, Bounds
from distal.lang import abs, func, length, max, select, vec2, vec3
from distal.render.camera import Ray


@func
def eye_of(camera: Callable[[vec2], Ray]) -> vec3:
    """Return the place that a picture is seen from."""
    return camera(vec2(0.0)).origin


@func
def with_thickness(d: float, p: vec3, eye: vec3, threshold: float, divisor: float) -> float:
    """Return the value of a shape without an inside as that of a thin solid.

    Args:
        d: The distance to the shape, or an estimate.
        p: The point.
        eye: The place that the picture is seen from.
        threshold: A third of a pixel, as a part of the distance from there.
        divisor: The number by which values are divided to be no more than distances.
    """
    return (d - threshold * length(p - eye)) / max(divisor, 1.0)


@func
def grown_by_thickness(bounds: Bounds, eye: vec3, threshold: float) -> Bounds:
    """Return a box around shapes without an inside, grown by the most that they are thick.

    Args:
        bounds: Their box.
        eye: As for ``with_thickness``.
        threshold: As for ``with_thickness``.
    """
    corner = max(abs(bounds.low - eye), abs(bounds.high - eye))
    margin = 2.0 * threshold * length(select(corner < ENDLESS, corner, 0.0))
    return Bounds(bounds.low - margin, bounds.high + margin)
