"""Topology of one cell of the lattice, for each sign pattern of its corners.

Input: nothing. Output: tables of integers. Corner ``i`` has the offsets of its bits (bit 0 is x,
bit 1 is y, bit 2 is z); a mask has bit ``i`` set if corner ``i`` is inside. An edge is *crossed* if
its ends differ; a *component* is a set of crossed edges that the surface connects within the cell.

A face with four crossed edges is *ambiguous*: the surface goes around its inside corners, or, if
the face is *joined*, around its outside corners, so that the inside corners are connected. Which of
the two it is belongs to the face, so that both of its cells agree. A *case* is a mask with the
ambiguous faces that are joined, as bits: bit ``2 * axis + upper``. Does not depend on the surface.

Source: Gregory M. Nielson, "Dual Marching Cubes" (2004), for one vertex in each component.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import combinations, product
from typing import Final

import numpy as np
import numpy.typing as npt

Table = npt.NDArray[np.int64]
Corner = tuple[int, int, int]

CORNERS: Final[tuple[Corner, ...]] = tuple((i & 1, i >> 1 & 1, i >> 2) for i in range(8))
# Each edge as (axis, first corner); the second corner has the axis's bit set.
EDGES: Final = tuple((a, c) for a in range(3) for c in range(8) if not c >> a & 1)
FACES: Final = tuple((axis, upper) for axis in range(3) for upper in (False, True))
# The most components of a cell, segments of a face, and planes around a region.
MOST_COMPONENTS: Final = 4
MOST_SEGMENTS: Final = 2
MOST_PLANES: Final = 8


@dataclass(frozen=True, slots=True)
class CellTables:
    """Tables for each case.

    Attributes:
        case: (256, 64): the case of a mask and the faces that are joined.
        ambiguous: (256, 3): whether the upper face along each axis is ambiguous, by mask.
        separable: Whether the regions of the case's components are separable by planes; where they
            are not, no face of the cell may be joined.
        component: (cases, 12): the component of each edge; -1 if it is not crossed.
        components: (cases,): how many components there are.
        segments: (cases, 3, 2, 2): the two crossed edges of each segment of the surface on the
            upper face along each axis; -1 if there is no such segment.
        regions: (cases, 4): the corners at the ends of each component's edges, as bits.
        planes: (256, 8, 4): planes around the convex hull of corners that are given as bits, with
            integer coefficients (a, b, c, d): a x + b y + c z <= d in the unit cell. Rows without a
            plane are 0. Only regions of cells with several components have planes.
    """

    case: Table
    ambiguous: npt.NDArray[np.bool_]
    separable: npt.NDArray[np.bool_]
    component: Table
    components: Table
    segments: Table
    regions: Table
    planes: Table


@cache
def cell_tables() -> CellTables:
    """Return the tables."""
    case, pairs = numbered_cases()
    count = len(pairs)
    separable = np.ones(count, np.bool_)
    component = np.full((count, 12), -1, np.int64)
    components = np.zeros(count, np.int64)
    segments = np.full((count, 3, MOST_SEGMENTS, 2), -1, np.int64)
    regions = np.zeros((count, MOST_COMPONENTS), np.int64)
    planes = np.zeros((256, MOST_PLANES, 4), np.int64)
    for row, (mask, joined) in enumerate(pairs):
        groups = edge_groups(mask, joined)
        components[row] = len(groups)
        parts = [region(group) for group in groups]
        separable[row] = all(are_separable(a, b) for a, b in combinations(parts, 2))
        for number, (group, part) in enumerate(zip(groups, parts, strict=True)):
            component[row, list(group)] = number
            bits = sum(1 << CORNERS.index(corner) for corner in part)
            regions[row, number] = bits
            if len(groups) > 1 and not planes[bits].any():
                rows = hull_planes(part)
                planes[bits, : len(rows)] = rows
        for axis in range(3):
            found = face_segments(mask, axis, upper=True, joined=joined)
            for place, pair in enumerate(found):
                segments[row, axis, place] = pair
    ambiguous = np.array(
        [[is_ambiguous(mask, axis, upper=True) for axis in range(3)] for mask in range(256)]
    )
    return CellTables(case, ambiguous, separable, component, components, segments, regions, planes)


def numbered_cases() -> tuple[Table, list[tuple[int, int]]]:
    """Return the number of each case by mask and joined faces, and the cases in this order."""
    known: dict[tuple[int, int], int] = {}
    case = np.zeros((256, 64), np.int64)
    for mask in range(256):
        open_faces = sum(
            1 << bit
            for bit, (axis, upper) in enumerate(FACES)
            if is_ambiguous(mask, axis, upper=upper)
        )
        for joined in range(64):
            pair = (mask, joined & open_faces)
            case[mask, joined] = known.setdefault(pair, len(known))
    return case, list(known)


def is_inside(mask: int, corner: int) -> bool:
    """Return whether a corner is inside."""
    return bool(mask >> corner & 1)


def ends(edge: int) -> tuple[int, int]:
    """Return the two corners of an edge."""
    axis, first = EDGES[edge]
    return first, first | 1 << axis


def face_corners(axis: int, *, upper: bool) -> tuple[int, int, int, int]:
    """Return the corners of a face, in order around it."""
    first = int(upper) << axis
    u, v = 1 << (axis + 1) % 3, 1 << (axis + 2) % 3
    return first, first | u, first | u | v, first | v


def is_ambiguous(mask: int, axis: int, *, upper: bool) -> bool:
    """Return whether a face has four crossed edges."""
    a, b, c, d = (is_inside(mask, corner) for corner in face_corners(axis, upper=upper))
    return a == c and b == d and a != b


def face_segments(mask: int, axis: int, *, upper: bool, joined: int = 0) -> list[tuple[int, int]]:
    """Return the pairs of crossed edges that the surface connects on a face.

    Args:
        mask: The corners that are inside.
        axis: The axis that the face is perpendicular to.
        upper: Whether it is the face at the upper end of the axis.
        joined: The faces whose inside corners are connected.
    """
    corners = face_corners(axis, upper=upper)
    around = [edge_between(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    crossed = [edge for edge in around if is_crossed(mask, edge)]
    if len(crossed) < 4:
        return [(crossed[0], crossed[1])] if crossed else []
    apart = not joined >> FACES.index((axis, upper)) & 1
    return [(around[i - 1], around[i]) for i in range(4) if is_inside(mask, corners[i]) == apart]


def edge_between(a: int, b: int) -> int:
    """Return the edge between two neighboring corners."""
    axis = (a ^ b).bit_length() - 1
    return EDGES.index((axis, min(a, b)))


def is_crossed(mask: int, edge: int) -> bool:
    """Return whether the ends of an edge differ."""
    first, second = ends(edge)
    return is_inside(mask, first) != is_inside(mask, second)


def edge_groups(mask: int, joined: int = 0) -> list[tuple[int, ...]]:
    """Return the components of a case: sets of crossed edges, in order of their first edges."""
    group = {edge: edge for edge in range(12) if is_crossed(mask, edge)}
    for axis, upper in FACES:
        for a, b in face_segments(mask, axis, upper=upper, joined=joined):
            kept, replaced = sorted((group[a], group[b]))
            group = {e: kept if of == replaced else of for e, of in group.items()}
    return [tuple(e for e in group if group[e] == of) for of in sorted(set(group.values()))]


def region(group: tuple[int, ...]) -> tuple[Corner, ...]:
    """Return the corners at the ends of a component's edges; their convex hull is its region."""
    return tuple(CORNERS[c] for c in sorted({corner for edge in group for corner in ends(edge)}))


