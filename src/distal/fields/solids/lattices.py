"""Infinite strut lattices: round bars between the points of a crystal lattice.

Input: a point, the edge length of the repeated cell, the radius of the struts. Output: the
distance, exact outside. All but the diamond lattice are symmetric about the planes through their
nodes and halfway between them, so a point is folded into an eighth of a cell, which also contains
its nearest strut.
"""

from __future__ import annotations

from typing import Final

from distal.fields.flats.edges import nearer
from distal.fields.flats.honeycomb import hexagon_cell, hexagon_reach
from distal.fields.guarantees import EXACT_OUTSIDE, Limit, primitive
from distal.fields.widths import radius_width
from distal.lang import abs, clamp, dot, floor, func, length, max, min, round, select, vec2, vec3

ROOT_HALF: Final = 0.7071067811865476
ROOT_THIRD: Final = 0.5773502691896258


def _cubic_gaps_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be below 0.5 cell_size" if 2.0 * radius >= cell_size else None


def _diagonal_gaps_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be at most 0.25 cell_size" if 4.0 * radius > cell_size else None


def _octet_gaps_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be at most 0.15 cell_size" if radius > 0.15 * cell_size else None


def _open_cells_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be at most 0.15 cell_size" if radius > 0.15 * cell_size else None


@func
def folded(p: vec3, cell_size: float) -> vec3:
    """Return the point folded into the eighth of a cell between a node at 0 and the middle."""
    return abs(p - cell_size * round(p / cell_size))


@func
def descending(q: vec3) -> vec3:
    """Return the components in descending order."""
    highest = max(max(q.x, q.y), q.z)
    lowest = min(min(q.x, q.y), q.z)
    middle = max(min(q.x, q.y), min(max(q.x, q.y), q.z))
    return vec3(highest, middle, lowest)


@primitive(
    "CubicLattice",
    EXACT_OUTSIDE,
    requires=_cubic_gaps_stay,
    tier=2,
    width=radius_width,
)
@func
def cubic_lattice(p: vec3, cell_size: float = 0.5, radius: float = 0.06) -> float:
    """Infinite lattice of struts along the edges of cubes, with a node at the origin.

    Args:
        p: Point.
        cell_size: Edge length of the cubes.
        radius: Radius of the struts, below half of ``cell_size``.

    Source: the nearest of three perpendicular lines after folding.

    Measured:
        cubic_lattice((0.5, 0.0, 0.0), 1.0, 0.125) = -0.125
        cubic_lattice((2.25, 1.5, 0.0), 1.0, 0.125) = 0.125
        cubic_lattice((0.0, 3.25, 5.5), 2.0, 0.25) = 0.25
    """
    return length(descending(folded(p, cell_size)).yz) - radius


@func
def from_face_diagonals(q: vec3) -> vec2:
    """Return the offset, in two components, from the nearest face diagonal through 0."""
    s = descending(q)
    return vec2(ROOT_HALF * (s.x - s.y), s.z)


@primitive(
    "BccLattice",
    EXACT_OUTSIDE,
    requires=_diagonal_gaps_stay,
    tier=2,
    width=radius_width,
)
@func
def bcc_lattice(p: vec3, cell_size: float = 0.5, radius: float = 0.05) -> float:
    """Infinite lattice of struts from the corners of cubes to their middles (body-centred cubic).

    Args:
        p: Point.
        cell_size: Edge length of the cubes; a corner is at the origin.
        radius: Radius of the struts, at most a quarter of ``cell_size``.

    Source: the nearest line after folding, which is the cube's diagonal.

    Measured:
        bcc_lattice((0.25, 0.25, 0.25), 1.0, 0.125) = -0.125
        bcc_lattice((0.5, 0.0, 0.0), 1.0, 0.125) = 0.2832483
        bcc_lattice((4.0, 1.0, -2.0), 2.0, 0.25) = 0.5664966
    """
    q = folded(p, cell_size)
    return ROOT_THIRD * length(q - q.yzx) - radius


