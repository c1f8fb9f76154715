"""The tables of cells: components, segments of faces, regions."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from distal.mesh import tables
from distal.mesh.tables import CORNERS, EDGES, FACES, cell_tables, edge_groups, region

CASES = tables.numbered_cases()[1]


def test_segments_join_the_edges_of_each_component_to_one_loop() -> None:
    # A component's boundary is one closed loop: every edge is on two faces.
    for mask, joined in CASES:
        pairs = [
            pair
            for axis, upper in FACES
            for pair in tables.face_segments(mask, axis, upper=upper, joined=joined)
        ]
        for group in edge_groups(mask, joined):
            own = [pair for pair in pairs if pair[0] in group]
            assert all(b in group for _, b in own)
            assert sorted(e for pair in own for e in pair) == sorted([*group, *group])


@pytest.mark.parametrize("joined", [0, 63])
def test_both_cells_of_a_face_see_the_same_segments(joined: int) -> None:
    for axis in range(3):
        step = 1 << axis
        for bits in range(16):
            upper = tables.face_corners(axis, upper=True)
            lower = tables.face_corners(axis, upper=False)
            below = sum(1 << c for i, c in enumerate(upper) if bits >> i & 1)
            above = sum(1 << c for i, c in enumerate(lower) if bits >> i & 1)
            seen = {
                frozenset(EDGES.index((EDGES[e][0], EDGES[e][1] & ~step)) for e in pair)
                for pair in tables.face_segments(below, axis, upper=True, joined=joined)
            }
            expected = tables.face_segments(above, axis, upper=False, joined=joined)
            assert seen == {frozenset(pair) for pair in expected}


def test_joined_faces_connect_their_inside_corners() -> None:
    mask = 0b1001  # two corners across the lower face along z
    assert len(edge_groups(mask)) == 2
    assert len(edge_groups(mask, 1 << FACES.index((2, False)))) == 1


def test_regions_of_a_cell_are_separable_by_planes() -> None:
    # This is why triangles of different components of a cell cannot intersect.
    made = cell_tables()
    assert len(CASES) == 656
    assert made.separable[made.case[:, 0]].all()
    assert int((~made.separable).sum()) == 12
    seen = set()
    for (mask, joined), separable in zip(CASES, made.separable, strict=True):
        parts = [region(group) for group in edge_groups(mask, joined)]
        pairs = list(combinations(parts, 2))
        found = all(separating_plane(a, b) for a, b in pairs if (a, b) not in seen)
        assert found == separable
        seen |= set(pairs) if separable else set()
    apart = [edge_groups(mask) for mask in range(256)]
    assert sum(len(groups) > 1 for groups in apart) == 92
    assert sum(len(list(combinations(groups, 2))) for groups in apart) == 118


def separating_plane(one: Any, other: Any) -> bool:
    """Whether linear programming finds n p >= d on one side, <= d on the other, not 0 for both."""
    rows = [[-x, -y, -z, 1.0] for x, y, z in one] + [[x, y, z, -1.0] for x, y, z in other]
    gain = np.array(rows).sum(axis=0)
    found = linprog(gain, A_ub=rows, b_ub=np.zeros(len(rows)), bounds=[(-1, 1)] * 4)
    return bool(found.status == 0 and found.fun < -1e-6)


def test_planes_are_those_of_the_convex_hull() -> None:
    made = cell_tables()
    for row, (mask, joined) in enumerate(CASES):
        groups = edge_groups(mask, joined)
        if len(groups) == 1:
            continue  # alone, a point may be anywhere in its cell
        for number, group in enumerate(groups):
            planes = made.planes[made.regions[row, number]].astype(float)
            planes = planes[planes[:, :3].any(axis=1)]
            expected = ConvexHull(np.array(region(group))).equations
            own = planes * [1.0, 1.0, 1.0, -1.0] / np.linalg.norm(planes[:, :3], axis=1)[:, None]
            assert unique_rows(own) == unique_rows(expected)


def unique_rows(rows: Any) -> set[tuple[float, ...]]:
    return {tuple(np.round(row, 6) + 0.0) for row in rows}


@pytest.mark.parametrize("mask", [0, 255])
def test_a_cell_without_a_change_has_nothing(mask: int) -> None:
    made = cell_tables()
    case = made.case[mask, 0]
    assert made.components[case] == 0
    assert (made.component[case] == -1).all() and (made.segments[case] == -1).all()


def test_corners_are_numbered_by_their_bits() -> None:
    assert [x + 2 * y + 4 * z for x, y, z in CORNERS] == list(range(8))
