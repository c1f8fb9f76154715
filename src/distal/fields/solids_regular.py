"""Regular and Archimedean solids from the directions of their faces, sharp and smoothed.

What flows in: a point and the numbers of a shape. What flows out: the distance: exact inside, a
lower bound outside (a convex body's largest plane distance); for the smooth forms a bound with
slope 1. The directions come as axes: a face looks both ways along each.

Source: Ergun Akleman and Jianer Chen, "Generalized Distance Functions", Shape Modeling
International 1999; Mercury, "hg_sdf" (https://mercury.sexy/hg_sdf/), for the families of axes.
"""

from __future__ import annotations

import math
from typing import Final

from distal.fields.claims import LOWER_BOUND, Bounds, Limit, primitive
from distal.fields.solids_axes import TINY
from distal.fields.solids_boxes import CONVEX_BOUND
from distal.lang import abs, func, max, pow, vec3

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

RADIUS: Final = {"radius": Limit.POSITIVE}


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


@func
def octahedron_bounds(radius: float) -> Bounds:
    """The box of the vertices."""
    return Bounds(vec3(-radius), vec3(radius))


@primitive("OctahedronCheap", CONVEX_BOUND, bounds=octahedron_bounds, limits=RADIUS)
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


@func
def dodecahedron_bounds(radius: float) -> Bounds:
    """The box of the vertices."""
    return Bounds(vec3(-radius * DODECAHEDRON_REACH), vec3(radius * DODECAHEDRON_REACH))


@primitive("Dodecahedron", CONVEX_BOUND, bounds=dodecahedron_bounds, limits=RADIUS)
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


@func
def icosahedron_bounds(radius: float) -> Bounds:
    """The box of the vertices."""
    return Bounds(vec3(-radius * ICOSAHEDRON_REACH), vec3(radius * ICOSAHEDRON_REACH))


@primitive("Icosahedron", CONVEX_BOUND, bounds=icosahedron_bounds, limits=RADIUS)
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


@func
def truncated_octahedron_bounds(radius: float) -> Bounds:
    """The box of the squares."""
    reach = radius * TRUNCATED_OCTAHEDRON_SQUARE
    return Bounds(vec3(-reach), vec3(reach))


@primitive("TruncatedOctahedron", CONVEX_BOUND, bounds=truncated_octahedron_bounds, limits=RADIUS)
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


@func
def truncated_icosahedron_bounds(radius: float) -> Bounds:
    """The box of the vertices."""
    return Bounds(vec3(-radius * FOOTBALL_REACH), vec3(radius * FOOTBALL_REACH))


@primitive("TruncatedIcosahedron", CONVEX_BOUND, bounds=truncated_icosahedron_bounds, limits=RADIUS)
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


# The smooth forms take, in place of the largest part along an axis, the sum of all parts to a power
# e, then its e-th root. It grows by at most (weight / 3)^(1/e) for each unit of distance, where
# weight is the sum of 1 / distance^2 of the faces, of which the nearest is at distance 1: the axes
# of each family point evenly in all directions, so for e = 2 it is exactly sqrt(weight / 3) times
# the distance from the centre, a ball; and |v|_e^e <= |v|_2^2 where no part is above 1.


@func
def powers_of_diagonals(p: vec3, exponent: float) -> float:
    """Over the octahedron's four axes."""
    return (
        pow(abs(p.x + p.y + p.z) * DIAGONAL, exponent)
        + pow(abs(p.x + p.y - p.z) * DIAGONAL, exponent)
        + pow(abs(p.x - p.y + p.z) * DIAGONAL, exponent)
        + pow(abs(p.x - p.y - p.z) * DIAGONAL, exponent)
    )


@func
def powers_of_pairs(p: vec3, short: float, long: float, exponent: float) -> float:
    """Over (0, short, long) and (0, short, -long), and their cyclic turns."""
    return (
        pow(abs(p.y * short + p.z * long), exponent)
        + pow(abs(p.y * short - p.z * long), exponent)
        + pow(abs(p.z * short + p.x * long), exponent)
        + pow(abs(p.z * short - p.x * long), exponent)
        + pow(abs(p.x * short + p.y * long), exponent)
        + pow(abs(p.x * short - p.y * long), exponent)
    )


