"""Flat faces have the triangles that they need, and curved ones those that the tolerance needs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal import Box, Capsule, Cylinder, Polygon, Sphere, linear_gradient
from distal.devices import threads
from distal.mesh import fewer, triangle_arithmetic
from distal.mesh.checks import checked, close_pairs, intersecting_pairs
from distal.mesh.face_groups import face_groups, mates_of
from distal.mesh.flat_faces import without_spare_points
from distal.mesh.kernels import rows_of
from distal.mesh.solid import Mesh
from tests.mesh.test_mesh import turned, volume_of

FAULTLESS = {"open_edges": 0, "pinched_points": 0, "intersections": 0}


def areas(points: Any, triangles: Any) -> Any:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def without_points(points: Any, triangles: Any) -> Any:
    """The triangles with few points; they have no faults."""
    close = 1e-6 * float(np.ptp(points, axis=0).max())
    rows, _ = without_spare_points(
        points, triangles, face_groups(points, triangles, None, close), close
    )
    used, corners = np.unique(rows, return_inverse=True)
    assert checked(points[used], corners.reshape(-1, 3)) == FAULTLESS
    return rows


# Flat faces


@pytest.mark.parametrize("distance", [0.0, 1.0])
def test_boxes_are_twelve_triangles(distance: float) -> None:
    made = (Box(1.0) | Box(1.0).translate(x=distance)).mesh(check=True)
    assert len(made.triangles) == made.report["triangles"] == 12 < made.report["triangles_before"]
    assert len(made.points) == len(made.normals) == 8  # type: ignore[arg-type]
    assert made.report["check"] == FAULTLESS
    assert volume_of(made.points, made.triangles) == pytest.approx(1.0 + distance, rel=1e-9)


def test_a_plate_with_a_bore_has_its_volume_and_its_area() -> None:
    wide, high, radius, tolerance = 40.0, 6.0, 7.0, 0.02
    made = (Box(wide, high, wide) - Cylinder(radius, 20.0)).mesh(tolerance, check=True)
    assert made.report["check"] == FAULTLESS
    error = made.report["error"]["largest"]
    assert error <= tolerance
    # The bore's facets are within the tolerance on both sides of the surface.
    around = 2.0 * math.pi * (radius + tolerance) * high
    volume = wide * wide * high - math.pi * radius**2 * high
    area = (
        2.0 * (wide * wide - math.pi * radius**2)
        + 4.0 * wide * high
        + 2.0 * math.pi * radius * high
    )
    assert abs(volume_of(made.points, made.triangles) - volume) <= around * tolerance
    found = areas(made.points, made.triangles).sum()
    assert abs(found - area) <= 2.0 * around * tolerance / high + 0.01 * around
    # As many corners as two rims of a polygon within the tolerance need, and half as many more.
    needed = math.ceil(math.pi / math.acos(1.0 - tolerance / radius))
    assert len(made.triangles) <= 1.5 * 4 * needed + 24
    assert made.report["triangles_before"] > 5 * len(made.triangles)


def squares(seed: int) -> Any:
    """Squares of a grid with holes and without squares that touch at a corner only."""
    rng = np.random.default_rng(seed)
    found = np.zeros((14, 14), np.bool_)
    found[1:-1, 1:-1] = rng.random((12, 12)) < 0.75
    while True:
        a, b, c, d = found[:-1, :-1], found[1:, :-1], found[:-1, 1:], found[1:, 1:]
        diagonal = np.argwhere(((a & d) & ~(b | c)) | ((b & c) & ~(a | d)))
        if not len(diagonal):
            return found
        x, y = diagonal[0]
        found[x : x + 2, y : y + 2] = False


def slab(filled: Any) -> tuple[Any, Any]:
    """The surface of squares one unit high, two triangles for each square of it."""
    quads = []
    for x, y in np.argwhere(filled):
        ring = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        quads.append([(*p, 1) for p in ring])
        quads.append([(*p, 0) for p in ring[::-1]])
        for i, (dx, dy) in enumerate(((0, -1), (1, 0), (0, 1), (-1, 0))):
            if not filled[x + dx, y + dy]:
                p, q = ring[i], ring[(i + 1) % 4]
                quads.append([(*p, 0), (*q, 0), (*q, 1), (*p, 1)])
    corners = np.array(quads).reshape(-1, 3)
    points, which = np.unique(corners, axis=0, return_inverse=True)
    a, b, c, d = which.reshape(-1, 4).T
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return points.astype(np.float64), triangles


def parts_of(filled: Any) -> int:
    """How many parts there are whose squares share sides."""
    left, count = {tuple(p) for p in np.argwhere(filled).tolist()}, 0
    while left:
        count += 1
        some = [left.pop()]
        while some:
            x, y = some.pop()
            beside = {(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)} & left
            left -= beside
            some += beside
    return count


@pytest.mark.parametrize("seed", range(12))
def test_polygons_with_holes_become_as_many_triangles_as_their_corners_need(seed: int) -> None:
    filled = squares(seed)
    points, triangles = slab(filled)
    places = turned(points * (1.0, 0.7, 1.3) + (3.0, 5.0, 0.0), x=0.3, y=0.5, z=0.7)
    rows = without_points(places, triangles)
    around = sum(filled[i : 13 + i, j : 13 + j].astype(int) for i in (0, 1) for j in (0, 1))
    corners = int((around % 2 == 1).sum())
    holes = parts_of(~filled) - 1
    # n corners and h holes are n + 2 h - 2 triangles; each side has two.
    assert len(rows) == 2 * (corners + 2 * holes - 2 * parts_of(filled)) + 2 * corners
    assert volume_of(places, rows) == pytest.approx(volume_of(places, triangles), rel=1e-12)
    for axis in range(3):
        for way in (-1.0, 1.0):
            seen = [_seen(points, some, axis, way) for some in (rows, triangles)]
            assert seen[0] == pytest.approx(seen[1], rel=1e-12)


def _seen(points: Any, triangles: Any, axis: int, way: float) -> float:
    """The area that looks along an axis."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float(np.maximum(way * np.cross(b - a, c - a)[:, axis], 0.0).sum() / 2.0)


