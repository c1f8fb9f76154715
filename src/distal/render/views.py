"""Views: normal, depth, steps, slope and others as pictures.

Input: a ray, and the functions and numbers of a scene. Output: display-ready colors and alpha.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    Field3,
    abs,
    clamp,
    cos,
    dot,
    exp,
    func,
    gradient,
    length,
    max,
    mix,
    smoothstep,
    vec3,
    vec4,
)
from distal.lang.srgb import encode_srgb
from distal.render.camera import Ray
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.normals import EXACT
from distal.render.trace import facing_normal, hit_point, point_before

EMPTY = vec3(0.08, 0.08, 0.1)


@func
def heat(x: float) -> vec3:
    """Map 0 to 1 to dark blue, green, yellow, red; equal differences look about equal."""
    t = clamp(x, 0.0, 1.0)
    red = smoothstep(0.35, 0.75, t)
    green = smoothstep(0.05, 0.45, t) - 0.85 * smoothstep(0.65, 1.0, t)
    blue = 0.25 + 0.6 * smoothstep(0.0, 0.2, t) - 0.85 * smoothstep(0.3, 0.6, t)
    return vec3(red, green, blue)


@func
def isolines(d: float, spacing: float) -> vec3:
    """Color a distance: warm outside, cool inside, with a line at every multiple of ``spacing``."""
    tint = vec3(0.95, 0.6, 0.3) if d > 0.0 else vec3(0.4, 0.65, 0.95)
    color = tint * (1.0 - exp(-3.0 * abs(d)))
    color *= 0.85 + 0.15 * cos(6.283185307 * d / spacing)
    return mix(vec3(1.0), color, smoothstep(0.0, 0.01 + 0.02 * spacing, abs(d)))


@func
def view_normal(ray: Ray, first_hit: Callable[[Ray], Hit], field: Field3, numbers: March) -> vec4:
    """Show the normal's x, y, z as red, green, blue."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    return vec4(0.5 + 0.5 * facing_normal(field, ray, hit, numbers, EXACT, 0.0), 1.0)


@func
def view_depth(ray: Ray, first_hit: Callable[[Ray], Hit]) -> vec4:
    """Show the distance: near is bright; the brightness halves at 20/3 units."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(vec3(0.0), 0.0)
    return vec4(vec3(1.0 / (1.0 + 0.15 * hit.t)), 1.0)


@func
def view_steps(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    steps: int,
) -> vec4:
    """Show the cost of a ray: the number of field evaluations as a fraction of the limit."""
    hit = first_hit(ray)
    return vec4(heat(float(hit.steps) / float(steps)), 1.0)


@func
def view_coordinate(ray: Ray) -> vec4:
    """Show the direction of the ray as a color."""
    return vec4(0.5 + 0.5 * ray.direction, 1.0)


@func
def view_signal(ray: Ray, first_hit: Callable[[Ray], Hit]) -> vec4:
    """Show the distance along the ray as a gray value."""
    hit = first_hit(ray)
    return vec4(vec3(exp(-0.2 * hit.t) if hit.found else 0.0), 1.0)


@func
def view_slope(
    ray: Ray, first_hit: Callable[[Ray], Hit], field: Field3, numbers: March, slope: float
) -> vec4:
    """Show |gradient| on the surface, relative to the Lipschitz bound (slope); magenta above it."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    steep = length(gradient(field, point_before(ray, hit, numbers)))
    if steep > 1.001 * slope:
        return vec4(1.0, 0.0, 1.0, 1.0)
    return vec4(heat(steep / slope), 1.0)


@func
def view_material(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    surface: Callable[[vec3], Surface],
) -> vec4:
    """Show the material's color plus its emission, without light."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    found = surface(hit_point(ray, hit))
    return vec4(encode_srgb(found.color + found.emission), 1.0)


@func
def view_distance(ray: Ray, field: Field3) -> vec4:
    """Show the field on the plane through the origin that faces the camera."""
    t = -dot(ray.origin, ray.direction) / max(dot(ray.direction, ray.direction), 1e-6)
    return vec4(isolines(field(ray.origin + t * ray.direction), 0.1), 1.0)


@func
def view_slice(
    ray: Ray, field: Field3, slice_normal: vec3, slice_offset: float, far: float
) -> vec4:
    """Show the field's lines of equal distance on a plane.

    Args:
        ray: Ray.
        field: Signed distance.
        slice_normal: Unit normal of the plane.
        slice_offset: Distance of the plane from the origin.
        far: Distance along the ray where rays end.
    """
    facing = dot(ray.direction, slice_normal)
    t = (slice_offset - dot(ray.origin, slice_normal)) / facing if abs(facing) > 1e-6 else -1.0
    if t < 0.0 or t > far:
        return vec4(EMPTY, 0.0)
    return vec4(isolines(field(ray.origin + t * ray.direction), 0.1), 1.0)


VIEWS = {
    "coordinate": view_coordinate,
    "signal": view_signal,
    "distance": view_distance,
    "normal": view_normal,
    "depth": view_depth,
    "steps": view_steps,
    "material": view_material,
    "slope": view_slope,
    "slice": view_slice,
}
