"""Probe one pixel: return as numbers what its ray hits.

Input: a pixel, and the functions and numbers of a scene. Output: a ``Seen``. The ray is marched as
in the picture; the value and its slope are those of the author's own field.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import Field3, func, gradient, length, struct, vec2, vec3
from distal.render.camera import Ray
from distal.render.march import Hit, March, crossing
from distal.render.material import Surface
from distal.render.normals import exact_normal
from distal.render.trace import hit_point, point_before


@struct
class Seen:
    """A ray, where it ended, and the properties of the surface there.

    ``span`` is the interval along the ray that is inside the scene's box; ``value`` is the field at
    the end of the ray; ``part`` and ``paint`` are the numbers of the shape and the material there.
    """

    origin: vec3
    direction: vec3
    span: vec2
    found: bool
    t: float
    steps: int
    side: float
    lost: int
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
    first_hit: Callable[[Ray], Hit],
    field: Field3,
    surface: Callable[[vec3], Surface],
    part: Callable[[vec3], float],
    paint: Callable[[vec3], float],
    bounds: Bounds,
    numbers: March,
) -> Seen:
    """Return what the ray through a place in a picture hits."""
    ray = camera((2.0 * coord - resolution) / resolution.y)
    hit = first_hit(ray)
    p = hit_point(ray, hit)
    return Seen(
        ray.origin,
        ray.direction,
        crossing(ray, bounds),
        hit.found,
        hit.t,
        hit.steps,
        hit.side,
        hit.lost,
        p,
        field(p),
        exact_normal(field, point_before(ray, hit, numbers)),
        length(gradient(field, p)),
        part(p),
        paint(p),
        surface(p),
    )