@pytest.mark.parametrize("seed", [3, 4])
def test_a_star_with_holes_has_the_area_of_its_corners(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 17))
    radii = rng.uniform(6.0, 10.0, 17)
    corners = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    x, y = corners.T
    area = 0.5 * abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())) - 3.0
    star = Polygon([tuple(p) for p in corners.tolist()]).extrude(2.0)
    for angle in (0.3, 2.4, 4.5):
        star = star - Box(1.0, 1.0, 5.0).translate(
            3.0 * math.cos(angle), 3.0 * math.sin(angle), 0.0
        )
    made = star.mesh(0.005, check=True)
    assert made.report["check"] == FAULTLESS
    assert _seen(made.points, made.triangles, 2, 1.0) == pytest.approx(area, rel=1e-3)
    # The star's corners and those of the holes, on both sides, if none of them is cut.
    assert len(made.triangles) <= 1.5 * (2 * (29 + 6 - 2) + 2 * 29)


def prism(sides: int) -> tuple[Any, Any]:
    """A prism of radius 1 with so many sides, each cut into four rows, and caps that are fans."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    rings = [np.stack([np.cos(angles), np.sin(angles), np.full(sides, z)], 1) for z in range(5)]
    points = np.concatenate([*rings, [(0, 0, 0), (0, 0, 4)]])
    i = np.arange(sides)
    j = (i + 1) % sides
    rows = []
    for ring in range(4):
        low, high = ring * sides, (ring + 1) * sides
        rows += [
            np.stack([low + i, low + j, high + j], 1),
            np.stack([low + i, high + j, high + i], 1),
        ]
    rows += [np.stack([j, i, np.full(sides, 5 * sides)], 1)]
    rows += [np.stack([4 * sides + i, 4 * sides + j, np.full(sides, 5 * sides + 1)], 1)]
    return points, np.concatenate(rows)


def test_sides_that_hardly_bend_are_no_flat_face() -> None:
    # Neighbors are within 1e-6 of each other's planes, all sides together are a cylinder.
    sides = 3500
    points, triangles = prism(sides)
    found = face_groups(points, triangles, None, 1e-6 * 4.0)
    caps = found.of[8 * sides : 9 * sides], found.of[9 * sides :]
    assert all(len(np.unique(cap)) == 1 for cap in caps) and caps[0][0] != caps[1][0]
    sizes = np.bincount(found.of[: 8 * sides] + 1)[1:]
    assert sizes.max() < 0.02 * 8 * sides
    for cap, way in zip(caps, (-1.0, 1.0), strict=True):
        assert np.abs(found.normals[cap[0]] - (0.0, 0.0, way)).max() < 1e-9


def test_a_prism_keeps_its_sides() -> None:
    points, triangles = prism(7)
    assert len(without_points(points, triangles)) == 7 * 2 + 2 * 5


def test_neighbors_are_found() -> None:
    _, triangles = prism(5)
    mates = mates_of(triangles)
    ends = np.stack([triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)], axis=1)
    assert (ends[mates] == ends[:, ::-1]).all()
    assert (mates[mates] == np.arange(len(mates))).all()


def test_a_face_whose_triangles_would_intersect_keeps_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The step of flat faces alone: collapses, which are checked too, may touch such a face."""
    filled = np.zeros((7, 7), np.bool_)
    filled[1:-1, 1:-1] = True
    points, triangles = slab(filled)
    calls = []

    def meeting(points: Any, triangles: Any, some: Any, watch: Any, faces: Any = None) -> Any:
        calls.append(len(triangles))
        top = np.flatnonzero((points[triangles][:, :, 2] == 1.0).all(axis=1))
        return top[:1] if len(calls) == 1 else top[:0]

    monkeypatch.setattr(fewer, "meeting_triangles", meeting)
    rows = fewer._with_flat_faces(points, triangles, None, lambda share: None)
    assert len(calls) == 2 and calls[0] == 12
    kept, before = (
        {tuple(sorted(row)) for row in some[(points[some][:, :, 2] == 1.0).all(axis=1)].tolist()}
        for some in (rows, triangles)
    )
    assert kept == before and len(kept) == 2 * 25
    # Two below; the sides have the points of the top's edges.
    assert len(rows) == 2 * 25 + 2 + 4 * 6
    used, corners = np.unique(rows, return_inverse=True)
    assert checked(points[used], corners.reshape(-1, 3)) == FAULTLESS


