"""Smooth minima: unions without a crease, one pair of functions for each family.

Input: two distances and ``smooth``, how far the surface moves outwards where both are equal. It has
the same meaning for all families, so one can be replaced by another (they differ in shape, not in
size). Output: the distance of the union, and from ``NAME_mix`` the share of the second shape, which
is the derivative by ``b``, so normals and materials are blended in the same way. ``blends`` makes
intersections and differences from these functions. Does not depend on points or shapes.

All except the round corners return ``min(a, b)`` minus a bulge. The bulge depends on ``|a - b|``
alone and its derivative is between 0 and 1/2, so the gradient is a weighted mean of the children's
gradients, and the slope never grows. With ``smooth = 0`` all are the hard minimum, without a
division by zero; for equal distances ``a`` is used.

Source: Inigo Quilez, "Smooth minimum" (https://iquilezles.org/articles/smin/), for the families
and their normalisation. The shares are the derivatives of the formulas.
"""

from __future__ import annotations

from distal.lang import abs, exp, exp2, func, length, log2, max, min, pow, select, sqrt, vec2

# Lower limit of the width, which is used as a divisor; a smaller blend is a crease.
SHARP = 1e-12
# Distance of the quarter circle's corner from the middle of the arc, as a fraction of the radius.
CORNER = 0.2928932188134524  # 1 - sqrt(1/2)


@func
def share_of_second(a: float, b: float, share_of_farther: float) -> float:
    """Return the share of ``b`` from the share of the farther of the two."""
    return select(b < a, 1.0 - share_of_farther, share_of_farther)


@func
def nearness(a: float, b: float, width: float) -> float:
    """Return 1 if the two are equal, decreasing to 0 if they differ by ``width``."""
    return max(1.0 - abs(a - b) / width, 0.0)


