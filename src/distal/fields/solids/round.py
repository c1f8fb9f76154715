"""Balls, ellipsoids, superellipsoids, and a ball with bumps.

Input: a point and the numbers of a shape. Output: the distance, or a bound on it.
"""

from __future__ import annotations

from typing import Final

from distal.fields.chords import in_ball, in_round
from distal.fields.constants import TINY
from distal.fields.guarantees import EXACT, LOWER_BOUND, NOTHING, Bounds, Limit, primitive
from distal.fields.solids.axes import sphere_bounds
from distal.fields.solids.regular import along_vertices
from distal.fields.widths import radii_width, radius_width, superellipsoid_width
from distal.lang import abs, clamp, func, length, max, min, pow, select, sqrt, vec2, vec3

EGG: Final = vec3(0.5, 0.75, 0.5)
HALF_BALL: Final = vec3(0.5)


@primitive(
    "Sphere",
    EXACT,
    bounds=sphere_bounds,
    chord=in_ball,
    width=radius_width,
)
@func
def sphere(p: vec3, radius: float = 1.0) -> float:
    """Ball, centred at the origin.

    Args:
        p: Point.
        radius: Radius.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        sphere((2.0, 3.0, 6.0), 1.0) = 6.0
        sphere((0.0, 0.0, 0.0), 1.0) = -1.0
        sphere((0.0, 0.0, -0.5), 0.5) = 0.0
    """
    return length(p) - radius


@func
def ellipsoid_bounds(radii: vec3) -> Bounds:
    """Return the box with these half sizes."""
    return Bounds(-radii, radii)


@func
def ellipsoid_slope(radii: vec3) -> float:
    """Return a bound on the slope.

    It depends on the squared ratio s of the largest to the smallest radius. Far away the field is
    |q|^2 / |q / radii| with q = p / radii; nearer, its gradient is a weighted mean of this field's
    gradient and a unit vector. Weight the axes by the squares of q's components: the squared slope
    is then 4 - 4 E(r^2) E(r^-2) + E(r^2)^2 E(r^-4), at most E(r^2)^2 E(r^-4). The chord of the
    convex x^-2 bounds the last factor, and the resulting cubic is largest at E(r^2) = 2 (s^2 + s +
    1) / (3 (s + 1)), in units of the smallest radius, squared.
    """
    ratio = max(radii.x, radii.y, radii.z) / min(radii.x, radii.y, radii.z)
    s = ratio * ratio
    k = s * s + s + 1.0
    return sqrt(k * k * k * (4.0 / 27.0)) / (s * (s + 1.0))


@func
def ellipsoid_growth(radii: vec3) -> float:
    """Return half of (s + 1 / s), with s the ratio of the largest to the smallest radius.

    With k = |q| outside, a point is at most |p| (k - 1) / k from the box, and the field is (k - 1)
    k / |q / radii|. Weight the axes by the squares of q's components: the quotient is at most
    sqrt(E(r^2) E(r^-2)), and that is at most (s + 1 / s) / 2 (Kantorovich's inequality).
    """
    ratio = max(radii.x, radii.y, radii.z) / min(radii.x, radii.y, radii.z)
    return 0.5 * (ratio + 1.0 / ratio)


@func
def ellipsoid_chord(p: vec3, direction: vec3, radii: vec3) -> vec2:
    """Return the part of a line inside: that of the ball which the ellipsoid is stretched from."""
    return in_round(p / radii, direction / radii, 1.0)


@primitive(
    "Ellipsoid",
    LOWER_BOUND,
    slope=ellipsoid_slope,
    bounds=ellipsoid_bounds,
    growth=ellipsoid_growth,
    chord=ellipsoid_chord,
    width=radii_width,
)
@func
def ellipsoid(p: vec3, radii: vec3 = EGG) -> float:
    """Ellipsoid; outside a lower bound, close to the distance near the surface.

    Outside, the value is the convex function ``|p / radii| - 1`` divided by its own slope. Inside,
    this would jump at the centre, so the factor changes gradually to the smallest radius.

    Args:
        p: Point.
        radii: Half of the size along x, y and z.

    Source: Inigo Quilez, "Ellipsoid SDF" (https://iquilezles.org/articles/ellipsoids/), outside.

    Measured:
        ellipsoid((2.0, 0.0, 0.0), (1.0, 2.0, 3.0)) = 1.0
        ellipsoid((0.0, 5.0, 0.0), (1.0, 2.0, 3.0)) = 3.0
        ellipsoid((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)) = -1.0
    """
    q = p / radii
    k = length(q)
    scale = k / max(length(q / radii), TINY)
    smallest = min(radii.x, radii.y, radii.z)
    return (k - 1.0) * select(k < 1.0, smallest + (scale - smallest) * k, scale)


def superellipsoid_requires(across: float, upward: float) -> str | None:
    """Return why exponents below 1 are invalid (no bound on the slope), or None."""
    if across < 1.0 or upward < 1.0:
        return "across and upward must be 1 or more"
    return None


