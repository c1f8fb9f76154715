"""The pixels of a picture that is made of random paths.

Input: a pixel, a camera, the light along a ray, and which samples to take. Output: the mean of
these samples, as linear light and straight alpha. The mean of several such pictures, weighted by
their numbers of samples, is the picture.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import func, inversesqrt, ivec2, max, pcg, select, uint, vec2, vec4
from distal.render.camera import Ray
from distal.render.film import mean_light, tent
from distal.render.footprint import Cone
from distal.render.lost_rays import marked, merged, unmarked
from distal.render.sampling.points import Stream, pair, scattered_stream

PLACE_IN_PIXEL = 0


@func
def exposed_paths(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray, Cone, Stream], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    first_sample: int,
    seed: uint,
    index: int,
    transparent: bool,
    counted: bool = False,
) -> vec4:
    """Return linear light and straight alpha of a pixel: the mean of some of its samples.

    Places in the pixel have the distribution of a tent filter that is two pixels wide.

    Args:
        coord: Middle of the pixel, in pixels.
        resolution: Size of the picture, in pixels.
        camera: Ray of a place in the picture.
        radiance: Linear light and alpha of a ray, by the path of these random numbers.
        cone: The cone of a place in the picture, of a pixel of this size.
        samples: Number of samples.
        first_sample: The number of the first one.
        seed: Selects one of many sets of random numbers.
        index: The number of the frame, whose random numbers are others.
        transparent: Whether alpha is 0 where a ray hits nothing.
        counted: Whether alpha is marked with why rays were lost; a constant.
    """
    pixel = 2.0 / resolution.y
    count = max(samples, 1)
    spread = cone(pixel * (coord - 0.5 * resolution), pixel * inversesqrt(float(count)))
    at = ivec2(coord)
    of_frame = pcg(seed) + uint(index)
    total = vec4(0.0)
    lost = 0
    for i in range(count):
        stream = scattered_stream(at, first_sample + i, of_frame)
        u = pair(stream, PLACE_IN_PIXEL)
        place = coord + vec2(tent(2.0 * u.x - 1.0), tent(2.0 * u.y - 1.0))
        seen = radiance(camera((2.0 * place - resolution) / resolution.y), spread, stream)
        alpha = seen.w
        if counted:
            found = unmarked(seen.w)
            alpha = found.alpha
            lost = merged(lost, found.lost)
        weight = max(alpha, 0.0) if transparent else select(alpha < 0.0, 0.0, 1.0)
        total += vec4(seen.xyz * weight, weight)
    mean = mean_light(total, count)
    return vec4(mean.xyz, marked(mean.w, lost, counted))
