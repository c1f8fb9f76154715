"""Regular and Archimedean solids from the directions of their faces.

Input: a point and the numbers of a shape. Output: a convex body's largest plane
distance: exact inside, a lower bound outside. The directions come as axes: a face looks both ways
along each.

Source: Ergun Akleman and Jianer Chen, "Generalized Distance Functions", Shape Modeling
International 1999; Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), for the families of axes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from distal.fields.constants import ROOT_THREE
from distal.fields.guarantees import INSIDE_AND_BOUND, primitive
from distal.fields.solids.axes import cube_of_radius, sphere_bounds
from distal.lang import abs, func, max, vec3
from distal.lang.functions import Func

GOLDEN: Final = (1.0 + math.sqrt(5.0)) / 2.0
DIAGONAL: Final = 1.0 / math.sqrt(3.0)
# Of (0, 1, golden) and of (0, 1/golden, golden), normalised: a dodecahedron's faces look along the
# first and its cyclic turns, an icosahedron's along the second and along the diagonals.
VERTEX_SHORT: Final = 1.0 / math.sqrt(1.0 + GOLDEN * GOLDEN)
VERTEX_LONG: Final = GOLDEN * VERTEX_SHORT
FACE_SHORT: Final = DIAGONAL / GOLDEN
FACE_LONG: Final = DIAGONAL * GOLDEN

# Distance of the faces where the vertices are at distance 1.
OCTAHEDRON_FACE: Final = DIAGONAL
ICOSAHEDRON_FACE: Final = math.sqrt((5.0 + 2.0 * math.sqrt(5.0)) / 15.0)
DODECAHEDRON_FACE: Final = ICOSAHEDRON_FACE
TRUNCATED_OCTAHEDRON_HEXAGON: Final = 3.0 / math.sqrt(15.0)
TRUNCATED_OCTAHEDRON_SQUARE: Final = 2.0 / math.sqrt(5.0)
# (0, 1, 3 golden) is a vertex.
FOOTBALL_RADIUS: Final = math.sqrt(1.0 + 9.0 * GOLDEN * GOLDEN)
FOOTBALL_HEXAGON: Final = 3.0 * GOLDEN * FACE_LONG / FOOTBALL_RADIUS
FOOTBALL_PENTAGON: Final = VERTEX_LONG * (1.0 / GOLDEN + 3.0 * GOLDEN) / FOOTBALL_RADIUS
# How far the vertices reach along x, y and z.
DODECAHEDRON_REACH: Final = FACE_LONG
ICOSAHEDRON_REACH: Final = VERTEX_LONG
FOOTBALL_REACH: Final = 3.0 * GOLDEN / FOOTBALL_RADIUS


def equal_faces(name: str, face: float, reach: float) -> Callable[[Func], Func]:
    """Declare the ``@func`` below as a body whose nearest faces are equally far away.

    Growth: to move all faces out by r scales such a body by 1 + r over their distance. The vertices
    then leave the box by at most r times their own distance over it (a side by their reach over
    it). Faces that are farther away move out by less than the scale.

    Args:
        name: The shape's.
        face: Distance of the faces, for vertices at distance 1.
        reach: How far the vertices reach along an axis.
    """

    def declare(distance: Func) -> Func:
        bounds = cube_of_radius(f"{distance.name}_bounds", reach)
        growth, side_growth = 1.0 / face, reach / face
        make = primitive(
            name, INSIDE_AND_BOUND, bounds=bounds, growth=growth, side_growth=side_growth
        )
        return make(distance)

    return declare


# The largest part of p along any axis of a family. ``q`` is abs(p): every family has the symmetry
# of the box, so that one octant is enough.


@func
def along_diagonals(q: vec3) -> float:
    """Along the octahedron's axes."""
    return (q.x + q.y + q.z) * DIAGONAL


@func
def along_vertices(q: vec3) -> float:
    """Along the axes through an icosahedron's vertices."""
    return max(
        q.y * VERTEX_SHORT + q.z * VERTEX_LONG,
        q.z * VERTEX_SHORT + q.x * VERTEX_LONG,
        q.x * VERTEX_SHORT + q.y * VERTEX_LONG,
    )


@func
def along_faces(q: vec3) -> float:
    """Along the axes through an icosahedron's faces."""
    return max(
        along_diagonals(q),
        q.z * FACE_SHORT + q.y * FACE_LONG,
        q.x * FACE_SHORT + q.z * FACE_LONG,
        q.y * FACE_SHORT + q.x * FACE_LONG,
    )


@primitive("OctahedronCheap", INSIDE_AND_BOUND, bounds=sphere_bounds, growth=1.0 / OCTAHEDRON_FACE)
@func
def octahedron_cheap(p: vec3, radius: float = 1.0) -> float:
    """Octahedron by its faces alone; beyond edges less than the distance.

    Args:
        p: Point.
        radius: From the centre to the vertices, which lie on the axes.

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
    """Regular body of twelve pentagons; beyond edges less than the distance.

    Args:
        p: Point.
        radius: From the centre to the vertices.

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
    """Regular body of twenty triangles; beyond edges less than the distance.

    Args:
        p: Point.
        radius: From the centre to the vertices.

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
)
@func
def truncated_octahedron(p: vec3, radius: float = 1.0) -> float:
    """Body of eight hexagons and six squares with equal edges; it fills space.

    Args:
        p: Point.
        radius: From the centre to the vertices.

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
    """Football: twenty hexagons and twelve pentagons with equal edges.

    Args:
        p: Point.
        radius: From the centre to the vertices.

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
