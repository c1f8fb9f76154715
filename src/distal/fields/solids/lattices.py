"""Infinite strut lattices: round bars between the points of a crystal lattice.

Input: a point, the edge length of the repeated cell, the radius of the struts. Output: the
distance, exact outside. Each lattice is symmetric about the planes through its nodes and halfway
between them, so a point is folded into an eighth of a cell, which also contains its nearest strut.
"""

from __future__ import annotations

from typing import Final

from distal.fields.flats.edges import nearer
from distal.fields.guarantees import EXACT_OUTSIDE, primitive
from distal.lang import abs, func, length, max, min, round, vec2, vec3

ROOT_HALF: Final = 0.7071067811865476
ROOT_THIRD: Final = 0.5773502691896258


def _cubic_gaps_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be below 0.5 cell_size" if 2.0 * radius >= cell_size else None


def _diagonal_gaps_stay(cell_size: float, radius: float) -> str | None:
    return "radius must be at most 0.25 cell_size" if 4.0 * radius > cell_size else None


def _octet_gaps_stay(cell_size: float, radius: float) -> str | None:
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


@primitive("CubicLattice", EXACT_OUTSIDE, requires=_cubic_gaps_stay, tier=2)
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


@primitive("BccLattice", EXACT_OUTSIDE, requires=_diagonal_gaps_stay, tier=2)
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


@primitive("FccLattice", EXACT_OUTSIDE, requires=_diagonal_gaps_stay, tier=2)
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


@primitive("OctetLattice", EXACT_OUTSIDE, requires=_octet_gaps_stay, tier=2)
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
