"""Boxes and rectangles that are infinite along single axes."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from distal import (
    Box,
    BoxCheap,
    Camera,
    ChamferBox,
    CompileError,
    InfiniteCylinder,
    Plane,
    Rectangle,
    RoundBox,
    Scene,
    Sphere,
    union,
)
from distal.lang import slider
from distal.scene.lowering.known_bounds import known_bounds_of

POINTS = np.random.default_rng(2).uniform(-4.0, 4.0, (2000, 3)) * (10.0, 1.0, 1.0)


def test_a_bar_is_a_rectangle_in_space():
    bar, flat = Box(inf, 1.0, 0.5), Rectangle(1.0, 0.5)
    assert np.abs(bar(POINTS) - flat(POINTS[:, 1:])).max() < 1e-6
    assert bar.bounds() == ((-inf, -0.5, -0.25), (inf, 0.5, 0.25))
    assert bar.exact


def test_a_slab_is_two_planes():
    slab = Box(size=(inf, 1.0, inf))
    assert np.abs(slab(POINTS) - (np.abs(POINTS[:, 1]) - 0.5)).max() < 1e-6
    assert slab.bounds() == ((-inf, -0.5, -inf), (inf, 0.5, inf))
    cheap = BoxCheap((inf, 1.0, inf))
    assert np.abs(cheap(POINTS) - slab(POINTS)).max() < 1e-6


def test_round_bars_and_strips():
    bar, inner = RoundBox((inf, 1.0, 0.5), 0.2), Rectangle(0.6, 0.1)
    assert np.abs(bar(POINTS) - (inner(POINTS[:, 1:]) - 0.2)).max() < 1e-6
    strip = Rectangle(inf, 0.4)
    assert strip((1e4, 0.5)) == pytest.approx(0.3, abs=1e-6)
    assert strip.bounds() == ((-inf, -0.2), (inf, 0.2))
    assert strip.extrude(1.0).bounds()[0] == (-inf, -0.2, -0.5)


def test_operators_keep_infinite_sides():
    bar = Box(inf, 0.2, 0.2)
    moved = bar.translate(5.0, 1.0, 0.0).round(0.1)
    assert np.ravel(moved.bounds()) == pytest.approx([-inf, 0.8, -0.2, inf, 1.2, 0.2])
    comb = bar.repeat(0.0, 1.0, 1.0, count=(1, 3, 2))
    assert np.ravel(comb.bounds()) == pytest.approx([-inf, -1.1, -0.6, inf, 1.1, 0.6])
    assert comb((1e5, 1.0, 0.5)) == pytest.approx(-0.1, abs=1e-6)
    assert (bar & Box(3.0)).bounds()[1] == pytest.approx((1.5, 0.1, 0.1))
    assert (Sphere(1.0) - bar).bounds()[0] == (-1.0, -1.0, -1.0)
    turned = bar.rotate(z=0.5 * np.pi)
    assert turned((0.0, 1e4, 0.0)) == pytest.approx(-0.1, abs=1e-2)
    assert turned.bounds()[1][1] == inf


def test_a_size_may_be_infinite_beside_a_parameter():
    made = Box(inf, slider("Height", 1.0, low=0.2, high=2.0), 0.5)
    assert made((50.0, 0.8, 0.0), params={"Height": 1.2}) == pytest.approx(0.2, abs=1e-6)
    assert repr(Box(inf, 1.0, 0.5)) == 'Box(size=(float("inf"), 1.0, 0.5))'


@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_the_picture_is_that_of_a_long_box(device):
    """Rays meet both in closed form, also those along the bar."""
    views = [Camera((0.0, 1.0, 4.0), (0.0, 0.0, 0.0)), Camera((0.0, 1.0, 3.0), (90.0, 1.0, 3.0))]
    for camera in views:
        a, b = (
            Scene(
                union(Box(length, 0.4, 0.4), Sphere(0.5).translate(0, 0.6, 0)),
                camera=camera,
                background=(1, 1, 1),
            ).render((40, 30), samples=1, device=device, view="normal")
            for length in (inf, 1e6)
        )
        assert np.ptp(a.array[..., 0]) > 0.1
        assert np.abs(a.array - b.array).mean() < 2e-3


def test_what_is_wrong_is_said():
    with pytest.raises(CompileError, match="'size of Box' is infinite along all axes"):
        Box(inf)
    with pytest.raises(CompileError, match="takes a finite 32-bit number, not inf"):
        ChamferBox((inf, 1.0, 1.0))
    with pytest.raises(CompileError, match="takes a finite 32-bit number, not -inf"):
        Box(-inf, 1.0, 1.0)
    with pytest.raises(CompileError, match="takes a finite 32-bit number, not inf"):
        Sphere(inf)
    with pytest.raises(CompileError, match="twist gives this shape no bound on its slope"):
        Box(inf, 1.0, 1.0).twist(1.0)


# Transitions of infinite shapes


def test_a_floor_rises_to_another_floor() -> None:
    step = Plane(y=0.0).transition_linear(Plane(y=1.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    x = np.linspace(-3.0, 5.0, 81)
    height = np.clip(x / 2.0, 0.0, 1.0)  # linear, because the planes are less than 2 apart
    on = np.stack([x, height, 0.0 * x], axis=1)
    assert np.abs(step(on)).max() < 1e-6
    # Far from the way it is each of the planes; far above and below values are bounds.
    for place, plane in ((-9.0, 0.0), (9.0, 1.0)):
        for y in (-0.8, 0.4, 1.9):
            assert float(step([[place, y, 0.0]])[0]) == pytest.approx(y - plane, abs=1e-5)
        assert 60.0 < float(step([[place, 70.0, 0.0]])[0]) <= 70.0 - plane
        assert float(step([[place, -50.0, 0.0]])[0]) < -40.0


def test_surfaces_farther_apart_than_the_way_are_joined_by_a_wall() -> None:
    wall = Plane(y=0.0).transition_linear(Plane(y=9.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    # Where both planes are farther than the way is long, both count the same: the middle.
    for y in (2.0, 4.5, 7.0):
        assert float(wall([[0.5, y, 0.0]])[0]) == pytest.approx(0.0, abs=1e-5)
        assert float(wall([[0.0, y, 0.0]])[0]) > 0.5
        assert float(wall([[1.0, y, 0.0]])[0]) < -0.5


@pytest.mark.parametrize("ease", ["linear", "smooth"])
def test_the_slope_of_infinite_transitions_is_kept(ease: str) -> None:
    shapes = (
        Plane(y=0.0).transition_linear(Plane(y=9.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), ease),
        Sphere(1.0).transition_radial(Plane(y=-0.5), 0.5, 1.5, ease),
        InfiniteCylinder(1.0).transition_linear(Plane(), (-1.0, 0.0, 0.0), (0.5, 0.3, 0.0), ease),
    )
    random = np.random.default_rng(3)
    a = random.uniform(-3.0, 3.0, (20_000, 3))
    b = a + random.normal(0.0, 1e-2, a.shape)
    for shape in shapes:
        steepest = float((np.abs(shape(a) - shape(b)) / np.linalg.norm(a - b, axis=1)).max())
        assert 1.0 < steepest <= known_bounds_of(shape.node).slope * (1.0 + 1e-3)
