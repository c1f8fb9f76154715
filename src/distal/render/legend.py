"""Legends of views: what the colors mean, with numbers, in a panel at the picture's lower left.

Input: a pixel's color and place, and the numbers of a view. Output: the same color, or the
legend's. All sizes are in squares of the lettering, which are whole pixels.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    Field3,
    abs,
    clamp,
    floor,
    func,
    ivec4,
    max,
    min,
    mix,
    round,
    select,
    vec2,
    vec3,
    vec4,
)
from distal.render.camera import Ray
from distal.render.lettering import (
    ADVANCE,
    HEIGHT,
    decimals_for,
    number_covers,
    number_width,
    word,
    word_covers,
)
from distal.render.ranges import Range, is_packed, value_at
from distal.render.views import (
    BROKEN,
    Lines,
    depth_color,
    heat,
    isolines,
    meeting,
    slope_color,
)

INK = vec3(0.96, 0.96, 0.94)
PAPER = vec3(0.05, 0.055, 0.065)
LABEL_INK = vec3(0.06, 0.06, 0.08)
LABEL_PAPER = vec3(0.98, 0.97, 0.94)
OPACITY = 0.78
SMALLEST_PICTURE = 180.0  # the shorter side, in pixels; a smaller picture has no legend
# The panel: from the picture's edge, its size, and what is in it, from its lower left.
MARGIN = 6.0
PADDING = 7.0
BAR = 132.0
BAR_HEIGHT = 7.0
TICKS_Y = PADDING
BAR_Y = PADDING + HEIGHT + 4.0
TITLE_Y = BAR_Y + BAR_HEIGHT + 5.0
PANEL = vec2(BAR + 2.0 * PADDING + 8.0, TITLE_Y + HEIGHT + PADDING)
BAR_X = 0.5 * (PANEL.x - BAR)
MOST_TICKS = 4
# Labels of slice lines: columns of a picture, and the room that a label needs, in squares.
COLUMNS = 3.0
LABEL_ROOM = 18.0
SEARCH_STEPS = 3
X = ivec4(*word("x"))
Y = ivec4(*word("y"))
Z = ivec4(*word("z"))
LINE = ivec4(*word("line"))
LINE_WIDTH = 4.0 * ADVANCE


@func
def square_size(resolution: vec2) -> float:
    """Return the size of a square of the lettering, in pixels."""
    return floor(min(resolution.x, resolution.y) / 480.0 + 1.0)


@func
def panel_place(coord: vec2, resolution: vec2) -> vec2:
    """Return the place of a pixel in squares, from the panel's lower left."""
    return floor(coord / square_size(resolution)) - MARGIN + 0.5


@func
def has_legend(coord: vec2, resolution: vec2, height: float) -> bool:
    """Return whether a pixel is on a panel of a height, in squares, with cut corners."""
    if min(resolution.x, resolution.y) < SMALLEST_PICTURE:
        return False
    place = panel_place(coord, resolution)
    if place.x < 0.0 or place.y < 0.0 or place.x > PANEL.x or place.y > height:
        return False
    to_edge = min(place, vec2(PANEL.x, height) - place)
    return to_edge.x + to_edge.y > 2.5


@func
def on_paper(color: vec4) -> vec3:
    """Return the panel's color over a pixel."""
    return mix(color.rgb, PAPER, OPACITY)


@func
def tick_covers(value: float, decimals: int, share: float, place: vec2) -> bool:
    """Return whether the number of a tick covers a place; it stays within the bar.

    Args:
        value: The number.
        decimals: Digits after the decimal point.
        share: Place on the bar, 0 to 1.
        place: In squares, from the panel's lower left.
    """
    width = number_width(value, decimals)
    right = clamp(BAR_X + share * BAR + 0.5 * width, BAR_X + width, BAR_X + BAR)
    return number_covers(value, decimals, vec2(place.x - floor(right + 0.5), place.y - TICKS_Y))


@func
def with_scale(
    color: vec4,
    coord: vec2,
    resolution: vec2,
    title: ivec4,
    ticks: int,
    decimals: int,
    scale: Callable[[float], vec3],
    value: Callable[[float], float],
) -> vec4:
    """Draw a legend over a pixel: a title, a bar of colors, and numbers under the bar.

    Args:
        color: Display-ready color.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The title (``lettering.word``).
        ticks: How many numbers there are.
        decimals: Digits of the numbers after the decimal point.
        scale: The color at a share of the bar, 0 to 1.
        value: The number at a share of the bar.
    """
    if not has_legend(coord, resolution, PANEL.y):
        return color
    place = panel_place(coord, resolution)
    if word_covers(title, place - vec2(BAR_X, TITLE_Y)):
        return vec4(INK, 1.0)
    along = (place.x - BAR_X) / BAR
    above = place.y - BAR_Y
    if along >= 0.0 and along <= 1.0 and above >= 0.0 and above < BAR_HEIGHT:
        return vec4(scale(along), 1.0)
    inked = False
    for i in range(MOST_TICKS):
        share = float(i) / float(ticks - 1)
        if i < ticks and tick_covers(value(share), decimals, share, place):
            inked = True
    return vec4(select(inked, INK, on_paper(color)), 1.0)


