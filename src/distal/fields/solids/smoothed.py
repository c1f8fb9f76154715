"""Regular and Archimedean solids with soft edges: shapes between a ball and the sharp solid.

Input: a point and the numbers of a shape. Output: a bound on the distance with slope 1.

The sharp solid takes the largest projection of the point on the axes; these shapes take the e-th
root of the sum of all projections to the power e. Its slope is at most (weight / 3)^(1/e), where
weight is the sum of 1 / distance^2 of the faces, of which the nearest is at distance 1. Reason: the
axes of each family are distributed evenly, so for e = 2 the value is exactly sqrt(weight / 3) times
the distance from the centre, a ball; and |v|_e^e <= |v|_2^2 if no component is above 1.

Source: Ergun Akleman and Jianer Chen, "Generalized Distance Functions", Shape Modeling
International 1999; the scale to slope 1 is derived here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from distal.fields.constants import TINY
from distal.fields.guarantees import LOWER_BOUND, Bounds, named, primitive
from distal.fields.solids.regular import (
    DIAGONAL,
    DODECAHEDRON_FACE,
    DODECAHEDRON_REACH,
    FACE_LONG,
    FACE_SHORT,
    FOOTBALL_HEXAGON,
    FOOTBALL_PENTAGON,
    FOOTBALL_REACH,
    ICOSAHEDRON_FACE,
    ICOSAHEDRON_REACH,
    OCTAHEDRON_FACE,
    TRUNCATED_OCTAHEDRON_HEXAGON,
    TRUNCATED_OCTAHEDRON_SQUARE,
    VERTEX_LONG,
    VERTEX_SHORT,
    along_diagonals,
    along_faces,
    along_vertices,
)
from distal.fields.widths import inradius_width
from distal.lang import abs, func, max, pow, vec3
from distal.lang.functions import Func

OCTAHEDRON_WEIGHT: Final = 4.0
DODECAHEDRON_WEIGHT: Final = 6.0
ICOSAHEDRON_WEIGHT: Final = 10.0
# The ratio of the second family's face distance to the first's.
SQUARE_RATIO: Final = TRUNCATED_OCTAHEDRON_SQUARE / TRUNCATED_OCTAHEDRON_HEXAGON
PENTAGON_RATIO: Final = FOOTBALL_PENTAGON / FOOTBALL_HEXAGON
TRUNCATED_OCTAHEDRON_WEIGHT: Final = 4.0 + 3.0 / SQUARE_RATIO**2
FOOTBALL_WEIGHT: Final = 10.0 + 6.0 / PENTAGON_RATIO**2


@func
def powers_of_diagonals(p: vec3, exponent: float) -> float:
    """Return the sum of powers for the octahedron's four axes."""
    return (
        pow(abs(p.x + p.y + p.z) * DIAGONAL, exponent)
        + pow(abs(p.x + p.y - p.z) * DIAGONAL, exponent)
        + pow(abs(p.x - p.y + p.z) * DIAGONAL, exponent)
        + pow(abs(p.x - p.y - p.z) * DIAGONAL, exponent)
    )


@func
def powers_of_pairs(p: vec3, short: float, long: float, exponent: float) -> float:
    """Return the sum for (0, short, long), (0, short, -long) and their cyclic permutations."""
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
    """Return the sum of powers for the ten axes through an icosahedron's faces."""
    # (0, long, short): the dodecahedron's vertices are permuted in the opposite order.
    return powers_of_diagonals(p, exponent) + powers_of_pairs(p, FACE_LONG, FACE_SHORT, exponent)


@func
def smooth_growth(exponent: float, weight: float, reach: float) -> float:
    """Return the extent of the sharp solid around the smooth one, for a radius of 1.

    Its faces are at the distance given by the slope of the sum of powers; ``reach`` is the extent
    of its vertices for nearest faces at distance 1. Moving the surface outwards only scales both
    solids, so this is also the growth (of the sides if ``reach`` is the extent along an axis).
    """
    return pow(weight / 3.0, 1.0 / exponent) * reach


@func
def cube_around(side: float) -> Bounds:
    """Return the box from minus to plus ``side``."""
    return Bounds(vec3(-side), vec3(side))


@func
def smoothed(total: float, scale: float, inradius: float, exponent: float, weight: float) -> float:
    """Return the field from the sum of the powers of p / scale.

    The scale is the largest projection: then the largest power is 1, whatever the exponent is.
    """
    return scale * pow(total * (3.0 / weight), 1.0 / exponent) - inradius


def smooth_requires(exponent: float) -> str | None:
    """Return why an exponent below 2 is invalid, or None."""
    return None if exponent >= 2.0 else "exponent must be 2 or more"


def smooth_body(name: str, weight: float, face: float, reach: float) -> Callable[[Func], Func]:
    """Declare the ``@func`` below as a smooth solid, with the box of the sharp one around it.

    Args:
        name: Name of the shape.
        weight: Sum of 1 / distance^2 of the faces, the nearest of which is at distance 1.
        face: Distance of the nearest faces, for vertices at distance 1.
        reach: Extent of the vertices along an axis, for vertices at distance 1.
    """
    furthest, along_axis = 1.0 / face, reach / face

    def declare(distance: Func) -> Func:
        def growth(exponent: float) -> float:
            return smooth_growth(exponent, weight, furthest)

        def side_growth(exponent: float) -> float:
            return smooth_growth(exponent, weight, along_axis)

        def bounds(inradius: float, exponent: float) -> Bounds:
            return cube_around(inradius * growth_of_sides(exponent))

        growth_of_sides = named(f"{distance.name}_side_growth", side_growth)
        make = primitive(
            name,
            LOWER_BOUND,
            bounds=named(f"{distance.name}_bounds", bounds),
            requires=smooth_requires,
            growth=named(f"{distance.name}_growth", growth),
            side_growth=growth_of_sides,
            width=inradius_width,
        )
        return make(distance)

    return declare


