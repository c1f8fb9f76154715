"""Regular and Archimedean solids, defined by the directions of their faces.

Input: a point and the numbers of a shape. Output: the largest distance to a face's plane: exact
inside, a lower bound outside. The directions are given as axes: there is a face at both ends of
each axis.

Source: Ergun Akleman and Jianer Chen, "Generalized Distance Functions", Shape Modeling
International 1999; Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), for the families of axes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from distal.fields.chords import between_faces, in_both
from distal.fields.constants import ROOT_THREE
from distal.fields.guarantees import INSIDE_AND_BOUND, primitive
from distal.fields.solids.axes import cube_of_radius, sphere_bounds
from distal.fields.widths import octahedron_width, round_solid_width
from distal.lang import abs, func, max, vec2, vec3, vec4
from distal.lang.functions import Func

GOLDEN: Final = (1.0 + math.sqrt(5.0)) / 2.0
DIAGONAL: Final = 1.0 / math.sqrt(3.0)
# Components of (0, 1, golden) and (0, 1/golden, golden), normalised. The normals of a dodecahedron
# are the first vector and its cyclic permutations; those of an icosahedron are the second vector,
# its cyclic permutations, and the diagonals.
VERTEX_SHORT: Final = 1.0 / math.sqrt(1.0 + GOLDEN * GOLDEN)
VERTEX_LONG: Final = GOLDEN * VERTEX_SHORT
FACE_SHORT: Final = DIAGONAL / GOLDEN
FACE_LONG: Final = DIAGONAL * GOLDEN

# Distance of the faces for vertices at distance 1.
OCTAHEDRON_FACE: Final = DIAGONAL
ICOSAHEDRON_FACE: Final = math.sqrt((5.0 + 2.0 * math.sqrt(5.0)) / 15.0)
DODECAHEDRON_FACE: Final = ICOSAHEDRON_FACE
TRUNCATED_OCTAHEDRON_HEXAGON: Final = 3.0 / math.sqrt(15.0)
TRUNCATED_OCTAHEDRON_SQUARE: Final = 2.0 / math.sqrt(5.0)
# (0, 1, 3 golden) is a vertex.
FOOTBALL_RADIUS: Final = math.sqrt(1.0 + 9.0 * GOLDEN * GOLDEN)
FOOTBALL_HEXAGON: Final = 3.0 * GOLDEN * FACE_LONG / FOOTBALL_RADIUS
FOOTBALL_PENTAGON: Final = VERTEX_LONG * (1.0 / GOLDEN + 3.0 * GOLDEN) / FOOTBALL_RADIUS
# Extent of the vertices along x, y and z.
DODECAHEDRON_REACH: Final = FACE_LONG
ICOSAHEDRON_REACH: Final = VERTEX_LONG
FOOTBALL_REACH: Final = 3.0 * GOLDEN / FOOTBALL_RADIUS


def equal_faces(name: str, face: float, reach: float) -> Callable[[Func], Func]:
    """Declare the ``@func`` below as a solid whose nearest faces have equal distance.

    Growth: moving all faces outwards by r scales such a solid by 1 + r / face. The vertices then
    leave the box by at most r / face (a side by r * reach / face). Faces that are farther away move
    outwards by less than this scale.

    Args:
        name: Name of the shape.
        face: Distance of the faces, for vertices at distance 1.
        reach: Extent of the vertices along an axis.
    """

    def declare(distance: Func) -> Func:
        bounds = cube_of_radius(f"{distance.name}_bounds", reach)
        growth, side_growth = 1.0 / face, reach / face
        make = primitive(
            name,
            INSIDE_AND_BOUND,
            bounds=bounds,
            growth=growth,
            side_growth=side_growth,
            width=round_solid_width,
        )
        return make(distance)

    return declare


# The largest projection of p on the axes of a family. ``q`` is abs(p): every family has the
# symmetry of the box, so one octant is enough.


@func
def along_diagonals(q: vec3) -> float:
    """Return the largest projection on the octahedron's axes."""
    return (q.x + q.y + q.z) * DIAGONAL


@func
def along_vertices(q: vec3) -> float:
    """Return the largest projection on the axes through an icosahedron's vertices."""
    return max(
        q.y * VERTEX_SHORT + q.z * VERTEX_LONG,
        q.z * VERTEX_SHORT + q.x * VERTEX_LONG,
        q.x * VERTEX_SHORT + q.y * VERTEX_LONG,
    )


@func
def along_faces(q: vec3) -> float:
    """Return the largest projection on the axes through an icosahedron's faces."""
    return max(
        along_diagonals(q),
        q.z * FACE_SHORT + q.y * FACE_LONG,
        q.x * FACE_SHORT + q.z * FACE_LONG,
        q.y * FACE_SHORT + q.x * FACE_LONG,
    )


