"""Curves from formulas: their tubes, frames and copies, against closed forms."""

from __future__ import annotations

from math import cos, pi, sin, tau

import numpy as np
import pytest

from distal import Box, Capsule, Circle, CompileError, Curve, Rectangle, Sphere, circle_path
from distal.lang import slider

RING = Curve.from_function(lambda a: (2 * cos(a), 0.0, 2 * sin(a)), 0, tau)
HELIX = Curve.from_function(lambda a: (cos(a), 0.3 * a, sin(a)), 0, 2 * tau, tolerance=1e-3)
POINTS = np.random.default_rng(3).uniform(-3.0, 3.0, (1500, 3))


def knot(a: float) -> tuple[float, float, float]:
    return (2 + cos(3 * a)) * cos(2 * a), sin(3 * a), (2 + cos(3 * a)) * sin(2 * a)


def rotated(quaternion: np.ndarray, vector: tuple[float, float, float]) -> np.ndarray:
    v, w = quaternion[:, :3], quaternion[:, 3:]
    across = np.cross(v, vector)
    return np.array(vector) + 2.0 * (w * across + np.cross(v, across))


def test_the_tube_of_a_circle_is_a_torus():
    tube = RING.tube(0.3)
    true = np.hypot(np.hypot(POINTS[:, 0], POINTS[:, 2]) - 2.0, POINTS[:, 1]) - 0.3
    assert np.abs(tube(POINTS) - true).max() <= RING.error + 1e-6
    assert RING.closed and 0.0 < RING.error < 0.002
    assert not HELIX.closed


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3, 1e-4])
def test_the_tolerance_holds_between_the_measured_places(tolerance):
    curve = Curve.from_function(knot, 0, tau, tolerance=tolerance)
    on = np.array([knot(a) for a in np.linspace(0.0, tau, 3001)])
    far = curve.tube(0.1)(on) + 0.1
    assert curve.error <= tolerance
    assert far.max() <= 1.02 * tolerance
    tight = Curve.from_function(knot, 0, tau, tolerance=tolerance / 10.0)
    assert tight.pieces > curve.pieces


def test_the_tube_is_exact_for_the_parabolas_and_its_slope_is_one():
    tube = HELIX.tube(0.2)
    on = np.array([HELIX(t) for t in np.linspace(0.0, 1.0, 20001)])
    true = np.array([np.linalg.norm(on - p, axis=1).min() for p in POINTS[:300]]) - 0.2
    assert np.abs(tube(POINTS[:300]) - true).max() < 1e-4
    steps = np.random.default_rng(4).normal(size=POINTS.shape) * 0.02
    change = np.abs(tube(POINTS + steps) - tube(POINTS))
    assert (change <= np.linalg.norm(steps, axis=1) + 1e-5).all()
    low, high = tube.bounds()
    assert low == pytest.approx((-1.2, -0.2, -1.2), abs=3e-3)
    assert high == pytest.approx((1.2, 0.6 * tau + 0.2, 1.2), abs=3e-3)


def test_the_radius_of_a_tube_may_be_a_parameter():
    tube = RING.tube(slider("Radius", 0.3, low=0.1, high=0.5))
    assert tube((2.0, 0.0, 0.0), params={"Radius": 0.5}) == pytest.approx(-0.5, abs=2e-3)


def test_frames_follow_the_curve_and_do_not_twist():
    """Along a helix an untwisted frame turns back against the frame of the curvature."""
    points, turns = HELIX.frames(41)
    a = np.linspace(0.0, 2 * tau, 41)
    true = np.stack([-np.sin(a), np.full(41, 0.3), np.cos(a)], axis=1) / np.hypot(1.0, 0.3)
    ahead, side = rotated(turns, (0, 1, 0)), rotated(turns, (0, 0, 1))
    assert np.abs(ahead - true).max() < 0.02
    assert np.abs(points - np.stack([np.cos(a), 0.3 * a, np.sin(a)], axis=1)).max() < 5e-3
    normal = -np.stack([np.cos(a), np.zeros(41), np.sin(a)], axis=1)
    angle = np.unwrap(np.arctan2((np.cross(ahead, normal) * side).sum(1), (normal * side).sum(1)))
    # The curvature's frame turns by torsion: 0.3 / (1 + 0.09) for each unit of length.
    turned = (angle[-1] - angle[0]) / (2 * tau * np.hypot(1.0, 0.3))
    assert abs(turned) == pytest.approx(0.3 / 1.09, rel=0.01)


def test_frames_of_a_closed_curve_meet():
    curve = Curve.from_function(knot, 0, tau)
    _, turns = curve.frames(200)
    side = rotated(turns, (0, 0, 1))
    steps = np.linalg.norm(np.roll(side, -1, axis=0) - side, axis=1)
    assert steps[-1] < 2.0 * np.median(steps) + 0.02
    assert steps.max() < 0.25


def test_frames_with_a_fixed_up_and_other_axes():
    _, turns = RING.frames(12, up=(0, 1, 0), axis=(1, 0, 0))
    assert np.abs(rotated(turns, (0, 1, 0)) - (0.0, 1.0, 0.0)).max() < 1e-9
    points, _ = RING.frames(spacing=tau / 5)
    assert len(points) == 10


