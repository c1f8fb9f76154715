"""Glow: the halo that a lens and an eye add around what is brighter than the display shows.

Input: linear light, as a buffer of one color for each pixel from the top row on. Output: the halo,
as linear light. The steps are pictures of their own: the excess of light, averaged over blocks of
pixels; its blur across and along; and its enlargement to the picture. Does not depend on scenes.

Source: the shape of the halo, a sum of a narrow and a wide Gaussian, follows Spencer, Shirley,
    Zimmerman and Greenberg, "Physically-Based Glare Effects for Digital Images" (1995).
"""

from __future__ import annotations

from typing import Final

from distal.lang import Buffer, clamp, exp, floor, func, ivec2, max, mix, select, vec2, vec3, vec4

# The side of a block of pixels, and the reach of a blur, as a share of the picture's height.
BLOCK_PX: Final = 4
REACH = 0.12
MOST_BLOCKS = 1024
# Standard deviations of both Gaussians, as shares of the height, and the weight of the narrow one.
NARROW: Final = 0.012
WIDE: Final = 0.045
NARROW_WEIGHT: Final = 0.6
# The data of this buffer is replaced for each step.
LIGHT: Final = Buffer([vec4(0.0)])


@func
def light_at(at: ivec2, size: ivec2) -> vec3:
    """Return the color in a column and row, from the top, of a buffer with this width and height.

    A place beside the picture has the color of the nearest pixel.
    """
    column = clamp(at.x, 0, size.x - 1)
    row = clamp(at.y, 0, size.y - 1)
    return LIGHT[row * size.x + column].xyz


@func
def from_top(coord: vec2, resolution: vec2) -> vec2:
    """Return a place in pixels whose y counts from the top."""
    return vec2(coord.x, resolution.y - coord.y)


@func
def excess(color: vec3) -> vec3:
    """Return the light beyond white, in the hue of the color."""
    most = max(color.r, max(color.g, color.b))
    return color * (max(most - 1.0, 0.0) / max(most, 1e-6))


@func
def brightest_blocks(coord: vec2, resolution: vec2, size: vec2) -> vec4:
    """Return the mean excess of a block of the picture in the buffer.

    Args:
        coord: Middle of the pixel that stands for the block.
        resolution: Number of blocks across and along.
        size: Size of the picture in pixels.
    """
    corner = floor(from_top(coord, resolution)) * float(BLOCK_PX)
    total = vec3(0.0)
    for j in range(BLOCK_PX):
        for i in range(BLOCK_PX):
            at = ivec2(int(corner.x) + i, int(corner.y) + j)
            total += excess(light_at(at, ivec2(int(size.x), int(size.y))))
    return vec4(total / float(BLOCK_PX * BLOCK_PX), 1.0)


@func
def blurred(coord: vec2, resolution: vec2, is_across: bool, deviation: float) -> vec4:
    """Return the buffer, of the picture's size, blurred along a direction by a Gaussian.

    Args:
        coord: Middle of the pixel.
        resolution: Size of the picture in pixels.
        is_across: Whether the direction is that of rows, else that of columns.
        deviation: Standard deviation, as a share of the picture's height.
    """
    size = ivec2(int(resolution.x), int(resolution.y))
    middle = floor(from_top(coord, resolution))
    pixels = max(deviation * resolution.y, 0.3)
    reach = clamp(int(REACH * resolution.y) + 1, 1, MOST_BLOCKS)
    way = select(is_across, ivec2(1, 0), ivec2(0, 1))
    total = vec3(0.0)
    weights = 0.0
    for k in range(-reach, reach + 1):
        share = float(k) / pixels
        weight = exp(-0.5 * share * share)
        total += weight * light_at(ivec2(int(middle.x), int(middle.y)) + k * way, size)
        weights += weight
    return vec4(total / weights, 1.0)


@func
def enlarged(coord: vec2, resolution: vec2, size: vec2) -> vec4:
    """Return the buffer of blocks at a pixel of the picture, interpolated between blocks.

    Args:
        coord: Middle of the pixel.
        resolution: Size of the picture in pixels.
        size: Number of blocks across and along.
    """
    at = from_top(coord, resolution) / float(BLOCK_PX) - 0.5
    low = floor(at)
    share = at - low
    corner = ivec2(int(low.x), int(low.y))
    blocks = ivec2(int(size.x), int(size.y))
    above = mix(light_at(corner, blocks), light_at(corner + ivec2(1, 0), blocks), share.x)
    beside = light_at(corner + ivec2(1, 1), blocks)
    below = mix(light_at(corner + ivec2(0, 1), blocks), beside, share.x)
    return vec4(mix(above, below, share.y), 0.0)
