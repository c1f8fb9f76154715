"""The part map: which part of a scene each pixel shows, as a number.

Input: a pixel, and the functions of a scene. Output: bytes of a number, for programs that read the
picture back; nobody looks at it.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import floor, func, mod, vec2, vec3, vec4
from distal.render.camera import Ray
from distal.render.march import Hit
from distal.render.trace import hit_point

NOTHING = vec4(0.0)
BASE = 256.0
LARGEST = 255.0


@func
def part_bytes(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    first_hit: Callable[[Ray], Hit],
    part: Callable[[vec3], float],
) -> vec4:
    """Return the number of the part that a ray hits, its lowest byte in red; alpha 0 if it misses.

    Args:
        coord: Middle of the pixel, in pixels.
        resolution: Size of the picture, in pixels.
        camera: Ray of a place in the picture.
        first_hit: First surface along a ray.
        part: Number of the part at a point.
    """
    ray = camera((2.0 * coord - resolution) / resolution.y)
    hit = first_hit(ray)
    if not hit.found:
        return NOTHING
    whole = part(hit_point(ray, hit)) + 0.5
    digits = vec3(whole, whole / BASE, whole / (BASE * BASE))
    return vec4(floor(mod(digits, BASE)) / LARGEST, 1.0)
