"""Between the plane and space by turning, wrapping, cutting and casting shadows.

Input: the distance of a flat shape or of a solid, the point, and the shape's bounds.
Output: the distance of the solid or the flat shape, and the rules of its slope and box.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.constants import PI, TINY
from distal.fields.extents import (
    at_least_one,
    box_distance,
    rectangle_distance,
    turned,
    unless_endless,
)
from distal.fields.flats.edges import inside_both
from distal.fields.guarantees import (
    LOWER_BOUND,
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Limit,
    operator,
)
from distal.lang import (
    Field3,
    abs,
    atan2,
    clamp,
    cos,
    cross,
    dot,
    func,
    length,
    mat3,
    max,
    min,
    normalize,
    select,
    sin,
    vec2,
    vec3,
)

FORWARDS: Final = vec3(0.0, 0.0, 1.0)
BACKWARDS: Final = vec3(0.0, 0.0, -1.0)
# Beyond this share of y a normal is taken for upright.
NEARLY_LEVEL: Final = 0.999
UP: Final = vec3(0.0, 1.0, 0.0)
ORIGIN: Final = vec3(0.0, 0.0, 0.0)


@func
def revolved(p: vec3, offset: float = 0.0) -> vec2:
    """How far from the y axis, and how high; ``offset`` moves the outline outwards.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).
    """
    return vec2(length(p.xz) - offset, p.y)


@func
def revolved_bounds(bounds: Bounds2, offset: float = 0.0) -> Bounds:
    """The cylinder that the right side draws."""
    reach = max(bounds.high.x + offset, 0.0)
    return Bounds(vec3(-reach, bounds.low.y, -reach), vec3(reach, bounds.high.y, reach))


@func
def from_end_face(p: vec3, angle: float) -> vec2:
    """How far out along the nearer end of a turn, and how far past it.

    Half of the turn lies to each side of the plane z = 0, x > 0.
    """
    c = cos(0.5 * angle)
    s = sin(0.5 * angle)
    z = abs(p.z)
    return vec2(c * p.x + s * z, c * z - s * p.x)


@func
def partly_revolved(p: vec3, offset: float = 0.0, angle: float = PI) -> vec2:
    """As ``revolved``; past an end, the place seen at a right angle to the end's face."""
    end = from_end_face(p, angle)
    return vec2(select(end.y > 0.0, end.x, length(p.xz)) - offset, p.y)


@func
def partly_revolved_value(d: float, p: vec3, angle: float = PI) -> float:
    """Inside the outline and between both ends; inside, at most the way to an end's plane."""
    end = from_end_face(p, angle)
    behind = select(end.x > 0.0, end.y, -length(p.xz))
    return inside_both(d, select(end.y > 0.0, end.y, behind))


@func
def partly_revolved_growth(growth: float, angle: float = PI) -> float:
    """Behind the axis an end counts as a whole plane: its distance is too little by the sine."""
    return max(growth, 1.0 / max(sin(min(0.5 * angle, 0.5 * PI)), TINY))


def turn_requirement(offset: float, angle: float) -> str | None:
    """Why an outline cannot be turned so far, or None."""
    if angle >= 2.0 * math.pi:
        return "angle must be below a full turn (without it, it goes all around)"
    return None


@func
def wrap_margin(bounds: Bounds2, radius: float, height: float) -> float:
    """How much of a wrapped outline's values counts: less than the gap behind the cylinder.

    There the outline's two sides meet; where both are cut off, there is no jump.
    """
    gap = PI * radius - max(abs(bounds.low.x), abs(bounds.high.x))
    return min(gap, 0.5 * (radius - 0.5 * height))


@func
def wrapped(p: vec3, radius: float) -> vec2:
    """How far around the cylinder, measured on it, and how high; z > 0 is its front."""
    return vec2(radius * atan2(p.x, p.z), p.y)


@func
def wrapped_value(
    d: float, p: vec3, radius: float, height: float, bounds: Bounds2, slope: float
) -> float:
    """The outline as a relief, half of ``height`` out of and into the cylinder's surface.

    The outline's values are scaled to what they are at the relief's inner side, where it is most
    compressed; farther in they fade out toward the axis.
    """
    inner = radius - 0.5 * height
    outward = length(p.xz)
    margin = wrap_margin(bounds, radius, height)
    flat = max(d, rectangle_distance(wrapped(p, radius), bounds))
    near = (inner / radius) * clamp(flat, -margin, margin)
    past_faces = abs(outward - radius) - 0.5 * height
    within = max(past_faces, near * min(outward / inner, 1.0))
    relief = select(outward < inner, within, inside_both(near, past_faces))
    return max(relief, box_distance(p, wrapped_bounds(bounds, radius, height)))


