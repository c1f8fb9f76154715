"""Mesh files as many programs write them are read right, or refused for the true reason."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from distal import Polygon, Shape
from distal.diagnostics import LoadError
from distal.polygons.filling import filled, strips
from distal.polygons.reading import read_mesh
from tests.readers.mesh_variants import M_SHAPE, VARIANTS, Variant, is_right, prism_of


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda v: f"{v.suffix[1:]}-{v.name}")
def test_a_variant_is_read_right_or_refused_for_the_true_reason(
    tmp_path: Path, variant: Variant
) -> None:
    path = tmp_path / f"a{variant.suffix}"
    path.write_bytes(variant.data)
    try:
        mesh = read_mesh(path)
    except LoadError as error:
        assert variant.reason, error.message
        assert re.search(variant.reason, error.message)
        assert "\n" not in error.message
    else:
        assert variant.right is not None
        assert is_right(mesh.points[mesh.triangles], variant.right)


def test_the_notch_of_a_concave_cap_is_open(tmp_path: Path) -> None:
    text, _ = prism_of(M_SHAPE, [])
    (tmp_path / "m.obj").write_text(text)
    solid = Shape.from_mesh(str(tmp_path / "m.obj"), spacing=0.05)
    right = Polygon(M_SHAPE).extrude(1).translate(0, 0, 0.5)
    place = np.array([[1.0, 1.5, 0.0]])
    assert abs(solid(place) - right(place)).max() < 0.1


def area_of(corners: np.ndarray) -> float:
    x, y = corners.T
    return float(x @ np.roll(y, -1) - np.roll(x, -1) @ y) / 2


def simple_polygon(random: np.random.Generator, count: int) -> np.ndarray:
    """Return random points in an order in which no two edges cross."""
    places = random.integers(0, 40, (count, 2)).astype(float)
    places = np.unique(places, axis=0)
    order = random.permutation(len(places))
    for _ in range(400):
        corners = places[order]
        crossing = next(crossings(corners), None)
        if crossing is None:
            break
        i, j = crossing
        order[i + 1 : j + 1] = order[i + 1 : j + 1][::-1].copy()
    else:
        return np.zeros((0, 2))
    corners = places[order]
    return corners if area_of(corners) > 0 else corners[::-1]


def crossings(corners: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield pairs of edges that cross or touch each other."""
    ends = np.roll(corners, -1, axis=0)
    n = len(corners)
    for i in range(n):
        for j in range(i + 1, n):
            a, b, c, d = corners[i], ends[i], corners[j], ends[j]
            if j == i + 1 or (i == 0 and j == n - 1):
                p, q, r = (a, b, d) if j == i + 1 else (c, a, b)
                if cross(q - p, r - q) == 0 and (q - p) @ (r - q) < 0:
                    yield i, j
                continue
            s, t = (
                cross(b - a, c - a) * cross(b - a, d - a),
                cross(d - c, a - c) * cross(d - c, b - c),
            )
            apart = (np.maximum(a, b) < np.minimum(c, d)) | (np.maximum(c, d) < np.minimum(a, b))
            if s <= 0 and t <= 0 and not apart.any():
                yield i, j


def cross(first: np.ndarray, second: np.ndarray) -> float:
    return float(first[0] * second[1] - first[1] * second[0])


def check_filled(flat: np.ndarray, random: np.random.Generator) -> None:
    """Fill a polygon that is turned in space, and check its triangles."""
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    points = np.column_stack([flat, np.zeros(len(flat))]) @ turn.T + random.normal(size=3)
    count = len(flat)
    found = filled(points, np.array([count]), np.arange(count))
    assert len(found) == count - 2
    normal = turn[:, 2]
    a, b, c = points[found[:, 0]], points[found[:, 1]], points[found[:, 2]]
    areas = np.cross(b - a, c - a) @ normal / 2
    # No piece is turned around or flat, so that pieces of the right sum do not overlap.
    assert areas.min() > 1e-9 * areas.sum()
    assert areas.sum() == pytest.approx(area_of(flat))
    # Its border is that of the polygon; each edge inside has a triangle on both sides.
    edges = {(int(t[i]), int(t[(i + 1) % 3])) for t in found for i in range(3)}
    assert len(edges) == 3 * len(found)
    border = {edge for edge in edges if edge[::-1] not in edges}
    assert border == {(i, (i + 1) % count) for i in range(count)}


