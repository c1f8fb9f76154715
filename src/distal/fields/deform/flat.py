"""Deformations of flat shapes: elongated, bent. The counterpart of ``solid``.

Input: a point of the plane. Output: the point at which the shape is evaluated, the slope, the
rectangle. The formulas are those of ``solid``, with the third coordinate 0.
"""

from __future__ import annotations

from distal.fields.deform.solid import bent, bent_bounds, bent_slope, bent_value, elongated
from distal.fields.guarantees import LOWER_BOUND, Bounds2, Growth, Limit, operator
from distal.fields.repeat.flat import flat_bounds, in_space, slab
from distal.fields.widths import deformed_width
from distal.lang import func, vec2


@func
def elongated_flat(p: vec2, lengths: vec2) -> vec2:
    """Return the point before the shape was cut in the middle and its halves moved apart."""
    return elongated(in_space(p), in_space(lengths)).xy


@func
def elongated_flat_bounds(bounds: Bounds2, lengths: vec2) -> Bounds2:
    """Return the rectangle, enlarged by half of the lengths on each side."""
    return Bounds2(bounds.low - 0.5 * lengths, bounds.high + 0.5 * lengths)


@func
def bent_flat(p: vec2, rate: float, bounds: Bounds2) -> vec2:
    """Return the point before a rotation by ``rate`` per unit along x: the ends go up."""
    return bent(in_space(p), rate, slab(bounds)).xy


@func
def bent_flat_bounds(bounds: Bounds2) -> Bounds2:
    """Return the square around the circle about the origin that contains the rectangle."""
    return flat_bounds(bent_bounds(slab(bounds)))


@func
def bent_flat_value(d: float, p: vec2, bounds: Bounds2) -> float:
    """Return the value, but at least the distance to the disc around the shape."""
    return bent_value(d, in_space(p), slab(bounds))


@func
def bent_flat_slope(slope: float, bounds: Bounds2, rate: float) -> float:
    """Return the slope of a rotation whose angle changes in the plane of rotation."""
    return bent_slope(slope, slab(bounds), rate)


ELONGATE_FLAT = operator(
    "flat elongate",
    point=elongated_flat,
    keeps=LOWER_BOUND,
    bounds=elongated_flat_bounds,
    limits={"lengths": Limit.NOT_NEGATIVE},
    growth=Growth.KEPT,
)
BEND_FLAT = operator(
    "flat bend",
    point=bent_flat,
    finish=bent_flat_value,
    slope=bent_flat_slope,
    bounds=bent_flat_bounds,
    needs="a shape that ends around the origin: the farther out, the steeper it would get",
    growth=Growth.HELD,
    width=deformed_width,
)
