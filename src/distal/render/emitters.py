"""Lights for paths: random directions to a light, and what a direction shows of it.

Input: a ``LightSample`` (a declared light at a point) or the table of an environment. Output: a
direction with its weight and density. Direct light and paths read the same declarations; a light
that ``render.declarations.light`` declares needs nothing more for paths.

A light of non-zero size is a uniformly bright ball (a cone of directions, if it is far away). Its
radiance follows from what it sends to a white surface, so that paths and direct light agree without
occlusion. The inside of the ball is bright, too. A ball in the scene of radius r that emits e is
``point_light(p, middle, r * r, e, r)``.

``radiance`` is that of the language: an even background of radiance 1 lets a white matte surface
show 1.
"""

from __future__ import annotations

from distal.lang import cross, dot, func, max, min, select, sqrt, struct, vec2, vec3
from distal.render.lights import FAR_AWAY, LightSample
from distal.render.sampling.warps import (
    axes_about,
    cone_density,
    in_cone,
    into_space,
    narrowness,
)

PI = 3.14159265358979
FULL_TURN = 6.28318530717959
# The square of the sine of half the angular size below which a light counts as a point: 32 bits
# cannot tell its directions apart.
POINT = 1e-11


@struct
class Emission:
    """A random direction to a light.

    Attributes:
        direction: Unit vector to the light.
        distance: Distance to the surface of the light along it.
        weight: Radiance divided by density. A path adds ``throughput * value * weight``, where
            ``value`` is that of ``scatter.respond``.
        density: Density by solid angle; 0 for a point, which no ray meets by chance.
    """

    direction: vec3
    distance: float
    weight: vec3
    density: float


@struct
class LightOnRay:
    """What a ray meets of a light.

    Attributes:
        distance: Distance to the surface of the light.
        radiance: Its radiance; 0 if the ray misses it.
        density: Density by solid angle with which ``sample_light`` chooses the ray; 0 if it misses.
    """

    distance: float
    radiance: vec3
    density: float


@func
def sine_squared(light: LightSample) -> float:
    """Return the squared sine of half the angular size of a light; 1 or more inside of it.

    ``radius`` of a light at a finite distance is its radius divided by the distance to its middle,
    the sine; of a light that is the same everywhere it is the tangent.
    """
    squared = light.radius * light.radius
    far = light.distance >= FAR_AWAY
    return select(far, squared / (1.0 + squared), squared)


@func
def narrowness_of(sine: float) -> float:
    """Return 1 - cos of half the angle of a light; 2, the whole sphere, inside of it."""
    return 2.0 if sine >= 1.0 else narrowness(sine)


@func
def way_to_ball(light: LightSample, sine: float, direction: vec3) -> float:
    """Return the distance to the surface of a light along a direction that meets it."""
    across = cross(light.direction, direction)
    half = sqrt(max(sine - dot(across, across), 0.0))
    along = dot(light.direction, direction)
    near = light.distance * (along + select(sine >= 1.0, half, -half))
    return select(light.distance >= FAR_AWAY, light.distance, near)


@func
def sample_light(light: LightSample, u: vec2) -> Emission:
    """Return a random direction to a light, uniform by the solid angle that it covers.

    Args:
        light: The light at the point.
        u: Point of the unit square.

    Source: Peter Shirley, Changyaw Wang and Kurt Zimmerman, "Monte Carlo Techniques for Direct
        Lighting Calculations" (1996).
    """
    sine = sine_squared(light)
    middle = light.direction / sqrt(max(dot(light.direction, light.direction), 1e-20))
    if sine < POINT:
        return Emission(middle, light.distance, light.radiance * PI, 0.0)
    narrow = narrowness_of(sine)
    direction = into_space(axes_about(middle), in_cone(u, narrow))
    # Radiance is radiance / sine; divided by the density 1 / (2 pi narrow).
    weight = light.radiance * (FULL_TURN * narrow / sine)
    return Emission(direction, way_to_ball(light, sine, direction), weight, cone_density(narrow))


@func
def seen_light(light: LightSample, direction: vec3) -> LightOnRay:
    """Return what a ray from the light's point meets of it, and how likely it is sampled.

    Args:
        light: The light at the point where the ray starts.
        direction: Unit direction of the ray.
    """
    sine = sine_squared(light)
    across = cross(light.direction, direction)
    ahead = dot(light.direction, direction) > 0.0 and dot(across, across) <= sine
    if sine < POINT or not (ahead or sine >= 1.0):
        return LightOnRay(FAR_AWAY, vec3(0.0), 0.0)
    density = cone_density(narrowness_of(sine))
    return LightOnRay(way_to_ball(light, sine, direction), light.radiance / sine, density)


@func
def power_share(density: float, other: float) -> float:
    """Return the weight of a sample that two strategies could have made: the power heuristic.

    Args:
        density: Density of the strategy that made it; 0 for a direction that only it can make.
        other: Density of the other strategy; 0 if it cannot make this sample.

    Source: Eric Veach, "Robust Monte Carlo Methods for Light Transport Simulation" (1997), 9.2.4.
    """
    ratio = other / max(density, 1e-30)
    return 1.0 if density <= 0.0 or other <= 0.0 else 1.0 / (1.0 + min(ratio * ratio, 1e30))
