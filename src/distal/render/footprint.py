"""Footprints: the part of a surface that a pixel shows, over which patterns are averaged.

Input: a camera and a pixel; a ray and the surface that it hits. Output: a ``Cone``, the width of a
pixel along its ray, and a ``Footprint``, its two sides on the surface. Patterns that depend on a
footprint neither alias nor shimmer, with one sample in each pixel.

Source: Homan Igehy, "Tracing Ray Differentials" (1999), here of a round ray; Akenine-Möller et al.,
"Improved Shader and Texture Level of Detail Using Ray Cones" (2021).
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    abs,
    cross,
    dot,
    func,
    inversesqrt,
    length,
    max,
    min,
    select,
    struct,
    vec2,
    vec3,
)
from distal.render.camera import Ray

# The smallest cosine between a ray and the normal. At the horizon a footprint is still finite.
GRAZING = 1e-4
# The two sides are found again in the coordinates of a moved shape by differences over this part of
# their length: short, so that few differences cross the border of a repetition.
STEP = 0.0625


@struct
class Cone:
    """The width of a pixel along its ray.

    Attributes:
        width: The width at the origin of the ray, in scene units.
        spread: The growth of the width per unit of distance.
        sample: The number of the sample in the pixel, from 0: each has its own ray to a wide light.
        samples: How many samples the pixel has.
    """

    width: float
    spread: float
    sample: int = 0
    samples: int = 1


@struct
class Footprint:
    """The sides of a pixel on a surface; the pixel is the parallelogram around the point.

    Attributes:
        across: The side perpendicular to the ray.
        along: The side in the direction of the ray, which is longer.
        facing: How much the surface faces the eye: the cosine of the angle between the normal and
            the direction to the eye, 0 at outlines.
    """

    across: vec3
    along: vec3
    facing: float = 1.0


# The samples of a pattern that has no closed form: a picture.
TAPS = 8
# Of rays that are infinitely thin: patterns are not averaged.
THIN = Cone(0.0, 0.0)
POINT = Footprint(vec3(0.0), vec3(0.0))


@func
def thin(uv: vec2, size: float) -> Cone:
    """Return the cone of a pixel whose patterns are not averaged."""
    return Cone(0.0, 0.0)


@func
def point_footprint() -> Footprint:
    """Return the footprint of a point: patterns are not averaged."""
    return Footprint(vec3(0.0), vec3(0.0))


@func
def flat_footprint(footprint: Footprint) -> Footprint:
    """Return the footprint of a point that is seen at the same angle."""
    return Footprint(vec3(0.0), vec3(0.0), footprint.facing)


@func
def facing_of(footprint: Footprint) -> float:
    """Return the cosine of the angle between the normal and the direction to the eye."""
    return footprint.facing


@func
def pixel_cone(camera: Callable[[vec2], Ray], uv: vec2, size: float) -> Cone:
    """Return the cone of a pixel, from the difference of two rays, for any camera.

    Args:
        camera: Ray of a place in the picture.
        uv: Place of the pixel in the picture.
        size: Side of the pixel, in the unit of ``uv``.
    """
    here = camera(uv)
    # The diagonal: the root mean square of the differences across and along.
    there = camera(uv + vec2(size, size))
    diagonal = 0.7071067811865476
    return Cone(
        diagonal * length(there.origin - here.origin),
        diagonal * length(there.direction - here.direction),
    )


@func
def continued(cone: Cone, t: float) -> Cone:
    """Return the cone of a ray that continues at distance ``t``, mirrored or refracted."""
    return Cone(cone.width + cone.spread * t, cone.spread, cone.sample, cone.samples)


@func
def footprint_at(cone: Cone, direction: vec3, t: float, n: vec3) -> Footprint:
    """Return the footprint of a pixel on a surface.

    Args:
        cone: The pixel's cone.
        direction: Unit direction of the ray.
        t: Distance along the ray.
        n: Unit normal, on either side.
    """
    width = cone.width + cone.spread * t
    cosine = dot(direction, n)
    level = direction - cosine * n
    squared = dot(level, level)
    # Seen from straight above, all directions on the surface are alike.
    other = cross(n, vec3(1.0, 0.0, 0.0)) if abs(n.x) < 0.7 else cross(n, vec3(0.0, 1.0, 0.0))
    along = select(squared > 1e-8, level * inversesqrt(max(squared, 1e-12)), other)
    side = cross(n, along)
    facing = min(abs(cosine), 1.0)
    return Footprint(side * width, along * (width / max(facing, GRAZING)), facing)


@func
def footprint_length(footprint: Footprint) -> float:
    """Return the length of the longer side of a footprint."""
    return max(length(footprint.across), length(footprint.along))


@func
def extent(footprint: Footprint, direction: vec3) -> float:
    """Return the width of the footprint along a direction: that of a box of equal variance."""
    across = dot(footprint.across, direction)
    along = dot(footprint.along, direction)
    return length(vec2(across, along))


@func
def tap(footprint: Footprint, index: int) -> vec3:
    """Return where one of ``TAPS`` samples of a footprint is, from its middle.

    Samples are at equal distances along the longer side, alternately on both sides of its middle.
    """
    along = (float(index) + 0.5) / float(TAPS) - 0.5
    return footprint.along * along + footprint.across * (float(index % 2) * 0.5 - 0.25)


@func
def step_along(p: vec3, side: vec3, sign: float) -> vec3:
    """Return a point that is moved by a small part of a side of a footprint."""
    return p + (sign * STEP) * side


@func
def shorter(a: vec3, b: vec3) -> vec3:
    """Return the shorter of two vectors; the longer difference crosses a border."""
    return select(dot(b, b) < dot(a, a), b, a)


@func
def moved_footprint(
    footprint: Footprint,
    q: vec3,
    across_ahead: vec3,
    across_behind: vec3,
    along_ahead: vec3,
    along_behind: vec3,
) -> Footprint:
    """Return a footprint in the coordinates of a moved shape, by finite differences.

    Args:
        footprint: The footprint before.
        q: The point in these coordinates.
        across_ahead: The point of ``step_along`` the side across, in these coordinates.
        across_behind: The same in the opposite direction.
        along_ahead: The point of ``step_along`` the side along.
        along_behind: The same in the opposite direction.
    """
    return Footprint(
        shorter(across_ahead - q, q - across_behind) / STEP,
        shorter(along_ahead - q, q - along_behind) / STEP,
        footprint.facing,
    )
