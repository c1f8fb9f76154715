"""The probe of one pixel: what its ray meets, as numbers.

Input: a pixel, and the functions and numbers of a scene. Output: a ``Seen``. The ray marches as in
the picture itself.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import Field3, func, gradient, length, struct, vec2, vec3
from distal.render.camera import Ray
from distal.render.heightfield_march import Stride
from distal.render.march import March, crossing
from distal.render.material import Surface
from distal.render.normals import exact_normal
from distal.render.trace import first_surface, hit_point, point_before


@struct
class Seen:
    """A ray, where it ended, and what is there.

    ``span`` is where along the ray the scene's box is; ``value`` the field where the ray ended;
    ``part`` and ``paint`` the numbers of the shape and of the material there.
    """

    origin: vec3
    direction: vec3
    span: vec2
    found: bool
    t: float
    steps: int
    side: float
    p: vec3
    value: float
    normal: vec3
    steepness: float
    part: float
    paint: float
    surface: Surface


@func
def look_along(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    field: Field3,
    surface: Callable[[vec3], Surface],
    part: Callable[[vec3], float],
    paint: Callable[[vec3], float],
    bounds: Bounds,
    numbers: March,
    steps: int,
    hybrid: bool,
    stride: Stride,
) -> Seen:
    """What the ray through a place in a picture meets."""
    ray = camera((2.0 * coord - resolution) / resolution.y)
    hit = first_surface(field, ray, bounds, numbers, steps, hybrid, stride)
    p = hit_point(ray, hit)
    return Seen(
        ray.origin,
        ray.direction,
        crossing(ray, bounds),
        hit.found,
        hit.t,
        hit.steps,
        hit.side,
        p,
        field(p),
        exact_normal(field, point_before(ray, hit, numbers)),
        length(gradient(field, p)),
        part(p),
        paint(p),
        surface(p),
    )
