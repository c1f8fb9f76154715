"""Flat curves whose nearest point is searched: how near the search comes where it is hardest.

Beside the evolute, where centres of curvature lie, two roots of the nearest point's equation meet
and every iteration is slow. The oracle is the nearest of many points on the curve, which is too far
by no more than its spacing.
"""

from __future__ import annotations

import numpy as np
import pytest

import distal


def _nearest(points, curve):
    return np.array([np.min(np.linalg.norm(curve - p, axis=1)) for p in points])


def _never_farther(shape, points, curve, width=0.0, tolerance=2e-6):
    """The field's distance is at most the oracle's (whose error only makes it larger)."""
    found = np.abs(np.asarray(shape(points)) + width)
    oracle = _nearest(points, curve)
    spacing = np.linalg.norm(np.diff(curve, axis=0), axis=1).max()
    assert (found - oracle).max() <= tolerance
    assert (oracle - found).max() <= spacing


@pytest.mark.parametrize("radii", [(1.0, 0.5), (1.0, 0.02), (0.3, 1.0), (1.0, 0.999)])
def test_ellipses_beside_their_evolute(radii):
    a, b = radii
    t = np.linspace(0.0, 2.0 * np.pi, 20001)
    curve = np.stack([a * np.cos(t), b * np.sin(t)], axis=1)
    s = np.linspace(0.0, 0.5 * np.pi, 150)
    gap = a * a - b * b
    evolute = np.stack([gap / a * np.cos(s) ** 3, gap / b * np.sin(s) ** 3], axis=1)
    # The long axis, and points too close to it for their height to count in 32 bits.
    axis = np.linspace(-1.2, 1.2, 50)[:, None] * (1.0, 1e-7)
    points = np.concatenate([evolute[np.abs(evolute).max(axis=1) < 3.0], axis, axis[:, ::-1]])
    _never_farther(distal.Ellipse(radii), points, curve)


@pytest.mark.parametrize("curvature", [0.05, 1.0, 40.0])
def test_parabolas_beside_their_evolute(curvature):
    x = np.linspace(-1.0, 1.0, 40001) ** 3 * 4.0
    curve = np.stack([x, curvature * x * x], axis=1)
    s = np.linspace(-0.7, 0.7, 200)
    evolute = np.stack(
        [-4.0 * curvature**2 * s**3, 3.0 * curvature * s**2 + 0.5 / curvature], axis=1
    )
    points = evolute[np.abs(evolute).max(axis=1) < 4.0 * max(1.0, 1.0 / curvature)]
    found = np.abs(np.asarray(distal.Parabola(curvature)(points)))
    assert (found - _nearest(points, curve)).max() <= 2e-6


