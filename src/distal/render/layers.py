"""Layers of a picture for compositing: depth, normal, albedo and material as plain values.

Input: the ray through the middle of a pixel, and the functions and numbers of a scene. Output:
values, not colors: up to three numbers, and in w whether there is a surface. A pixel has one
sample, because a mean of depths or of material numbers has no meaning.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import Field3, func, vec2, vec3, vec4
from distal.render.camera import Ray
from distal.render.footprint import THIN, Cone
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.normals import EXACT
from distal.render.trace import facing_normal, hit_point, refined

NOTHING = vec4(0.0)


@func
def through_middle(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray, Cone], vec4],
) -> vec4:
    """Return the value of the ray through the middle of a pixel, unfiltered.

    Args:
        coord: Middle of the pixel, in pixels.
        resolution: Size of the picture, in pixels.
        camera: Ray of a place in the picture.
        radiance: Value of a ray.
    """
    return radiance(camera((2.0 * coord - resolution) / resolution.y), THIN)


@func
def layer_depth(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    field: Field3,
    numbers: March,
) -> vec4:
    """Return the distance along the ray to the first surface, in scene units."""
    hit = first_hit(ray)
    if not hit.found:
        return NOTHING
    return vec4(refined(field, ray, hit, numbers, hit.t), 0.0, 0.0, 1.0)


@func
def layer_normal(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    field: Field3,
    numbers: March,
    normals: int = EXACT,
    normal_step: float = 1e-3,
) -> vec4:
    """Return the unit normal that the shading uses, in world space, facing the ray's origin."""
    hit = first_hit(ray)
    if not hit.found:
        return NOTHING
    return vec4(facing_normal(field, ray, hit, numbers, normals, normal_step), 1.0)


@func
def layer_albedo(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    surface: Callable[[vec3], Surface],
) -> vec4:
    """Return the material's color, linear and without light."""
    hit = first_hit(ray)
    if not hit.found:
        return NOTHING
    return vec4(surface(hit_point(ray, hit)).color, 1.0)


@func
def layer_material(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    identity: Callable[[vec3], float],
) -> vec4:
    """Return the number of the material with the largest weight."""
    hit = first_hit(ray)
    if not hit.found:
        return NOTHING
    return vec4(identity(hit_point(ray, hit)), 0.0, 0.0, 1.0)


LAYERS = {
    "depth": layer_depth,
    "normal": layer_normal,
    "albedo": layer_albedo,
    "material": layer_material,
}
