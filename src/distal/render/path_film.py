"""The pixels of a picture that is made of random paths.

Input: a pixel, a camera, the light along a ray, and which samples to take. Output: the mean of
these samples, as linear light times alpha, and alpha. The mean of several such pictures, weighted
by their numbers of samples, is the picture.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.guarantees import UNBOUNDED
from distal.lang import (
    Buffer,
    abs,
    func,
    inversesqrt,
    ivec2,
    max,
    min,
    pcg,
    select,
    uint,
    vec2,
    vec4,
)
from distal.render.camera import Ray
from distal.render.film import listed_place
from distal.render.filters import TENT, place_by_filter
from distal.render.footprint import Cone
from distal.render.lost_rays import marked, merged, unmarked
from distal.render.material import brightest
from distal.render.sampling.points import Stream, pair, reversed_bits, scattered_stream, single_of

# The numbers of the camera's decisions; ``paths.CAMERA_DECISIONS`` of them.
PLACE_IN_PIXEL: Final = 0
PLACE_ON_LENS: Final = 1
# The uniform with the largest light of a sample.
LARGEST: Final = "Largest_light"
# Selects the scrambling of the shutter's times; any constant.
TIMES = 0x5EED71ED


@func
def exposed_paths(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2, Stream], Ray],
    radiance: Callable[[Ray, Cone, Stream], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    first_sample: int,
    seed: uint,
    index: int,
    transparent: bool,
    filter: int = TENT,
    largest: float = UNBOUNDED,
    counted: bool = False,
) -> vec4:
    """Return linear light times alpha, and alpha, of a pixel: the mean of some of its samples.

    Args:
        coord: Middle of the pixel, in pixels.
        resolution: Size of the picture, in pixels.
        camera: Ray of a place in the picture, through the place on the lens that these random
            numbers choose.
        radiance: Linear light and alpha of a ray, by the path of these random numbers.
        cone: The cone of a place in the picture, of a pixel of this size.
        samples: Number of samples.
        first_sample: The number of the first one.
        seed: Selects one of many sets of random numbers.
        index: The number of the frame, whose random numbers are others.
        transparent: Whether alpha is 0 where a ray hits nothing.
        filter: The reconstruction filter, of ``filters``; a constant.
        largest: Brighter samples are scaled to this light, in their brightest component.
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
        placed = place_by_filter(pair(stream, PLACE_IN_PIXEL), filter)
        place = (2.0 * (coord + placed.offset) - resolution) / resolution.y
        seen = radiance(camera(place, stream), spread, stream)
        alpha = seen.w
        if counted:
            found = unmarked(seen.w)
            alpha = found.alpha
            lost = merged(lost, found.lost)
        weight = max(alpha, 0.0) if transparent else select(alpha < 0.0, 0.0, 1.0)
        light = seen.xyz * min(largest / max(brightest(abs(seen.xyz)), 1e-30), 1.0)
        total += vec4(light, 1.0) * (weight * placed.weight)
    mean = total / float(count)
    return vec4(mean.xyz, marked(mean.w, lost, counted))


@func
def exposed_paths_again(
    coord: vec2,
    grid: vec2,
    resolution: vec2,
    camera: Callable[[vec2, Stream], Ray],
    radiance: Callable[[Ray, Cone, Stream], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    first_sample: int,
    seed: uint,
    index: int,
    transparent: bool,
    again: bool,
    places: Buffer[int],
    filter: int = TENT,
    largest: float = UNBOUNDED,
    counted: bool = False,
) -> vec4:
    """Return a pixel of the picture, or of a list of its pixels (``film.listed_place``).

    Args:
        coord: Middle of the pixel of the grid.
        grid: Size of the grid; without a list that of the picture.
        resolution: Size of the picture.
        camera: Ray of a place in the picture, through a random place on the lens.
        radiance: Linear light and alpha of a ray, by the path of these random numbers.
        cone: The cone of a place in the picture, of a pixel of this size.
        samples: Number of samples.
        first_sample: The number of the first one.
        seed: Selects one of many sets of random numbers.
        index: The number of the frame.
        transparent: Whether alpha is 0 where a ray hits nothing.
        again: Whether pixels are those of a list.
        places: Index of each pixel of the list in the picture, from the top row on.
        filter: The reconstruction filter; a constant.
        largest: The largest light of a sample.
        counted: Whether alpha is marked with why rays were lost; a constant.
    """
    at = select(again, listed_place(coord, grid, resolution, places), coord)
    return exposed_paths(
        at, resolution, camera, radiance, cone, samples, first_sample, seed, index, transparent,
        filter, largest, counted,
    )  # fmt: skip


@func
def shutter_share(sample: int, seed: uint, index: int) -> float:
    """Return how far the shutter's time has passed at a sample, from 0 to 1.

    The first 2^k samples have one time in each of 2^k equal intervals.

    Args:
        sample: The number of the sample.
        seed: Selects one of many sets of random numbers.
        index: The number of the frame.
    """
    of_frame = pcg(pcg(seed) + uint(index))
    return single_of(reversed_bits(uint(sample)), of_frame ^ uint(TIMES))