# Colors


def test_faces_of_two_colors_stay_apart() -> None:
    left = Box(1.0).paint("#ff0000")
    right = Box(1.0).paint("#0000ff").translate(x=1.0)
    made = (left | right).mesh(check=True)
    assert made.report["check"] == FAULTLESS
    assert made.triangle_colors is not None
    # Four sides of two squares, and an end of each.
    assert len(made.triangles) == 20
    blue = made.triangle_colors[:, 2] == 1.0
    found = areas(made.points, made.triangles)
    assert found[blue].sum() == pytest.approx(5.0, rel=1e-3)
    assert found[~blue].sum() == pytest.approx(5.0, rel=1e-3)


def test_gradients_keep_their_points() -> None:
    shades = linear_gradient("#000000", "#ffffff", start=(0, -0.5, 0), end=(0, 0.5, 0))
    made = Box(1.0).paint(shades).mesh(check=True)
    assert made.report["check"] == FAULTLESS
    corners = made.points[made.triangles]
    ends = (np.abs(corners[:, :, 1]) > 0.499).all(axis=1)
    # The sides vary: they keep their triangles. Top and bottom do not, and have points at edges.
    assert np.ptp(corners[~ends][:, :, 1], axis=1).max() < 0.3  # joined cells
    assert (np.abs(corners[ends][:, :, ::2]).max(axis=2) > 0.499).all()
    assert 0.5 * made.report["triangles_before"] < len(made.triangles)
    assert len(made.triangles) < made.report["triangles_before"]


# Curved faces


