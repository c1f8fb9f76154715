"""Lights that come from somewhere: what each sends to a point.

Input: a point and the numbers of a light. Output: a ``LightSample``. Knows neither
shadows nor surfaces. The unit of ``radiance``: a white diffuse surface, square on, shows it as it
is, so that a point light of intensity 1 at distance 1 shows 1.
"""

from __future__ import annotations

from distal.lang import clamp, cos, dot, func, inversesqrt, max, normalize, struct, tan, vec3

FAR_AWAY = 1e9  # how far light from everywhere the same is taken to come
WHITE = vec3(1.0)
ORIGIN = vec3(0.0)
OVERHEAD = vec3(0.0, 3.0, 0.0)
DIAGONAL = vec3(1.0, 1.0, 1.0)


@struct
class LightSample:
    """The light of one source at one point.

    Attributes:
        direction: Unit vector to the light.
        distance: How far it is.
        radiance: What a white diffuse surface would show, square on and unshadowed.
        radius: Tangent of half the angle that the light fills; 0 casts hard shadows.
    """

    direction: vec3
    distance: float
    radiance: vec3
    radius: float


@func
def no_light() -> LightSample:
    """A light that is not there."""
    return LightSample(vec3(0.0, 1.0, 0.0), FAR_AWAY, vec3(0.0), 0.0)


@func
def distant_light(
    p: vec3,
    direction: vec3 = DIAGONAL,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    angle: float = 0.0,
) -> LightSample:
    """Light from far away, the same everywhere.

    Args:
        p: Point; counts for nothing.
        direction: To the light, of any length but 0.
        intensity: Brightness.
        color: Linear colour.
        angle: How wide it looks (the sun: 0.0093).
    """
    return LightSample(normalize(direction), FAR_AWAY, color * intensity, tan(0.5 * angle))


@func
def point_light(
    p: vec3,
    position: vec3 = OVERHEAD,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    radius: float = 0.0,
) -> LightSample:
    """Light from one point (or a small ball), weaker by the square of the distance.

    Args:
        p: Point.
        position: Where the light is.
        intensity: Brightness at distance 1.
        color: Linear colour.
        radius: Of the ball, for soft shadows and the size of highlights.
    """
    offset = position - p
    # A point on the light itself: as if a thousandth away.
    squared = max(dot(offset, offset), 1e-6)
    inverse = inversesqrt(squared)
    radiance = color * (intensity / squared)
    return LightSample(offset * inverse, squared * inverse, radiance, radius * inverse)


@func
def spot_light(
    p: vec3,
    position: vec3 = OVERHEAD,
    target: vec3 = ORIGIN,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    angle: float = 0.7,
    softness: float = 0.2,
    radius: float = 0.0,
) -> LightSample:
    """A point light that shines in a cone.

    Args:
        p: Point.
        position: Where the light is.
        target: What it points at.
        intensity: Brightness in the middle, at distance 1.
        color: Linear colour.
        angle: Of the whole cone, below pi.
        softness: Share of the half angle over which the rim fades: 0 sharp, 1 from the middle on.
        radius: Of the lamp, for soft shadows.
    """
    light = point_light(p, position, intensity, color, radius)
    along = dot(light.direction, normalize(position - target))
    rim = cos(0.5 * angle)
    full = cos(0.5 * angle * (1.0 - softness))
    share = clamp((along - rim) / max(full - rim, 1e-6), 0.0, 1.0)
    faded = light.radiance * (share * share * (3.0 - 2.0 * share))
    return LightSample(light.direction, light.distance, faded, light.radius)
