"""Polyhedra with exact distance, and convex solids bounded by any planes.

Input: a point and the numbers of a shape. Output: the distance. The symmetry of the shape is used
to mirror the point to where one known face, with one known edge, is the nearest.
"""

from __future__ import annotations

import math
from typing import Any, Final

from distal.fields.chords import below_face, in_both, in_box
from distal.fields.constants import HALF_ROOT, ROOT_THREE
from distal.fields.guarantees import EXACT, INSIDE_AND_BOUND, Bounds, primitive
from distal.fields.ordering import larger_first, largest_first
from distal.fields.solids.axes import cube_of_radius, sphere_bounds
from distal.fields.solids.boxes import UNIT_CUBE, box_bounds
from distal.fields.solids.regular import DIAGONAL, octahedron_chord
from distal.fields.widths import octahedron_width, pyramid_width, tetrahedron_width
from distal.lang import (
    Buffer,
    abs,
    clamp,
    dot,
    func,
    length,
    max,
    min,
    select,
    sqrt,
    vec2,
    vec3,
    vec4,
)
from distal.lang import size as count_of

CUT_CORNERS: Final = Buffer(
    [
        vec4(x * DIAGONAL, y * DIAGONAL, z * DIAGONAL, 0.6)
        for x in (-1.0, 1.0)
        for y in (-1.0, 1.0)
        for z in (-1.0, 1.0)
    ]
)


@func
def face_edge(height: float, past_edge: float, past_end: float) -> float:
    """Return the distance to a convex solid near one face and one edge of this face.

    Args:
        height: Distance above the face's plane.
        past_edge: Distance beyond the edge, in the face's plane.
        past_end: Distance beyond the edge's end, along the edge.
    """
    return select(past_edge > 0.0, length(vec3(height, past_edge, max(past_end, 0.0))), height)


@primitive(
    "Octahedron",
    EXACT,
    bounds=sphere_bounds,
    chord=octahedron_chord,
    width=octahedron_width,
)
@func
def octahedron(p: vec3, radius: float = 1.0) -> float:
    """Regular octahedron with its vertices on the axes.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/);
        by symmetry.

    Measured:
        octahedron((0.0, 0.0, 0.0), 3.0) = -1.7320508075688772
        octahedron((2.0, 2.0, 2.0), 3.0) = 1.7320508075688772
        octahedron((0.0, 4.0, 0.0), 1.0) = 3.0
    """
    # The nearest edge belongs to the two largest components.
    q = largest_first(abs(p))
    return face_edge(
        (q.x + q.y + q.z - radius) * DIAGONAL,
        (q.x + q.y - 2.0 * q.z - radius) * (DIAGONAL * HALF_ROOT),
        (q.x - q.y - radius) * HALF_ROOT,
    )


@primitive(
    "Tetrahedron",
    EXACT,
    bounds=cube_of_radius("tetrahedron_bounds", DIAGONAL),
    width=tetrahedron_width,
)
@func
def tetrahedron(p: vec3, radius: float = 1.0) -> float:
    """Regular tetrahedron on alternate corners of a cube, one of them along (1, 1, 1).

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: derived from the symmetry: mirrors lead to x >= y >= |z|, where the face along
        (1, 1, -1) and its edge through (x, 0, 0) along (0, 1, 1) are nearest.

    Measured:
        tetrahedron((0.0, 0.0, 0.0), 3.0) = -1.0
        tetrahedron((2.0, 0.0, 0.0), 1.7320508075688772) = 1.0
        tetrahedron((3.0, 3.0, 3.0), 1.7320508075688772) = 3.4641016151377544
    """
    # An even number of signs may change: the two larger components become positive.
    q = largest_first(abs(p))
    z = select(p.x * p.y * p.z < 0.0, -q.z, q.z)
    corner = radius * DIAGONAL
    return face_edge(
        (q.x + q.y - z - corner) * DIAGONAL,
        (2.0 * (q.x - corner) - q.y + z) * (DIAGONAL * HALF_ROOT),
        (q.y + z) * HALF_ROOT - corner / HALF_ROOT,
    )


@func
def pyramid_bounds(size: float, height: float) -> Bounds:
    """Return the box of the base and the tip."""
    reach = vec3(0.5 * size, 0.5 * height, 0.5 * size)
    return Bounds(-reach, reach)


