"""Flat shapes bounded by ellipses, parabolas and hyperbolas.

Input: a point and the numbers of a shape. Output: the distance, negative inside.

The nearest point of a conic is the root of a polynomial. Here an equation with the same root is
used on which Newton's method converges from one side, so a fixed number of steps is enough. The
number is measured: the error is below 2e-6 of the shape's size, even next to the evolute.
"""

from __future__ import annotations

from typing import Final

from distal.fields.constants import HALF_ROOT, TINY
from distal.fields.flats.edges import centred_bounds, disc_bounds, nearer
from distal.fields.guarantees import EXACT, UNBOUNDED, Bounds2, Limit, primitive
from distal.fields.widths import blobby_width, ellipse_width, gap_width, radius_width, segment_width
from distal.lang import abs, dot, func, length, max, min, pow, select, sqrt, vec2

WIDE: Final = vec2(0.7, 0.4)
# The largest root of t^3 = t + 1. It bounds the root of t^3 + a t = b by the larger of two terms.
PLASTIC: Final = 1.3247179572447460
# The root of c^2 + c^3 = 1, rounded down.
BELOW_BOTH: Final = 0.7548
CUBIC_STEPS: Final = 5
ELLIPSE_STEPS: Final = 4
HYPERBOLA_STEPS: Final = 5


@func
def largest_root(a: float, b: float) -> float:
    """Return the largest root of t^3 + a t = b for b >= 0.

    Beyond its root the cubic increases and is convex, so Newton's method converges to it from any
    larger number; the start is at most 1.5 times the root.
    """
    by_b = pow(max(b, TINY), 1.0 / 3.0)
    start = select(a > 0.0, min(by_b, b / max(a, TINY)), PLASTIC * max(by_b, sqrt(max(-a, 0.0))))
    t = start
    for _ in range(CUBIC_STEPS):
        t = (2.0 * t * t * t + b) / max(3.0 * t * t + a, TINY)
    return t


@func
def parabola_foot(q: vec2, curvature: float) -> float:
    """Return the x of the point nearest to ``q`` on y = curvature x^2.

    Requires q.x >= 0 and curvature > 0.
    """
    # In units of the focal parameter, so that the cubic's coefficients are near 1 for a very steep
    # or a very flat parabola too.
    double = 2.0 * curvature
    return largest_root(2.0 - 2.0 * double * q.y, 2.0 * double * q.x) / double


@primitive(
    "Parabola",
    EXACT,
    limits={"curvature": Limit.POSITIVE},
    width=UNBOUNDED,
)
@func
def parabola(p: vec2, curvature: float = 1.0) -> float:
    """Region above the parabola y = curvature x^2.

    Args:
        p: Point.
        curvature: Coefficient of x^2: half of the curvature at the lowest point.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/); the cubic by Newton's method.

    Measured:
        parabola((0.0, -3.0), 1.0) = 3.0
        parabola((0.0, 1.25), 1.0) = -1.0
        parabola((3.0, 0.0), 1.0) = 2.23606797749979
    """
    q = vec2(abs(p.x), p.y)
    x = parabola_foot(q, curvature)
    d = length(q - vec2(x, curvature * x * x))
    return select(q.y > curvature * q.x * q.x, -d, d)


@func
def parabola_segment_bounds(width: float, height: float) -> Bounds2:
    """Return the rectangle from the base to the top."""
    return Bounds2(vec2(-0.5 * width, 0.0), vec2(0.5 * width, height))


@primitive(
    "ParabolaSegment",
    EXACT,
    bounds=parabola_segment_bounds,
    width=segment_width,
)
@func
def parabola_segment(p: vec2, width: float = 1.0, height: float = 0.8) -> float:
    """Region between a parabola that opens downwards and the x axis.

    Args:
        p: Point.
        width: Width of the base, along the x axis.
        height: Height of the top above the base.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/); the cubic by Newton's method.

    Measured:
        parabola_segment((0.0, 5.0), 2.0, 1.0) = 4.0
        parabola_segment((0.5, -3.0), 2.0, 1.0) = 3.0
        parabola_segment((0.0, 0.25), 2.0, 1.0) = -0.25
    """
    half = 0.5 * width
    curvature = height / (half * half)
    # Coordinates with the top as origin and y downwards.
    q = vec2(abs(p.x), height - p.y)
    x = min(parabola_foot(q, curvature), half)
    from_curve = q - vec2(x, curvature * x * x)
    from_base = vec2(max(q.x - half, 0.0), p.y)
    d = length(nearer(from_base, from_curve))
    inside = p.y > 0.0 and q.y > curvature * q.x * q.x
    return select(inside, -d, d)


