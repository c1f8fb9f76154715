"""Triangles that are cut where colors and finishes meet: where borders are, and what stays true."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import Box, Camera, Scene, Sphere, checker, linear_gradient, metal
from distal.lang import func, vec3
from distal.mesh import jumps
from distal.mesh.checks import checked
from distal.mesh.solid import Mesh

SOUND = {"open_edges": 0, "pinched_points": 0, "intersections": 0}
RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
NORMAL, LEVEL = np.array((0.6, 0.8, 0.0)), 0.1


@func
def halves(p: vec3) -> vec3:
    """Red on one side of a plane, blue on the other."""
    return vec3(1.0, 0.0, 0.0) if p.x * 0.6 + p.y * 0.8 < 0.1 else vec3(0.0, 0.0, 1.0)


@func
def three(p: vec3) -> vec3:
    """The halves, and green above another plane: all meet in two points of a ball."""
    return vec3(0.0, 1.0, 0.0) if p.z > 0.3 else halves(p)


@func
def seen_from_z(p: vec3) -> vec3:
    """Three colors that meet in the middle of what is seen along z."""
    below = vec3(1.0, 0.0, 0.0) if p.y < 0.1 else vec3(0.0, 0.0, 1.0)
    return vec3(0.0, 1.0, 0.0) if p.x > 0.3 else below


def sound(made: Mesh) -> None:
    """Check that a mesh is closed, manifold and free of intersections, in 64 and in 32 bits."""
    assert checked(made.points, made.triangles) == SOUND
    single = made.points.astype(np.float32).astype(np.float64)
    assert checked(single, made.triangles) == SOUND
    assert made.normals is not None
    np.testing.assert_allclose(np.linalg.norm(made.normals, axis=1), 1.0, rtol=1e-9)


def border_sides(made: Mesh) -> Any:
    """The sides between triangles of different colors, (k, 2)."""
    ends = np.stack([made.triangles, np.roll(made.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    keys = ends.min(axis=1) * len(made.points) + ends.max(axis=1)
    order = np.argsort(keys, kind="stable").reshape(-1, 2)
    assert made.triangle_colors is not None
    differ = (made.triangle_colors[order[:, 0] // 3] != made.triangle_colors[order[:, 1] // 3]).any(
        1
    )
    return ends[order[differ, 0]]


def longest_side(made: Mesh) -> float:
    corners = made.points[made.triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())


@pytest.mark.parametrize("tolerance", [0.02, 0.002])
def test_the_border_of_two_halves_is_where_the_plane_is(tolerance: float) -> None:
    made = Sphere(1.0).paint(halves).mesh(tolerance)
    sound(made)
    assert made.triangle_colors is not None
    assert set(map(tuple, made.triangle_colors.tolist())) == {RED, BLUE}
    ends = border_sides(made)
    off = np.abs(made.points[ends] @ NORMAL - LEVEL)
    # A border that is closer to a corner than this share of the side stays there.
    assert off.max() <= jumps.NEAR_END * longest_side(made)
    assert np.median(off) < 1e-6
    length = np.linalg.norm(np.diff(made.points[ends], axis=1), axis=2).sum()
    circle = 2.0 * np.pi * np.sqrt(1.0 - LEVEL**2)
    assert length == pytest.approx(circle, rel=2.0 * tolerance)
    corners = made.points[made.triangles]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    red = made.triangle_colors[:, 0] == 1.0
    assert area[red].sum() / area.sum() == pytest.approx((1.0 + LEVEL) / 2.0, abs=0.1 * tolerance)


def test_three_colors_meet_in_points() -> None:
    made = Sphere(1.0).paint(three).mesh(0.01)
    sound(made)
    assert made.triangle_colors is not None
    assert set(map(tuple, made.triangle_colors.tolist())) == {RED, GREEN, BLUE}
    ends = border_sides(made)
    at, ways = np.unique(ends, return_counts=True)
    meeting = made.points[at[ways == 3]]
    # Where both planes cross the ball: z = .3, and x on the line of the first plane.
    along = np.sqrt(1.0 - 0.3**2 - LEVEL**2)
    expected = [LEVEL * NORMAL + (s * along * -0.8, s * along * 0.6, 0.3) for s in (-1.0, 1.0)]
    assert len(meeting) == 2
    off = np.linalg.norm(meeting[:, None] - np.array(expected)[None], axis=2).min(axis=0)
    assert off.max() < 0.02 * longest_side(made) + 0.01


BALLS = (
    Sphere(1.0).translate(x=-0.6).paint("#ff0000"),
    Sphere(1.0).translate(x=0.6).paint("#0000ff"),
)


def test_a_narrow_blend_has_its_border_in_the_middle() -> None:
    made = BALLS[0].union(BALLS[1], smooth=0.002).mesh(0.01)
    sound(made)
    assert made.triangle_colors is not None
    ends = border_sides(made)
    a, b = (np.linalg.norm(made.points - (x, 0.0, 0.0), axis=1) for x in (-0.6, 0.6))
    # The colors are mixed where the distances differ by less than four times the blend.
    assert np.abs(a - b)[ends].max() < 4 * 0.002 + jumps.NEAR_END * longest_side(made)
    length = np.linalg.norm(np.diff(made.points[ends], axis=1), axis=2).sum()
    assert length >= 2.0 * np.pi * 0.8 * 0.98
    corners = made.points[made.triangles].mean(axis=1)
    blue = made.triangle_colors[:, 2] > 0.5
    assert (blue == (corners[:, 0] > 0.0)).all()


@func
def display(x: float) -> float:
    """The sRGB value of linear light."""
    return 12.92 * x if x < 0.0031308 else 1.055 * x ** (1.0 / 2.4) - 0.055


def test_two_colors_of_a_wide_blend_meet_where_the_palette_says() -> None:
    made = BALLS[0].union(BALLS[1], smooth=0.1).mesh(0.01, colors=2)
    sound(made)
    assert made.triangle_colors is not None
    palette = np.unique(made.triangle_colors, axis=0)
    assert len(palette) == 2
    shares = np.linspace(0.0, 1.0, 100_001)
    shown = display(np.stack([1.0 - shares, 0.0 * shares, shares], axis=1).ravel()).reshape(-1, 3)
    known = display(palette.ravel()).reshape(-1, 3)
    nearer = [np.linalg.norm(shown - entry, axis=1) for entry in known]
    share = shares[np.argmin(np.abs(nearer[0] - nearer[1]))]
    points = made.points[np.unique(border_sides(made))]
    a, b = (np.linalg.norm(points - (x, 0.0, 0.0), axis=1) - 1.0 for x in (-0.6, 0.6))
    # The share of the second: 1/2 + (a - b) / (8 smooth).
    off = 0.5 + (a - b) / (8.0 * 0.1) - share
    assert np.median(np.abs(off)) < 1e-4
    assert np.abs(off).max() < 2.0 * jumps.NEAR_END * longest_side(made) / (8.0 * 0.1)


def test_gradients_are_not_cut() -> None:
    ramp = linear_gradient("#ff0000", "#0000ff", start=(0, -1, 0), end=(0, 1, 0))
    made = Sphere(1.0).paint(ramp).mesh(0.01)
    assert made.report["border_points"] == 0 and made.triangle_colors is None
    plain = Sphere(1.0).mesh(0.01)
    # No triangle is cut, and none is spared: the color varies in each.
    assert len(made.triangles) == plain.report["triangles_before"] > len(plain.triangles)
    wide = BALLS[0].union(BALLS[1], smooth=0.15).mesh(0.002)
    assert wide.report["border_points"] == 0


def test_patterns_on_flat_faces_keep_volume_and_bounds() -> None:
    squares = checker("#ff0000", "#00ff00", size=0.31)
    made = Box(1.0).rotate(x=0.3, y=0.4).paint(squares).mesh(0.02)
    sound(made)
    assert made.report["border_points"] > 1000
    assert made.report["triangles"] == len(made.triangles)
    assert made.report["points"] == len(made.points)
    a, b, c = np.moveaxis(made.points[made.triangles], 1, 0)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(1.0, rel=1e-3)
    plain = Box(1.0).rotate(x=0.3, y=0.4).mesh(0.02)
    np.testing.assert_allclose(made.bounds, plain.bounds, rtol=0.0, atol=1e-12)
    # Colors beside borders too: points that are not middles, away from the border by a little.
    # Places are spread evenly over the surface.
    rng = np.random.default_rng(5)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    rows = rng.choice(len(area), 20_000, p=area / area.sum())
    shares = rng.dirichlet((1, 1, 1), len(rows))
    places = np.einsum("ij,ijk->ik", shares, made.points[made.triangles[rows]])
    near = np.abs((places / 0.31) - np.round(places / 0.31)).min(axis=1) * 0.31
    cells = np.floor(places / 0.31).sum(axis=1) % 2
    assert made.triangle_colors is not None
    odd = made.triangle_colors[rows, 1] > 0.5
    agree = (cells == 1) == odd
    far = near > 0.005
    share = agree[far].mean()
    assert max(share, 1.0 - share) > 0.999


def test_finishes_are_cut_too() -> None:
    shape = Sphere(1.0).paint(metal("#808080", 0.2)) & Box(4.0)
    body = shape.translate(x=-0.6).union(Sphere(1.0).translate(x=0.6).paint("#808080"))
    made = body.mesh(0.02)
    sound(made)
    assert made.finish is not None and len(made.finish.kinds) == 2  # type: ignore[union-attr]


def test_colors_are_those_of_the_picture() -> None:
    shape, size = Sphere(1.0).paint(seen_from_z), 48
    made = shape.mesh(0.02)
    camera = Camera(position=(0.0, 0.0, 6.0), target=(0.0, 0.0, 0.0), fov_deg=20.0)
    picture = Scene(shape, camera=camera, background="black").render((size, size)).array
    across = ((np.arange(size) + 0.5) / size * 2.0 - 1.0) * np.tan(np.radians(10.0))
    ways = np.stack([*np.meshgrid(across, -across), -np.ones((size, size))], axis=2)
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    # A ball hides at (o + t w): the nearer root.
    half = ways @ np.array((0.0, 0.0, 6.0))
    inside = half**2 - 35.0
    t = -half - np.sqrt(np.maximum(inside, 0.0))
    seen = np.array((0.0, 0.0, 6.0)) + t[..., None] * ways
    planes = np.abs(seen[..., :2] - (0.3, 0.1)).min(axis=2)
    rows = np.argwhere((inside > 0.3) & (planes > 0.06))
    assert len(rows) > 300
    places = seen[rows[:, 0], rows[:, 1]]
    # The triangle that a place is seen through from the center: all its planes have it inside.
    a, b, c = np.moveaxis(made.points[made.triangles], 1, 0)
    sides = [places @ np.cross(p, q).T for p, q in ((a, b), (b, c), (c, a))]
    found = np.min(sides, axis=0).argmax(axis=1)
    assert made.triangle_colors is not None
    expected = made.triangle_colors[found].argmax(axis=1)
    assert set(expected.tolist()) == {0, 1, 2}
    assert (picture[rows[:, 0], rows[:, 1], :3].argmax(axis=1) == expected).all()