@primitive(
    "Pyramid",
    EXACT,
    bounds=pyramid_bounds,
    width=pyramid_width,
)
@func
def pyramid(p: vec3, size: float = 1.0, height: float = 1.0) -> float:
    """Upright pyramid with a square base.

    Args:
        p: Point.
        size: Side length of the base.
        height: Full height; the origin is at half of it.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/);
        worked out anew in the plane of a side.

    Measured:
        pyramid((0.0, 4.0, 0.0), 2.0, 2.0) = 3.0
        pyramid((3.0, -4.0, 7.0), 2.0, 2.0) = 7.0
        pyramid((0.0, -0.75, 0.0), 2.0, 2.0) = -0.25
    """
    half = 0.5 * size
    # The nearest side faces +x; z runs along its base.
    q = larger_first(abs(p.xz))
    x = q.x - half
    z = q.y
    y = p.y + 0.5 * height
    # Coordinates up along the side's plane, and above the plane.
    slope_length = length(vec2(half, height))
    up = (y * height - x * half) / slope_length
    above = (x * height + y * half) / slope_length
    # The vector from the nearest point of the slanted edge, from (half, 0) to the tip.
    edge = vec2(-half, slope_length)
    beside = vec2(z - half, up)
    from_edge = beside - edge * clamp(dot(beside, edge) / dot(edge, edge), 0.0, 1.0)
    past_edge = beside.x * edge.y > beside.y * edge.x
    from_side = select(past_edge, from_edge, vec2(max(beside.x, 0.0), min(up, 0.0)))
    base = vec3(max(x, 0.0), max(z - half, 0.0), y)
    square = min(dot(from_side, from_side) + above * above, dot(base, base))
    return select(max(above, -y) < 0.0, max(above, -y), sqrt(square))


def convex_polyhedron_requires(planes: Any) -> str | None:
    """Return why a plane's normal is not of length 1, or None."""
    rows: Any = getattr(planes, "data", ()) if isinstance(planes, Buffer) else planes
    for x, y, z, _ in rows:
        if math.fabs(x * x + y * y + z * z - 1.0) > 1e-4:
            return "the first three numbers of each of the planes must be a vector of length 1"
    return None


@func
def convex_polyhedron_chord(p: vec3, direction: vec3, planes: Buffer[vec4], size: vec3) -> vec2:
    """Return the part of a line below all planes."""
    chord = in_box(p, direction, 0.5 * size)
    for i in range(count_of(planes)):
        plane = planes[i]
        below = below_face(dot(p, plane.xyz) - plane.w, dot(direction, plane.xyz))
        chord = in_both(chord, below)
    return chord


@primitive(
    "ConvexPolyhedron",
    INSIDE_AND_BOUND,
    chord=convex_polyhedron_chord,
    bounds=box_bounds,
    requires=convex_polyhedron_requires,
    growth=ROOT_THREE,
    side_growth=1.0,
)
@func
def convex_polyhedron(p: vec3, planes: Buffer[vec4] = CUT_CORNERS, size: vec3 = UNIT_CUBE) -> float:
    """Box cut by planes; a lower bound beyond edges.

    Args:
        p: Point.
        planes: For each plane the outward normal of length 1 and, as fourth number, the distance of
            the plane from the origin along the normal.
        size: Full size of the box. If the planes enclose a smaller solid, it only serves as the
            bounding box.

    Source: the largest of the planes' distances; Akleman and Chen, "Generalized Distance
        Functions", 1999.

    Measured:
        convex_polyhedron((3.0, 0.0, 0.0), [(1.0, 0.0, 0.0, 0.5)], (4.0, 4.0, 4.0)) = 2.5
        convex_polyhedron((0.0, 0.0, 0.0), [(0.6, 0.8, 0.0, 1.0)], (4.0, 4.0, 4.0)) = -1.0
        convex_polyhedron((0.0, 5.0, 0.0), [(0.6, 0.8, 0.0, 1.0)], (4.0, 4.0, 4.0)) = 3.0
    """
    q = abs(p) - 0.5 * size
    outside = max(q.x, q.y, q.z)
    for i in range(count_of(planes)):
        plane = planes[i]
        outside = max(outside, dot(p, plane.xyz) - plane.w)
    return outside
