"""Samples in a pixel: their offsets, their filtered mean, and which pixels need more of them.

Input: a pixel, a camera, and the light along a ray; or a picture of display values. Output: linear
light and straight alpha; or the contrast of each pixel with its neighbors.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.lang import (
    Buffer,
    Frame,
    abs,
    clamp,
    dot,
    func,
    image,
    inversesqrt,
    max,
    min,
    round,
    select,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.lang.srgb import decode_srgb, encode_srgb
from distal.render.camera import Ray
from distal.render.filters import tent
from distal.render.footprint import Cone
from distal.render.lost_rays import marked, merged, unmarked

GOLDEN = 0.6180339887
# Adaptive sampling: a pixel whose contrast is larger gets so many samples besides the first one.
CONTRAST: Final = 0.04
MORE_SAMPLES: Final = 8
# The CPU computes blocks of 8x8 pixels together, with AVX2 of 8x4. In strips of 8 columns, these
# are neighbors in the list. In strips of 4, half of a block is empty: still_life takes 1.25 times
# as long.
STRIP_PX: Final = 8
# The uniforms of programs with several samples; ``PASS_NUMBERS`` differ between two passes.
SAMPLES: Final = "Samples"
AGAIN: Final = "Again"
PICTURE_SIZE: Final = "Picture_size"
FIRST_SAMPLE: Final = "First_sample"
PASS_NUMBERS: Final = frozenset((SAMPLES, FIRST_SAMPLE, AGAIN, PICTURE_SIZE))
# Rec. 709 luma.
LUMA = vec3(0.2126, 0.7152, 0.0722)
# The data of these buffers is replaced for each picture.
PLACES: Final = Buffer([0])
FIRSTS: Final = Buffer([vec4(0.0)])
SHOWN: Final = Buffer([vec4(0.0)])


@func
def are_coprime(a: int, b: int) -> bool:
    """Return whether 1 is the only common divisor of two positive numbers below 2**16.

    Euclid's algorithm; by Lamé's theorem it ends within 24 steps.
    """
    larger = a
    smaller = b
    for _ in range(24):
        if smaller == 0:
            break
        rest = larger % smaller
        larger = smaller
        smaller = rest
    return larger == 1


@func
def lattice_step(count: int) -> int:
    """Return the number that is coprime to ``count`` and nearest to the golden ratio of it.

    Its multiples modulo ``count`` are a permutation of 0 to ``count - 1`` without visible order.
    """
    golden = GOLDEN * float(count)
    nearest = int(round(golden))
    towards = 1 if golden > float(nearest) else -1
    step = 1
    for distance in range(count):
        near = max(nearest + towards * distance, 1)
        far = max(nearest - towards * distance, 1)
        if are_coprime(count, near):
            step = near
            break
        if are_coprime(count, far):
            step = far
            break
    return step


@func
def sample_offset(column: int, row: int, count: int) -> vec2:
    """Return the offset of a sample from the middle of a pixel, in pixels.

    Both coordinates are stratified: each column and each row of strata has one sample (a rank-1
    lattice). Offsets have the distribution of a tent filter that is two pixels wide, and their mean
    is 0. A single sample is in the middle.

    Args:
        column: The stratum across: the index of the sample.
        row: The stratum along: ``column`` times ``lattice_step``, modulo the number of samples.
        count: Number of samples.
    """
    if count <= 1:
        return vec2(0.0, 0.0)
    across = float(2 * column + 1 - count) / float(count)
    along = float(2 * row + 1 - count) / float(count)
    return vec2(tent(across), tent(along))


@struct
class Gathered:
    """The sum of a pixel's samples.

    Attributes:
        light: Linear light, weighted by alpha; the sum of the weights in w.
        lost: Why rays were lost; see ``lost_rays``.
    """

    light: vec4
    lost: int


@func
def gathered(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray, Cone], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    step: int,
    transparent: bool,
    counted: bool = False,
) -> Gathered:
    """Return the sum of a pixel's samples.

    Alpha is 1 unless ``transparent``, except for rays that start inside a solid and do not leave
    it.

    Args:
        coord: Middle of the pixel, in pixels.
        resolution: Size of the picture, in pixels.
        camera: Ray of a place in the picture.
        radiance: Linear light and alpha of a ray.
        cone: The cone of a place in the picture, of a pixel of this size.
        samples: Number of samples.
        step: ``lattice_step`` of this number.
        transparent: Whether alpha is 0 where a ray hits nothing.
        counted: Whether alpha is marked with why rays were lost; a constant.
    """
    pixel = 2.0 / resolution.y
    # Each sample stands for a part of the pixel.
    spread = cone(pixel * (coord - 0.5 * resolution), pixel * inversesqrt(float(max(samples, 1))))
    total = vec4(0.0)
    lost = 0
    row = 0
    for i in range(max(samples, 1)):
        place = coord + sample_offset(i, row, samples)
        row = select(row + step >= samples, row + step - samples, row + step)
        part = Cone(spread.width, spread.spread, i, samples)
        seen = radiance(camera((2.0 * place - resolution) / resolution.y), part)
        alpha = seen.w
        if counted:
            found = unmarked(seen.w)
            alpha = found.alpha
            lost = merged(lost, found.lost)
        weight = max(alpha, 0.0) if transparent else select(alpha < 0.0, 0.0, 1.0)
        total += vec4(seen.xyz * weight, weight)
    return Gathered(total, lost)


@func
def mean_light(total: vec4, samples: int) -> vec4:
    """Return linear light and straight alpha of a sum of samples.

    The color is the mean over the samples that have one.
    """
    return vec4(total.xyz / max(total.w, 1e-6), min(total.w / float(max(samples, 1)), 1.0))


@func
def exposed(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray, Cone], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    step: int,
    transparent: bool,
    counted: bool = False,
) -> vec4:
    """Return linear light and straight alpha of a pixel: the mean of its samples.

    Arguments as for ``gathered``; if rays are counted, alpha is marked.
    """
    sums = gathered(coord, resolution, camera, radiance, cone, samples, step, transparent, counted)
    mean = mean_light(sums.light, samples)
    return vec4(mean.xyz, marked(mean.w, sums.lost, counted))


@func
def listed_index(coord: vec2, grid: vec2) -> int:
    """Return which pixel of a list a pixel of the grid is.

    A list of pixels is arranged in a smaller picture, the grid: from the top to the bottom of a
    strip of ``STRIP_PX`` columns, then of the next one.

    Args:
        coord: Middle of the pixel of the grid.
        grid: Size of the grid.
    """
    column = int(coord.x)
    strip = column // STRIP_PX
    return (strip * int(grid.y) + int(grid.y - coord.y)) * STRIP_PX + column - strip * STRIP_PX


@func
def listed_place(coord: vec2, grid: vec2, resolution: vec2, places: Buffer[int]) -> vec2:
    """Return the middle of the pixel of the picture that a pixel of the grid stands for.

    Args:
        coord: Middle of the pixel of the grid.
        grid: Size of the grid.
        resolution: Size of the picture.
        places: Index of each pixel of the list in the picture, from the top row on.
    """
    place = places[listed_index(coord, grid)]
    width = int(resolution.x)
    return vec2(float(place % width) + 0.5, resolution.y - 0.5 - float(place // width))


@func
def exposed_again(
    coord: vec2,
    grid: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray, Cone], vec4],
    cone: Callable[[vec2, float], Cone],
    samples: int,
    step: int,
    transparent: bool,
    again: bool,
    places: Buffer[int],
    firsts: Buffer[vec4],
    counted: bool = False,
) -> vec4:
    """Return a pixel of one of the two passes of adaptive sampling.

    The first pass renders the picture. The second one renders a list of pixels that need more
    samples, arranged in a grid (``listed_place``). Pixel i of the list has the samples of pixel
    ``places[i]`` of the picture and, besides, ``firsts[i]``, the result of the first pass.
    Other arguments as for ``gathered``.

    Args:
        coord: Middle of the pixel of the grid.
        grid: Size of the grid; in the first pass that of the picture.
        resolution: Size of the picture.
        camera: Ray of a place in the picture.
        radiance: Linear light and alpha of a ray.
        cone: The cone of a place in the picture, of a pixel of this size.
        samples: Number of samples, besides that of the first pass.
        step: ``lattice_step`` of this number.
        transparent: Whether alpha is 0 where a ray hits nothing.
        again: Whether this is the second pass.
        places: Index of each pixel in the picture, from the top row on.
        firsts: Linear light and alpha of the first pass, without marks.
        counted: As for ``exposed``.
    """
    index = listed_index(coord, grid)
    at = select(again, listed_place(coord, grid, resolution, places), coord)
    sums = gathered(at, resolution, camera, radiance, cone, samples, step, transparent, counted)
    first = firsts[index]
    known = select(again, vec4(first.xyz * first.w, first.w), vec4(0.0))
    mean = mean_light(sums.light + known, max(samples, 1) + select(again, 1, 0))
    return vec4(mean.xyz, marked(mean.w, sums.lost, counted))


@func
def brightness(shown: vec4) -> vec2:
    """Return the luma of a display value, in linear light before black, and its alpha."""
    light = dot(decode_srgb(clamp(shown.rgb, 0.0, 1.0)), LUMA)
    return vec2(light * shown.a, shown.a)


@image
def contrast(frame: Frame) -> vec4:
    """Show the largest difference of a pixel of ``SHOWN`` from its eight neighbors.

    The difference is that of luma, in linear light, or that of alpha. ``SHOWN`` has one display
    value for each pixel, from the top row on.
    """
    width = int(frame.resolution.x)
    height = int(frame.resolution.y)
    x = int(frame.coord.x)
    y = height - 1 - int(frame.coord.y)
    here = brightness(SHOWN[y * width + x])
    most = 0.0
    for j in range(-1, 2):
        for i in range(-1, 2):
            row = clamp(y + j, 0, height - 1)
            column = clamp(x + i, 0, width - 1)
            apart = abs(brightness(SHOWN[row * width + column]) - here)
            most = max(most, max(apart.x, apart.y))
    return vec4(vec3(most), 1.0)


@func
def exposed_image(
    coord: vec2,
    color: Callable[[vec2], vec4],
    samples: int,
    step: int,
) -> vec4:
    """Return the mean of several samples of a picture of display values.

    The mean is that of linear light, weighted by alpha; the result is a display value.

    Args:
        coord: Middle of the pixel, in pixels.
        color: Display value and straight alpha of a place in the picture.
        samples: Number of samples.
        step: ``lattice_step`` of this number.
    """
    total = vec4(0.0)
    row = 0
    for i in range(max(samples, 1)):
        seen = color(coord + sample_offset(i, row, samples))
        row = select(row + step >= samples, row + step - samples, row + step)
        total += vec4(decode_srgb(seen.rgb) * seen.a, seen.a)
    mean = mean_light(total, samples)
    return vec4(encode_srgb(mean.xyz), mean.w)