@func
def with_steps(color: vec4, coord: vec2, resolution: vec2, title: ivec4, steps: int) -> vec4:
    """Draw the legend of steps."""
    return with_scale(color, coord, resolution, title, 3, 0, heat, lambda x: x * float(steps))


@func
def with_depth(color: vec4, coord: vec2, resolution: vec2, title: ivec4, shown: Range) -> vec4:
    """Draw the legend of depths."""
    if is_packed(shown):
        return color
    decimals = decimals_for(max(abs(shown.low), abs(shown.high)), 3)
    return with_scale(
        color, coord, resolution, title, 3, decimals, depth_color, lambda x: value_at(x, shown)
    )


@func
def with_signal(color: vec4, coord: vec2, resolution: vec2, title: ivec4, shown: Range) -> vec4:
    """Draw the legend of a signal: white is low."""
    if is_packed(shown):
        return color
    decimals = decimals_for(max(abs(shown.low), abs(shown.high)), 3)
    return with_scale(
        color,
        coord,
        resolution,
        title,
        3,
        decimals,
        lambda x: vec3(1.0 - 0.9 * x),
        lambda x: value_at(x, shown),
    )


@func
def with_slope(color: vec4, coord: vec2, resolution: vec2, title: ivec4, slope: float) -> vec4:
    """Draw the legend of slopes; magenta and the declared bound are at its upper right."""
    if has_legend(coord, resolution, PANEL.y):
        place = panel_place(coord, resolution) - vec2(BAR_X + BAR, TITLE_Y)
        decimals = decimals_for(slope, 3)
        if number_covers(slope, decimals, place):
            return vec4(INK, 1.0)
        left = place.x + number_width(slope, decimals) + 4.0
        if left < 0.0 and left > -HEIGHT and place.y > 0.0 and place.y < HEIGHT:
            return vec4(BROKEN, 1.0)
    return with_scale(
        color, coord, resolution, title, 4, 0, lambda x: slope_color(3.0 * x), lambda x: 3.0 * x
    )


@func
def axis_color(axis: float, part: float, rest: float) -> vec3:
    """Return the color of one component's value.

    Args:
        axis: 0 to 2 for x, y, z.
        part: The color's value for the component, 0 to 1.
        rest: The color's value for a component of 0.
    """
    blue = vec3(rest, rest, part)
    return select(
        axis < 0.5, vec3(part, rest, rest), select(axis < 1.5, vec3(rest, part, rest), blue)
    )


@func
def with_axes(
    color: vec4, coord: vec2, resolution: vec2, title: ivec4, axes: int, least: float, most: float
) -> vec4:
    """Draw the legend of vectors: a bar for each component as red, green or blue.

    Args:
        color: Display-ready color.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The title (``lettering.word``).
        axes: How many components there are: 2 or 3.
        least: The left end of the bars: ``-most`` or 0.
        most: The right end of the bars.
    """
    if not has_legend(coord, resolution, PANEL.y):
        return color
    place = panel_place(coord, resolution)
    part = BAR / float(axes)
    axis = clamp(floor((place.x - BAR_X) / part), 0.0, float(axes) - 1.0)
    x = place.x - BAR_X - axis * part
    above = place.y - BAR_Y
    if x >= 0.0 and x <= part - 4.0 and above >= 0.0 and above < BAR_HEIGHT:
        rest = -least / (most - least)
        return vec4(axis_color(axis, x / (part - 4.0), rest), 1.0)
    decimals = decimals_for(most, 2) if abs(most - 1.0) > 0.02 else 0
    y = place.y - TICKS_Y
    width = number_width(least, decimals)
    inked = number_covers(least, decimals, vec2(x - width, y))
    inked = inked or number_covers(most, decimals, vec2(x - part + 4.0, y))
    letter = X if axis < 0.5 else (Y if axis < 1.5 else Z)
    if width + number_width(most, decimals) < part - 16.0:
        inked = inked or word_covers(letter, vec2(x - floor(0.5 * part) + 4.0, y))
    inked = inked or word_covers(title, place - vec2(BAR_X, TITLE_Y))
    return vec4(select(inked, INK, on_paper(color)), 1.0)


@func
def with_directions(color: vec4, coord: vec2, resolution: vec2, title: ivec4) -> vec4:
    """Draw the legend of unit vectors."""
    return with_axes(color, coord, resolution, title, 3, -1.0, 1.0)


@func
def with_title(color: vec4, coord: vec2, resolution: vec2, title: ivec4) -> vec4:
    """Draw a title alone."""
    height = HEIGHT + 2.0 * PADDING
    if not has_legend(coord, resolution, height):
        return color
    inked = word_covers(title, panel_place(coord, resolution) - vec2(BAR_X, PADDING))
    return vec4(select(inked, INK, on_paper(color)), 1.0)


