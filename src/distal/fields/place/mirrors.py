"""Mirror images of solids, and symmetric solids: images of one part of a shape beside this part.

Input: a point. Output: the point at which the shape is evaluated, and the box of the image or of
all images. Does not depend on repetition (``repeat``).

A reflection is a rigid move: it keeps every distance.

A fold at a plane (symmetry) never increases the distance of two points, so it keeps every slope. It
also keeps a lower bound, because no image of the shape is nearer to a point than the shape is to
the folded point. Exactness is lost if the shape crosses the plane: the part behind it is not
visible, but its distance still counts.
"""

from __future__ import annotations

from distal.fields.constants import PI
from distal.fields.extents import hull_of, turned
from distal.fields.guarantees import (
    EXACT,
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

# Reflections


@func
def reflected(p: vec3, x: bool, y: bool, z: bool) -> vec3:
    """Return the point before a reflection along the chosen axes."""
    q = p
    if x:
        q.x = -q.x
    if y:
        q.y = -q.y
    if z:
        q.z = -q.z
    return q


@func
def reflected_bounds(bounds: Bounds, x: bool, y: bool, z: bool) -> Bounds:
    """Return the box of the mirror image."""
    low, high = bounds.low, bounds.high
    if x:
        low.x, high.x = -bounds.high.x, -bounds.low.x
    if y:
        low.y, high.y = -bounds.high.y, -bounds.low.y
    if z:
        low.z, high.z = -bounds.high.z, -bounds.low.z
    return Bounds(low, high)


@func
def reflected_across(p: vec3, across: vec3, offset: float) -> vec3:
    """Return the point before a reflection in the plane with the normal ``across``.

    The division makes it rigid for a normal whose length is 1 but for the rounding of its digits.
    """
    return p - across * (2.0 / dot(across, across) * (dot(p, across) - offset))


@func
def reflected_direction(p: vec3, across: vec3) -> vec3:
    """Return the direction before a reflection in a plane."""
    return reflected_across(p, across, 0.0)


@func
def reflection_matrix(across: vec3) -> mat3:
    """Return the matrix of a reflection in the plane through the origin (Householder)."""
    twice = across * (2.0 / dot(across, across))
    return mat3(
        vec3(1.0, 0.0, 0.0) - across.x * twice,
        vec3(0.0, 1.0, 0.0) - across.y * twice,
        vec3(0.0, 0.0, 1.0) - across.z * twice,
    )


@func
def reflected_across_bounds(bounds: Bounds, across: vec3, offset: float) -> Bounds:
    """Return the box around the mirror image of the box."""
    there = turned(bounds, reflection_matrix(across))
    shift = across * (2.0 * offset / dot(across, across))
    return Bounds(there.low + shift, there.high + shift)


# Folds


@func
def symmetric_across(p: vec3, across: vec3, offset: float) -> vec3:
    """Mirror a point to the side of the plane that its normal ``across`` points to."""
    return p - across * (2.0 * min(dot(p, across) - offset, 0.0))


@func
def symmetric_across_bounds(bounds: Bounds, across: vec3, offset: float) -> Bounds:
    """Return the box around the box and its mirror image."""
    return hull_of(bounds, reflected_across_bounds(bounds, across, offset))


@func
def symmetric_in_turn(p: vec3, planes: Buffer[vec4]) -> vec3:
    """Mirror a point to the side of each plane that its normal points to, one after the other."""
    q = p
    for i in range(size(planes)):
        q = symmetric_across(q, planes[i].xyz, planes[i].w)
    return q


@func
def symmetric_in_turn_bounds(bounds: Bounds, planes: Buffer[vec4]) -> Bounds:
    """Return the box around all mirror images; the last plane mirrors the shape itself."""
    around = bounds
    for i in range(size(planes)):
        plane = planes[size(planes) - 1 - i]
        around = symmetric_across_bounds(around, plane.xyz, plane.w)
    return around


@func
def symmetric_flat_in_turn(p: vec2, planes: Buffer[vec4]) -> vec2:
    """Mirror a point of the plane z = 0 likewise."""
    return symmetric_in_turn(vec3(p, 0.0), planes).xy


@func
def symmetric_flat_in_turn_bounds(bounds: Bounds2, planes: Buffer[vec4]) -> Bounds2:
    """Return the rectangle around all mirror images."""
    box = Bounds(vec3(bounds.low, 0.0), vec3(bounds.high, 0.0))
    around = symmetric_in_turn_bounds(box, planes)
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


def axes_requirement(x: bool, y: bool, z: bool) -> str | None:
    """Return why no axis is chosen, or None."""
    return None if x or y or z else "name at least one axis"


def count_requirement(count: int) -> str | None:
    """Return why a number of copies is invalid, or None."""
    return None if count >= 1 else "count must be 1 or more"


REFLECT = operator(
    "mirror",
    point=reflected,
    keeps=EXACT,
    linear=True,
    turn=reflected,
    bounds=reflected_bounds,
    requires=axes_requirement,
    growth=Growth.KEPT,
)
REFLECT_ACROSS = operator(
    "mirror across",
    point=reflected_across,
    keeps=EXACT,
    linear=True,
    turn=reflected_direction,
    bounds=reflected_across_bounds,
    limits={"across": Limit.UNIT},
    growth=Growth.TURNED,
)
SYMMETRY = operator(
    "symmetry",
    point=symmetric,
    keeps=LOWER_BOUND,
    bounds=symmetric_bounds,
    requires=axes_requirement,
    growth=Growth.KEPT,
)
SYMMETRY_ACROSS = operator(
    "symmetry across",
    point=symmetric_across,
    keeps=LOWER_BOUND,
    bounds=symmetric_across_bounds,
    limits={"across": Limit.UNIT},
    growth=Growth.TURNED,
)
# Many planes in a row, which ``scene.lowering.nesting`` makes: authors write each by itself.
SYMMETRY_PLANES = Operator(
    "symmetry planes",
    point=symmetric_in_turn,
    keeps=LOWER_BOUND,
    bounds=symmetric_in_turn_bounds,
    growth=Growth.TURNED,
)
SYMMETRY_PLANES_FLAT = Operator(
    "flat symmetry planes",
    point=symmetric_flat_in_turn,
    keeps=LOWER_BOUND,
    bounds=symmetric_flat_in_turn_bounds,
    growth=Growth.TURNED,
)
SYMMETRY_DIAGONAL = operator(
    "symmetry diagonal",
    point=diagonal,
    keeps=LOWER_BOUND,
    bounds=diagonal_bounds,
    growth=Growth.KEPT,
)
SYMMETRY_OCTANT = operator(
    "symmetry octant",
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
