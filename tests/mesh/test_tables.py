"""The tables of cells: components, segments of faces, regions."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from distal.mesh import tables
from distal.mesh.tables import CORNERS, EDGES, cell_tables, edge_groups, region


def test_segments_join_the_edges_of_each_component_to_one_loop() -> None:
    # A component's boundary is one closed loop: every edge is on two faces.
    for mask in range(256):
        pairs = [
            pair
            for axis in range(3)
            for upper in (False, True)
            for pair in tables.face_segments(mask, axis, upper=upper)
        ]
        for group in edge_groups(mask):
            own = [pair for pair in pairs if pair[0] in group]
            assert all(b in group for _, b in own)
            assert sorted(e for pair in own for e in pair) == sorted([*group, *group])


def test_both_cells_of_a_face_see_the_same_segments() -> None:
    for axis in range(3):
        step = 1 << axis
        for bits in range(16):
            upper = tables.face_corners(axis, upper=True)
            lower = tables.face_corners(axis, upper=False)
            below = sum(1 << c for i, c in enumerate(upper) if bits >> i & 1)
            above = sum(1 << c for i, c in enumerate(lower) if bits >> i & 1)
            seen = {
                frozenset(EDGES.index((EDGES[e][0], EDGES[e][1] & ~step)) for e in pair)
                for pair in tables.face_segments(below, axis, upper=True)
            }
            assert seen == {
                frozenset(pair) for pair in tables.face_segments(above, axis, upper=False)
            }


def test_regions_of_a_cell_are_separable_by_planes() -> None:
    # This is why triangles of different components of a cell cannot intersect.
    several = [mask for mask in range(256) if len(edge_groups(mask)) > 1]
    pairs = [(a, b) for mask in several for a, b in combinations(edge_groups(mask), 2)]
    assert (len(several), len(pairs)) == (92, 118)
    for one, other in {(region(a), region(b)) for a, b in pairs}:
        # Find a plane n p = d with n p >= d on one side, <= d on the other, not 0 for both.
        rows = [[-x, -y, -z, 1.0] for x, y, z in one] + [[x, y, z, -1.0] for x, y, z in other]
        gain = np.array(rows).sum(axis=0)
        found = linprog(gain, A_ub=rows, b_ub=np.zeros(len(rows)), bounds=[(-1, 1)] * 4)
        assert found.status == 0 and found.fun < -1e-6


def test_planes_are_those_of_the_convex_hull() -> None:
    made = cell_tables()
    for mask in range(256):
        groups = edge_groups(mask)
        for number, group in enumerate(groups):
            planes = made.planes[mask, number].astype(float)
            planes = planes[planes[:, :3].any(axis=1)]
            if len(groups) == 1:
                assert not len(planes)  # alone, a point may be anywhere in its cell
                continue
            expected = ConvexHull(np.array(region(group))).equations
            own = planes * [1.0, 1.0, 1.0, -1.0] / np.linalg.norm(planes[:, :3], axis=1)[:, None]
            assert unique_rows(own) == unique_rows(expected)


def unique_rows(rows: Any) -> set[tuple[float, ...]]:
    return {tuple(np.round(row, 6) + 0.0) for row in rows}


@pytest.mark.parametrize("mask", [0, 255])
def test_a_cell_without_a_change_has_nothing(mask: int) -> None:
    made = cell_tables()
    assert made.components[mask] == 0
    assert (made.component[mask] == -1).all() and (made.segments[mask] == -1).all()


def test_corners_are_numbered_by_their_bits() -> None:
    assert [x + 2 * y + 4 * z for x, y, z in CORNERS] == list(range(8))