@pytest.mark.parametrize("steepness", [1e-3, 0.01, 1.0, 1e3])
def test_hyperbolas_next_to_their_surface(steepness):
    s = np.linspace(0.0, 2.0, 300)
    out, up = np.cosh(s), steepness * np.sinh(s)
    normal = np.stack([out, -np.sinh(s) / steepness], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    way = np.array([0.0, 1e-6, -1e-6, 1e-4, -1e-4])[:, None, None] * min(steepness, 1.0)
    points = np.stack([out, up], axis=1) - way * normal
    found = np.asarray(distal.Hyperbola(1.0, steepness)(points.reshape(-1, 2)))
    size = np.linalg.norm(points, axis=-1)
    assert (np.abs(found.reshape(size.shape) - way[..., 0]) / size).max() <= 4e-7


@pytest.mark.parametrize("curvature", [1e-4, 0.01, 1e3, 4e4])
def test_parabolas_of_any_curvature(curvature):
    # In focal lengths, normals of a parabola all have the same form.
    s = np.linspace(0.0, 3.0, 300)
    feet = np.stack([s, 0.5 * s * s], axis=1)
    normal = np.stack([s, -np.ones_like(s)], axis=1) / np.hypot(s, 1.0)[:, None]
    points = (feet + 0.7 * normal) * (0.5 / curvature)
    found = np.asarray(distal.Parabola(curvature)(points)) * (2.0 * curvature)
    assert np.abs(found - 0.7).max() <= 4e-6


def test_bezier_curves_beside_their_evolute():
    start, control, end = np.array([(-0.9, -0.4), (0.3, 0.9), (0.6, -0.7)])
    t = np.linspace(0.0, 1.0, 8001)[:, None]
    way, bend = control - start, end - 2.0 * control + start
    curve = start + (2.0 * way + bend * t) * t
    velocity = 2.0 * (way + bend * t)
    turn = 2.0 * (velocity[:, 0] * bend[1] - velocity[:, 1] * bend[0])
    radius = (velocity**2).sum(axis=1) / turn
    evolute = curve + np.stack([-velocity[:, 1], velocity[:, 0]], axis=1) * radius[:, None]
    points = evolute[::20]
    shape = distal.QuadraticBezier(tuple(start), tuple(control), tuple(end), radius=0.05)
    _never_farther(shape, points[np.abs(points).max(axis=1) < 3.0], curve, width=0.05)


def test_a_straight_bezier_curve_is_a_segment():
    points = np.random.default_rng(0).uniform(-2.0, 2.0, (300, 2))
    start, end = (-1.0, -0.5), (1.0, 0.75)
    for share in (0.5, 0.2, 0.0):
        control = tuple(np.array(start) + share * (np.array(end) - start))
        curve = distal.QuadraticBezier(start, control, end, radius=0.1)
        segment = distal.Segment(start, end, radius=0.1)
        assert np.asarray(curve(points)) == pytest.approx(np.asarray(segment(points)), abs=1e-6)


def test_four_pieces_follow_a_cubic_within_what_the_docstring_says():
    rng = np.random.default_rng(1)
    t = np.linspace(0.0, 1.0, 501)[:, None]
    for _ in range(5):
        p = rng.uniform(-1.0, 1.0, (4, 2))
        curve = (1 - t) ** 3 * p[0] + 3 * (1 - t) ** 2 * t * p[1] + 3 * (1 - t) * t * t * p[2]
        curve += t**3 * p[3]
        shape = distal.CubicBezier(*map(tuple, p), radius=0.05)
        assert (np.asarray(shape(curve)) + 0.05).max() < 2e-3 * np.ptp(p, axis=0).max()


@pytest.mark.parametrize(("inner", "turns"), [(0.1, 3), (0.01, 1), (0.5, 1)])
def test_parabolas_follow_spirals_within_what_the_docstrings_say(inner, turns):
    angle = np.linspace(0.0, 2.0 * np.pi * turns, 3001)
    share = angle / angle[-1]
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    even = distal.ArchimedeanSpiral(inner, 1.0, turns, radius=0.01)
    steady = distal.LogarithmicSpiral(inner, 1.0, turns, radius=0.01)
    on_even = (inner + (1.0 - inner) * share)[:, None] * around
    on_steady = (inner ** (1.0 - share))[:, None] * around
    assert (np.asarray(even(on_even)) + 0.01).max() < 1e-3
    assert (np.asarray(steady(on_steady)) + 0.01).max() < 1e-3


def test_gears_mesh():
    """Two gears of one tooth size at the sum of their radii touch and never overlap."""
    first, second = distal.GearProfile(0.6, count=12), distal.GearProfile(0.9, count=18)
    axis = np.linspace(-1.0, 1.0, 400)
    points = np.stack(np.meshgrid(axis * 0.3, 0.6 + axis * 0.15), axis=-1).reshape(-1, 2)
    for turn in np.linspace(0.0, 2.0 * np.pi / 12.0, 5):
        # A tooth of the first starts up; the second, above it, starts with a gap down.
        below = first.rotate(float(turn))
        above = second.rotate(float(np.pi + np.pi / 18.0 - turn * 12.0 / 18.0))
        both = np.maximum(np.asarray(below(points)), np.asarray(above.translate(0.0, 1.5)(points)))
        assert -1e-5 < both.min() < 5e-3