@primitive(
    "QuadraticCircle",
    EXACT,
    bounds=disc_bounds,
    width=radius_width,
)
@func
def quadratic_circle(p: vec2, radius: float = 0.5) -> float:
    """Approximate circle made of four parabolas, each perpendicular to two axes at its ends.

    Args:
        p: Point.
        radius: Radius along the axes; along the diagonals it is 6 % more.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/); the cubic by Newton's method.

    Measured:
        quadratic_circle((0.0, 5.0), 2.0) = 3.0
        quadratic_circle((0.75, 0.75), 1.0) = 0.0
        quadratic_circle((0.0, 0.0), 2.0) = -2.0
    """
    q = abs(p)
    # Coordinates across the diagonal, and along it downwards from the parabola's top.
    top = 1.5 * HALF_ROOT * radius
    seen = vec2(HALF_ROOT * abs(q.x - q.y), top - HALF_ROOT * (q.x + q.y))
    curvature = HALF_ROOT / radius
    x = min(parabola_foot(seen, curvature), HALF_ROOT * radius)
    d = length(seen - vec2(x, curvature * x * x))
    return select(seen.y > curvature * seen.x * seen.x, -d, d)


def _points_stay(radius: float, depth: float) -> str | None:
    if depth > 0.5 * HALF_ROOT * radius:
        return "depth may be at most 0.353 radius: there neighboring sides touch at the points"
    return None


@primitive(
    "BlobbyCross",
    EXACT,
    bounds=disc_bounds,
    limits={"depth": Limit.POSITIVE},
    requires=_points_stay,
    width=blobby_width,
)
@func
def blobby_cross(p: vec2, radius: float = 0.6, depth: float = 0.15) -> float:
    """Star with four points on the axes, joined by concave parabolas.

    Args:
        p: Point.
        radius: Distance from the middle to a point.
        depth: How far a side is moved inwards from the straight line between two points.

    Source: Inigo Quilez, "2D distance functions"
    (https://iquilezles.org/articles/distfunctions2d/); the cubic by Newton's method.

    Measured:
        blobby_cross((0.0, -5.0), 2.0, 1.0) = 3.0
        blobby_cross((4.0, 4.0), 1.0, 0.25) = 5.0
        blobby_cross((0.75, 0.75), 2.0, 0.35355339059327373) = 0.0
    """
    q = abs(p)
    # Coordinates across the diagonal, and along it inwards from the parabola's vertex.
    half = HALF_ROOT * radius
    seen = vec2(HALF_ROOT * abs(q.x - q.y), depth - half + HALF_ROOT * (q.x + q.y))
    curvature = depth / (half * half)
    x = min(parabola_foot(seen, curvature), half)
    from_curve = seen - vec2(x, curvature * x * x)
    d = length(from_curve)
    return select(from_curve.y < 0.0, -d, d)


@func
def ellipse_bounds(radii: vec2) -> Bounds2:
    """Return the rectangle around the ellipse."""
    return centred_bounds(radii)


@func
def ellipse_start(scaled: vec2, gap: float) -> float:
    """Return a number slightly below the root u of an equation.

    The equation is (scaled.x / (u + gap))^2 + (scaled.y / u)^2 = 1. Because 1 / (1 + x)^2 >= 1 - 2
    x, the root is above that of u^2 (A + B u) = 1. This bound is needed next to the evolute's
    points on the long axis, where other bounds are far too low.
    """
    squares = scaled * scaled
    rest = max(gap * gap - squares.x, TINY * TINY)
    flat = scaled.y * gap / sqrt(rest)
    steep = pow(squares.y * gap * gap * gap / (2.0 * squares.x), 1.0 / 3.0)
    return BELOW_BOTH * min(flat, steep)


