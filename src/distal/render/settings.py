"""Convert the numbers of a scene to the structs that the renderers take.

Input: the numbers of a scene, the resolution of the picture. Output: structs for marching and
shading.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import ENDLESS, UNBOUNDED, Bounds
from distal.lang import clamp, dot, func, max, min, select, vec2, vec3
from distal.render.camera import Ray
from distal.render.footprint import pixel_cone
from distal.render.heightfield_march import Stride
from distal.render.march import March
from distal.render.shade import Shading
from distal.render.steer import pivot_within, scale_of

# Rays through an infinite scene end at this many times the scale of the view.
FAR_SCALES = 40.0
# The least threshold of a hit: rounding errors of a place, for each unit of the ray's length.
PRECISION = 2e-6
# The margin around a box, as a part of its longest side.
MARGIN = 1e-4


@func
def subject_depth(bounds: Bounds, camera: Callable[[vec2], Ray]) -> float:
    """Return the distance from the camera to the point that it turns around, along its axis."""
    eye = camera(vec2(0.0))
    return dot(pivot_within(bounds, camera) - eye.origin, eye.direction)


@func
def hit_threshold(resolution: vec2, bounds: Bounds, camera: Callable[[vec2], Ray]) -> float:
    """Return how close to a surface a ray has hit it, as a part of the ray's length.

    A third of a pixel of a lens of 40 degrees, also for wider ones. Longer lenses and orthographic
    cameras, which also look from far away: a third of a pixel at the subject. Not below 32-bit
    precision.

    Args:
        resolution: Size of the picture in pixels.
        bounds: Box around the surfaces.
        camera: Ray of a place in the picture.
    """
    pixel = pixel_cone(camera, vec2(0.0), 2.0 / resolution.y)
    third = 0.343 * (pixel.width / max(subject_depth(bounds, camera), 1e-20) + pixel.spread)
    return min(clamp(0.25 / resolution.y, 1e-4, 1e-3), max(third, PRECISION))


@func
def march_numbers(
    divisor: float, near: float, far: float, threshold: float, steepest: float = 1.0
) -> March:
    """Return the parameters of a march.

    Args:
        divisor: Distances are divided by it to get a safe step.
        near: Distance along the ray where rays begin.
        far: Distance along the ray where rays end.
        threshold: A ray has hit a surface that is closer than this part of the ray's length.
        steepest: The largest number by which the field already divides one of its parts.
    """
    return March(max(divisor, 1.0), near, far, threshold, max(steepest, 1.0))


@func
def stride_over(bounds: Bounds, stride: float, stride_growth: float) -> Stride:
    """Return the steps of the hybrid march over terrain, which is below the top of its box.

    Args:
        bounds: Box of the terrain.
        stride: The shortest step at the start, for each unit of distance.
        stride_growth: The factor by which the shortest step grows with each step.
    """
    return Stride(bounds.high.y, stride, stride_growth)


@func
def look(ambient_occlusion: float, fog_density: float) -> Shading:
    """Return the parameters of shading.

    Args:
        ambient_occlusion: Reach of ambient occlusion, in scene units; 0 for none.
        fog_density: Fraction of the light that fog takes, per scene unit.
    """
    return Shading(ambient_occlusion, fog_density)


@func
def grown_bounds(bounds: Bounds) -> Bounds:
    """Return a box with a margin for 32-bit rounding errors."""
    sides = bounds.high - bounds.low
    finite = select(sides < ENDLESS, max(sides, 0.0), 0.0)
    margin = MARGIN * max(finite.x, max(finite.y, finite.z))
    return Bounds(bounds.low - margin, bounds.high + margin)


@func
def no_box() -> Bounds:
    """Return a box that no ray enters."""
    return Bounds(vec3(UNBOUNDED), vec3(-UNBOUNDED))


@func
def automatic_far(bounds: Bounds, camera: Callable[[vec2], Ray]) -> float:
    """Return the distance at which rays end: beyond every surface if the scene's box is finite.

    Args:
        bounds: Box around the surfaces.
        camera: Ray of a place in the picture.
    """
    low = min(bounds.low.x, min(bounds.low.y, bounds.low.z))
    high = max(bounds.high.x, max(bounds.high.y, bounds.high.z))
    finite = max(-low, high) < ENDLESS
    return select(finite, UNBOUNDED, FAR_SCALES * scale_of(bounds, camera(vec2(0.0)).origin))
