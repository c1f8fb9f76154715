"""Lights that come from somewhere: what each sends to a point.

Input: a point and the numbers of a light. Output: a ``LightSample``. Knows neither
shadows nor surfaces. The unit of ``radiance``: a white diffuse surface, square on, shows it as it
is, so that a point light of intensity 1 at distance 1 shows 1.
"""

from __future__ import annotations

import math

from distal.lang import clamp, cos, dot, func, inversesqrt, max, normalize, struct, tan, vec3
from distal.render.declarations import light

FAR_AWAY = 1e9  # the distance of a light that is the same everywhere
WHITE = vec3(1.0)
ORIGIN = vec3(0.0)
FROM_ABOVE = vec3(1.0, 2.0, 1.0)
EIGHTH_TURN = math.pi / 4


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


def _shines_somewhere(direction: tuple[float, ...]) -> str | None:
    return None if any(direction) else "direction is a vector of zeros, which points nowhere"


def _has_a_cone(position: tuple[float, ...], target: tuple[float, ...], angle: float) -> str | None:
    if position == target:
        return "position and target are the same place"
    if angle < math.pi:
        return None
    return "angle is the cone's opening in radians, below pi; np.radians makes it of degrees"


@light("DistantLight", requires=_shines_somewhere)
@func
def distant_light(
    p: vec3,
    direction: vec3 = FROM_ABOVE,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    angle: float = 0.0,
) -> LightSample:
    """Light from one side, equally bright everywhere: the sun.

    Args:
        p: Point; has no effect.
        direction: Towards the light, of any length.
        intensity: How bright a white matte surface shows that faces it.
        color: Its colour.
        angle: How wide it looks, in radians: what softens its shadows (the sun: 0.0093).
    """
    return LightSample(normalize(direction), FAR_AWAY, color * intensity, tan(0.5 * angle))


@light("PointLight")
@func
def point_light(
    p: vec3,
    position: vec3,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    radius: float = 0.0,
) -> LightSample:
    """Light from one point, fading with the square of the distance.

    Args:
        p: Point.
        position: Where it is.
        intensity: How bright a white matte surface shows that faces it at distance 1.
        color: Its colour.
        radius: How large it is: what softens its shadows.
    """
    offset = position - p
    # A point on the light itself: as if a thousandth away.
    squared = max(dot(offset, offset), 1e-6)
    inverse = inversesqrt(squared)
    radiance = color * (intensity / squared)
    return LightSample(offset * inverse, squared * inverse, radiance, radius * inverse)


@light("SpotLight", requires=_has_a_cone)
@func
def spot_light(
    p: vec3,
    position: vec3,
    target: vec3 = ORIGIN,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    angle: float = EIGHTH_TURN,
    softness: float = 0.2,
    radius: float = 0.0,
) -> LightSample:
    """A point light that shines in a cone.

    Args:
        p: Point.
        position: Where it is.
        target: What it points at.
        intensity: As for a point light.
        color: Its colour.
        angle: The whole cone's opening, in radians; below pi.
        softness: Share of half the angle over which the rim fades: 0 sharp, 1 from the axis on.
        radius: How large it is: what softens its shadows.
    """
    light = point_light(p, position, intensity, color, radius)
    along = dot(light.direction, normalize(position - target))
    rim = cos(0.5 * angle)
    full = cos(0.5 * angle * (1.0 - softness))
    share = clamp((along - rim) / max(full - rim, 1e-6), 0.0, 1.0)
    faded = light.radiance * (share * share * (3.0 - 2.0 * share))
    return LightSample(light.direction, light.distance, faded, light.radius)
