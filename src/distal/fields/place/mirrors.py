"""Symmetric solids: mirror images of one part of a shape.

Input: a point. Output: the point at which the shape is evaluated, and the box of all images. Does
not depend on repetition (``repeat``).

A mirror fold never increases the distance of two points, so it keeps every slope. It also keeps a
lower bound, because no image of the shape is nearer to a point than the shape is to the folded
point. Exactness is lost if the shape crosses a mirror plane: the part behind the plane is not
visible, but its distance still counts.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.fields.extents import hull_of, turned
from distal.fields.guarantees import (
    LOWER_BOUND,
    Bounds,
    Bounds2,
    Growth,
    Limit,
    Operator,
    operator,
)
from distal.fields.ordering import larger_first
from distal.lang import (
    Buffer,
    abs,
    atan2,
    cos,
    dot,
    func,
    length,
    mat3,
    max,
    min,
    round,
    sin,
    size,
    vec2,
    vec3,
    vec4,
)


@func
def mirrored(p: vec3, normal: vec3, offset: float) -> vec3:
    """Mirror a point to the side of the plane that ``normal`` points to."""
    return p - normal * (2.0 * min(dot(p, normal) - offset, 0.0))


@func
def mirrored_bounds(bounds: Bounds, normal: vec3, offset: float) -> Bounds:
    """Return the box around the box and its mirror image."""
    image = mat3(
        vec3(1.0, 0.0, 0.0) - 2.0 * normal.x * normal,
        vec3(0.0, 1.0, 0.0) - 2.0 * normal.y * normal,
        vec3(0.0, 0.0, 1.0) - 2.0 * normal.z * normal,
    )
    there = turned(bounds, image)
    shift = normal * (2.0 * offset)
    return hull_of(bounds, Bounds(there.low + shift, there.high + shift))


@func
def mirrored_in_turn(p: vec3, planes: Buffer[vec4]) -> vec3:
    """Mirror a point to the side of each plane that its normal points to, one after the other."""
    q = p
    for i in range(size(planes)):
        q = mirrored(q, planes[i].xyz, planes[i].w)
    return q


@func
def mirrored_in_turn_bounds(bounds: Bounds, planes: Buffer[vec4]) -> Bounds:
    """Return the box around all mirror images; the last plane mirrors the shape itself."""
    around = bounds
    for i in range(size(planes)):
        plane = planes[size(planes) - 1 - i]
        around = mirrored_bounds(around, plane.xyz, plane.w)
    return around


@func
def mirrored_flat_in_turn(p: vec2, planes: Buffer[vec4]) -> vec2:
    """Mirror a point of the plane z = 0 likewise."""
    return mirrored_in_turn(vec3(p, 0.0), planes).xy


@func
def mirrored_flat_in_turn_bounds(bounds: Bounds2, planes: Buffer[vec4]) -> Bounds2:
    """Return the rectangle around all mirror images."""
    box = Bounds(vec3(bounds.low, 0.0), vec3(bounds.high, 0.0))
    around = mirrored_in_turn_bounds(box, planes)
    return Bounds2(around.low.xy, around.high.xy)


@func
def symmetric(p: vec3, x: bool, y: bool, z: bool) -> vec3:
    """Mirror a point to the positive side of the chosen axes."""
    q = p
    if x:
        q.x = abs(q.x)
    if y:
        q.y = abs(q.y)
    if z:
        q.z = abs(q.z)
    return q


@func
def symmetric_bounds(bounds: Bounds, x: bool, y: bool, z: bool) -> Bounds:
    """Return the positive part of the box and its mirror images."""
    both = max(bounds.high, vec3(0.0))
    low, high = bounds.low, bounds.high
    if x:
        low.x, high.x = -both.x, both.x
    if y:
        low.y, high.y = -both.y, both.y
    if z:
        low.z, high.z = -both.z, both.z
    return Bounds(low, high)


@func
def diagonal(p: vec3) -> vec3:
    """Mirror a point to the side of the plane x = z where x is larger."""
    q = larger_first(p.xz)
    return vec3(q.x, p.y, q.y)


@func
def diagonal_bounds(bounds: Bounds) -> Bounds:
    """Return the box around the box and its mirror image."""
    return hull_of(bounds, Bounds(bounds.low.zyx, bounds.high.zyx))


@func
def octant(p: vec3) -> vec3:
    """Mirror a point to the eighth of a turn about the y axis from the x axis to the diagonal."""
    q = larger_first(abs(p.xz))
    return vec3(q.x, p.y, q.y)


@func
def octant_bounds(bounds: Bounds) -> Bounds:
    """Return the box's part in this eighth and its mirror images."""
    side = max(bounds.high.x, 0.0)
    return Bounds(vec3(-side, bounds.low.y, -side), vec3(side, bounds.high.y, side))


