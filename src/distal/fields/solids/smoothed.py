"""Regular and Archimedean solids with soft edges: between a ball and the sharp body.

Input: a point and the numbers of a shape. Output: a bound on the distance with
slope 1.

Where the sharp body takes the largest part of the point along an axis, these take the sum of all
parts to a power e, then its e-th root. It grows by at most (weight / 3)^(1/e) for each unit of
distance, where weight is the sum of 1 / distance^2 of the faces, of which the nearest is at
distance 1: the axes of each family point evenly in all directions, so for e = 2 it is exactly
sqrt(weight / 3) times the distance from the centre, a ball; and |v|_e^e <= |v|_2^2 where no part is
above 1.

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
)
from distal.lang import abs, func, max, pow, vec3
from distal.lang.functions import Func

OCTAHEDRON_WEIGHT: Final = 4.0
DODECAHEDRON_WEIGHT: Final = 6.0
ICOSAHEDRON_WEIGHT: Final = 10.0
# The second family of faces is farther away than the first by this factor.
SQUARE_RATIO: Final = TRUNCATED_OCTAHEDRON_SQUARE / TRUNCATED_OCTAHEDRON_HEXAGON
PENTAGON_RATIO: Final = FOOTBALL_PENTAGON / FOOTBALL_HEXAGON
TRUNCATED_OCTAHEDRON_WEIGHT: Final = 4.0 + 3.0 / SQUARE_RATIO**2
FOOTBALL_WEIGHT: Final = 10.0 + 6.0 / PENTAGON_RATIO**2


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
def smooth_growth(exponent: float, weight: float, reach: float) -> float:
    """How far the sharp body that holds the smooth one reaches, for a radius of 1.

    Its faces are at the distance by which the sum of powers grows; ``reach`` is how far its
    vertices are where its nearest faces are at distance 1. Moving the surface out only scales both
    bodies: this is also the growth, of the sides where ``reach`` is that along an axis.
    """
    return pow(weight / 3.0, 1.0 / exponent) * reach


@func
def cube_around(side: float) -> Bounds:
    """The box from minus to plus ``side``."""
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


def smooth_body(name: str, weight: float, face: float, reach: float) -> Callable[[Func], Func]:
    """Declare the ``@func`` below as a smooth body, in the box of the sharp one around it.

    Args:
        name: The shape's.
        weight: Sum of 1 / distance^2 of the faces, the nearest of which is at distance 1.
        face: Distance of the nearest faces, for vertices at distance 1.
        reach: How far the vertices reach along an axis then.
    """
    furthest, along_axis = 1.0 / face, reach / face

    def declare(distance: Func) -> Func:
        def growth(exponent: float) -> float:
            return smooth_growth(exponent, weight, furthest)

        def side_growth(exponent: float) -> float:
            return smooth_growth(exponent, weight, along_axis)

        def bounds(radius: float, exponent: float) -> Bounds:
            return cube_around(radius * growth_of_sides(exponent))

        growth_of_sides = named(f"{distance.name}_side_growth", side_growth)
        make = primitive(
            name,
            LOWER_BOUND,
            bounds=named(f"{distance.name}_bounds", bounds),
            requires=smooth_requires,
            growth=named(f"{distance.name}_growth", growth),
            side_growth=growth_of_sides,
        )
        return make(distance)

    return declare


@smooth_body("SmoothOctahedron", OCTAHEDRON_WEIGHT, OCTAHEDRON_FACE, 1.0)
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


@smooth_body("SmoothDodecahedron", DODECAHEDRON_WEIGHT, DODECAHEDRON_FACE, DODECAHEDRON_REACH)
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


@smooth_body("SmoothIcosahedron", ICOSAHEDRON_WEIGHT, ICOSAHEDRON_FACE, ICOSAHEDRON_REACH)
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


@smooth_body(
    "SmoothTruncatedOctahedron",
    TRUNCATED_OCTAHEDRON_WEIGHT,
    TRUNCATED_OCTAHEDRON_HEXAGON,
    TRUNCATED_OCTAHEDRON_SQUARE,
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


@smooth_body("SmoothTruncatedIcosahedron", FOOTBALL_WEIGHT, FOOTBALL_HEXAGON, FOOTBALL_REACH)
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
