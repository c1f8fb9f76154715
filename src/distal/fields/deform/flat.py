"""Flat shapes bent out of shape: elongated, bent. As ``deform`` does for solids.

Input: a point of the plane. Output: the point to ask the shape at, the slope, the
rectangle. Of these the scene code of ``deform`` is the same, with the third coordinate 0.
"""

from __future__ import annotations

from distal.fields.deform.solid import bent, bent_bounds, bent_slope, bent_value, elongated
from distal.fields.guarantees import LOWER_BOUND, Bounds2, Growth, Limit, operator
from distal.fields.repeat.flat import flat_bounds, in_space, slab
from distal.lang import func, vec2


@func
def elongated_flat(p: vec2, lengths: vec2) -> vec2:
    """The place before the shape was cut in the middle and its halves were moved apart."""
    return elongated(in_space(p), in_space(lengths)).xy


@func
def elongated_flat_bounds(bounds: Bounds2, lengths: vec2) -> Bounds2:
    """The rectangle, larger by half the lengths on each side."""
    return Bounds2(bounds.low - 0.5 * lengths, bounds.high + 0.5 * lengths)


@func
def bent_flat(p: vec2, rate: float, bounds: Bounds2) -> vec2:
    """The place before a turn by ``rate`` for each unit along x: the ends go up."""
    return bent(in_space(p), rate, slab(bounds)).xy


@func
def bent_flat_bounds(bounds: Bounds2) -> Bounds2:
    """As far around as the rectangle reaches."""
    return flat_bounds(bent_bounds(slab(bounds)))


@func
def bent_flat_value(d: float, p: vec2, bounds: Bounds2) -> float:
    """At least the distance to the disc."""
    return bent_value(d, in_space(p), slab(bounds))


@func
def bent_flat_slope(slope: float, bounds: Bounds2, rate: float) -> float:
    """A turn that changes along the plane it turns."""
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
)
