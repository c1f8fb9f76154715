"""Ambient light: light from all directions.

Input: a unit normal and the numbers of the light. Output: the light that a white diffuse surface
shows without occlusion. Lights with a position or direction are in ``lights``.
"""

from __future__ import annotations

from distal.lang import Buffer, acos, clamp, dot, func, max, normalize, sqrt, vec3
from distal.render.declarations import light

PI = 3.14159265358979
WHITE = vec3(1.0)
SKY = vec3(0.6, 0.75, 1.0)
EARTH = vec3(0.3, 0.25, 0.2)
UP = vec3(0.0, 1.0, 0.0)
ZENITH = vec3(0.2, 0.4, 0.8)
HORIZON = vec3(0.8, 0.85, 0.9)
GROUND = vec3(0.25, 0.22, 0.2)


@func
def even_radiance(direction: vec3, intensity: float = 0.1, color: vec3 = WHITE) -> vec3:
    """Return the radiance of an ambient light from a direction."""
    return color * intensity


@light("AmbientLight", radiance=even_radiance)
@func
def ambient_light(n: vec3, intensity: float = 0.1, color: vec3 = WHITE) -> vec3:
    """The same light from every direction.

    Args:
        n: Unit normal; has no effect.
        intensity: Brightness; a white matte surface shows this value.
        color: Its color.
    """
    return color * intensity


def _has_an_upper_half(up: tuple[float, ...]) -> str | None:
    return None if any(up) else "up is a vector of zeros, which points nowhere"


@func
def hemisphere_radiance(
    direction: vec3,
    sky: vec3 = SKY,
    ground: vec3 = EARTH,
    intensity: float = 0.5,
    up: vec3 = UP,
) -> vec3:
    """Return the radiance of a hemisphere light from a direction.

    Args:
        direction: Unit direction.
        sky: Color of the upper half.
        ground: Color of the lower half.
        intensity: A factor on both.
        up: Direction of the upper half, of any length.
    """
    return (sky if dot(direction, up) > 0.0 else ground) * intensity


@light("HemisphereLight", requires=_has_an_upper_half, radiance=hemisphere_radiance)
@func
def hemisphere_light(
    n: vec3,
    sky: vec3 = SKY,
    ground: vec3 = EARTH,
    intensity: float = 0.5,
    up: vec3 = UP,
) -> vec3:
    """Light of one color from the upper half of space and of another from the lower half.

    Args:
        n: Unit normal.
        sky: Color of the upper half.
        ground: Color of the lower half.
        intensity: A factor on both.
        up: Direction of the upper half, of any length.
    """
    share = 0.5 + 0.5 * dot(n, normalize(up))
    return (ground + (sky - ground) * share) * intensity


@func
def climbing_share(height: float) -> float:
    """Return the diffuse light of a source whose radiance is its height above the horizon.

    ``height`` is the y component of the normal. The integral over the sphere of the product of two
    cosines, both clamped at 0, is 2/3 ((pi - a) cos a + sin a), divided by pi; a is the angle
    between them.

    Source: Arvo, "Analytic Methods for Simulated Light Transport" (1995), double-axis moments.
    """
    cosine = clamp(height, -1.0, 1.0)
    sine = sqrt(max(1.0 - cosine * cosine, 0.0))
    return 2.0 / (3.0 * PI) * ((PI - acos(cosine)) * cosine + sine)


@func
def sky_ambient(
    n: vec3,
    zenith: vec3 = ZENITH,
    horizon: vec3 = HORIZON,
    ground: vec3 = GROUND,
    intensity: float = 1.0,
) -> vec3:
    """Return the exact diffuse light of ``sky.sky`` without its sun."""
    upper = 0.5 + 0.5 * n.y
    gradient = (zenith - horizon) * climbing_share(n.y)
    return (ground * (1.0 - upper) + horizon * upper + gradient) * intensity


@func
def environment_ambient(n: vec3, harmonics: Buffer[vec3], intensity: float = 1.0) -> vec3:
    """Return the diffuse light of an environment map, from its nine spherical harmonics.

    Args:
        n: Unit normal.
        harmonics: Nine coefficients, computed by ``environment.harmonics``.
        intensity: Brightness.

    Source: Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment Maps"
        (2001).
    """
    light = harmonics[0] + harmonics[1] * n.y + harmonics[2] * n.z + harmonics[3] * n.x
    light += harmonics[4] * (n.x * n.y) + harmonics[5] * (n.y * n.z) + harmonics[7] * (n.x * n.z)
    light += harmonics[6] * (3.0 * n.z * n.z - 1.0) + harmonics[8] * (n.x * n.x - n.y * n.y)
    return max(light * intensity, vec3(0.0))