@func
def folded(q: vec2, count: int) -> vec2:
    """Mirror a point to the wedge from angle 0 to half of one of ``count`` sectors."""
    sector = 2.0 * PI / float(count)
    angle = atan2(q.y, q.x)
    angle = abs(angle - sector * round(angle / sector))
    return length(q) * vec2(cos(angle), sin(angle))


@func
def kaleidoscope(p: vec3, count: int) -> vec3:
    """Mirror a point to the wedge between the x axis and half of one of ``count`` sectors."""
    q = folded(vec2(p.x, -p.z), count)
    return vec3(q.x, p.y, -q.y)


@func
def outer_radius(bounds: Bounds) -> float:
    """Return the largest distance of a box from the y axis."""
    return length(max(abs(bounds.low.xz), abs(bounds.high.xz)))


@func
def kaleidoscope_bounds(bounds: Bounds) -> Bounds:
    """Return the box of the cylinder about the y axis that contains the box."""
    side = outer_radius(bounds)
    return Bounds(vec3(-side, bounds.low.y, -side), vec3(side, bounds.high.y, side))


def symmetry_requirement(x: bool, y: bool, z: bool) -> str | None:
    """Return why no axis is chosen, or None."""
    return None if x or y or z else "name at least one axis"


def count_requirement(count: int) -> str | None:
    """Return why a number of copies is invalid, or None."""
    return None if count >= 1 else "count must be 1 or more"


MIRROR = operator(
    "mirror",
    point=mirrored,
    keeps=LOWER_BOUND,
    bounds=mirrored_bounds,
    limits={"normal": Limit.UNIT},
    growth=Growth.TURNED,
)
# Many mirrors in a row, which ``scene.lowering.nesting`` makes: authors write each by itself.
MIRRORS = Operator(
    "mirrors",
    point=mirrored_in_turn,
    keeps=LOWER_BOUND,
    bounds=mirrored_in_turn_bounds,
    growth=Growth.TURNED,
)
MIRRORS_FLAT = Operator(
    "flat mirrors",
    point=mirrored_flat_in_turn,
    keeps=LOWER_BOUND,
    bounds=mirrored_flat_in_turn_bounds,
    growth=Growth.TURNED,
)
SYMMETRY = operator(
    "symmetry",
    point=symmetric,
    keeps=LOWER_BOUND,
    bounds=symmetric_bounds,
    requires=symmetry_requirement,
    growth=Growth.KEPT,
)
MIRROR_DIAGONAL = operator(
    "mirror diagonal",
    point=diagonal,
    keeps=LOWER_BOUND,
    bounds=diagonal_bounds,
    growth=Growth.KEPT,
)
MIRROR_OCTANT = operator(
    "mirror octant",
    point=octant,
    keeps=LOWER_BOUND,
    bounds=octant_bounds,
    growth=Growth.CORNERED,
)
KALEIDOSCOPE = operator(
    "kaleidoscope",
    point=kaleidoscope,
    keeps=LOWER_BOUND,
    bounds=kaleidoscope_bounds,
    requires=count_requirement,
    growth=Growth.TURNED,
)
