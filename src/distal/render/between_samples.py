"""The surface between two samples along a ray, and its picture.

Input: the value and gradient at the first sample of a ray that is inside. Output: normals, places
and display-ready colors.
"""

from __future__ import annotations

from distal.lang import abs, clamp, dot, func, length, max, select, vec3, vec4
from distal.render.views import EMPTY, normal_color


@func
def surface_between(value: float, slope: vec3, layer: vec3, place: float) -> vec4:
    """Return the normal, and where the surface is between a sample and the one before it.

    The place is found by one step of Newton's method. Where the value does not fall along the ray,
    it is midway. The normal is 0 where the gradient is.

    Args:
        value: The value at the sample, which is negative.
        slope: The gradient there.
        layer: From one layer of samples to the next.
        place: The place of the sample along the ray, in layers; the result's has the same unit.
    """
    largest = max(abs(slope.x), max(abs(slope.y), abs(slope.z)))
    direction = slope / select(largest > 0.0, largest, 1.0)
    size = length(direction)
    normal = direction / select(size > 0.0, size, 1.0)
    along = dot(slope, layer)
    step = value / select(along < 0.0, along, -1.0)
    crossing = clamp(place - step, max(place - 1.0, 0.0), place)
    return vec4(normal, select(along < 0.0, crossing, place - 0.5))


@func
def normal_pixel(normal: vec3, is_surface: float) -> vec4:
    """Show a normal; the background of views, transparent, where there is no surface."""
    return select(is_surface > 0.5, vec4(normal_color(normal), 1.0), vec4(EMPTY, 0.0))
