"""The surface near oriented points: scene code, run for many places by the CPU.

Input: a place, and points with normals in buffers. Output: the height of the place above the
surface, how many points are about it, a triangle for a point. Lengths are in units of the radius
within which points count. Does not depend on files or grids.
"""

from __future__ import annotations

from typing import Final

from distal.lang import (
    Buffer,
    abs,
    cross,
    dot,
    func,
    ivec3,
    length,
    max,
    select,
    sqrt,
    struct,
    vec3,
)

# The data of these buffers is replaced for each cloud. Points are sorted by their cells, which are
# as wide as the radius.
SITES: Final = Buffer([vec3(0.0)])
DIRECTIONS: Final = Buffer([vec3(0.0)])
# The first point of each cell and of one cell more; the steps of one cell along y and z.
SITE_STARTS: Final = Buffer([0])
SITE_STEPS: Final = Buffer([0])
# The area of each point, as a square of the unit.
SITE_AREAS: Final = Buffer([0.0])

TINY: Final = 1e-30
# The side of an equilateral triangle of area 1, and the part of it that is the distance from the
# middle to a corner, to a side.
SIDE: Final = 1.5196713713031851
TO_CORNER: Final = 0.5773502691896258
TO_SIDE: Final = 0.28867513459481287


@struct
class PointsAbout:
    """What the points about a place say.

    Attributes:
        height: The height of the place above the surface, in units of the radius.
        weight: The sum of the points' weights; 0 if there are none.
        normal: The sum of their weighted normals.
    """

    height: float
    weight: float
    normal: vec3


@struct
class Surfel:
    """A triangle for a point: about it, across its normal, of its area."""

    a: vec3
    b: vec3
    c: vec3


@func
def lowest_row(p: vec3) -> int:
    """Return the cell before the lowest one of the 27 about a place, which is in no border cell."""
    cell = ivec3(p)
    return cell.x - 1 + (cell.y - 1) * SITE_STEPS[0] + (cell.z - 1) * SITE_STEPS[1]


@func
def surroundings(p: vec3) -> PointsAbout:
    """Return what the points within the radius say of a place.

    The weighted mean of heights above tangent planes (Kolluri), where a plane's normal is the mean
    of the point's own one and of all: the chord between two points of a sphere is perpendicular to
    the sum of their normals, so spheres are exact, which the tangent planes alone are not.

    Source: Kolluri, Provably Good Moving Least Squares, 2005; for the mean of normals,
    Rusinkiewicz, A Symmetric Objective Function for ICP, 2019.
    """
    first = lowest_row(p)
    weight = 0.0
    normal = vec3(0.0)
    offset = vec3(0.0)
    height = 0.0
    for k in range(3):
        for j in range(3):
            row = first + j * SITE_STEPS[0] + k * SITE_STEPS[1]
            # The three cells of a row follow each other.
            for at in range(SITE_STARTS[row], SITE_STARTS[row + 3]):
                to = p - SITES[at]
                near = max(1.0 - dot(to, to), 0.0)
                share = near * near * near * near
                weight += share
                normal += share * DIRECTIONS[at]
                offset += share * to
                height += share * dot(DIRECTIONS[at], to)
    mean = normal / max(length(normal), TINY)
    return PointsAbout(0.5 * (height + dot(mean, offset)) / max(weight, TINY), weight, normal)


@func
def points_within(p: vec3) -> int:
    """Return the number of points within the radius."""
    first = lowest_row(p)
    count = 0
    for k in range(3):
        for j in range(3):
            row = first + j * SITE_STEPS[0] + k * SITE_STEPS[1]
            for at in range(SITE_STARTS[row], SITE_STARTS[row + 3]):
                to = p - SITES[at]
                count += select(dot(to, to) <= 1.0, 1, 0)
    return count


@func
def agreement(p: vec3, site: int) -> float:
    """Return how far a point's normal agrees with the others', -1 to 1; 0 without others."""
    others = surroundings(p).normal - DIRECTIONS[site]  # its own weight is 1
    return dot(others, DIRECTIONS[site]) / max(length(others), TINY)


@func
def surfel(p: vec3, site: int) -> Surfel:
    """Return the triangle of a point, counterclockwise seen from outside."""
    n = DIRECTIONS[site]
    axis = select(abs(n.x) < 0.6, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0))
    across = cross(n, axis)
    u = across / max(length(across), TINY)
    v = cross(n, u)
    side = SIDE * sqrt(SITE_AREAS[site])
    low = p - v * (side * TO_SIDE)
    return Surfel(low - u * (0.5 * side), low + u * (0.5 * side), p + v * (side * TO_CORNER))
