"""Backgrounds: the light of a ray that hits nothing.

Input: a unit direction and the numbers of a background. Output: linear light. The sky's sun as a
light (a ``LightSample``) is here too; the sky's diffuse light is ``ambient.sky_ambient``.
"""

from __future__ import annotations

from distal.lang import clamp, cos, dot, func, max, mix, normalize, smoothstep, vec3
from distal.render.ambient import GROUND, HORIZON, ZENITH, sky_ambient
from distal.render.declarations import ExtraParameter, background
from distal.render.lights import LightSample, distant_light

SUN_COLOR = vec3(1.0, 0.9, 0.75)
BLACK = vec3(0.0)
PALE = vec3(0.9, 0.9, 0.9)
BLUE = vec3(0.35, 0.5, 0.75)
DIAGONAL = vec3(1.0, 1.0, 1.0)


@func
def plain_background(direction: vec3, color: vec3 = BLACK) -> vec3:
    """The same color in every direction."""
    return color


@background("GradientBackground")
@func
def gradient_background(
    direction: vec3,
    bottom: vec3 = PALE,
    top: vec3 = BLUE,
) -> vec3:
    """One color straight down and another straight up, blended linearly by height.

    Args:
        direction: Unit direction.
        bottom: Color straight down.
        top: Color straight up.
    """
    return mix(bottom, top, 0.5 + 0.5 * direction.y)


@func
def sky_sun(
    p: vec3, sun: vec3, sun_color: vec3, sun_intensity: float, sun_angle: float
) -> LightSample:
    """Return the sky's sun as a light."""
    return distant_light(p, sun, sun_intensity, sun_color, sun_angle)


def _has_a_sun(sun: tuple[float, ...]) -> str | None:
    return None if any(sun) else "sun is a vector of zeros, which points nowhere"


LIGHT = ExtraParameter(
    "light",
    False,
    "bool",
    "Whether it lights the scene whose background it is. Among a scene's lights it always does.",
    keyword_only=True,
)


@func
def sky_radiance(
    direction: vec3,
    zenith: vec3 = ZENITH,
    horizon: vec3 = HORIZON,
    ground: vec3 = GROUND,
    intensity: float = 1.0,
) -> vec3:
    """Return the light of ``sky`` from a direction, without its sun."""
    air = mix(horizon, zenith, clamp(direction.y, 0.0, 1.0))
    # A blend over a thousandth on either side keeps the horizon from flickering.
    return mix(ground, air, smoothstep(-1e-3, 1e-3, direction.y)) * intensity


@background(
    "Sky",
    requires=_has_a_sun,
    extras=(LIGHT,),
    sample=sky_sun,
    ambient=sky_ambient,
    radiance=sky_radiance,
)
@func
def sky(
    direction: vec3,
    sun: vec3 = DIAGONAL,
    sun_color: vec3 = SUN_COLOR,
    sun_intensity: float = 1.0,
    sun_angle: float = 0.05,
    zenith: vec3 = ZENITH,
    horizon: vec3 = HORIZON,
    ground: vec3 = GROUND,
    intensity: float = 1.0,
) -> vec3:
    """A clear sky with a sun, and ground below the horizon.

    Args:
        direction: Unit direction.
        sun: Direction to the sun; of any length.
        sun_color: The sun's color.
        sun_intensity: The value that a white matte surface shows if it faces the sun.
        sun_angle: Angular size of the sun, in radians.
        zenith: Color overhead.
        horizon: Color along the horizon.
        ground: Color below.
        intensity: Brightness of everything but the sun.
    """
    base = sky_radiance(direction, zenith, horizon, ground, intensity)
    along = dot(direction, normalize(sun))
    rim = cos(0.5 * sun_angle)
    disc = smoothstep(rim - 0.2 * (1.0 - rim), rim + 0.2 * (1.0 - rim), along)
    glow = max(along, 0.0) ** 64 * 0.25 + max(along, 0.0) ** 512 * 0.5
    # The disc is shown much dimmer than it is; otherwise every tone map would clip it to white.
    return base + sun_color * (sun_intensity * (4.0 * disc + glow))