@func
def powers_of_faces(p: vec3, exponent: float) -> float:
    """Over the ten axes through an icosahedron's faces."""
    # Those of (0, long, short): the dodecahedron's vertices turn the other way round.
    return powers_of_diagonals(p, exponent) + powers_of_pairs(p, FACE_LONG, FACE_SHORT, exponent)


@func
def smooth_bounds(radius: float, exponent: float, weight: float, reach: float) -> Bounds:
    """The box of the sharp body that holds the smooth one.

    Its faces are at distance ``radius`` times the growth; ``reach`` is how far its vertices reach
    along an axis where its nearest faces are at distance 1.
    """
    side = radius * pow(weight / 3.0, 1.0 / exponent) * reach
    return Bounds(vec3(-side), vec3(side))


@func
def largest_part(p: vec3) -> float:
    """Scale that keeps powers from overflowing."""
    q = abs(p)
    return max(q.x, q.y, q.z, TINY)


@func
def smoothed(total: float, scale: float, radius: float, exponent: float, weight: float) -> float:
    """The field from the sum of the powers of p / scale."""
    return scale * pow(total * (3.0 / weight), 1.0 / exponent) - radius


def smooth_requires(exponent: float) -> str | None:
    """At 2 it is a ball; below, no longer convex in every direction alike."""
    return None if exponent >= 2.0 else "exponent must be 2 or more"


OCTAHEDRON_WEIGHT: Final = 4.0
DODECAHEDRON_WEIGHT: Final = 6.0
ICOSAHEDRON_WEIGHT: Final = 10.0
# The second family of faces is farther away than the first by this factor.
SQUARE_RATIO: Final = TRUNCATED_OCTAHEDRON_SQUARE / TRUNCATED_OCTAHEDRON_HEXAGON
PENTAGON_RATIO: Final = FOOTBALL_PENTAGON / FOOTBALL_HEXAGON
TRUNCATED_OCTAHEDRON_WEIGHT: Final = 4.0 + 3.0 / SQUARE_RATIO**2
FOOTBALL_WEIGHT: Final = 10.0 + 6.0 / PENTAGON_RATIO**2


@func
def smooth_octahedron_bounds(radius: float, exponent: float) -> Bounds:
    """The box of the sharp one around it."""
    return smooth_bounds(radius, exponent, OCTAHEDRON_WEIGHT, 1.0 / OCTAHEDRON_FACE)


@primitive(
    "SmoothOctahedron",
    LOWER_BOUND,
    bounds=smooth_octahedron_bounds,
    limits=RADIUS,
    requires=smooth_requires,
)
@func
def smooth_octahedron(p: vec3, radius: float = 0.6, exponent: float = 12.0) -> float:
    """Between a ball and an octahedron; a bound with slope 1.

    Args:
        p: Point.
        radius: Of the ball for exponent 2; the largest ball inside an octahedron for a large one.
        exponent: 2 or more; the larger, the sharper.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_octahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_octahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_octahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.2795070569547775
    """
    scale = largest_part(p)
    total = powers_of_diagonals(p / scale, exponent)
    return smoothed(total, scale, radius, exponent, OCTAHEDRON_WEIGHT)


@func
def smooth_dodecahedron_bounds(radius: float, exponent: float) -> Bounds:
    """The box of the sharp one around it."""
    reach = DODECAHEDRON_REACH / DODECAHEDRON_FACE
    return smooth_bounds(radius, exponent, DODECAHEDRON_WEIGHT, reach)


@primitive(
    "SmoothDodecahedron",
    LOWER_BOUND,
    bounds=smooth_dodecahedron_bounds,
    limits=RADIUS,
    requires=smooth_requires,
)
@func
def smooth_dodecahedron(p: vec3, radius: float = 0.8, exponent: float = 24.0) -> float:
    """Between a ball and a dodecahedron; a bound with slope 1.

    Args:
        p: Point.
        radius: Of the ball for exponent 2; the largest ball inside a dodecahedron for a large one.
        exponent: 2 or more; the larger, the sharper.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_dodecahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_dodecahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_dodecahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.6403352103801803
    """
    scale = largest_part(p)
    total = powers_of_pairs(p / scale, VERTEX_SHORT, VERTEX_LONG, exponent)
    return smoothed(total, scale, radius, exponent, DODECAHEDRON_WEIGHT)