@func
def wrapped_slope(slope: float, bounds: Bounds2, radius: float, height: float) -> float:
    """The outline's, and inside the relief what the fading adds: half of 1, at a right angle."""
    steepest = max(slope, 1.0)
    fits = wrap_margin(bounds, radius, height) > 0.0
    return select(fits, length(vec2(steepest, 0.5)), UNBOUNDED)


@func
def wrapped_bounds(bounds: Bounds2, radius: float, height: float) -> Bounds:
    """The cylinder around the relief."""
    outer = radius + 0.5 * height
    return Bounds(vec3(-outer, bounds.low.y, -outer), vec3(outer, bounds.high.y, outer))


def relief_requirement(radius: float, height: float) -> str | None:
    """Why a relief cannot be so thick, or None."""
    return "height must be below twice the radius" if height >= 2.0 * radius else None


@func
def plane_right(normal: vec3) -> vec3:
    """The x axis of a cutting plane: level; for a level plane, that of space."""
    level = abs(normal.y) > NEARLY_LEVEL
    return normalize(cross(select(level, BACKWARDS, UP), normal))


@func
def sliced(p: vec2, origin: vec3 = ORIGIN, normal: vec3 = FORWARDS) -> vec3:
    """The place on a plane in space.

    Looking against the normal, y is up as far as the plane allows; on a level plane it is -z.
    """
    right = plane_right(normal)
    return origin + p.x * right + p.y * cross(normal, right)


@func
def sliced_bounds(bounds: Bounds, origin: vec3 = ORIGIN, normal: vec3 = FORWARDS) -> Bounds2:
    """The box, seen at a right angle to the plane."""
    right = plane_right(normal)
    up = cross(normal, right)
    seen = turned(
        bounds,
        mat3(vec3(right.x, up.x, 0.0), vec3(right.y, up.y, 0.0), vec3(right.z, up.z, 0.0)),
    )
    middle = vec2(dot(origin, right), dot(origin, up))
    return Bounds2(seen.low.xy - middle, seen.high.xy - middle)


@func
def height_of_slice(bounds: Bounds, index: int, count: int) -> float:
    """Where one of ``count`` slices through a box lies, from its back to its front."""
    share = (float(index) + 0.5) / float(count)
    return bounds.low.z + (bounds.high.z - bounds.low.z) * share


@func
def projected(field: Field3, p: vec2, bounds: Bounds, count: int = 32) -> float:
    """What many slices along z together cover: the shadow on the plane, from within.

    Parts thinner along z than the distance between two slices may be missed.
    """
    d = UNBOUNDED
    for i in range(count):
        d = min(d, field(vec3(p, height_of_slice(bounds, i, count))))
    return d


@func
def projected_site(field: Field3, p: vec2, bounds: Bounds, count: int = 32) -> vec3:
    """The place in the slice that is nearest."""
    d = UNBOUNDED
    place = vec3(p, 0.0)
    for i in range(count):
        q = vec3(p, height_of_slice(bounds, i, count))
        here = field(q)
        place = select(here < d, q, place)
        d = min(d, here)
    return place


@func
def projected_slope(slope: float, bounds: Bounds) -> float:
    """The solid's, where its box has a front and a back."""
    return unless_endless(max(abs(bounds.low.z), abs(bounds.high.z)), slope)


@func
def projected_bounds(bounds: Bounds) -> Bounds2:
    """The box, seen along z."""
    return Bounds2(bounds.low.xy, bounds.high.xy)


def slices_requirement(count: int) -> str | None:
    """Why so many slices cannot be, or None."""
    return None if 1 <= count <= 4096 else "count must be from 1 to 4096"


REVOLVE = operator(
    "revolve",
    point=revolved,
    keeps=LOWER_BOUND,
    bounds=revolved_bounds,
    growth=Growth.KEPT,
)
REVOLVE_PARTLY = operator(
    "revolve partly",
    point=partly_revolved,
    finish=partly_revolved_value,
    keeps=LOWER_BOUND,
    slope=at_least_one,
    bounds=revolved_bounds,
    limits={"angle": Limit.POSITIVE},
    requires=turn_requirement,
    growth=partly_revolved_growth,
)
WRAP_CYLINDER = operator(
    "wrap cylinder",
    point=wrapped,
    finish=wrapped_value,
    slope=wrapped_slope,
    bounds=wrapped_bounds,
    limits={"radius": Limit.POSITIVE, "height": Limit.POSITIVE},
    requires=relief_requirement,
    needs="a flat shape that is less wide than the cylinder is around",
    growth=Growth.HELD,
)
SLICE = operator(
    "slice",
    point=sliced,
    keeps=LOWER_BOUND,
    bounds=sliced_bounds,
    limits={"normal": Limit.UNIT},
    growth=Growth.TURNED,
)
PROJECT = operator(
    "project",
    around=projected,
    site=projected_site,
    slope=projected_slope,
    bounds=projected_bounds,
    requires=slices_requirement,
    needs="a solid that ends along z",
    growth=Growth.KEPT,
)
