"""Show the local variables of an author's picture as colors: numbers, coordinates, vectors.

Input: the value of a local at a pixel, and whether the pixel reached it; the range of its values,
if a host has measured one. Output: a color with a legend; without a range, a color that shows
magnitude and sign for any value.
"""

from __future__ import annotations

from distal.lang import (
    abs,
    clamp,
    dot,
    exp,
    func,
    ivec4,
    max,
    min,
    mix,
    round,
    select,
    sign,
    smoothstep,
    vec2,
    vec3,
    vec4,
)
from distal.render.legend import with_axes, with_scale
from distal.render.lettering import decimals_for
from distal.render.ranges import Range, exponent, is_packed, packed, share_of, value_at
from distal.render.views import depth_color

UNREACHED = vec4(0.08, 0.08, 0.1, 1.0)


@func
def shown_number(value: float, reached: bool) -> vec4:
    """Show 0 to 1 as black to white, bluer below 0, warmer above 1, with a line at each integer."""
    below = vec3(0.15, 0.4, 1.0) * (1.0 - exp(at_most_zero(value)))
    within = vec3(clamp(value, 0.0, 1.0))
    warm = mix(vec3(0.75, 0.2, 0.05), vec3(1.0, 0.95, 0.85), exp(-0.5 * max(value - 1.0, 0.0)))
    to_line = abs((value + 0.5) % 1.0 - 0.5)
    above = warm * (0.7 + 0.3 * smoothstep(0.0, 0.06, to_line))
    color = select(value < 0.0, below, select(value > 1.0, above, within))
    return select(reached, vec4(color, 1.0), UNREACHED)


@func
def at_most_zero(value: float) -> float:
    """Return the value if it is below 0, else 0."""
    return -max(-value, 0.0)


@func
def shown_coordinate(value: vec2, reached: bool) -> vec4:
    """Show x as red and y as green: dark to bright from -1 to 1, repeated in a triangle wave."""
    there_and_back = 1.0 - abs((0.5 * value + 0.5) % 2.0 - 1.0)
    return select(reached, vec4(there_and_back, 0.5, 1.0), UNREACHED)


@func
def shown_vector(value: vec3, reached: bool) -> vec4:
    """Show magnitudes of x, y, z as red, green, blue; negative ones at 0.4 of the brightness."""
    color = clamp(max(value, -0.4 * value), 0.0, 1.0)
    return select(reached, vec4(color, 1.0), UNREACHED)


@func
def pixel_place(coord: vec2, resolution: vec2) -> vec2:
    """Return the coordinate of a pixel: y is -1 to 1 from bottom to top, x has the same unit."""
    return (2.0 * coord - resolution) / resolution.y


@func
def brightness(color: vec3) -> float:
    """Return the relative luminance of a color as it is displayed (weights of BT.709)."""
    return dot(color, vec3(0.2126, 0.7152, 0.0722))


@func
def local_number(
    value: float,
    whole: bool,
    reached: bool,
    shown: Range,
    coord: vec2,
    resolution: vec2,
    title: ivec4,
) -> vec4:
    """Show a number: dark blue is low, bright is high.

    Args:
        value: The number.
        whole: Whether it is always a whole number.
        reached: Whether the pixel has one.
        shown: The range of the values; empty if it is not known.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The local's name (``lettering.word``).
    """
    if shown.low == shown.high:
        return shown_number(value, reached)
    if is_packed(shown):
        return packed(value, reached)
    if whole:
        low = round(shown.low)
        high = max(round(shown.high), low + 1.0)
        shown = Range(low, 0.5 * (low + high), high)
    color = select(reached, vec4(depth_color(1.0 - share_of(value, shown)), 1.0), UNREACHED)
    decimals = 0 if whole else decimals_for(max(abs(shown.low), abs(shown.high)), 3)
    return with_scale(
        color,
        coord,
        resolution,
        title,
        2 if whole else 3,
        decimals,
        lambda x: depth_color(1.0 - x),
        lambda x: value_at(x, shown),
    )


@func
def local_vector(
    value: vec3,
    axes: int,
    plain: vec4,
    reached: bool,
    shown: Range,
    coord: vec2,
    resolution: vec2,
    title: ivec4,
) -> vec4:
    """Show a vector: its components as red, green, blue, within the range of the values.

    Args:
        value: The vector; the components that it lacks are 0.
        axes: How many components it has.
        plain: Its color if the range is not known.
        reached: Whether the pixel has one.
        shown: The range of the values; empty if it is not known.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The local's name (``lettering.word``).
    """
    if shown.low == shown.high:
        return plain
    lowest = min(value.x, min(value.y, value.z))
    highest = max(value.x, max(value.y, value.z))
    if is_packed(shown):
        return packed(select(lowest < 0.0, min(lowest, -highest), highest), reached)
    is_signed = shown.low < 0.0
    # Colors and other values from 0 to 1 are shown as they are.
    most = max(max(abs(shown.low), abs(shown.high)), select(is_signed, 1e-9, 1.0))
    least = select(is_signed, -most, 0.0)
    # Small values of a wide range remain visible.
    curve = min(exponent(Range(0.0, abs(shown.middle), most)), 1.0)
    curved = sign(value) * abs(value / most) ** select(is_signed, curve, 1.0)
    color = clamp((curved * most - least) / (most - least), 0.0, 1.0)
    painted = select(reached, vec4(color, 1.0), UNREACHED)
    return with_axes(painted, coord, resolution, title, axes, least, most)


@func
def local_coordinate(
    value: vec2, reached: bool, shown: Range, coord: vec2, resolution: vec2, title: ivec4
) -> vec4:
    """Show a vec2: x as red, y as green (``local_vector``)."""
    plain = shown_coordinate(value, reached)
    return local_vector(vec3(value, 0.0), 2, plain, reached, shown, coord, resolution, title)


@func
def local_direction(
    value: vec3, reached: bool, shown: Range, coord: vec2, resolution: vec2, title: ivec4
) -> vec4:
    """Show a vec3: x as red, y as green, z as blue (``local_vector``)."""
    plain = shown_vector(value, reached)
    return local_vector(value, 3, plain, reached, shown, coord, resolution, title)
