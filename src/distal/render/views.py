"""Views: normal, depth, steps, slope and others as pictures.

Input: a ray, and the functions and numbers of a scene. Output: display-ready colors and alpha.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import (
    Field3,
    abs,
    clamp,
    dot,
    floor,
    func,
    gradient,
    length,
    log2,
    max,
    min,
    mix,
    round,
    select,
    smoothstep,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.lang.srgb import encode_srgb
from distal.render.camera import Ray
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.normals import EXACT
from distal.render.ranges import Range, is_packed, packed, share_of
from distal.render.trace import facing_normal, hit_point, point_before

# The colors of slopes: below 1, at 1, at 1.5, from 2.5, and above the declared bound.
BELOW = vec3(0.45, 0.62, 0.80)
CALM = vec3(0.80, 0.84, 0.86)
WARM = vec3(0.96, 0.70, 0.25)
RED = vec3(0.78, 0.10, 0.10)
BROKEN = vec3(1.0, 0.0, 1.0)
# The colors of depths: near, in the middle, far.
NEAR = vec3(0.99, 0.94, 0.78)
MIDDLE = vec3(0.24, 0.62, 0.62)
FAR = vec3(0.08, 0.09, 0.26)
# The colors of slices, near the surface and away from it.
OUTSIDE = vec3(0.96, 0.78, 0.52)
INSIDE = vec3(0.36, 0.60, 0.86)
LINE_DISTANCE = 20.0  # between lines, in pixels of a picture 480 pixels high
EMPTY = vec3(0.08, 0.08, 0.1)


@struct
class Lines:
    """Lines of equal distance on a plane.

    Attributes:
        spread: How far the rays of neighboring pixels are apart: at their origins, and for each
            unit of distance along them.
        step: Distance from one line to the next, a round number of scene units.
        width: Width of a thin line, in pixels.
    """

    spread: vec2
    step: float
    width: float


@func
def heat(x: float) -> vec3:
    """Map 0 to 1 to dark blue, green, yellow, red; equal differences look about equal."""
    t = clamp(x, 0.0, 1.0)
    red = smoothstep(0.35, 0.75, t)
    green = smoothstep(0.05, 0.45, t) - 0.85 * smoothstep(0.65, 1.0, t)
    blue = 0.25 + 0.6 * smoothstep(0.0, 0.2, t) - 0.85 * smoothstep(0.3, 0.6, t)
    return vec3(red, green, blue)


@func
def slope_color(slope: float) -> vec3:
    """Map a slope to a color: 1 is calm, less is blue, more is warm, 2.5 and more is red."""
    below = mix(BELOW, CALM, clamp((slope - 0.2) / 0.8, 0.0, 1.0))
    above = mix(below, WARM, clamp((slope - 1.0) / 0.5, 0.0, 1.0))
    return mix(above, RED, clamp(slope - 1.5, 0.0, 1.0))


@func
def depth_color(share: float) -> vec3:
    """Map 0 to 1 to the colors of near to far."""
    near = mix(NEAR, MIDDLE, smoothstep(0.0, 1.0, clamp(2.0 * share, 0.0, 1.0)))
    return mix(near, FAR, smoothstep(0.0, 1.0, clamp(2.0 * share - 1.0, 0.0, 1.0)))


@func
def round_step(x: float) -> float:
    """Return the nearest of 1, 2 and 5 times a power of ten, by ratio."""
    power: float = 10.0 ** floor(log2(max(x, 1e-30)) * 0.30102999566 + 1e-5)
    part = x / power
    large = select(part < 7.0710678, 5.0, 10.0)
    return power * select(part < 1.4142136, 1.0, select(part < 3.1622777, 2.0, large))


@func
def line_covers(d: float, step: float, change: float, width: float) -> float:
    """Return how much of a pixel the lines at multiples of ``step`` cover.

    Args:
        d: Distance.
        step: Distance from one line to the next.
        change: How much the distance changes from pixel to pixel.
        width: Width of a line in pixels.
    """
    away = abs(d - step * round(d / step)) / max(change, 1e-20)
    return clamp(0.5 * width + 0.5 - away, 0.0, 1.0)


@func
def isolines(d: float, change: float, step: float, width: float) -> vec3:
    """Color a distance: warm outside, blue inside, a line at every multiple of ``step``.

    Every fifth line is bold; that at 0 is black. Lines that would be less than two pixels apart
    are not drawn.

    Args:
        d: Distance.
        change: How much the distance changes from pixel to pixel.
        step: Distance from one line to the next.
        width: Width of a thin line in pixels.
    """
    outside = d > 0.0
    away = clamp(abs(d) / (8.0 * step), 0.0, 1.0)
    near = select(outside, vec3(1.0, 0.97, 0.92), vec3(0.90, 0.96, 1.0))
    color = mix(near, 0.8 * select(outside, OUTSIDE, INSIDE), away)
    room = clamp(step / max(change, 1e-20) - 2.0, 0.0, 1.0)
    color *= 1.0 - 0.35 * room * line_covers(d, step, change, width)
    room = clamp(5.0 * step / max(change, 1e-20) - 2.0, 0.0, 1.0)
    color *= 1.0 - 0.45 * room * line_covers(d, 5.0 * step, change, 2.0 * width)
    zero = clamp(1.5 * width + 0.5 - abs(d) / max(change, 1e-20), 0.0, 1.0)
    return mix(color, vec3(0.05), zero)


@func
def meeting(ray: Ray, normal: vec3, offset: float) -> float:
    """Return the distance along a ray to a plane; -1 if the ray is parallel to it."""
    facing = dot(ray.direction, normal)
    steep = select(abs(facing) > 1e-6, facing, 1.0)
    t = (offset - dot(ray.origin, normal)) / steep
    return select(abs(facing) > 1e-6, t, -1.0)


@func
def lines_on(
    camera: Callable[[vec2], Ray], resolution: vec2, slice_normal: vec3, slice_offset: float
) -> Lines:
    """Return the lines of a plane, about ``LINE_DISTANCE`` pixels apart in the picture's middle.

    Args:
        camera: Ray of a place in the picture.
        resolution: Size of the picture in pixels.
        slice_normal: Unit normal of the plane.
        slice_offset: Distance of the plane from the origin.
    """
    ray = camera(vec2(0.0, 0.0))
    beside = camera(vec2(2.0 / resolution.y, 0.0))
    spread = vec2(length(beside.origin - ray.origin), length(beside.direction - ray.direction))
    t = meeting(ray, slice_normal, slice_offset)
    seen = select(t > 0.0, t, abs(slice_offset - dot(ray.origin, slice_normal)))
    width = max(min(resolution.x, resolution.y) / 480.0, 1.0)
    return Lines(spread, round_step(LINE_DISTANCE * width * (spread.x + spread.y * seen)), width)


@func
def facing_plane(camera: Callable[[vec2], Ray]) -> vec3:
    """Return the unit normal of the planes that the middle of the picture faces."""
    return camera(vec2(0.0, 0.0)).direction


@func
def normal_color(normal: vec3) -> vec3:
    """Map a normal's x, y, z from -1 to 1 to red, green, blue."""
    return 0.5 + 0.5 * normal