@func
def smooth_icosahedron_bounds(radius: float, exponent: float) -> Bounds:
    """The box of the sharp one around it."""
    reach = ICOSAHEDRON_REACH / ICOSAHEDRON_FACE
    return smooth_bounds(radius, exponent, ICOSAHEDRON_WEIGHT, reach)


@primitive(
    "SmoothIcosahedron",
    LOWER_BOUND,
    bounds=smooth_icosahedron_bounds,
    limits=RADIUS,
    requires=smooth_requires,
)
@func
def smooth_icosahedron(p: vec3, radius: float = 0.8, exponent: float = 24.0) -> float:
    """Between a ball and an icosahedron; a bound with slope 1.

    Args:
        p: Point.
        radius: Of the ball for exponent 2; the largest ball inside an icosahedron for a large one.
        exponent: 2 or more; the larger, the sharper.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_icosahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_icosahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_icosahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.6403352103801803
    """
    scale = largest_part(p)
    total = powers_of_faces(p / scale, exponent)
    return smoothed(total, scale, radius, exponent, ICOSAHEDRON_WEIGHT)


@func
def smooth_truncated_octahedron_bounds(radius: float, exponent: float) -> Bounds:
    """The box of the sharp one around it."""
    return smooth_bounds(radius, exponent, TRUNCATED_OCTAHEDRON_WEIGHT, SQUARE_RATIO)


@primitive(
    "SmoothTruncatedOctahedron",
    LOWER_BOUND,
    bounds=smooth_truncated_octahedron_bounds,
    limits=RADIUS,
    requires=smooth_requires,
)
@func
def smooth_truncated_octahedron(p: vec3, radius: float = 0.8, exponent: float = 24.0) -> float:
    """Between a ball and a truncated octahedron; a bound with slope 1.

    Args:
        p: Point.
        radius: Of the ball for exponent 2; the largest ball inside the body for a large one.
        exponent: 2 or more; the larger, the sharper.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_truncated_octahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_truncated_octahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_truncated_octahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.5013988255342774
    """
    scale = largest_part(p)
    q = p / scale
    sides = abs(q) / SQUARE_RATIO
    squares = pow(sides.x, exponent) + pow(sides.y, exponent) + pow(sides.z, exponent)
    total = powers_of_diagonals(q, exponent) + squares
    return smoothed(total, scale, radius, exponent, TRUNCATED_OCTAHEDRON_WEIGHT)


@func
def smooth_truncated_icosahedron_bounds(radius: float, exponent: float) -> Bounds:
    """The box of the sharp one around it."""
    return smooth_bounds(radius, exponent, FOOTBALL_WEIGHT, FOOTBALL_REACH / FOOTBALL_HEXAGON)


@primitive(
    "SmoothTruncatedIcosahedron",
    LOWER_BOUND,
    bounds=smooth_truncated_icosahedron_bounds,
    limits=RADIUS,
    requires=smooth_requires,
)
@func
def smooth_truncated_icosahedron(p: vec3, radius: float = 0.9, exponent: float = 48.0) -> float:
    """Between a ball and a football; a bound with slope 1.

    Args:
        p: Point.
        radius: Of the ball for exponent 2; the largest ball inside the body for a large one.
        exponent: 2 or more; the larger, the sharper.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_truncated_icosahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_truncated_icosahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_truncated_icosahedron((0.0, 3.0, 0.0), 1.0, 2.0) = 2.0
    """
    scale = largest_part(p)
    q = p / scale
    pentagons = powers_of_pairs(q / PENTAGON_RATIO, VERTEX_SHORT, VERTEX_LONG, exponent)
    total = powers_of_faces(q, exponent) + pentagons
    return smoothed(total, scale, radius, exponent, FOOTBALL_WEIGHT)
