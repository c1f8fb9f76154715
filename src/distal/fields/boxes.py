"""Boxes around shapes, as the object model combines them."""

from __future__ import annotations

from distal.fields.guarantees import UNBOUNDED, Bounds, Bounds2
from distal.lang import func, max, min, vec2, vec3


@func
def hull(bounds_a: Bounds, bounds_b: Bounds) -> Bounds:
    """Return the smallest box around two boxes."""
    return Bounds(min(bounds_a.low, bounds_b.low), max(bounds_a.high, bounds_b.high))


@func
def hull2(bounds_a: Bounds2, bounds_b: Bounds2) -> Bounds2:
    """Return the smallest rectangle around two rectangles."""
    return Bounds2(min(bounds_a.low, bounds_b.low), max(bounds_a.high, bounds_b.high))


@func
def everywhere() -> Bounds:
    """Return the box of an infinite shape."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


@func
def everywhere2() -> Bounds2:
    """Return the rectangle of an infinite flat shape."""
    return Bounds2(vec2(-UNBOUNDED), vec2(UNBOUNDED))


@func
def given_bounds(low: vec3, high: vec3) -> Bounds:
    """Return the box that an author declares for their own function."""
    return Bounds(low, high)


@func
def given_bounds2(low: vec2, high: vec2) -> Bounds2:
    """Return the rectangle that an author declares for their own flat function."""
    return Bounds2(low, high)


@func
def given_slope(slope: float) -> float:
    """Return the slope that an author declares for their own function."""
    return slope


@func
def given_growth(growth: float) -> float:
    """Return the growth that an author declares for their own function."""
    return growth
