"""Planes, half spaces, slabs and wedges; triangles and quads without thickness.

Input: a point and the numbers of a shape. Output: the signed distance; for faces, which have no
inside, the unsigned distance.
"""

from __future__ import annotations

from typing import Final

from distal.fields.chords import below_face, between_faces
from distal.fields.constants import TINY
from distal.fields.guarantees import EXACT, EXACT_OUTSIDE, UNBOUNDED, Bounds, primitive
from distal.fields.solids.axes import below_a_turn
from distal.fields.solids.cones import inside_cone
from distal.fields.solids.cylinders import to_segment
from distal.fields.widths import thickness_width
from distal.lang import abs, cross, dot, func, length, max, min, select, vec2, vec3

UP: Final = vec3(0.0, 1.0, 0.0)
CORNER_A: Final = vec3(-0.5, 0.0, 0.5)
CORNER_B: Final = vec3(0.5, 0.0, 0.5)
CORNER_C: Final = vec3(0.5, 0.0, -0.5)
CORNER_D: Final = vec3(-0.5, 0.0, -0.5)


@func
def plane_chord(p: vec3, direction: vec3, y: float) -> vec2:
    """Return the part of a line below the plane."""
    return below_face(p.y - y, direction.y)


@func
def plane_bounds(y: float) -> Bounds:
    """Return the box of the ground, which ends only above."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED, y, UNBOUNDED))


@primitive(
    "Plane",
    EXACT,
    bounds=plane_bounds,
    linear=True,
    chord=plane_chord,
    width=UNBOUNDED,
    along="xyz",
)
@func
def plane(p: vec3, y: float = 0.0) -> float:
    """Ground: the half space below a horizontal plane.

    Args:
        p: Point.
        y: Height of the plane.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        plane((5.0, 3.0, -2.0), 1.0) = 2.0
        plane((0.0, 0.0, 0.0), 1.0) = -1.0
        plane((4.0, -1.0, 0.0), -1.0) = 0.0
    """
    return p.y - y


@func
def half_space_chord(p: vec3, direction: vec3, normal: vec3, distance: float) -> vec2:
    """Return the part of a line below the plane."""
    return below_face(dot(p, normal) - distance, dot(direction, normal))


@func
def half_space_bounds(normal: vec3, distance: float) -> Bounds:
    """Return the box of the half space, which ends on one side if its normal is along an axis."""
    far = vec3(UNBOUNDED)
    return Bounds(
        select(normal < vec3(-1.0 + TINY), vec3(-distance), -far),
        select(normal > vec3(1.0 - TINY), vec3(distance), far),
    )


@primitive(
    "HalfSpace",
    EXACT,
    bounds=half_space_bounds,
    linear=True,
    chord=half_space_chord,
    width=UNBOUNDED,
)
@func
def half_space(p: vec3, normal: vec3 = UP, distance: float = 0.0) -> float:
    """Half space on one side of a plane.

    Args:
        p: Point.
        normal: Normal of the plane that points outwards, of length 1.
        distance: Distance of the plane from the origin along the normal.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        half_space((5.0, 0.0, 0.0), (0.6, 0.8, 0.0), 1.0) = 2.0
        half_space((0.0, 0.0, 7.0), (0.6, 0.8, 0.0), 1.0) = -1.0
        half_space((0.6, 0.8, 3.0), (0.6, 0.8, 0.0), 1.0) = 0.0
    """
    return dot(p, normal) - distance


@func
def slab_bounds(thickness: float) -> Bounds:
    """Return the box of the slab, which ends only above and below."""
    reach = vec3(UNBOUNDED, 0.5 * thickness, UNBOUNDED)
    return Bounds(-reach, reach)


@func
def slab_chord(p: vec3, direction: vec3, thickness: float) -> vec2:
    """Return the part of a line between the two planes."""
    return between_faces(p.y, direction.y, 0.5 * thickness)


@primitive(
    "Slab",
    EXACT,
    bounds=slab_bounds,
    chord=slab_chord,
    width=thickness_width,
    along="xyz",
)
@func
def slab(p: vec3, thickness: float = 0.5) -> float:
    """Infinite horizontal slab, centred at y = 0.

    Args:
        p: Point.
        thickness: Full thickness.

    Source: the two planes.

    Measured:
        slab((1.0, 3.0, 1.0), 2.0) = 2.0
        slab((9.0, 0.25, 0.0), 2.0) = -0.75
        slab((0.0, -1.0, 7.0), 2.0) = 0.0
    """
    return abs(p.y) - 0.5 * thickness


@primitive(
    "Wedge",
    EXACT,
    requires=below_a_turn,
    width=UNBOUNDED,
)
@func
def wedge(p: vec3, *, opening: float = 1.0) -> float:
    """Infinite wedge between two planes that meet in the z axis; it opens downwards.

    Args:
        p: Point.
        opening: Whole angle between the planes in radians, below 2 pi.

    Source: the infinite cone of Inigo Quilez, "Distance functions"
        (https://iquilezles.org/articles/distfunctions/), in the plane.

    Measured:
        wedge((0.0, 5.0, 9.0), opening=1.0) = 5.0
        wedge((0.0, -2.0, 3.0), opening=1.0471975511965976) = -1.0
        wedge((-3.0, -1.0, 0.0), opening=1.5707963267948966) = 1.4142135623730951
    """
    return inside_cone(vec2(abs(p.x), p.y), 0.5 * opening)


@func
def beside_edge(p: vec3, start: vec3, end: vec3, normal: vec3) -> bool:
    """Return whether p lies outside the plane through an edge along the normal.

    The edges are counterclockwise around the normal. True if the normal is zero: for corners on one
    line only the edges count.
    """
    return dot(cross(end - start, normal), p - start) >= 0.0


@func
def nearer(u: vec3, v: vec3) -> vec3:
    """Return the shorter of two vectors."""
    return select(dot(v, v) < dot(u, u), v, u)


@func
def triangle_sheet_bounds(a: vec3, b: vec3, c: vec3) -> Bounds:
    """Return the box of the corners."""
    return Bounds(min(a, b, c), max(a, b, c))


@primitive(
    "TriangleSheet",
    EXACT_OUTSIDE,
    bounds=triangle_sheet_bounds,
    signed=False,
    width=0.0,
)
@func
def triangle_sheet(p: vec3, a: vec3 = CORNER_A, b: vec3 = CORNER_B, c: vec3 = CORNER_C) -> float:
    """Flat triangle without thickness.

    Args:
        p: Point.
        a: First corner.
        b: Second corner.
        c: Third corner.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        triangle_sheet((0.25, 2.0, 0.25), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)) = 2.0
        triangle_sheet((3.0, 3.0, -6.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)) = 7.0
        triangle_sheet((0.5, 3.0, -4.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)) = 5.0
    """
    normal = cross(b - a, c - a)
    outside = (
        beside_edge(p, a, b, normal) or beside_edge(p, b, c, normal) or beside_edge(p, c, a, normal)
    )
    above = dot(normal, p - a) / max(length(normal), TINY)
    edges = nearer(nearer(to_segment(p, a, b), to_segment(p, b, c)), to_segment(p, c, a))
    return select(outside, length(edges), abs(above))


@func
def quad_bounds(a: vec3, b: vec3, c: vec3, d: vec3) -> Bounds:
    """Return the box of the corners."""
    return Bounds(min(a, b, c, d), max(a, b, c, d))


@primitive(
    "Quad",
    EXACT_OUTSIDE,
    bounds=quad_bounds,
    signed=False,
    width=0.0,
)
@func
def quad(
    p: vec3,
    a: vec3 = CORNER_A,
    b: vec3 = CORNER_B,
    c: vec3 = CORNER_C,
    d: vec3 = CORNER_D,
) -> float:
    """Face with four corners, without thickness: the triangles a, b, c and a, c, d.

    If the corners lie in one plane and form a convex outline, so does the face; other corners are
    allowed.

    Args:
        p: Point.
        a: First corner.
        b: The next corner around the face.
        c: The corner opposite ``a``; the two triangles share the edge between them.
        d: The corner opposite ``b``.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        quad((0.0, 2.0, 0.25)) = 2.0
        quad((2.5, 3.0, 6.5)) = 7.0
        quad((0.25, 3.0, -4.5)) = 5.0
    """
    return min(triangle_sheet(p, a, b, c), triangle_sheet(p, a, c, d))
