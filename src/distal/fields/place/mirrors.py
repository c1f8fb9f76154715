"""Symmetric solids: part of a shape seen again in mirrors.

Input: a point. Output: the point to ask the shape at, and the box of all images.
Knows nothing of repetition (``repeat``).

A fold never moves two points apart: it keeps every slope, and a lower bound stays one, since no
image of the shape is nearer to a point than the shape is to the point of evaluation. Exactness is
lost where the shape reaches through a mirror: what lies behind it is not seen, but still measured.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.fields.extents import hull_of, turned
from distal.fields.guarantees import LOWER_BOUND, Bounds, Growth, Limit, operator
from distal.lang import abs, atan2, cos, dot, func, length, mat3, max, min, round, sin, vec2, vec3


@func
def mirrored(p: vec3, normal: vec3, offset: float) -> vec3:
    """The half of space that ``normal`` points into, seen in the other half too."""
    return p - normal * (2.0 * min(dot(p, normal) - offset, 0.0))


@func
def mirrored_bounds(bounds: Bounds, normal: vec3, offset: float) -> Bounds:
    """The box and its mirror image."""
    image = mat3(
        vec3(1.0, 0.0, 0.0) - 2.0 * normal.x * normal,
        vec3(0.0, 1.0, 0.0) - 2.0 * normal.y * normal,
        vec3(0.0, 0.0, 1.0) - 2.0 * normal.z * normal,
    )
    there = turned(bounds, image)
    shift = normal * (2.0 * offset)
    return hull_of(bounds, Bounds(there.low + shift, there.high + shift))


@func
def symmetric(p: vec3, x: bool, y: bool, z: bool) -> vec3:
    """The positive side of the chosen axes, seen on both."""
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
    """The positive part of the box, on both sides."""
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
    """The side of the plane x = z where x is larger, seen on both."""
    return vec3(max(p.x, p.z), p.y, min(p.x, p.z))


@func
def diagonal_bounds(bounds: Bounds) -> Bounds:
    """The box and its mirror image."""
    return hull_of(bounds, Bounds(bounds.low.zyx, bounds.high.zyx))


@func
def octant(p: vec3) -> vec3:
    """An eighth of the turn about the y axis, from the x axis to the diagonal, seen in all."""
    q = abs(p.xz)
    return vec3(max(q.x, q.y), p.y, min(q.x, q.y))


@func
def octant_bounds(bounds: Bounds) -> Bounds:
    """What the box shows of the eighth, on all sides."""
    side = max(bounds.high.x, 0.0)
    return Bounds(vec3(-side, bounds.low.y, -side), vec3(side, bounds.high.y, side))


@func
def folded(q: vec2, count: int) -> vec2:
    """A wedge from angle 0 to half a sector of ``count``, seen in all, every other one mirrored."""
    sector = 2.0 * PI / float(count)
    angle = atan2(q.y, q.x)
    angle = abs(angle - sector * round(angle / sector))
    return length(q) * vec2(cos(angle), sin(angle))


@func
def kaleidoscope(p: vec3, count: int) -> vec3:
    """``count`` mirrors about the y axis show what is between the x axis and half a sector."""
    q = folded(vec2(p.x, -p.z), count)
    return vec3(q.x, p.y, -q.y)


@func
def outer_radius(bounds: Bounds) -> float:
    """How far out a box goes from the y axis."""
    return length(max(abs(bounds.low.xz), abs(bounds.high.xz)))


@func
def kaleidoscope_bounds(bounds: Bounds) -> Bounds:
    """As far out as the box goes, all around."""
    side = outer_radius(bounds)
    return Bounds(vec3(-side, bounds.low.y, -side), vec3(side, bounds.high.y, side))


def symmetry_requirement(x: bool, y: bool, z: bool) -> str | None:
    """Why nothing would be mirrored, or None."""
    return None if x or y or z else "name at least one axis"


def count_requirement(count: int) -> str | None:
    """Why a number of copies makes no sense, or None."""
    return None if count >= 1 else "count must be 1 or more"


MIRROR = operator(
    "mirror",
    point=mirrored,
    keeps=LOWER_BOUND,
    bounds=mirrored_bounds,
    limits={"normal": Limit.UNIT},
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
