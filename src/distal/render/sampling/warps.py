"""Random directions: points of the unit square, moved to discs, cones, hemispheres and spheres.

Input: a point ``u`` of [0, 1)^2. Output: a point or a unit direction, in coordinates whose z axis
is the axis of the distribution; the density of each is its own function. Does not depend on
materials or lights.
"""

from __future__ import annotations

from distal.lang import (
    abs,
    cos,
    dot,
    func,
    max,
    min,
    mix,
    select,
    sin,
    sqrt,
    struct,
    vec2,
    vec3,
)

PI = 3.14159265358979
FULL_TURN = 6.28318530717959
QUARTER = 0.785398163397448


@struct
class Axes:
    """Three orthogonal unit vectors, right-handed; ``n`` is the z axis."""

    s: vec3
    t: vec3
    n: vec3


@func
def axes_about(n: vec3) -> Axes:
    """Return axes whose z axis is a unit vector; accurate in every direction.

    Source: Tom Duff et al., "Building an Orthonormal Basis, Revisited" (2017).
    """
    sign = select(n.z < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + n.z)
    b = n.x * n.y * a
    s = vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x)
    return Axes(s, vec3(b, sign + n.y * n.y * a, -n.y), n)


@func
def into_space(axes: Axes, v: vec3) -> vec3:
    """Convert coordinates along the axes to a vector of space."""
    return axes.s * v.x + axes.t * v.y + axes.n * v.z


@func
def along_axes(axes: Axes, v: vec3) -> vec3:
    """Convert a vector of space to coordinates along the axes."""
    return vec3(dot(axes.s, v), dot(axes.t, v), dot(axes.n, v))


@func
def on_disc(u: vec2) -> vec2:
    """Return a point of the unit disc; density 1 / pi. Neighbors in the square stay neighbors.

    Source: Peter Shirley and Kenneth Chiu, "A Low Distortion Map Between Disk and Square" (1997).
    """
    a = 2.0 * u.x - 1.0
    b = 2.0 * u.y - 1.0
    wide = abs(a) > abs(b)
    radius = select(wide, a, b)
    ratio = select(wide, b, a) / select(radius == 0.0, 1.0, radius)
    angle = select(wide, QUARTER * ratio, 2.0 * QUARTER - QUARTER * ratio)
    return radius * vec2(cos(angle), sin(angle))


@func
def in_cosine_hemisphere(u: vec2) -> vec3:
    """Return a direction about z, as dense as the cosine: ``cosine_density``.

    Source: Malley's method, e.g. Pharr, Jakob and Humphreys, "Physically Based Rendering" (2023),
        A.5.3.
    """
    flat = on_disc(u)
    return vec3(flat, sqrt(max(1.0 - dot(flat, flat), 0.0)))


@func
def cosine_density(cosine: float) -> float:
    """Return the density of ``in_cosine_hemisphere`` by solid angle."""
    return max(cosine, 0.0) / PI


@func
def in_cone(u: vec2, narrow: float) -> vec3:
    """Return a direction in a cone about z, uniform by solid angle: ``cone_density``.

    Exact for narrow cones, too, whose cosine rounds to 1.

    Args:
        u: Point of the unit square.
        narrow: 1 minus the cosine of half the opening, 0 to 2; 2 is the whole sphere.
    """
    flat = on_disc(u)
    squared = dot(flat, flat)
    down = squared * narrow
    # The sine of the angle from the axis, divided by the radius on the disc.
    return vec3(flat * sqrt(max(narrow * (2.0 - down), 0.0)), 1.0 - down)


@func
def cone_density(narrow: float) -> float:
    """Return the density of ``in_cone`` by solid angle; ``narrow`` is above 0."""
    return 1.0 / (FULL_TURN * narrow)


@func
def on_sphere(u: vec2) -> vec3:
    """Return a direction of the whole sphere; density 1 / (4 pi) by solid angle."""
    return in_cone(u, 2.0)


@func
def narrowness(sine_squared: float) -> float:
    """Return 1 - cos of an angle up to a quarter turn from the square of its sine.

    Accurate for small angles, where 1 - cos would cancel.
    """
    held = min(max(sine_squared, 0.0), 1.0)
    return held / (1.0 + sqrt(1.0 - held))


@func
def visible_facet(view: vec3, alpha: float, u: vec2) -> vec3:
    """Return the normal of a facet that is seen from ``view``, about z: ``facet_density``.

    Args:
        view: Unit direction to the eye; z is not negative.
        alpha: Width of the distribution of Trowbridge and Reitz ("GGX"), above 0.
        u: Point of the unit square.

    Source: Jonathan Dupuy and Anis Benyoub, "Sampling Visible GGX Normals with Spherical Caps"
        (2023).
    """
    squeezed = vec3(view.xy * alpha, view.z)
    around = squeezed / sqrt(max(dot(squeezed, squeezed), 1e-30))
    angle = FULL_TURN * u.x
    rise = mix(1.0, -around.z, u.y)
    level = sqrt(max(1.0 - rise * rise, 0.0))
    middle = vec3(level * cos(angle), level * sin(angle), rise) + around
    facet = vec3(middle.xy * alpha, max(middle.z, 0.0))
    return facet / sqrt(max(dot(facet, facet), 1e-30))