def test_each_copy_is_turned_further_by_the_roll():
    _, plain = RING.frames(8)
    _, turned = RING.frames(8, roll=pi / 2)
    a, b = rotated(plain, (0, 0, 1)), rotated(turned, (0, 0, 1))
    assert np.abs((a * b).sum(axis=1) - np.cos(pi / 2 * np.arange(8))).max() < 1e-9


def test_copies_lie_along_the_curve():
    beads = RING.copies(Capsule(radius=0.05, length=0.5), 6)
    for i in range(6):
        a = tau * i / 6
        ahead = np.array([-sin(a), 0.0, cos(a)])
        middle = np.array([2 * cos(a), 0.0, 2 * sin(a)])
        assert beads(tuple(middle + 0.2 * ahead)) < 0.0
        assert beads(tuple(middle + 0.2 * np.array([cos(a), 0.0, sin(a)]))) > 0.0


def test_an_outline_is_swept_along_an_open_curve():
    rail = HELIX.sweep(Rectangle(0.1, 0.3))
    on = np.array([HELIX(t) for t in np.linspace(0.02, 0.98, 60)])
    assert (rail(on) < 0.0).all()
    assert rail((0.0, 0.5, 0.0)) > 0.5


def test_an_outline_along_a_closed_curve_has_no_seam():
    # The ring's radius is 2; the outline's y axis starts along y.
    hoop = RING.sweep(Rectangle(0.4, 0.2), up=(0.0, 1.0, 0.0))
    pieces = 128
    for beside, height in ((0.1, 0.05), (0.3, 0.0), (0.0, 0.25), (-0.26, 0.16), (-0.1, -0.2)):
        radius = 2.0 + beside
        away = np.abs(np.array([beside, height])) - (0.2, 0.1)
        true = np.linalg.norm(np.maximum(away, 0.0)) + min(float(away.max()), 0.0)
        for share in (0.02, 0.5, 0.9):
            angles = (np.arange(pieces) + share) * (tau / pieces)
            level = np.full(pieces, height)
            values = hoop(np.stack([radius * np.cos(angles), level, radius * np.sin(angles)], 1))
            # The curve's error, and that of four straight pieces for each of its parabolas;
            # outside a sweep's value is a lower bound.
            assert float((values - true).min()) > -5e-3 and float((values - true).max()) < 2e-3
            # All pieces of the ring are alike, also those at its seam.
            assert float(values.max() - values.min()) < 5e-4
    assert hoop.slope == pytest.approx(1.0)


def test_a_wavy_closed_curve_keeps_its_outline_all_the_way():
    wave = Curve.from_function(
        lambda t: ((2 + 0.4 * cos(5 * t)) * cos(t), 0.0, (2 + 0.4 * cos(5 * t)) * sin(t)), 0, tau
    )
    rail = wave.sweep(Rectangle(0.1, 0.3))
    on = np.array([wave(t) for t in np.linspace(0.0, 1.0, 301)])
    assert (rail(on) < -0.04).all()
    assert (rail(on + np.array([0.0, 0.14, 0.0])) < 0.0).all()
    assert (rail(on + np.array([0.0, 0.17, 0.0])) > 0.0).all()


def test_a_curve_is_a_path_of_points_and_circles_are_curves():
    circle = Curve.from_function(circle_path(2.0))
    assert circle.closed
    assert circle(0.25) == pytest.approx(circle_path(2.0)(0.25), abs=2e-3)
    assert repr(RING).startswith("<closed curve of 32 parabolas, error 0.00038>")


def broken(a: float) -> tuple[float, float, float]:
    return (a, sin(1.0 / max(a, 1e-9)), 0.0)


WRONG = [
    (
        lambda: Curve.from_function(3),  # type: ignore[arg-type]
        "a curve is made from a function, not from 3",
    ),
    (lambda: Curve.from_function(lambda t: (0, 0, 0)), "the curve has no length"),
    (
        lambda: Curve.from_function(lambda t: (t, t)),
        "a curve returns three numbers, not (0.0, 0.0) as at t = 0",
    ),
    (
        lambda: Curve.from_function(broken, 0, 1, tolerance=1e-4),
        "the curve needs more than 512 pieces to be within 0.0001",
    ),
    (
        lambda: Curve.from_function(knot, 1, 1),
        "start and end of the curve are the same, 1",
    ),
    (
        lambda: Curve.from_function(knot, 0, tau).sweep(Circle(0.1)),
        "an outline along this closed curve does not meet itself: it comes back turned by ",
    ),
    (
        lambda: RING.sweep(Sphere(0.1)),  # type: ignore[arg-type]
        "a curve sweeps a flat shape, not",
    ),
    (lambda: RING.copies(Box(0.1)), "points_along takes either count or spacing"),
    (lambda: RING.copies(Box(0.1), 4, up=(0, 0, 0)), "'up of Curve' has no direction: it is zero"),
    (
        lambda: Curve.from_function(knot, 0, tau, tolerance=0),
        "'tolerance of Curve' must be above 0, not 0",
    ),
]


@pytest.mark.parametrize(("make", "message"), WRONG)
def test_what_is_wrong_is_said(make, message):
    with pytest.raises(CompileError) as found:
        make()
    assert found.value.diagnostics[0].message.startswith(message)
    assert found.value.diagnostics[0].span is not None
