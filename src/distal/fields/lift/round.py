"""Revolution and wrapping of flat shapes to solids; slices and projections of solids.

Input: the distance of a flat shape or of a solid, the point, and the shape's bounds. Output: the
distance of the solid or the flat shape, and the rules for its slope and box.
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
from distal.fields.widths import deformed_width
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
# A normal whose y component is larger counts as vertical.
NEARLY_LEVEL: Final = 0.999
UP: Final = vec3(0.0, 1.0, 0.0)
ORIGIN: Final = vec3(0.0, 0.0, 0.0)


@func
def revolved(p: vec3, offset: float = 0.0) -> vec2:
    """Return the distance from the y axis and the height; ``offset`` moves the outline outwards.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).
    """
    return vec2(length(p.xz) - offset, p.y)


@func
def revolved_bounds(bounds: Bounds2, offset: float = 0.0) -> Bounds:
    """Return the box of the cylinder that contains the revolved right side."""
    reach = max(bounds.high.x + offset, 0.0)
    return Bounds(vec3(-reach, bounds.low.y, -reach), vec3(reach, bounds.high.y, reach))


@func
def from_end_face(p: vec3, angle: float) -> vec2:
    """Return the distance outwards along the nearer end face, and the distance past it.

    Half of the revolution lies on each side of the half plane z = 0, x > 0.
    """
    c = cos(0.5 * angle)
    s = sin(0.5 * angle)
    z = abs(p.z)
    return vec2(c * p.x + s * z, c * z - s * p.x)


@func
def partly_revolved(p: vec3, offset: float = 0.0, angle: float = PI) -> vec2:
    """Return the same as ``revolved``; past an end, the point is projected onto the end face."""
    end = from_end_face(p, angle)
    return vec2(select(end.y > 0.0, end.x, length(p.xz)) - offset, p.y)


@func
def partly_revolved_value(d: float, p: vec3, angle: float = PI) -> float:
    """Return the distance, limited inside by the distance to an end's plane."""
    end = from_end_face(p, angle)
    behind = select(end.x > 0.0, end.y, -length(p.xz))
    return inside_both(d, select(end.y > 0.0, end.y, behind))


@func
def partly_revolved_growth(growth: float, angle: float = PI) -> float:
    """Return the growth.

    Behind the axis an end counts as a whole plane, whose distance is too small by the sine.
    """
    return max(growth, 1.0 / max(sin(min(0.5 * angle, 0.5 * PI)), TINY))


def turn_requirement(offset: float, angle: float) -> str | None:
    """Return why a partial revolution is invalid, or None."""
    if angle >= 2.0 * math.pi:
        return "angle must be below a full turn (without it, it goes all around)"
    return None


@func
def wrap_margin(bounds: Bounds2, radius: float, height: float) -> float:
    """Return the limit for the values of a wrapped outline: less than the gap behind the cylinder.

    The two sides of the outline meet there. If both values are limited, there is no jump.
    """
    gap = PI * radius - max(abs(bounds.low.x), abs(bounds.high.x))
    return min(gap, 0.5 * (radius - 0.5 * height))


@func
def wrapped(p: vec3, radius: float) -> vec2:
    """Return the arc length around the cylinder, and the height; z > 0 is the front."""
    return vec2(radius * atan2(p.x, p.z), p.y)


@func
def wrapped_value(
    d: float, p: vec3, radius: float, height: float, bounds: Bounds2, slope: float
) -> float:
    """Return the distance to the outline as a relief on the surface of a cylinder.

    It extends by half of ``height`` to both sides of the surface. The outline's values are scaled
    as at the relief's inner side, where it is compressed most; farther inside they fade out towards
    the axis.
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
    """Return the outline's slope, combined inside with that of the fading: 1/2, perpendicular."""
    steepest = max(slope, 1.0)
    fits = wrap_margin(bounds, radius, height) > 0.0
    return select(fits, length(vec2(steepest, 0.5)), UNBOUNDED)


@func
def wrapped_bounds(bounds: Bounds2, radius: float, height: float) -> Bounds:
    """Return the box of the cylinder around the relief."""
    outer = radius + 0.5 * height
    return Bounds(vec3(-outer, bounds.low.y, -outer), vec3(outer, bounds.high.y, outer))


def relief_requirement(radius: float, height: float) -> str | None:
    """Return why a relief is too thick, or None."""
    return "height must be below twice the radius" if height >= 2.0 * radius else None


@func
def plane_right(normal: vec3) -> vec3:
    """Return the x axis of a cutting plane: horizontal; for a horizontal plane, that of space."""
    level = abs(normal.y) > NEARLY_LEVEL
    return normalize(cross(select(level, BACKWARDS, UP), normal))


@func
def sliced(p: vec2, origin: vec3 = ORIGIN, normal: vec3 = FORWARDS) -> vec3:
    """Return the point of space for a point of a plane.

    Seen against the normal, y points upwards as far as the plane allows; on a horizontal plane it
    is -z.
    """
    right = plane_right(normal)
    return origin + p.x * right + p.y * cross(normal, right)


@func
def sliced_bounds(bounds: Bounds, origin: vec3 = ORIGIN, normal: vec3 = FORWARDS) -> Bounds2:
    """Return the box, projected onto the plane."""
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
    """Return the z of one of ``count`` slices through a box, from back to front."""
    share = (float(index) + 0.5) / float(count)
    return bounds.low.z + (bounds.high.z - bounds.low.z) * share


@func
def projected(field: Field3, p: vec2, bounds: Bounds, count: int = 32) -> float:
    """Return the union of many slices along z: a projection onto the plane, from inside.

    Parts that are thinner along z than the distance of two slices may be missed.
    """
    d = UNBOUNDED
    for i in range(count):
        d = min(d, field(vec3(p, height_of_slice(bounds, i, count))))
    return d


@func
def projected_site(field: Field3, p: vec2, bounds: Bounds, count: int = 32) -> vec3:
    """Return the point in the nearest slice."""
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
    """Return the solid's slope if its box is finite along z."""
    return unless_endless(max(abs(bounds.low.z), abs(bounds.high.z)), slope)


@func
def projected_bounds(bounds: Bounds) -> Bounds2:
    """Return the box, seen along z."""
    return Bounds2(bounds.low.xy, bounds.high.xy)


def slices_requirement(count: int) -> str | None:
    """Return why the number of slices is invalid, or None."""
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
    width=deformed_width,
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