@func
def view_normal(ray: Ray, first_hit: Callable[[Ray], Hit], field: Field3, numbers: March) -> vec4:
    """Show the normal's x, y, z as red, green, blue."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    return vec4(normal_color(facing_normal(field, ray, hit, numbers, EXACT, 0.0)), 1.0)


@func
def view_depth(ray: Ray, first_hit: Callable[[Ray], Hit], shown: Range) -> vec4:
    """Show the distance along the ray: bright is near, dark blue is far, within a range."""
    hit = first_hit(ray)
    if is_packed(shown):
        return packed(hit.t, hit.found)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    return vec4(depth_color(share_of(hit.t, shown)), 1.0)


@func
def view_steps(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    steps: int,
) -> vec4:
    """Show the cost of a ray: the number of field evaluations as a fraction of the limit."""
    hit = first_hit(ray)
    return vec4(heat(float(hit.steps) / float(steps)), 1.0)


@func
def view_coordinate(ray: Ray) -> vec4:
    """Show the direction of the ray as a color."""
    return vec4(0.5 + 0.5 * ray.direction, 1.0)


@func
def view_signal(ray: Ray, first_hit: Callable[[Ray], Hit], shown: Range) -> vec4:
    """Show the distance along the ray as a gray value, white near, black where nothing is hit."""
    hit = first_hit(ray)
    if is_packed(shown):
        return packed(hit.t, hit.found)
    return vec4(vec3(1.0 - 0.9 * share_of(hit.t, shown) if hit.found else 0.0), 1.0)


@func
def view_slope(
    ray: Ray, first_hit: Callable[[Ray], Hit], field: Field3, numbers: March, slope: float
) -> vec4:
    """Show |gradient| on the surface; magenta above the declared Lipschitz bound (slope)."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    steep = length(gradient(field, point_before(ray, hit, numbers)))
    if steep > 1.001 * slope:
        return vec4(BROKEN, 1.0)
    return vec4(slope_color(steep), 1.0)


@func
def view_material(
    ray: Ray,
    first_hit: Callable[[Ray], Hit],
    surface: Callable[[vec3], Surface],
) -> vec4:
    """Show the material's color plus its emission, without light."""
    hit = first_hit(ray)
    if not hit.found:
        return vec4(EMPTY, 0.0)
    found = surface(hit_point(ray, hit))
    return vec4(encode_srgb(found.color + found.emission), 1.0)


@func
def view_slice(
    ray: Ray,
    field: Field3,
    slice_normal: vec3,
    slice_offset: float,
    far: float,
    lines: Lines,
) -> vec4:
    """Show the field's lines of equal distance on a plane.

    Args:
        ray: Ray.
        field: Signed distance.
        slice_normal: Unit normal of the plane.
        slice_offset: Distance of the plane from the origin.
        far: Distance along the ray where rays end.
        lines: The lines.
    """
    t = meeting(ray, slice_normal, slice_offset)
    if t < 0.0 or t > far:
        return vec4(EMPTY, 0.0)
    p = ray.origin + t * ray.direction
    slope = gradient(field, p)
    # The rays of neighboring pixels meet the plane not beside the point, but where they reach it.
    facing = dot(ray.direction, slice_normal)
    across = length(slope - slice_normal * (dot(slope, ray.direction) / facing))
    change = across * (lines.spread.x + lines.spread.y * t)
    return vec4(isolines(field(p), change, lines.step, lines.width), 1.0)


@func
def view_distance(ray: Ray, field: Field3, slice_normal: vec3, far: float, lines: Lines) -> vec4:
    """Show the field on the plane through the origin that faces the camera (``facing_plane``)."""
    return view_slice(ray, field, slice_normal, 0.0, far, lines)


VIEWS = {
    "coordinate": view_coordinate,
    "signal": view_signal,
    "distance": view_distance,
    "normal": view_normal,
    "depth": view_depth,
    "steps": view_steps,
    "material": view_material,
    "slope": view_slope,
    "slice": view_slice,
}
