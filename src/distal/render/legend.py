"""The legend of the view of steps: a color bar with numbers at its ends.

Input: a pixel's color and place. Output: the same color, or the legend's. Digits are drawn by
arithmetic, so that every target can draw them.
"""

from __future__ import annotations

from distal.lang import clamp, floor, func, max, min, vec2, vec3, vec4
from distal.render.views import heat

# Ten digits of three columns by five rows; one bit per square, starting at the upper left.
DIGITS = [31599, 29850, 29671, 31143, 18925, 31183, 31695, 18727, 31727, 31215]
WIDTH = 4.0  # squares from one digit to the next
INK = vec3(1.0)
PAPER = vec3(0.02)


@func
def digit_covers(digit: int, square: vec2) -> bool:
    """Return whether the glyph of a digit covers a square; (0, 0) is at the lower left."""
    if square.x < 0.0 or square.y < 0.0 or square.x > 2.0 or square.y > 4.0:
        return False
    bit = square.x + 3.0 * (4.0 - square.y)
    row: float = floor(float(DIGITS[digit]) / 2.0**bit)
    return row % 2.0 > 0.5


@func
def number_covers(number: int, place: vec2) -> bool:
    """Return whether a number of up to four digits covers a place; its lower right is (0, 0).

    Args:
        number: 0 to 9999.
        place: In squares.
    """
    square = floor(vec2(place.x, place.y))
    column = floor(-square.x / WIDTH)
    left = max(number, 0)
    if column < 0.0 or column > 3.0:
        return False
    digits = 1
    rest = left
    for _ in range(3):
        rest = rest // 10
        if rest > 0:
            digits += 1
    if int(column) >= digits:
        return False
    for _ in range(int(column)):
        left = left // 10
    return digit_covers(left % 10, vec2(square.x + column * WIDTH + 3.0, square.y))


@func
def with_legend(color: vec4, coord: vec2, resolution: vec2, most: int) -> vec4:
    """Draw the legend over a pixel: a bar of ``views.heat`` from 0 to ``most`` at the lower edge.

    Args:
        color: Display-ready color.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        most: The number at the right end of the bar.
    """
    unit = max(floor(min(resolution.x, resolution.y) / 120.0), 1.0)
    low = vec2(4.0 * unit, 4.0 * unit)
    wide = resolution.x - 2.0 * low.x
    along = (coord.x - low.x) / max(wide, 1.0)
    above = coord.y - low.y
    if along < 0.0 or along > 1.0 or above < 0.0 or above > 12.0 * unit:
        return color
    if above < 4.0 * unit:
        return vec4(heat(clamp(along, 0.0, 1.0)), 1.0)
    text = vec2(coord.x - low.x, above - 6.0 * unit) / unit
    at_end = vec2(text.x - wide / unit, text.y)
    if number_covers(0, vec2(text.x - 4.0, text.y)) or number_covers(most, at_end):
        return vec4(INK, 1.0)
    return vec4(0.5 * color.rgb + 0.5 * PAPER, 1.0)