@smooth_body("SmoothOctahedron", OCTAHEDRON_WEIGHT, OCTAHEDRON_FACE, 1.0)
@func
def smooth_octahedron(p: vec3, inradius: float = 0.6, exponent: float = 12.0) -> float:
    """Shape between a ball and an octahedron; a bound with slope 1.

    Args:
        p: Point.
        inradius: Radius of the ball for exponent 2, and of the largest ball inside the octahedron
            for a large exponent.
        exponent: 2 or more; a larger exponent gives sharper edges.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_octahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_octahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_octahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.2795070569547775
    """
    scale = max(along_diagonals(abs(p)), TINY)
    total = powers_of_diagonals(p / scale, exponent)
    return smoothed(total, scale, inradius, exponent, OCTAHEDRON_WEIGHT)


@smooth_body("SmoothDodecahedron", DODECAHEDRON_WEIGHT, DODECAHEDRON_FACE, DODECAHEDRON_REACH)
@func
def smooth_dodecahedron(p: vec3, inradius: float = 0.8, exponent: float = 24.0) -> float:
    """Shape between a ball and a dodecahedron; a bound with slope 1.

    Args:
        p: Point.
        inradius: Radius of the ball for exponent 2, and of the largest ball inside the dodecahedron
            for a large exponent.
        exponent: 2 or more; a larger exponent gives sharper edges.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_dodecahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_dodecahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_dodecahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.6403352103801803
    """
    scale = max(along_vertices(abs(p)), TINY)
    total = powers_of_pairs(p / scale, VERTEX_SHORT, VERTEX_LONG, exponent)
    return smoothed(total, scale, inradius, exponent, DODECAHEDRON_WEIGHT)


@smooth_body("SmoothIcosahedron", ICOSAHEDRON_WEIGHT, ICOSAHEDRON_FACE, ICOSAHEDRON_REACH)
@func
def smooth_icosahedron(p: vec3, inradius: float = 0.8, exponent: float = 24.0) -> float:
    """Shape between a ball and an icosahedron; a bound with slope 1.

    Args:
        p: Point.
        inradius: Radius of the ball for exponent 2, and of the largest ball inside the icosahedron
            for a large exponent.
        exponent: 2 or more; a larger exponent gives sharper edges.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_icosahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_icosahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_icosahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.6403352103801803
    """
    scale = max(along_faces(abs(p)), TINY)
    total = powers_of_faces(p / scale, exponent)
    return smoothed(total, scale, inradius, exponent, ICOSAHEDRON_WEIGHT)


@smooth_body(
    "SmoothTruncatedOctahedron",
    TRUNCATED_OCTAHEDRON_WEIGHT,
    TRUNCATED_OCTAHEDRON_HEXAGON,
    TRUNCATED_OCTAHEDRON_SQUARE,
)
@func
def smooth_truncated_octahedron(p: vec3, inradius: float = 0.8, exponent: float = 24.0) -> float:
    """Shape between a ball and a truncated octahedron; a bound with slope 1.

    Args:
        p: Point.
        inradius: Radius of the ball for exponent 2, and of the largest ball inside the solid for a
            large exponent.
        exponent: 2 or more; a larger exponent gives sharper edges.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_truncated_octahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_truncated_octahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_truncated_octahedron((0.0, 3.0, 0.0), 1.0, 4.0) = 1.5013988255342774
    """
    sharp = abs(p)
    scale = max(along_diagonals(sharp), max(sharp.x, sharp.y, sharp.z) / SQUARE_RATIO, TINY)
    q = p / scale
    sides = abs(q) / SQUARE_RATIO
    squares = pow(sides.x, exponent) + pow(sides.y, exponent) + pow(sides.z, exponent)
    total = powers_of_diagonals(q, exponent) + squares
    return smoothed(total, scale, inradius, exponent, TRUNCATED_OCTAHEDRON_WEIGHT)


@smooth_body("SmoothTruncatedIcosahedron", FOOTBALL_WEIGHT, FOOTBALL_HEXAGON, FOOTBALL_REACH)
@func
def smooth_truncated_icosahedron(p: vec3, inradius: float = 0.9, exponent: float = 48.0) -> float:
    """Shape between a ball and a football; a bound with slope 1.

    Args:
        p: Point.
        inradius: Radius of the ball for exponent 2, and of the largest ball inside the solid for a
            large exponent.
        exponent: 2 or more; a larger exponent gives sharper edges.

    Source: Akleman and Chen, "Generalized Distance Functions", 1999, scaled to slope 1.

    Measured:
        smooth_truncated_icosahedron((2.0, 3.0, 6.0), 1.0, 2.0) = 6.0
        smooth_truncated_icosahedron((0.0, 0.0, 0.0), 0.5, 9.0) = -0.5
        smooth_truncated_icosahedron((0.0, 3.0, 0.0), 1.0, 2.0) = 2.0
    """
    sharp = abs(p)
    scale = max(along_faces(sharp), along_vertices(sharp) / PENTAGON_RATIO, TINY)
    q = p / scale
    pentagons = powers_of_pairs(q / PENTAGON_RATIO, VERTEX_SHORT, VERTEX_LONG, exponent)
    total = powers_of_faces(q, exponent) + pentagons
    return smoothed(total, scale, inradius, exponent, FOOTBALL_WEIGHT)