@primitive(
    "FccLattice",
    EXACT_OUTSIDE,
    requires=_diagonal_gaps_stay,
    tier=2,
    width=radius_width,
)
@func
def fcc_lattice(p: vec3, cell_size: float = 0.5, radius: float = 0.05) -> float:
    """Infinite lattice of struts from cube corners to face middles (face-centred cubic).

    Args:
        p: Point.
        cell_size: Edge length of the cubes; a corner is at the origin.
        radius: Radius of the struts, at most a quarter of ``cell_size``.

    Source: the nearest of three lines after folding.

    Measured:
        fcc_lattice((0.25, 0.25, 0.0), 1.0, 0.125) = -0.125
        fcc_lattice((0.5, 0.0, 0.0), 1.0, 0.125) = 0.2285534
        fcc_lattice((1.0, 1.0, -1.0), 2.0, 0.25) = 0.75
    """
    return length(from_face_diagonals(folded(p, cell_size))) - radius


@primitive(
    "OctetLattice",
    EXACT_OUTSIDE,
    requires=_octet_gaps_stay,
    tier=2,
    width=radius_width,
)
@func
def octet_lattice(p: vec3, cell_size: float = 0.75, radius: float = 0.05) -> float:
    """Infinite octet truss: struts along the edges of octahedra and tetrahedra that fill space.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube; a node is at the origin.
        radius: Radius of the struts, at most 0.15 ``cell_size``.

    Source: Buckminster Fuller's truss (US patent 2986241, 1961); the nearest of a tetrahedron's six
    edges after folding.

    Measured:
        octet_lattice((0.25, 0.25, 0.0), 1.0, 0.125) = -0.125
        octet_lattice((0.5, 0.0, 0.0), 1.0, 0.125) = 0.2285534
        octet_lattice((0.5, 0.5, 0.5), 2.0, 0.25) = 0.25
    """
    half = 0.5 * cell_size
    q = folded(p, cell_size)
    # The three edges that do not pass through the node: one in each of the faces opposite to it.
    away = half - q
    along = ROOT_HALF * (q.x + q.y + q.z - half - q)
    nearest = nearer(vec2(away.x, along.x), vec2(away.y, along.y))
    nearest = nearer(nearest, vec2(away.z, along.z))
    return length(nearer(nearest, from_face_diagonals(q))) - radius


@primitive(
    "KelvinLattice",
    EXACT_OUTSIDE,
    requires=_open_cells_stay,
    tier=2,
    width=radius_width,
)
@func
def kelvin_lattice(p: vec3, cell_size: float = 0.75, radius: float = 0.04) -> float:
    """Infinite Kelvin lattice: struts along the edges of truncated octahedra that fill space.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube; an octahedron's middle is at the origin.
        radius: Radius of the struts, at most 0.15 ``cell_size``.

    Source: Lord Kelvin, "On the division of space with minimum partitional area" (1887), for the
    cells; the nearest of two edges of a hexagon after folding and sorting.

    Measured:
        kelvin_lattice((0.5, 0.25, 0.0), 1.0, 0.125) = -0.125
        kelvin_lattice((0.0, 0.0, 0.0), 1.0, 0.125) = 0.4053301
        kelvin_lattice((1.0, 0.25, 0.25), 2.0, 0.25) = -0.25
    """
    q = descending(folded(p, cell_size))
    half, quarter = 0.5 * cell_size, 0.25 * cell_size
    # Both edges begin at (half, quarter, 0): one in the plane x = half, one in the plane z = 0.
    s = clamp(0.5 * (quarter - q.y + q.z), 0.0, quarter)
    t = clamp(0.5 * (half - q.x + q.y - quarter), 0.0, quarter)
    to_first = length(q - vec3(half, quarter - s, s))
    to_second = length(q - vec3(half - t, quarter + t, 0.0))
    return min(to_first, to_second) - radius


def _prisms_stay_open(cell_size: float, height: float, radius: float) -> str | None:
    if radius > 0.15 * min(cell_size, height):
        return "radius must be at most 0.15 of cell_size and of height"
    return None