@func
def octahedron_chord(p: vec3, direction: vec3, radius: float) -> vec2:
    """Return the part of a line inside: between four pairs of faces."""
    # Heights above the pairs of faces, times the square root of 3.
    levels = vec4(p.x + p.y + p.z, p.x + p.y - p.z, p.x - p.y + p.z, p.y + p.z - p.x)
    rises = vec4(
        direction.x + direction.y + direction.z,
        direction.x + direction.y - direction.z,
        direction.x - direction.y + direction.z,
        direction.y + direction.z - direction.x,
    )
    return in_both(
        in_both(between_faces(levels.x, rises.x, radius), between_faces(levels.y, rises.y, radius)),
        in_both(between_faces(levels.z, rises.z, radius), between_faces(levels.w, rises.w, radius)),
    )


@primitive(
    "OctahedronCheap",
    INSIDE_AND_BOUND,
    bounds=sphere_bounds,
    growth=1.0 / OCTAHEDRON_FACE,
    chord=octahedron_chord,
    width=octahedron_width,
)
@func
def octahedron_cheap(p: vec3, radius: float = 1.0) -> float:
    """Octahedron as the maximum of its faces' planes; a lower bound beyond edges.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices, which lie on the axes.

    Source: Inigo Quilez, "Distance functions" (https://iquilezles.org/articles/distfunctions/).

    Measured:
        octahedron_cheap((0.0, 0.0, 0.0), 3.0) = -1.7320508075688772
        octahedron_cheap((2.0, 2.0, 2.0), 3.0) = 1.7320508075688772
        octahedron_cheap((0.0, 4.0, 0.0), 1.0) = 1.7320508075688772
    """
    return along_diagonals(abs(p)) - radius * OCTAHEDRON_FACE


@equal_faces("Dodecahedron", DODECAHEDRON_FACE, DODECAHEDRON_REACH)
@func
def dodecahedron(p: vec3, radius: float = 1.0) -> float:
    """Regular solid of twelve pentagons; a lower bound beyond edges.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999.

    Measured:
        dodecahedron((1.0, 1.0, 1.0), 1.7320508075688772) = 0.0
        dodecahedron((0.0, 0.0, 0.0), 1.0) = -0.7946544722917661
        dodecahedron((0.0, 1.0514622242382672, 1.7013016167040798), 1.0) = 1.2053455277082339
    """
    return along_vertices(abs(p)) - radius * DODECAHEDRON_FACE


@equal_faces("Icosahedron", ICOSAHEDRON_FACE, ICOSAHEDRON_REACH)
@func
def icosahedron(p: vec3, radius: float = 1.0) -> float:
    """Regular solid of twenty triangles; a lower bound beyond edges.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999.

    Measured:
        icosahedron((0.0, 0.5257311121191336, 0.8506508083520399), 1.0) = 0.0
        icosahedron((0.0, 0.0, 0.0), 1.0) = -0.7946544722917661
        icosahedron((2.0, 2.0, 2.0), 1.0) = 2.6694471428459887
    """
    return along_faces(abs(p)) - radius * ICOSAHEDRON_FACE


@primitive(
    "TruncatedOctahedron",
    INSIDE_AND_BOUND,
    bounds=cube_of_radius("truncated_octahedron_bounds", TRUNCATED_OCTAHEDRON_SQUARE),
    growth=ROOT_THREE,
    side_growth=1.0,
    width=round_solid_width,
)
@func
def truncated_octahedron(p: vec3, radius: float = 1.0) -> float:
    """Solid of eight hexagons and six squares with equal edges; copies of it fill space.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999; each family of faces at its
        own distance.

    Measured:
        truncated_octahedron((0.0, 1.0, 2.0), 2.23606797749979) = 0.0
        truncated_octahedron((5.0, 0.0, 0.0), 2.23606797749979) = 3.0
        truncated_octahedron((0.0, 0.0, 0.0), 2.23606797749979) = -1.7320508075688772
    """
    q = abs(p)
    return max(
        along_diagonals(q) - radius * TRUNCATED_OCTAHEDRON_HEXAGON,
        max(q.x, q.y, q.z) - radius * TRUNCATED_OCTAHEDRON_SQUARE,
    )


@equal_faces("TruncatedIcosahedron", FOOTBALL_HEXAGON, FOOTBALL_REACH)
@func
def truncated_icosahedron(p: vec3, radius: float = 1.0) -> float:
    """Football: solid of twenty hexagons and twelve pentagons with equal edges.

    Args:
        p: Point.
        radius: Distance from the centre to the vertices.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999; each family of faces at its
        own distance.

    Measured:
        truncated_icosahedron((0.0, 0.20177410616759883, 0.9794320854864141), 1.0) = 0.0
        truncated_icosahedron((0.0, 0.0, 0.0), 1.0) = -0.9149583817426157
        truncated_icosahedron((2.0, 2.0, 2.0), 1.0) = 2.5491432333951387
    """
    q = abs(p)
    return max(
        along_faces(q) - radius * FOOTBALL_HEXAGON, along_vertices(q) - radius * FOOTBALL_PENTAGON
    )
