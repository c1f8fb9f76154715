"""The operator around a shape whose numbers differ from place to place: it keeps it to its box.

Input: a box that contains the shape, and a bound on the shape's slope within the box, as numbers
(``scene.lowering.varied_places`` computes them). Output: the shape. Within the box the field is
unchanged; beyond it, where nothing is known of the shape's slope, the shape is evaluated at the
nearest point of the box, and the value is at least the bound times the distance to the box.

Why the field within is unchanged: the box contains all points whose value is not positive, so from
a point within, the nearest side is at least ``-value / steepness`` away.
"""

from __future__ import annotations

from typing import Final

from distal.fields.boxes import given_bounds, given_bounds2
from distal.fields.extents import box_distance, rectangle_distance
from distal.fields.guarantees import Bounds, Bounds2, Growth, Operator
from distal.lang import clamp, func, max, vec2, vec3


@func
def nearest_within(p: vec3, low: vec3, high: vec3) -> vec3:
    """Return the nearest point of a box."""
    return clamp(p, low, high)


@func
def nearest_within_flat(p: vec2, low: vec2, high: vec2) -> vec2:
    """Return the nearest point of a rectangle."""
    return clamp(p, low, high)


@func
def at_least_to_box(d: float, p: vec3, low: vec3, high: vec3, steepness: float) -> float:
    """Return a value that is at least ``steepness`` times the distance to a box."""
    return max(d, steepness * box_distance(p, Bounds(low, high)))


@func
def at_least_to_rectangle(d: float, p: vec2, low: vec2, high: vec2, steepness: float) -> float:
    """Return a value that is at least ``steepness`` times the distance to a rectangle."""
    return max(d, steepness * rectangle_distance(p, Bounds2(low, high)))


@func
def known_steepness(steepness: float) -> float:
    """Return the bound on the slope."""
    return steepness


WITHIN: Final = Operator(
    "varied",
    point=nearest_within,
    finish=at_least_to_box,
    slope=known_steepness,
    bounds=given_bounds,
    growth=Growth.HELD,
)
WITHIN_FLAT: Final = Operator(
    "varied",
    point=nearest_within_flat,
    finish=at_least_to_rectangle,
    slope=known_steepness,
    bounds=given_bounds2,
    growth=Growth.HELD,
)
