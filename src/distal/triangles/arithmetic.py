"""How a triangle of a picture is colored, as scene code: at its corners, and in between.

Input: corners, their codes and the cut of a triangle. Output: what a renderer interpolates, and
display values. ``web/src/triangles/`` calls ``seen_corner`` and ``seen_color`` in WebGL; the
encoder and the reference decoder call the same functions with arrays.

A triangle without a cut has the linear function of its corners' codes. A cut is a line from side
ab to side ac: corner a's part has a's code, the other part the linear function that b and c have
and that is constant along the median from a. The change between them takes one pixel.
"""

from __future__ import annotations

from typing import Final

from distal.lang import (
    clamp,
    dot,
    func,
    length,
    max,
    mix,
    select,
    struct,
    vec2,
    vec3,
    vec4,
)

# Places of a cut on a side.
PLACES: Final = 8
# A pixel's middle lies here in its cell of the lattice, so that it is on no triangle's side.
MIDDLE: Final = (0.625, 0.5)
# Farther from a cut than any pixel.
FAR: Final = 1e4


@struct
class SeenTriangleCorner:
    """A corner of a triangle in the picture.

    Attributes:
        place: Homogeneous: -1 to 1 where it is seen.
        outer: The code beyond the cut; without a cut, the corner's own.
        away: Pixels from the cut, positive on the side of the first corner.
    """

    place: vec4
    outer: vec3
    away: float


@func
def cut_distance(p: vec2, a: vec2, b: vec2, c: vec2, cut: vec2) -> float:
    """Return the distance from a cut in pixels, positive on the side of corner a.

    Args:
        p: A place.
        a: The corner that is cut off.
        b: The next corner.
        c: The one after that.
        cut: Numbers of the places on ab and ac, from a; below 0 without a cut.
    """
    first = mix(a, b, (max(cut.x, 0.0) + 0.5) / PLACES)
    second = mix(a, c, (max(cut.y, 0.0) + 0.5) / PLACES)
    along = second - first
    across = vec2(-along.y, along.x) / length(along)
    away = dot(p - first, across)
    side = dot(a - first, across)
    return select(cut.x < 0.0, -FAR, select(side > 0.0, away, -away))


@func
def outer_code(corner: int, a: vec3, b: vec3, c: vec3, cut: vec2) -> vec3:
    """Return the code at a corner (0 for a, 1 for b, 2 for c) as the part beyond the cut has it."""
    first = select(cut.x < 0.0, a, 0.5 * (b + c))
    return select(corner == 0, first, select(corner == 1, b, c))


@func
def mixed_code(outer: vec3, inner: vec3, away: float, scale: float) -> vec3:
    """Return the code of a pixel.

    Args:
        outer: The code beyond the cut.
        inner: The code on the side of corner a.
        away: As ``cut_distance``.
        scale: Pixels of the canvas for one of the picture.
    """
    return mix(outer, inner, clamp(away * scale + 0.5, 0.0, 1.0))


@func
def display_values(code: vec3) -> vec3:
    """Return red, green and blue, from 0 to 1, of a code: luma, orange and green chroma (YCoCg)."""
    rest = code.x - code.z
    return clamp(vec3(rest + code.y, code.x + code.z, rest - code.y) / 255.0, 0.0, 1.0)


@func
def color_code(display: vec3) -> vec3:
    """Return the code of display values from 0 to 255. Source: Malvar and Sullivan 2003."""
    mean = 0.5 * (display.x + display.z)
    return vec3(0.5 * (mean + display.y), 0.5 * (display.x - display.z), 0.5 * (display.y - mean))


@func
def seen_corner(
    corner: int,
    ab: vec4,
    c: vec2,
    code_a: vec3,
    code_b: vec3,
    code_c: vec3,
    cut: vec2,
    size: vec2,
) -> SeenTriangleCorner:
    """Return a corner as WebGL draws it."""
    a, b = ab.xy, ab.zw
    p = select(corner == 0, a, select(corner == 1, b, c))
    place = (p - (vec2(MIDDLE[0], MIDDLE[1]) - 0.5)) / size * 2.0 - 1.0
    outer = outer_code(corner, code_a, code_b, code_c, cut)
    return SeenTriangleCorner(
        vec4(place.x, -place.y, 0.0, 1.0), outer, cut_distance(p, a, b, c, cut)
    )


@func
def seen_color(outer: vec3, inner: vec3, away: float, scale: float) -> vec4:
    """Return the display values of a pixel, as WebGL draws it."""
    return vec4(display_values(mixed_code(outer, inner, away, scale)), 1.0)