@primitive(
    "Ellipse",
    EXACT,
    bounds=ellipse_bounds,
    width=ellipse_width,
)
@func
def ellipse(p: vec2, radii: vec2 = WIDE) -> float:
    """Ellipse with its axes along x and y.

    Args:
        p: Point.
        radii: Half of the width and half of the height.

    Source: David Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid"
    (https://www.geometrictools.com/Documentation/DistancePointEllipseEllipsoid.pdf), for the
    equation; its root by Newton's method on the reciprocal of the length, which is nearly straight:
    J. J. Moré and D. C. Sorensen, "Computing a Trust Region Step" (1983).

    Measured:
        ellipse((0.0, 0.0), (3.0, 2.0)) = -2.0
        ellipse((5.0, 0.0), (3.0, 2.0)) = 2.0
        ellipse((0.0, -2.0), (3.0, 2.0)) = 0.0
    """
    wide = radii.x > radii.y
    r = select(wide, radii, radii.yx)
    q = max(abs(select(wide, p, p.yx)), TINY * r.y)
    # The nearest point is r^2 q / (t + r^2). u = t + r.y^2 is measured from the pole, so that it is
    # accurate to the last digit even if the point is close to the long axis.
    scaled = r * q
    gap = r.x * r.x - r.y * r.y
    offset = vec2(gap, 0.0)
    u = max(scaled.y, scaled.x - gap, ellipse_start(scaled, gap))
    for _ in range(ELLIPSE_STEPS):
        ratio = scaled / (u + offset)
        square = dot(ratio, ratio)
        u += (sqrt(square) - 1.0) * square / dot(ratio * ratio, 1.0 / (u + offset))
    ratio = scaled / (u + offset)
    foot = r * ratio / length(ratio)
    d = length(q - foot)
    unit = q / r
    return select(dot(unit, unit) < 1.0, -d, d)


@func
def hyperbola_start(m: float, c: float, past: float) -> float:
    """Return a number slightly below the root v of m v / sqrt(v^2 + 1) + c v = m - past.

    Because v / sqrt(v^2 + 1) <= 1 - 1 / (2 v^2 + 2), the root is above that of c v^3 + past v^2 + c
    v = m / 2 - past, whose three terms are bounded one by one. Other bounds are far too low next to
    the surface of a flat hyperbola.

    Args:
        m: Factor of the first term, above 0.
        c: Factor of the second term, above 0.
        past: The difference of ``m`` and the sum.
    """
    beyond = max(past, TINY * m)
    rest = max(0.5 * m - beyond, 0.0)
    by_c = rest / c
    return min(pow(0.4 * by_c, 1.0 / 3.0), sqrt(0.4 * rest / beyond), 0.2 * by_c)


@primitive(
    "Hyperbola",
    EXACT,
    limits={"steepness": Limit.POSITIVE},
    width=gap_width,
)
@func
def hyperbola(p: vec2, radius: float = 0.4, steepness: float = 1.0) -> float:
    """Region outside of the two branches of a hyperbola, on the left and on the right.

    Args:
        p: Point.
        radius: Distance from the middle to each branch, along x.
        steepness: Slope of the asymptotes.

    Source: the nearest point as the root of an equation that rises and is concave, from below, by
    Newton's method.

    Measured:
        hyperbola((0.0, 0.0), 2.0, 1.0) = 2.0
        hyperbola((3.0, 0.0), 2.0, 1.0) = -1.0
        hyperbola((-1.0, 0.0), 2.0, 0.5) = 1.0
    """
    other = radius * steepness
    q = max(abs(p), TINY * radius)
    # With w = other^2 - t the nearest point is (radius^2 q.x / (radius^2 + t), other^2 q.y / w).
    # It lies on the branch where m w / sqrt(w^2 + c^2) + w = total.
    total = radius * radius + other * other
    m = radius * q.x
    c = other * q.y
    w = max(total - m, total * c / (c + m), c * hyperbola_start(m, c, m - total))
    for _ in range(HYPERBOLA_STEPS):
        inverse = 1.0 / length(vec2(w, c))
        value = m * w * inverse + w - total
        w = max(w - value / (m * c * c * inverse * inverse * inverse + 1.0), TINY * c)
    y = c / w
    foot = vec2(radius * sqrt(1.0 + y * y), other * y)
    d = length(q - foot)
    unit = q / vec2(radius, other)
    return select(unit.x * unit.x - unit.y * unit.y > 1.0, -d, d)
