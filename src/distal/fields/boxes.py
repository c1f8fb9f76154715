"""Boxes around shapes: what the object model composes of them."""

from __future__ import annotations

from distal.fields.guarantees import UNBOUNDED, Bounds, Bounds2
from distal.lang import func, max, min, vec2, vec3


@func
def hull(bounds_a: Bounds, bounds_b: Bounds) -> Bounds:
    """The smallest box around two."""
    return Bounds(min(bounds_a.low, bounds_b.low), max(bounds_a.high, bounds_b.high))


@func
def hull2(bounds_a: Bounds2, bounds_b: Bounds2) -> Bounds2:
    """The smallest rectangle around two."""
    return Bounds2(min(bounds_a.low, bounds_b.low), max(bounds_a.high, bounds_b.high))


@func
def everywhere() -> Bounds:
    """The box of a shape without end."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


@func
def everywhere2() -> Bounds2:
    """The rectangle of a flat shape without end."""
    return Bounds2(vec2(-UNBOUNDED), vec2(UNBOUNDED))


@func
def given_bounds(low: vec3, high: vec3) -> Bounds:
    """The box that an author gives for a function of their own."""
    return Bounds(low, high)


@func
def given_bounds2(low: vec2, high: vec2) -> Bounds2:
    """The rectangle that an author gives for a flat function of their own."""
    return Bounds2(low, high)


@func
def given_slope(slope: float) -> float:
    """The slope that an author gives for a function of their own."""
    return slope


@func
def given_growth(growth: float) -> float:
    """The growth that an author gives for a function of their own."""
    return growth