@func
def superellipsoid_steepest(across: float, upward: float) -> float:
    """Return a bound on the slope of the norm, times the smallest radius."""
    return pow(2.0, max(1.0 / across - 0.5, 0.0) + max(1.0 / upward - 0.5, 0.0))


@func
def superellipsoid_side_growth(radii: vec3, across: float, upward: float) -> float:
    """Return the growth of the sides.

    The norm is at least each component of p / radii, so a point passes a side by at most its radius
    for each unit of the norm.
    """
    smallest = min(radii.x, radii.y, radii.z)
    return max(radii.x, radii.y, radii.z) / smallest * superellipsoid_steepest(across, upward)


@func
def superellipsoid_growth(radii: vec3, across: float, upward: float) -> float:
    """Return the growth: that of a side, all sides passed at the same time."""
    smallest = min(radii.x, radii.y, radii.z)
    return length(radii) / smallest * superellipsoid_steepest(across, upward)


@primitive(
    "Superellipsoid",
    LOWER_BOUND,
    bounds=ellipsoid_bounds,
    requires=superellipsoid_requires,
    growth=superellipsoid_growth,
    side_growth=superellipsoid_side_growth,
    width=superellipsoid_width,
)
@func
def superellipsoid(
    p: vec3, radii: vec3 = HALF_BALL, across: float = 4.0, upward: float = 4.0
) -> float:
    """Shape between a diamond, a ball and a box, set by two exponents; a bound with slope 1.

    The field is a norm: ``((|x|^across + |z|^across)^(upward/across) + |y|^upward)^(1/upward)`` of
    p / radii, minus 1. It is divided by its slope, which is at most the product of 2^(1/e - 1/2)
    for each exponent e below 2, over the smallest radius.

    Args:
        p: Point.
        radii: Half of the size along x, y and z.
        across: Exponent of the outline seen from above: 1 for a diamond, 2 for a circle, large for
            a square.
        upward: Exponent of the outline seen from the side.

    Source: Alan Barr, "Superquadrics and Angle-Preserving Transformations", IEEE Computer Graphics
        and Applications 1(1), 1981.

    Measured:
        superellipsoid((2.0, 0.0, 0.0), (1.0, 1.0, 1.0), 4.0, 4.0) = 1.0
        superellipsoid((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 8.0, 3.0) = -1.0
        superellipsoid((3.0, 4.0, 0.0), (1.0, 1.0, 1.0), 2.0, 2.0) = 4.0
    """
    q = abs(p / radii)
    # Divide by the largest component, so that no power overflows.
    largest = max(q.x, q.y, q.z, TINY)
    r = q / largest
    ring = pow(pow(r.x, across) + pow(r.z, across), upward / across)
    norm = largest * pow(ring + pow(r.y, upward), 1.0 / upward)
    steepest = superellipsoid_steepest(across, upward)
    return (norm - 1.0) * (min(radii.x, radii.y, radii.z) / steepest)


# A bump extends halfway to the next one: the cosine of half the angle between the vertices of an
# icosahedron.
BUMP_EDGE: Final = 0.8506508083520399
# The largest slope of a bump along the angle: 4 / (3 sqrt(3)) * sqrt(2 / (1 - BUMP_EDGE)).
BUMP_SLOPE: Final = 2.8172


@func
def blob_bounds(radius: float, height: float) -> Bounds:
    """Return the box of the ball with its bumps."""
    return Bounds(vec3(-radius - height), vec3(radius + height))


@func
def blob_slope(radius: float, height: float) -> float:
    """Return a bound on the slope: at most 1 outwards, combined with the slope of the bumps."""
    sideways = BUMP_SLOPE * height / radius
    return sqrt(1.0 + sideways * sideways)


def blob_requires(radius: float, height: float) -> str | None:
    """Return why the bumps are too high, or None."""
    return "height must be at most the radius" if height > radius else None


@primitive(
    "Blob",
    NOTHING,
    slope=blob_slope,
    bounds=blob_bounds,
    limits={"height": Limit.NOT_NEGATIVE},
    requires=blob_requires,
    growth=1.0,
    width=radius_width,
)
@func
def blob(p: vec3, radius: float = 0.75, height: float = 0.2) -> float:
    """Ball with twelve round bumps, in the directions of the vertices of an icosahedron.

    Args:
        p: Point.
        radius: Radius of the ball between the bumps.
        height: Height of the bumps, at most the radius.

    Source: after Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), with another profile.

    Measured:
        blob((2.0, 2.0, 2.0), 1.0, 0.25) = 2.4641016151377544
        blob((0.0, 1.0514622242382672, 1.7013016167040798), 1.0, 0.25) = 0.75
        blob((0.0, 0.0, 0.0), 1.0, 0.25) = -1.0
    """
    far = length(p)
    towards = along_vertices(abs(p))
    # 1 - cosine of the angle to the nearest bump's top, relative to that at its edge.
    outward = clamp((1.0 - towards / max(far, TINY)) / (1.0 - BUMP_EDGE), 0.0, 1.0)
    bump = (1.0 - outward) * (1.0 - outward)
    return far - radius - height * min(far / radius, 1.0) * bump