@func
def quadratic(a: float, b: float, smooth: float) -> float:
    """Return the default and cheapest blend.

    It differs from the minimum only where |a - b| < 4k.
    """
    width = max(4.0 * smooth, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * (0.25 * width)


@func
def quadratic_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``quadratic``."""
    return share_of_second(a, b, 0.5 * nearness(a, b, max(4.0 * smooth, SHARP)))


@func
def cubic(a: float, b: float, smooth: float) -> float:
    """Return a blend with continuous curvature.

    It differs from the minimum only where |a - b| < 6k.
    """
    width = max(6.0 * smooth, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * h * (width / 6.0)


@func
def cubic_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``cubic``."""
    h = nearness(a, b, max(6.0 * smooth, SHARP))
    return share_of_second(a, b, 0.5 * h * h)


@func
def quartic(a: float, b: float, smooth: float) -> float:
    """Return a blend like ``cubic``, smoother in the middle.

    It differs from the minimum only where |a - b| < 16/3 smooth.
    """
    width = max(16.0 / 3.0 * smooth, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - h * h * h * (4.0 - h) * (width / 16.0)


@func
def quartic_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``quartic``."""
    h = nearness(a, b, max(16.0 / 3.0 * smooth, SHARP))
    return share_of_second(a, b, 0.25 * h * h * (3.0 - h))


@func
def circular(a: float, b: float, smooth: float) -> float:
    """Return a blend with the profile of a circle.

    It differs from the minimum only where |a - b| < 3.41k.
    """
    width = max(smooth / CORNER, SHARP)
    h = nearness(a, b, width)
    return min(a, b) - 0.5 * width * (1.0 + h - sqrt(1.0 + h * (2.0 - h)))


@func
def circular_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``circular``."""
    h = nearness(a, b, max(smooth / CORNER, SHARP))
    return share_of_second(a, b, 0.5 - 0.5 * (1.0 - h) / sqrt(1.0 + h * (2.0 - h)))


@func
def corner_arc(a: float, b: float, radius: float) -> float:
    """Return the distance to the arc in a right angle; inside it, steeper than the children."""
    return max(radius, min(a, b)) - length(max(radius - vec2(a, b), vec2(0.0)))


@func
def corner_floor(a: float, b: float, radius: float) -> float:
    """Return the lower limit of ``round_corner``, below its surface; a crease for radius 0."""
    return min(a, b) - radius


@func
def round_corner(a: float, b: float, smooth: float) -> float:
    """Return a union with a quarter circle of radius ``smooth`` in right angles of surfaces.

    The slope is at most sqrt(slope_a^2 + slope_b^2): where both distances are within the radius,
    the value is a length in the plane of the two distances.
    """
    return max(corner_arc(a, b, smooth), corner_floor(a, b, smooth))


@func
def round_corner_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``round_corner``."""
    inner = max(smooth - vec2(a, b), vec2(0.0))
    total = inner.x + inner.y
    hard = select(b < a, 1.0, 0.0)
    creased = total <= SHARP or corner_arc(a, b, smooth) < corner_floor(a, b, smooth)
    return select(creased, hard, inner.y / max(total, SHARP))


@func
def circular_geometric(a: float, b: float, smooth: float) -> float:
    """Return ``round_corner``, with ``smooth`` as in the others: how far the surface moves."""
    return round_corner(a, b, smooth / CORNER)


@func
def circular_geometric_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``circular_geometric``."""
    return round_corner_mix(a, b, smooth / CORNER)


@func
def exponential(a: float, b: float, smooth: float) -> float:
    """Return the only blend whose result for many shapes does not depend on their order.

    It differs from the minimum everywhere.
    """
    x = abs(a - b) / max(smooth, SHARP)
    return min(a, b) - smooth * log2(1.0 + exp2(-x))


@func
def exponential_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``exponential``."""
    fading = exp2(-abs(a - b) / max(smooth, SHARP))
    return share_of_second(a, b, fading / (1.0 + fading))


@func
def root(a: float, b: float, smooth: float) -> float:
    """Return a blend with the profile of a hyperbola.

    It moves the surface everywhere, less with the distance from the seam.
    """
    x = abs(a - b)
    width = 2.0 * smooth
    # (sqrt(x^2 + w^2) - x) / 2, without the difference of nearly equal numbers
    return min(a, b) - 0.5 * width * width / max(length(vec2(x, width)) + x, SHARP)


@func
def root_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``root``."""
    x = abs(a - b)
    return share_of_second(a, b, 0.5 - 0.5 * x / max(length(vec2(x, 2.0 * smooth)), SHARP))


@func
def sigmoid(a: float, b: float, smooth: float) -> float:
    """Return a blend whose effect decreases exponentially; it differs from the minimum everywhere.

    The bulge is smooth * v / (exp(v) - 1) with v = |a - b| / smooth. This is 0/0 if the two are
    equal, so near 0 a series is used (its next term is below 1e-10 for v < 1/2, so that both agree
    there).
    """
    v = min(abs(a - b) / max(smooth, SHARP), 80.0)
    s = v * v
    even = s * (1.0 / 12.0 + s * (-1.0 / 720.0 + s * (1.0 / 30240.0 - s / 1209600.0)))
    series = 1.0 - 0.5 * v + even
    bulge = select(v < 0.5, series, v / (exp(max(v, 0.5)) - 1.0))
    return min(a, b) - smooth * bulge


@func
def sigmoid_mix(a: float, b: float, smooth: float) -> float:
    """Return the share of ``b`` in ``sigmoid``."""
    v = min(abs(a - b) / max(smooth, SHARP), 80.0)
    s = v * v
    series = 0.5 + v * (-1.0 / 6.0 + s * (1.0 / 180.0 - s / 5040.0))
    falling = 1.0 / (exp(max(v, 0.5)) - 1.0)
    direct = falling * (v * (1.0 + falling) - 1.0)
    return share_of_second(a, b, max(select(v < 0.5, series, direct), 0.0))


@func
def power_union(a: float, b: float, exponent: float) -> float:
    """Return a union that is rounded only outside: the surface itself keeps its crease.

    It is the quotient of the distances' powers; if one distance is not positive, it is the minimum.
    """
    near = min(a, b)
    ratio = near / max(max(a, b), SHARP)
    rounded = near * pow(1.0 + pow(max(ratio, 0.0), exponent), -1.0 / exponent)
    return select(near > 0.0, rounded, near)
