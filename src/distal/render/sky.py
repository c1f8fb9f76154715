"""Backgrounds: what a ray sees that meets nothing.

Input: a unit direction and the numbers of a background. Output: linear light. The
sky's parts as lights are here too: its sun, as a ``LightSample``; its diffuse light is
``ambient.sky_ambient``.
"""

from __future__ import annotations

from distal.lang import clamp, cos, dot, func, max, mix, normalize, smoothstep, vec3
from distal.render.ambient import GROUND, HORIZON, ZENITH
from distal.render.lights import LightSample, distant_light

SUN_COLOR = vec3(1.0, 0.9, 0.75)
BLACK = vec3(0.0)
PALE = vec3(0.9, 0.9, 0.9)
BLUE = vec3(0.35, 0.5, 0.75)
DIAGONAL = vec3(1.0, 1.0, 1.0)


@func
def plain_background(direction: vec3, color: vec3 = BLACK) -> vec3:
    """One colour everywhere."""
    return color


@func
def gradient_background(
    direction: vec3,
    bottom: vec3 = PALE,
    top: vec3 = BLUE,
) -> vec3:
    """One colour straight down, another straight up, evenly between by height."""
    return mix(bottom, top, 0.5 + 0.5 * direction.y)


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
    """A gradient by height, the ground below, and the sun's disc with a glow around it.

    Args:
        direction: Unit direction.
        sun: To the sun, of any length but 0.
        sun_color: Linear colour of the sun.
        sun_intensity: What the sun gives a white surface, square on.
        sun_angle: How wide the sun looks.
        zenith: Colour overhead.
        horizon: Colour along the horizon.
        ground: Colour below.
        intensity: Brightness of all but the sun.
    """
    air = mix(horizon, zenith, clamp(direction.y, 0.0, 1.0))
    # A thousandth on either side keeps the horizon from flickering.
    base = mix(ground, air, smoothstep(-1e-3, 1e-3, direction.y)) * intensity
    along = dot(direction, normalize(sun))
    rim = cos(0.5 * sun_angle)
    disc = smoothstep(rim - 0.2 * (1.0 - rim), rim + 0.2 * (1.0 - rim), along)
    glow = max(along, 0.0) ** 64 * 0.25 + max(along, 0.0) ** 512 * 0.5
    # The disc is shown far dimmer than it is, or every tone map would burn it out.
    return base + sun_color * (sun_intensity * (4.0 * disc + glow))


@func
def sky_sun(
    p: vec3,
    sun: vec3 = DIAGONAL,
    sun_color: vec3 = SUN_COLOR,
    sun_intensity: float = 1.0,
    sun_angle: float = 0.05,
) -> LightSample:
    """The sky's sun as a light."""
    return distant_light(p, sun, sun_intensity, sun_color, sun_angle)