@pytest.mark.parametrize("seed", range(40))
def test_random_polygons_are_filled(seed: int) -> None:
    random = np.random.default_rng(seed)
    flat = simple_polygon(random, int(random.integers(4, 26)))
    if len(flat) < 4:
        pytest.skip("no order of these points was without crossings")
    check_filled(flat, random)


def test_a_spiral_and_points_on_straight_edges_are_filled() -> None:
    angles = np.linspace(0.0, 6.0 * np.pi, 60)
    inner, outer = 1.0 + angles / 2, 1.7 + angles / 2
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    spiral = np.concatenate([outer[:, None] * directions, (inner[:, None] * directions)[::-1]])
    check_filled(spiral, np.random.default_rng(1))
    middles = (spiral + np.roll(spiral, -1, axis=0)) / 2
    check_filled(np.stack([spiral, middles], axis=1).reshape(-1, 2), np.random.default_rng(2))


def test_holes_that_bridges_join_are_left_open() -> None:
    # A plate with two square holes; its outline runs to each of them and back.
    first = [(1.0, 1.0), (1, 2), (2, 2), (2, 1), (1, 1)]
    second = [(3.0, 1.0), (3, 2), (4, 2), (4, 1), (3, 1)]
    flat = np.array(
        [(0, 0), *first, (0, 0), (3, 0), *second, (3, 0), (5, 0), (5, 3), (0, 3)], float
    )
    points = np.column_stack([flat, np.zeros(len(flat))])
    found = filled(points, np.array([len(flat)]), np.arange(len(flat)))
    a, b, c = (flat[found[:, i]] for i in range(3))
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(13.0)
    middles = (a + b + c) / 3
    for x in (1.0, 3.0):
        inside = (middles > (x, 1.0)).all(axis=1) & (middles < (x + 1.0, 2.0)).all(axis=1)
        assert not inside.any()


def test_polygons_that_cross_themselves_or_are_flat_have_their_triangles() -> None:
    star = np.array([(np.cos(a), np.sin(a), 0.0) for a in np.arange(5) * 0.8 * np.pi])
    line = np.array([(float(i), 0.0, 0.0) for i in range(6)])
    twice = np.array([(0.0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 0), (0, 1, 0)])
    for points in (star, line, twice, np.zeros((5, 3)), star[:, [2, 0, 1]]):
        found = filled(points, np.array([len(points)]), np.arange(len(points)))
        assert len(found) == len(points) - 2
        assert set(found.reshape(-1).tolist()) == set(range(len(points)))


def test_polygons_of_several_kinds_keep_their_places() -> None:
    flat = np.array([(0.0, 0.0), (2, 0), (2, 2), (1, 0.5), (0, 2), (1, -1), (5, 5), (6, 5), (5, 6)])
    points = np.column_stack([flat, np.zeros(len(flat))])
    corners = [(6, 7, 8), (0, 1), (4, 0, 1, 2, 3), (0, 5, 1, 3), (6, 7, 8)]
    counts = np.array([len(c) for c in corners])
    found = filled(points, counts, np.concatenate(corners))
    assert found[0].tolist() == found[-1].tolist() == [6, 7, 8]
    assert len(found) == 1 + 0 + 3 + 2 + 1
    assert {*found[1:4].reshape(-1).tolist()} == {0, 1, 2, 3, 4}
    assert {*found[4:6].reshape(-1).tolist()} == {0, 5, 1, 3}


@pytest.mark.parametrize("seed", range(20))
def test_strips_are_those_of_their_definition(seed: int) -> None:
    random = np.random.default_rng(seed)
    lists = [random.integers(-1, 5, random.integers(0, 9)) for _ in range(random.integers(0, 5))]
    expected = []
    for each in lists:
        window: list[int] = []
        for index in each.tolist():
            window = [] if index < 0 else [*window, index]
            if len(window) >= 3:
                a, b, c = window[-3:]
                expected.append([a, b, c] if len(window) % 2 else [b, a, c])
    counts = np.array([len(each) for each in lists], np.int64)
    found = strips(counts, np.concatenate([np.zeros(0, np.int64), *lists]))
    assert found.tolist() == expected
