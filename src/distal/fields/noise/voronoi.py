"""Cellular noise: cells around scattered points, and the walls between the cells as shapes.

Input: a point, the irregularity of the cells, a seed. Output: distances to the scattered points and
to the borders of their cells.

There is one point in each cell of a lattice, and the 27 surrounding cells (in the plane 9) are
evaluated. Points farther out are at least ``reach`` away, so distances are limited to what such
points could cause: no result jumps, and none is too large.

Source: Steven Worley, "A Cellular Texture Basis Function" (1996); the borders after Inigo Quilez,
"Voronoi borders" (https://iquilezles.org/articles/voronoilines/).
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import LOWER_BOUND, Limit, primitive
from distal.fields.noise.lattice import SEED_STEP, fraction
from distal.fields.widths import radius_width, thickness_width, voronoi_gap_width
from distal.lang import (
    clamp,
    dot,
    floor,
    func,
    inversesqrt,
    ivec2,
    ivec3,
    max,
    min,
    pcg,
    select,
    sqrt,
    struct,
    uint,
    vec2,
    vec3,
)

FROM_10_BITS: Final = 0.0009765625
FROM_16_BITS: Final = 1.52587890625e-05
# Lower limit of the squared distance of two points, for the computation of their border.
SMALLEST_SQUARE: Final = 1e-12


@struct
class Cellular:
    """The values of cellular noise at a point.

    Attributes:
        nearest: Distance to the nearest scattered point; at most ``reach``, which is 1 or more.
        second: Distance to the second nearest point; at most ``reach``.
        identity: A random number from 0 to 1 that belongs to the nearest point.
    """

    nearest: float
    second: float
    identity: float


@func
def reach(jitter: float) -> float:
    """Return a lower bound of the distance to points that are not evaluated."""
    return 1.5 - 0.5 * clamp(jitter, 0.0, 1.0)


@func
def scattered(bits: uint, jitter: float) -> vec3:
    """Return the position of a cell's point, relative to the cell's lower corner."""
    spread = vec3(
        float(bits & uint(1023)),
        float((bits >> uint(10)) & uint(1023)),
        float((bits >> uint(20)) & uint(1023)),
    )
    return 0.5 + clamp(jitter, 0.0, 1.0) * (spread * FROM_10_BITS - 0.5)


@func
def scattered_2(bits: uint, jitter: float) -> vec2:
    """Return the same as ``scattered``, in the plane."""
    spread = vec2(float(bits & uint(65535)), float(bits >> uint(16)))
    return 0.5 + clamp(jitter, 0.0, 1.0) * (spread * FROM_16_BITS - 0.5)


@func
def cellular(p: vec3, jitter: float = 0.8, seed: int = 0) -> Cellular:
    """Return the distances to the two nearest of the scattered points.

    Args:
        p: Point; one unit is one cell.
        jitter: From 0 for points on a lattice to 1 for points anywhere in their cells.
        seed: Selects one of many sets of points.
    """
    corner = floor(p)
    inside = p - corner
    cell = ivec3(corner)
    limit = reach(jitter)
    nearest = limit * limit
    second = nearest
    owner = uint(0)
    for k in range(-1, 2):
        plane = pcg(uint(cell.z + k) + uint(seed) * uint(SEED_STEP))
        for j in range(-1, 2):
            row = pcg(uint(cell.y + j) + plane)
            for i in range(-1, 2):
                bits = pcg(uint(cell.x + i) + row)
                d = vec3(ivec3(i, j, k)) + scattered(bits, jitter) - inside
                square = dot(d, d)
                second = min(second, max(square, nearest))
                owner = select(square < nearest, bits, owner)
                nearest = min(nearest, square)
    return Cellular(sqrt(nearest), sqrt(second), fraction(pcg(owner)))


@func
def cellular_2(p: vec2, jitter: float = 0.8, seed: int = 0) -> Cellular:
    """Return the same as ``cellular``, in the plane."""
    corner = floor(p)
    inside = p - corner
    cell = ivec2(corner)
    limit = reach(jitter)
    nearest = limit * limit
    second = nearest
    owner = uint(0)
    for j in range(-1, 2):
        row = pcg(uint(cell.y + j) + uint(seed) * uint(SEED_STEP))
        for i in range(-1, 2):
            bits = pcg(uint(cell.x + i) + row)
            d = vec2(ivec2(i, j)) + scattered_2(bits, jitter) - inside
            square = dot(d, d)
            second = min(second, max(square, nearest))
            owner = select(square < nearest, bits, owner)
            nearest = min(nearest, square)
    return Cellular(sqrt(nearest), sqrt(second), fraction(pcg(owner)))


@cellular.overload
def cellular_in_plane(p: vec2, jitter: float = 0.8, seed: int = 0) -> Cellular:
    """Return the same as ``cellular``, in the plane."""
    return cellular_2(p, jitter, seed)


@func
def worley(p: vec3, jitter: float = 0.8, seed: int = 0) -> float:
    """Distance to the nearest scattered point: from 0 to 1.5 - jitter / 2, slope up to 1.

    Args:
        p: Point; one unit is one cell.
        jitter: From 0 for points on a lattice to 1 for points anywhere in their cells.
        seed: Selects one of many sets of points.
    """
    return cellular(p, jitter, seed).nearest


@worley.overload
def worley_in_plane(p: vec2, jitter: float = 0.8, seed: int = 0) -> float:
    """Return ``worley`` in the plane, with the same range and slope."""
    return cellular_2(p, jitter, seed).nearest


@func
def voronoi_border(p: vec3, jitter: float = 0.8, seed: int = 0) -> float:
    """Distance to the border of the nearest point's cell: 0 or more, slope up to 1.

    Args:
        p: Point; one unit is one cell.
        jitter: From 0 for points on a lattice to 1 for points anywhere in their cells. Far above
            0.8, a few places may be too far from all points; the border then passes around them.
        seed: Selects one of many sets of points.
    """
    corner = floor(p)
    inside = p - corner
    cell = ivec3(corner)
    nearest = vec3(8.0)
    least = dot(nearest, nearest)
    for k in range(-1, 2):
        plane = pcg(uint(cell.z + k) + uint(seed) * uint(SEED_STEP))
        for j in range(-1, 2):
            row = pcg(uint(cell.y + j) + plane)
            for i in range(-1, 2):
                d = vec3(ivec3(i, j, k)) + scattered(pcg(uint(cell.x + i) + row), jitter) - inside
                square = dot(d, d)
                nearest = select(square < least, d, nearest)
                least = min(least, square)
    # A point that is not evaluated is at least ``reach`` away, its border half of the difference.
    border = max(0.5 * (reach(jitter) - sqrt(least)), 0.0)
    for k in range(-1, 2):
        plane = pcg(uint(cell.z + k) + uint(seed) * uint(SEED_STEP))
        for j in range(-1, 2):
            row = pcg(uint(cell.y + j) + plane)
            for i in range(-1, 2):
                d = vec3(ivec3(i, j, k)) + scattered(pcg(uint(cell.x + i) + row), jitter) - inside
                across = d - nearest
                square = dot(across, across)
                to_border = (
                    0.5 * dot(d + nearest, across) * inversesqrt(max(square, SMALLEST_SQUARE))
                )
                border = min(border, select(square > SMALLEST_SQUARE, to_border, border))
    return border


@func
def voronoi_border_2(p: vec2, jitter: float = 0.8, seed: int = 0) -> float:
    """Return the same as ``voronoi_border``, in the plane."""
    corner = floor(p)
    inside = p - corner
    cell = ivec2(corner)
    nearest = vec2(8.0)
    least = dot(nearest, nearest)
    for j in range(-1, 2):
        row = pcg(uint(cell.y + j) + uint(seed) * uint(SEED_STEP))
        for i in range(-1, 2):
            d = vec2(ivec2(i, j)) + scattered_2(pcg(uint(cell.x + i) + row), jitter) - inside
            square = dot(d, d)
            nearest = select(square < least, d, nearest)
            least = min(least, square)
    border = max(0.5 * (reach(jitter) - sqrt(least)), 0.0)
    for j in range(-1, 2):
        row = pcg(uint(cell.y + j) + uint(seed) * uint(SEED_STEP))
        for i in range(-1, 2):
            d = vec2(ivec2(i, j)) + scattered_2(pcg(uint(cell.x + i) + row), jitter) - inside
            across = d - nearest
            square = dot(across, across)
            to_border = 0.5 * dot(d + nearest, across) * inversesqrt(max(square, SMALLEST_SQUARE))
            border = min(border, select(square > SMALLEST_SQUARE, to_border, border))
    return border


@voronoi_border.overload
def voronoi_border_in_plane(p: vec2, jitter: float = 0.8, seed: int = 0) -> float:
    """Return the same as ``voronoi_border``, in the plane."""
    return voronoi_border_2(p, jitter, seed)


def _walls_leave_room(cell_size: float, thickness: float) -> str | None:
    return "thickness must be at most half of cell_size" if 2.0 * thickness > cell_size else None


def _gap_leaves_room(cell_size: float, gap: float) -> str | None:
    return "gap must be at most half of cell_size" if 2.0 * gap > cell_size else None


def _balls_leave_room(cell_size: float, radius: float) -> str | None:
    return "radius must be at most 0.7 cell_size" if radius > 0.7 * cell_size else None


@primitive(
    "VoronoiWalls",
    LOWER_BOUND,
    requires=_walls_leave_room,
    tier=2,
    width=thickness_width,
)
@func
def voronoi_walls(
    p: vec3, cell_size: float = 0.5, thickness: float = 0.08, jitter: float = 0.8, seed: int = 0
) -> float:
    """Infinite foam: the walls between the Voronoi cells of scattered points.

    Args:
        p: Point.
        cell_size: Mean distance of the points.
        thickness: Thickness of the walls, at most half of ``cell_size``.
        jitter: From 0 for cubes to 1 for the most irregular cells.
        seed: Selects one of many sets of points.

    Source: Inigo Quilez, "Voronoi borders" (https://iquilezles.org/articles/voronoilines/).

    Measured:
        voronoi_walls((0.5, 0.5, 0.5), 1.0, 0.25, 0.0) = 0.375
        voronoi_walls((2.25, 1.5, -3.5), 1.0, 0.25, 0.0) = 0.125
        voronoi_walls((4.0, 1.0, 3.0), 2.0, 0.5, 0.0) = -0.25
    """
    return cell_size * voronoi_border(p / cell_size, jitter, seed) - 0.5 * thickness


@primitive(
    "VoronoiCells",
    LOWER_BOUND,
    limits={"gap": Limit.POSITIVE},
    requires=_gap_leaves_room,
    tier=2,
    width=voronoi_gap_width,
)
@func
def voronoi_cells(
    p: vec3, cell_size: float = 0.5, gap: float = 0.08, jitter: float = 0.8, seed: int = 0
) -> float:
    """Infinite rubble: the Voronoi cells of scattered points, with a gap between them.

    Args:
        p: Point.
        cell_size: Mean distance of the points.
        gap: Width of the gap between two cells, at most half of ``cell_size``.
        jitter: From 0 for cubes to 1 for the most irregular cells.
        seed: Selects one of many sets of points.

    Source: Inigo Quilez, "Voronoi borders" (https://iquilezles.org/articles/voronoilines/).

    Measured:
        voronoi_cells((0.5, 0.5, 0.5), 1.0, 0.25, 0.0) = -0.375
        voronoi_cells((2.25, 1.5, -3.5), 1.0, 0.25, 0.0) = -0.125
        voronoi_cells((4.0, 1.0, 3.0), 2.0, 0.5, 0.0) = 0.25
    """
    return 0.5 * gap - cell_size * voronoi_border(p / cell_size, jitter, seed)


@primitive(
    "VoronoiLines",
    LOWER_BOUND,
    requires=_walls_leave_room,
    tier=2,
    width=thickness_width,
)
@func
def voronoi_lines(
    p: vec2, cell_size: float = 0.5, thickness: float = 0.08, jitter: float = 0.8, seed: int = 0
) -> float:
    """Infinite net: the borders between the Voronoi cells of points in the plane.

    Args:
        p: Point.
        cell_size: Mean distance of the points.
        thickness: Thickness of the borders, at most half of ``cell_size``.
        jitter: From 0 for squares to 1 for the most irregular cells.
        seed: Selects one of many sets of points.

    Source: Inigo Quilez, "Voronoi borders" (https://iquilezles.org/articles/voronoilines/).

    Measured:
        voronoi_lines((0.5, 0.5), 1.0, 0.25, 0.0) = 0.375
        voronoi_lines((2.25, 1.5), 1.0, 0.25, 0.0) = 0.125
        voronoi_lines((4.0, 1.0), 2.0, 0.5, 0.0) = -0.25
    """
    return cell_size * voronoi_border_2(p / cell_size, jitter, seed) - 0.5 * thickness


@primitive(
    "ScatteredBalls",
    LOWER_BOUND,
    requires=_balls_leave_room,
    tier=2,
    width=radius_width,
)
@func
def scattered_balls(
    p: vec3,
    cell_size: float = 0.5,
    radius: float = 0.2,
    jitter: float = 0.8,
    seed: int = 0,
    holes: bool = False,
) -> float:
    """Infinite set of balls around scattered points (gravel), or their complement (sponge).

    Args:
        p: Point.
        cell_size: Mean distance of the points.
        radius: Radius of the balls, at most 0.7 ``cell_size``.
        jitter: From 0 for balls on a lattice to 1 for the most irregular positions.
        seed: Selects one of many sets of points.
        holes: Whether the balls are holes.

    Source: Steven Worley, "A Cellular Texture Basis Function" (1996).

    Measured:
        scattered_balls((0.5, 0.5, 0.5), 1.0, 0.25, 0.0) = -0.25
        scattered_balls((2.0, 1.0, 3.0), 2.0, 0.5, 0.0) = 0.5
        scattered_balls((0.5, 0.0, 0.5), 1.0, 0.25, 0.0, 0, True) = -0.25
    """
    d = cell_size * worley(p / cell_size, jitter, seed) - radius
    return -d if holes else d
