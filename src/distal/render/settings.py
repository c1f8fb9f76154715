"""The numbers of a picture in the form that the renderers take.

Input: the numbers of a scene, the picture's resolution. Output: structs for marching and
shading.
"""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import clamp, func, max, vec2, vec3
from distal.render.heightfield_march import Stride
from distal.render.march import March
from distal.render.shade import Look


@func
def march_numbers(divisor: float, near: float, far: float, resolution: vec2) -> March:
    """The threshold is a third of a pixel of a usual lens, and not below 32-bit precision."""
    return March(max(divisor, 1.0), near, far, clamp(0.25 / resolution.y, 1e-4, 1e-3))


@func
def stride_over(bounds: Bounds, stride: float, stride_growth: float) -> Stride:
    """The steps over terrain, which is below the top of its box."""
    return Stride(bounds.high.y, stride, stride_growth)


@func
def look(ambient_occlusion: float, fog: vec3, fog_density: float) -> Look:
    """The numbers of shading."""
    return Look(ambient_occlusion, fog, fog_density)


@func
def grown_bounds(bounds: Bounds) -> Bounds:
    """A box with a margin for the rounding of 32 bits."""
    room = 1e-3 + 1e-4 * max(bounds.high - bounds.low, 0.0)
    return Bounds(bounds.low - room, bounds.high + room)
