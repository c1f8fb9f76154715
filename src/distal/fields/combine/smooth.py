"""Smooth minima: unions without a crease, one pair of functions for each family.

Input: two distances and ``k``, how far the surface moves out where both are equal, so that
families are exchanged without retuning (they differ in shape, not in size). Output: the
distance of the union, and from ``NAME_mix`` the share of the second shape, which is the derivative
by ``b``: normals and materials blend alike. Intersections and differences are made of these in
``edges``; nothing here knows of points or shapes.

All but the round corners answer ``min(a, b)`` minus a bulge that depends on ``|a - b|`` alone with
a derivative between 0 and 1/2: the gradient is a mean of the children's gradients, so the slope
never grows. At ``k = 0`` all are the hard minimum, with no division by zero; ties take ``a``.

Source: Inigo Quilez, "Smooth minimum" (https://iquilezles.org/articles/smin/), for the families
and their normalisation. The shares are the derivatives of the formulas.
"""

from __future__ import annotations

from distal.lang import abs, exp, exp2, func, length, log2, max, min, pow, select, sqrt, vec2

# Below this a blend is a crease: the smallest width that is divided by.
SHARP = 1e-12
LN2 = 0.6931471805599453
# The quarter circle's corner is this share of its radius away from the middle of the arc.
CORNER = 0.2928932188134524  # 1 - sqrt(1/2)


@func
def share_of_second(a: float, b: float, share_of_farther: float) -> float:
    """The share of ``b``, when that of the farther of the two is known."""
    return select(b < a, 1.0 - share_of_farther, share_of_farther)


@func
def nearness(a: float, b: float, width: float) -> float:
    """1 where the two are equal, falling to 0 where they are ``width`` apart."""
    return max(1.0 - abs(a - b) / width, 0.0)


@func
def quadratic(a: float, b: float, k: float) -> float:
    """The cheapest blend; the default. Differs from the minimum only where |a - b| < 4k."""
    width = max(4.0 * k, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * (0.25 * width)


@func
def quadratic_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``quadratic``."""
    return share_of_second(a, b, 0.5 * nearness(a, b, max(4.0 * k, SHARP)))


@func
def cubic(a: float, b: float, k: float) -> float:
    """Without a jump in curvature. Differs from the minimum only where |a - b| < 6k."""
    width = max(6.0 * k, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * h * (width / 6.0)


@func
def cubic_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``cubic``."""
    h = nearness(a, b, max(6.0 * k, SHARP))
    return share_of_second(a, b, 0.5 * h * h)


@func
def quartic(a: float, b: float, k: float) -> float:
    """As ``cubic``, smoother in the middle. Differs from the minimum where |a - b| < 16/3 k."""
    width = max(16.0 / 3.0 * k, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * h * (4.0 - h) * (width / 16.0)


@func
def quartic_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``quartic``."""
    h = nearness(a, b, max(16.0 / 3.0 * k, SHARP))
    return share_of_second(a, b, 0.25 * h * h * (3.0 - h))


@func
def circular(a: float, b: float, k: float) -> float:
    """The profile of a circle. Differs from the minimum only where |a - b| < 3.41k."""
    width = max(k / CORNER, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - 0.5 * width * (1.0 + h - sqrt(1.0 + h * (2.0 - h)))


@func
def circular_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``circular``."""
    h = nearness(a, b, max(k / CORNER, SHARP))
    return share_of_second(a, b, 0.5 - 0.5 * (1.0 - h) / sqrt(1.0 + h * (2.0 - h)))


@func
def corner_arc(a: float, b: float, radius: float) -> float:
    """The distance to the arc that fills a right angle; steeper than the children inside it."""
    return max(radius, min(a, b)) - length(max(radius - vec2(a, b), vec2(0.0)))


@func
def corner_floor(a: float, b: float, radius: float) -> float:
    """The least that ``round_corner`` answers: the surface is above it; radius 0 is a crease."""
    return min(a, b) - radius


@func
def round_corner(a: float, b: float, k: float) -> float:
    """A quarter circle of radius ``k`` where the surfaces meet at a right angle.

    Slope at most sqrt(slope_a^2 + slope_b^2): where both are within the radius the value is a
    length in the plane of the two distances.
    """
    return max(corner_arc(a, b, k), corner_floor(a, b, k))


@func
def round_corner_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``round_corner``."""
    inner = max(k - vec2(a, b), vec2(0.0))
    total = inner.x + inner.y
    hard = select(b < a, 1.0, 0.0)
    creased = total <= SHARP or corner_arc(a, b, k) < corner_floor(a, b, k)
    return select(creased, hard, inner.y / max(total, SHARP))


@func
def circular_geometric(a: float, b: float, k: float) -> float:
    """``round_corner``, measured like the others by how far the surface moves."""
    return round_corner(a, b, k / CORNER)


@func
def circular_geometric_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``circular_geometric``."""
    return round_corner_mix(a, b, k / CORNER)


@func
def exponential(a: float, b: float, k: float) -> float:
    """The only one that gives the same for many shapes in any order; acts everywhere."""
    x = abs(a - b) / max(k, SHARP)
    return min(a, b) - k * log2(1.0 + exp2(-x))


@func
def exponential_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``exponential``."""
    fading = exp2(-abs(a - b) / max(k, SHARP))
    return share_of_second(a, b, fading / (1.0 + fading))


@func
def root(a: float, b: float, k: float) -> float:
    """A hyperbola's profile: moves the surface everywhere, ever less away from the seam."""
    x = abs(a - b)
    width = 2.0 * k
    # (sqrt(x^2 + w^2) - x) / 2, without the difference of near numbers
    return min(a, b) - 0.5 * width * width / max(length(vec2(x, width)) + x, SHARP)


@func
def root_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``root``."""
    x = abs(a - b)
    return share_of_second(a, b, 0.5 - 0.5 * x / max(length(vec2(x, 2.0 * k)), SHARP))


@func
def sigmoid(a: float, b: float, k: float) -> float:
    """A profile that fades exponentially; acts everywhere.

    The bulge is k * v / (exp(v) - 1) with v = |a - b| / k: 0/0 where the two are equal, so a series
    of it stands there (its next term is below 1e-10 for v < 1/2, so that the two meet).
    """
    v = min(abs(a - b) / max(k, SHARP), 80.0)
    s = v * v
    even = s * (1.0 / 12.0 + s * (-1.0 / 720.0 + s * (1.0 / 30240.0 - s / 1209600.0)))
    series = 1.0 - 0.5 * v + even
    bulge = select(v < 0.5, series, v / (exp(max(v, 0.5)) - 1.0))
    return min(a, b) - k * bulge


@func
def sigmoid_mix(a: float, b: float, k: float) -> float:
    """The share of ``b`` in ``sigmoid``."""
    v = min(abs(a - b) / max(k, SHARP), 80.0)
    s = v * v
    series = 0.5 + v * (-1.0 / 6.0 + s * (1.0 / 180.0 - s / 5040.0))
    falling = 1.0 / (exp(max(v, 0.5)) - 1.0)
    direct = falling * (v * (1.0 + falling) - 1.0)
    return share_of_second(a, b, max(select(v < 0.5, series, direct), 0.0))


@func
def power_union(a: float, b: float, exponent: float) -> float:
    """Rounds only the levels outside: the surface itself keeps its crease.

    The quotient of the distances' powers; where one of them is not positive it is the minimum.
    """
    near = min(a, b)
    ratio = near / max(max(a, b), SHARP)
    rounded = near * pow(1.0 + pow(max(ratio, 0.0), exponent), -1.0 / exponent)
    return select(near > 0.0, rounded, near)