@func
def level_at(
    place: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    field: Field3,
    slice_normal: vec3,
    slice_offset: float,
) -> float:
    """Return the field where the ray of a pixel meets a plane; far away if it does not.

    Args:
        place: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        camera: Ray of a place in the picture.
        field: Signed distance.
        slice_normal: Unit normal of the plane.
        slice_offset: Distance of the plane from the origin.
    """
    ray = camera((2.0 * place - resolution) / resolution.y)
    t = meeting(ray, slice_normal, slice_offset)
    return select(t > 0.0, field(ray.origin + max(t, 0.0) * ray.direction), 1e9)


@func
def with_lines(
    color: vec4,
    coord: vec2,
    resolution: vec2,
    title: ivec4,
    camera: Callable[[vec2], Ray],
    field: Field3,
    slice_normal: vec3,
    slice_offset: float,
    lines: Lines,
) -> vec4:
    """Draw the legend of slices, and the distance at bold lines where there is room.

    Args:
        color: Display-ready color.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The title (``lettering.word``).
        camera: Ray of a place in the picture.
        field: Signed distance.
        slice_normal: Unit normal of the plane.
        slice_offset: Distance of the plane from the origin.
        lines: The lines.
    """
    if has_legend(coord, resolution, PANEL.y):
        return lines_legend(color, coord, resolution, title, lines)
    size = square_size(resolution)
    column = resolution.x / COLUMNS
    middle = (floor(coord.x / column) + 0.5) * column
    bold = 5.0 * lines.step
    decimals = decimals_for(bold, 1)
    small = min(resolution.x, resolution.y) < SMALLEST_PICTURE
    if small or abs(coord.x - middle) > 24.0 * size:
        return color
    # The bold line nearest to the pixel, along the column: Newton's method.
    place = vec2(middle, coord.y)
    level = 0.0
    change = 1.0
    value = 0.0
    for i in range(SEARCH_STEPS):
        value = level_at(place, resolution, camera, field, slice_normal, slice_offset)
        if i == 0:
            level = bold * round(value / bold)
        above = vec2(place.x, place.y + 1.0)
        above_value = level_at(above, resolution, camera, field, slice_normal, slice_offset)
        change = above_value - value
        way = (value - level) / select(abs(change) > 1e-12, change, 1e-12)
        place -= vec2(0.0, clamp(way, -12.0 * size, 12.0 * size))
    edge = 8.0 * size
    is_free = place.y > edge and place.y < resolution.y - edge
    is_free = is_free and not has_legend(place - vec2(3.0 * edge, edge), resolution, PANEL.y)
    has_room = (
        is_free and bold > LABEL_ROOM * size * abs(change) and abs(value - level) < abs(change)
    )
    width = number_width(level, decimals)
    at = floor((coord - place) / size + 0.5) + vec2(floor(0.5 * width + 0.5), 3.5)
    inside = at.x > -3.0 and at.x < width + 3.0 and at.y > -2.0 and at.y < HEIGHT + 2.0
    if not (has_room and inside):
        return color
    if number_covers(level, decimals, vec2(at.x - width, at.y)):
        return vec4(LABEL_INK, 1.0)
    return vec4(mix(color.rgb, LABEL_PAPER, 0.92), 1.0)


@func
def lines_legend(color: vec4, coord: vec2, resolution: vec2, title: ivec4, lines: Lines) -> vec4:
    """Return a pixel of the legend of slices: the bar has the lines that the picture has.

    Args:
        color: Display-ready color.
        coord: Place of the pixel, from the lower left.
        resolution: Size of the picture.
        title: The title (``lettering.word``).
        lines: The lines.
    """
    decimals = decimals_for(lines.step, 1)
    place = panel_place(coord, resolution) - vec2(BAR_X + BAR, TITLE_Y)
    if number_covers(lines.step, decimals, place):
        return vec4(INK, 1.0)
    left = place.x + number_width(lines.step, decimals) + LINE_WIDTH + 4.0
    if word_covers(LINE, vec2(left, place.y)):
        return vec4(INK, 1.0)
    change = 20.0 * lines.step / (BAR * square_size(resolution))
    return with_scale(
        color,
        coord,
        resolution,
        title,
        3,
        decimals_for(10.0 * lines.step, 1),
        lambda x: isolines((20.0 * x - 10.0) * lines.step, change, lines.step, lines.width),
        lambda x: (20.0 * x - 10.0) * lines.step,
    )


LEGENDS = {
    "coordinate": with_directions,
    "signal": with_signal,
    "distance": with_lines,
    "normal": with_directions,
    "depth": with_depth,
    "steps": with_steps,
    "material": with_title,
    "slope": with_slope,
    "slice": with_lines,
}
TITLES = {
    "coordinate": "ray direction",
    "signal": "distance of hit",
    "distance": "distance",
    "normal": "normal",
    "depth": "depth",
    "steps": "steps",
    "material": "unlit color",
    "slope": "slope",
    "slice": "distance",
}