SOLIDS = {
    "capsule": Capsule(1.0, 5.0),
    "csg": (Sphere(1.0) & Box(1.5)) - Cylinder(0.4, 3.0),
    "bracket": (
        Box(6.0, 1.4, 3.0).translate(0, 0.7, 0) | Box(1.4, 5.0, 3.0).translate(-2.3, 2.5, 0)
    )
    - Cylinder(0.5, 8.0).translate(1.0, 0, 0.2),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_curved_faces_are_within_the_tolerance_both_ways(name: str) -> None:
    shape, tolerance = SOLIDS[name], 0.01
    made = shape.mesh(tolerance, check=True)
    report = made.report
    assert report["check"] == FAULTLESS and not report["warnings"]
    assert len(made.triangles) < 0.5 * report["triangles_before"]
    assert report["error"]["largest"] <= tolerance
    rng = np.random.default_rng(1)
    rows = made.triangles[rng.integers(0, len(made.triangles), 20000)]
    weights = rng.dirichlet((1.0, 1.0, 1.0), len(rows))
    assert (
        np.abs(shape(np.einsum("ij,ijk->ik", weights, made.points[rows]))).max() < 1.1 * tolerance
    )
    # Points of the surface: those of a much finer mesh.
    fine = shape.mesh(0.2 * tolerance)
    some = fine.points[rng.integers(0, len(fine.points), 1500)]
    assert to_mesh(made, some).max() < 1.1 * tolerance


def to_mesh(made: Mesh, places: Any) -> Any:
    """The distance of each place to the nearest triangle."""
    corners = [np.repeat(made.points[made.triangles[:, i]][None], len(places), 0) for i in range(3)]
    flat = [corner.reshape(-1, 3) for corner in corners]
    p = np.repeat(places, len(made.triangles), axis=0)
    found = rows_of(triangle_arithmetic.distance_to_triangle, p, *flat)
    return found.reshape(len(places), -1).min(axis=1)


def test_no_triangle_of_a_curved_face_is_low() -> None:
    made = SOLIDS["capsule"].mesh(0.01)
    heights = rows_of(
        triangle_arithmetic.least_height, *(made.points[made.triangles[:, i]] for i in range(3))
    )
    assert heights.min() >= 0.2 * 0.01


def test_points_at_triangles_that_intersect_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = SOLIDS["csg"].mesh(0.01)
    calls = []
    kept = fewer.meeting_triangles

    def meeting(points: Any, triangles: Any, some: Any, watch: Any, faces: Any = None) -> Any:
        calls.append(len(triangles))
        if len(calls) == 2:  # the first is that of flat faces
            return np.flatnonzero(some)[:5]
        return kept(points, triangles, some, watch, faces)

    monkeypatch.setattr(fewer, "meeting_triangles", meeting)
    made = SOLIDS["csg"].mesh(0.01, check=True)
    assert len(calls) > 2 and made.report["check"] == FAULTLESS
    assert made.triangles.tobytes() != plain.triangles.tobytes()
    assert 0.9 * len(plain.triangles) < len(made.triangles) < 1.5 * len(plain.triangles)


def test_the_same_bytes_again(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    for count in (1, 2):
        monkeypatch.setattr(threads, "usable_threads", lambda count=count: count)
        made.append(SOLIDS["bracket"].mesh(0.02))
    assert made[0].points.tobytes() == made[1].points.tobytes()
    assert made[0].triangles.tobytes() == made[1].triangles.tobytes()


# What checks compare


def test_pairs_of_triangles_of_all_sizes_are_found() -> None:
    rng = np.random.default_rng(5)
    sizes = 10.0 ** rng.uniform(-3.0, 0.3, 400)
    corners = rng.uniform(-1.0, 1.0, (400, 1, 3)) + sizes[:, None, None] * rng.normal(
        size=(400, 3, 3)
    )
    points, triangles = corners.reshape(-1, 3), np.arange(1200).reshape(-1, 3)
    low, high = corners.min(axis=1), corners.max(axis=1)
    meet = (low[:, None] <= high[None]).all(axis=2) & (low[None] <= high[:, None]).all(axis=2)
    expected = {(i, j) for i, j in np.argwhere(meet).tolist() if i < j}
    assert pairs(points, triangles, None) == expected
    some = rng.random(400) < 0.1
    assert pairs(points, triangles, some) == {(i, j) for i, j in expected if some[i] or some[j]}
    found = {tuple(sorted(pair)) for pair in intersecting_pairs((points,), triangles).tolist()}
    kept = {tuple(sorted(pair)) for pair in intersecting_pairs((points,), triangles, some).tolist()}
    assert kept == {(i, j) for i, j in found if some[i] or some[j]} and len(kept) > 5


def pairs(points: Any, triangles: Any, some: Any) -> set[tuple[int, int]]:
    found = [
        (min(pair), max(pair))
        for one, other in close_pairs((points,), triangles, some)
        for pair in zip(one.tolist(), other.tolist(), strict=True)
    ]
    assert len(found) == len(set(found))
    return set(found)
