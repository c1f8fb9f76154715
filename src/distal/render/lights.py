"""Lights with a position or direction: the light that each sends to a point.

Input: a point and the numbers of a light. Output: a ``LightSample``. Does not depend on shadows or
surfaces. The unit of ``radiance``: a white diffuse surface that faces the light shows this value,
so a point light of intensity 1 at distance 1 shows 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from distal.lang import clamp, cos, dot, func, inversesqrt, max, normalize, struct, tan, vec3
from distal.render.declarations import ExtraParameter, light

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
        distance: Distance to the light.
        radiance: The value that a white diffuse surface shows if it faces the light, unshadowed.
        radius: Tangent of half the angular size of the light; 0 casts hard shadows.
    """

    direction: vec3
    distance: float
    radiance: vec3
    radius: float


@func
def no_light() -> LightSample:
    """Return a light without effect."""
    return LightSample(vec3(0.0, 1.0, 0.0), FAR_AWAY, vec3(0.0), 0.0)


def _shines_somewhere(direction: tuple[float, ...]) -> str | None:
    return None if any(direction) else "direction is a vector of zeros, which points nowhere"


def _has_a_cone(position: tuple[float, ...], target: tuple[float, ...], angle: float) -> str | None:
    if position == target:
        return "position and target are the same place"
    if angle < math.pi:
        return None
    return "angle is the cone's opening in radians, below pi; in degrees: 45 * deg"


@light("DistantLight", requires=_shines_somewhere)
@func
def distant_light(
    p: vec3,
    direction: vec3 = FROM_ABOVE,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    angle: float = 0.0,
) -> LightSample:
    """Light from one direction, equally bright everywhere, such as the sun.

    Args:
        p: Point; has no effect.
        direction: Towards the light, of any length.
        intensity: The value that a white matte surface shows if it faces the light.
        color: Its color.
        angle: Its angular size in radians, which softens shadows (the sun: 0.0093).
    """
    return LightSample(normalize(direction), FAR_AWAY, color * intensity, tan(0.5 * angle))


@func
def with_falloff(light: LightSample, falloff: Callable[[float], float]) -> LightSample:
    """Return a light that falls off otherwise than with the square of the distance.

    Args:
        light: The light, which falls off with the square.
        falloff: Of the distance; 1 / distance**2 changes nothing.
    """
    share = light.distance * light.distance * falloff(light.distance)
    return LightSample(light.direction, light.distance, light.radiance * share, light.radius)


FALLOFF = ExtraParameter(
    "falloff",
    None,
    "Func | None",
    "A ``@func`` of the distance (float) that returns the share of the intensity that arrives, "
    "instead of 1 / distance**2.",
    keyword_only=True,
)


@light("PointLight", extras=(FALLOFF,))
@func
def point_light(
    p: vec3,
    position: vec3,
    intensity: float = 1.0,
    color: vec3 = WHITE,
    radius: float = 0.0,
) -> LightSample:
    """Light from one point, falling off with the square of the distance.

    Args:
        p: Point.
        position: Position of the light.
        intensity: The value that a white matte surface shows if it faces the light at distance 1.
        color: Its color.
        radius: Radius of the light, which softens shadows.
    """
    offset = position - p
    # Limits the brightness at the light itself: distances below a rounding error count as that.
    squared = max(dot(offset, offset), 1e-12 * dot(p, p) + 1e-30)
    inverse = inversesqrt(squared)
    radiance = color * (intensity / squared)
    return LightSample(offset * inverse, squared * inverse, radiance, radius * inverse)


@light("SpotLight", requires=_has_a_cone, extras=(FALLOFF,))
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
        position: Position of the light.
        target: The point that it points at.
        intensity: As for a point light.
        color: Its color.
        angle: The opening of the whole cone, in radians; below pi.
        softness: Fraction of the half angle in which the light fades: 0 for a sharp rim, 1 to fade
            from the axis on.
        radius: Radius of the light, which softens shadows.
    """
    light = point_light(p, position, intensity, color, radius)
    along = dot(light.direction, normalize(position - target))
    rim = cos(0.5 * angle)
    full = cos(0.5 * angle * (1.0 - softness))
    share = clamp((along - rim) / max(full - rim, 1e-6), 0.0, 1.0)
    faded = light.radiance * (share * share * (3.0 - 2.0 * share))
    return LightSample(light.direction, light.distance, faded, light.radius)