@cache
def are_separable(one: tuple[Corner, ...], other: tuple[Corner, ...]) -> bool:
    """Return whether a plane has one region on each side; it may touch them.

    Corners are whole numbers, so planes with small integer coefficients are enough.
    """
    for x, y, z in product(range(-2, 3), repeat=3):
        n = (x, y, z)
        low = min(along(n, p) for p in one)
        high = max(along(n, p) for p in other)
        if n != (0, 0, 0) and low >= high and max(along(n, p) for p in one) > high:
            return True
    return False


def hull_planes(points: tuple[Corner, ...]) -> list[tuple[int, int, int, int]]:
    """Return the planes around the convex hull of corners, in order of their coefficients."""
    found: set[tuple[int, int, int, int]] = set()
    for a, b, c in combinations(points, 3):
        normal = cross(minus(b, a), minus(c, a))
        if normal == (0, 0, 0):
            continue
        largest = max(map(abs, normal))
        # Differences of corners are -1, 0 or 1: the components of a cross product are -2 to 2.
        if largest == 2 and all(part % 2 == 0 for part in normal):
            normal = (normal[0] // 2, normal[1] // 2, normal[2] // 2)
        for sign in (1, -1):
            n = (sign * normal[0], sign * normal[1], sign * normal[2])
            limit = along(n, a)
            if all(along(n, p) <= limit for p in points):
                found.add((*n, limit))
    return sorted(found)


def minus(a: Corner, b: Corner) -> Corner:
    """Return the difference of two points."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a: Corner, b: Corner) -> Corner:
    """Return the cross product of two vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def along(a: Corner, b: Corner) -> int:
    """Return the scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