@primitive(
    "HexagonalLattice",
    EXACT_OUTSIDE,
    limits={"height": Limit.POSITIVE},
    requires=_prisms_stay_open,
    tier=2,
    width=radius_width,
)
@func
def hexagonal_lattice(
    p: vec3, cell_size: float = 0.5, height: float = 0.4, radius: float = 0.03
) -> float:
    """Infinite honeycomb of struts: the edges of upright hexagonal prisms that fill space.

    ``Honeycomb(…).extrude(None)`` is the honeycomb of walls.

    Args:
        p: Point.
        cell_size: Distance between the middles of adjacent prisms, in the xz plane; one is about
            the y axis.
        height: Height of a prism along y; hexagons are at 0 and multiples of it.
        radius: Radius of the struts, at most 0.15 of ``cell_size`` and of ``height``.

    Source: the nearest edge of a hexagon and the nearest of its corners, after folding.

    Measured:
        hexagonal_lattice((0.0, 1.0, 0.5), 1.0, 1.0, 0.125) = -0.125
        hexagonal_lattice((0.0, 0.25, 0.0), 1.0, 1.0, 0.125) = 0.4340170
        hexagonal_lattice((0.5773503, 0.5, 0.0), 1.0, 1.0, 0.125) = -0.125
    """
    q = hexagon_cell(p.xz, cell_size)
    above = p.y - height * round(p.y / height)
    to_edge = length(vec2(0.5 * cell_size - hexagon_reach(q), above))
    # The corners in a quarter of the hexagon, whose sides face along z.
    s = abs(q)
    corner = ROOT_THIRD * cell_size
    to_corner = min(length(s - vec2(corner, 0.0)), length(s - vec2(0.5 * corner, 0.5 * cell_size)))
    return min(to_edge, to_corner) - radius


@func
def from_face_centred(q: vec3) -> vec3:
    """Return the offset from the nearest point with whole coordinates whose sum is even."""
    nearest = round(q)
    away = q - nearest
    total = nearest.x + nearest.y + nearest.z
    if total - 2.0 * floor(0.5 * total) < 0.5:
        return away
    # The next one lies along the axis of the largest offset.
    size = abs(away)
    step = select(away < 0.0, vec3(-1.0), vec3(1.0))
    if size.x >= size.y and size.x >= size.z:
        return away - vec3(step.x, 0.0, 0.0)
    if size.y >= size.z:
        return away - vec3(0.0, step.y, 0.0)
    return away - vec3(0.0, 0.0, step.z)


@primitive(
    "DiamondLattice",
    EXACT_OUTSIDE,
    requires=_open_cells_stay,
    tier=2,
    width=radius_width,
)
@func
def diamond_lattice(p: vec3, cell_size: float = 0.75, radius: float = 0.05) -> float:
    """Infinite diamond lattice: struts along the bonds of the atoms in a diamond.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube; an atom is at the origin.
        radius: Radius of the struts, at most 0.15 ``cell_size``.

    Source: W. H. and W. L. Bragg, "The structure of the diamond" (1913), for the bonds; the nearest
    of an atom's four bonds. Planes halfway between atoms of the same kind are mirrors.

    Measured:
        diamond_lattice((0.25, 0.25, 0.25), 1.0, 0.125) = -0.125
        diamond_lattice((0.5, 0.0, 0.0), 1.0, 0.125) = 0.2832483
        diamond_lattice((1.0, 1.0, 1.0), 2.0, 0.25) = 0.5664966
    """
    half = 0.5 * cell_size
    q = half * from_face_centred(p / half)
    # Of the four directions, which have an even number of minus signs, the one nearest to q.
    bond = vec3(1.0, 1.0, 1.0)
    if dot(q, vec3(1.0, -1.0, -1.0)) > dot(q, bond):
        bond = vec3(1.0, -1.0, -1.0)
    if dot(q, vec3(-1.0, 1.0, -1.0)) > dot(q, bond):
        bond = vec3(-1.0, 1.0, -1.0)
    if dot(q, vec3(-1.0, -1.0, 1.0)) > dot(q, bond):
        bond = vec3(-1.0, -1.0, 1.0)
    return length(q - clamp(dot(q, bond) / 3.0, 0.0, 0.5 * half) * bond) - radius
