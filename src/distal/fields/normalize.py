"""Rough distances from badly scaled implicit functions: the value divided by its gradient.

Input: a function that is 0 on a surface, and where. Output: about the distance near the surface.
Does not depend on how the function is declared.

The distance to the surface, to first order, is f / |grad f| (Taubin). Where the gradient vanishes,
between two blobs or in the middle of a ball, this has no bound, and rays would leave the scene in
one step. Here (f / reach)^2 is added to the squared gradient: on the surface nothing changes, and
no value is larger than ``reach``. The result is the same for f and for any multiple of f.

Source: Gabriel Taubin, "Distance Approximations for Rasterizing Implicit Curves", ACM Transactions
on Graphics 13 (1994), equation 2, for f / |grad f|.
"""

from __future__ import annotations

from distal.fields.extents import box_distance, rectangle_distance
from distal.fields.guarantees import Bounds, Bounds2
from distal.lang import (
    Field2,
    Field3,
    abs,
    func,
    length,
    max,
    min,
    value_and_gradient,
    vec2,
    vec3,
    vec4,
)

# The largest value without bounds, in scene units.
REACH = 1.0
# Far below any function's values: 0 divided by it stays 0.
LEAST = 1e-30


@func
def over_gradient(value: float, slope: vec3, reach: float) -> float:
    """Return about the distance from a value and a gradient; at most ``reach``.

    Both are first divided by the largest of their components, because squares of a function of
    size 1e25 or 1e-25 are not numbers of 32 bits.
    """
    share = value / reach
    largest = max(abs(slope.x), abs(slope.y), abs(slope.z), abs(share), LEAST)
    scaled = vec4(slope / largest, share / largest)
    return value / largest / max(length(scaled), 1e-6)


@func
def normalized(field: Field3, p: vec3) -> float:
    """Return a function's value, divided by its gradient."""
    value, slope = value_and_gradient(field, p)
    return over_gradient(value, slope, REACH)


@func
def normalized_flat(field: Field2, p: vec2) -> float:
    """Return a flat function's value, divided by its gradient."""
    value, slope = value_and_gradient(field, p)
    return over_gradient(value, vec3(slope, 0.0), REACH)


@func
def normalized_within(field: Field3, p: vec3, low: vec3, high: vec3) -> float:
    """Return a function's value, divided by its gradient, for a surface inside a box.

    Inside the solid no place is farther from the surface than half of the box's smallest side, nor
    than from the box; outside the box, the surface is at least as far away as the box is.
    """
    value, slope = value_and_gradient(field, p)
    size = high - low
    reach = 0.5 * min(size.x, size.y, size.z)
    return max(over_gradient(value, slope, reach), box_distance(p, Bounds(low, high)))


@func
def normalized_within_flat(field: Field2, p: vec2, low: vec2, high: vec2) -> float:
    """Return a flat function's value, divided by its gradient, for an outline in a rectangle."""
    value, slope = value_and_gradient(field, p)
    size = high - low
    d = over_gradient(value, vec3(slope, 0.0), 0.5 * min(size.x, size.y))
    return max(d, rectangle_distance(p, Bounds2(low, high)))
