"""Patterns around a whole cylinder, against the copies wrapped one by one and rotated."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Circle, CompileError, Pentagram, Rectangle, cell, union
from distal.lang import select

RANDOM = np.random.default_rng(11)
ANGLE = RANDOM.uniform(-np.pi, np.pi, 6000)
OUT = np.concatenate([RANDOM.uniform(0.05, 1.6, 2000), RANDOM.uniform(0.8, 1.2, 4000)])
POINTS = np.stack([OUT * np.sin(ANGLE), RANDOM.uniform(-0.5, 0.5, 6000), OUT * np.cos(ANGLE)], 1)
STAR = Pentagram(0.25).translate(0.05, 0.1)


def rotated(shape, count):
    # From one copy to the next, the arc goes from z towards x.
    return union(shape.rotate(y=2.0 * np.pi * i / count) for i in range(count))


@pytest.mark.parametrize("count", [3, 4, 8])
def test_the_surface_is_that_of_the_copies(count):
    made = STAR.wrap_cylinder(1.0, 0.3, count=count)
    oracle = rotated(STAR.wrap_cylinder(1.0, 0.3), count)
    found, true = made(POINTS), oracle(POINTS)
    assert (true < 0.0).sum() > 50
    assert np.array_equal(found < 0.0, true < 0.0)


def test_there_is_no_jump_at_the_seam():
    made = Pentagram(0.5).wrap_cylinder(1.0, 0.3, count=5)
    for angle in np.linspace(-np.pi, np.pi, 721):
        x, z = np.sin(angle), np.cos(angle)
        side = np.array([np.cos(angle), 0.0, -np.sin(angle)]) * 1e-5
        for out in (0.7, 1.0, 1.3):
            p = np.array([[x * out, 0.1, z * out]])
            assert abs(made(p + side)[0] - made(p - side)[0]) <= made.slope * 2.2e-5 + 1e-7


def test_an_outline_as_wide_as_the_circumference_is_a_ring():
    made = Rectangle(2.0 * np.pi, 0.4).wrap_cylinder(1.0, 0.3, count=1)
    inside = (np.abs(OUT - 1.0) < 0.15) & (np.abs(POINTS[:, 1]) < 0.2)
    assert inside.sum() > 100
    assert np.array_equal(made(POINTS) < 0.0, inside)


def test_copies_may_overlap_and_differ():
    made = Circle(0.75).wrap_cylinder(1.0, 0.2, count=5)
    single = Circle(0.75).wrap_cylinder(1.0, 0.2)
    assert np.array_equal(made(POINTS) < 0.0, rotated(single, 5)(POINTS) < 0.0)
    varied = Circle(0.1 + 0.05 * cell.x).wrap_cylinder(1.0, 0.2, count=4)
    for i in range(4):
        a = 0.5 * np.pi * i
        for radius, inside in ((0.09 + 0.05 * i, True), (0.11 + 0.05 * i, False)):
            p = (float(np.sin(a)), radius, float(np.cos(a)))
            assert (varied(p) < 0.0) is inside
    both = select(cell.x % 2.0 < 0.5, Circle(0.2), None).wrap_cylinder(1.0, 0.2, count=4)
    assert both((0.0, 0.0, 1.0)) < 0.0 < both((1.0, 0.0, 0.0))


def test_values_are_safe_to_march_and_the_slope_holds():
    made = STAR.wrap_cylinder(1.0, 0.3, count=6)
    steps = RANDOM.normal(size=POINTS.shape) * 0.02
    change = np.abs(made(POINTS + steps) - made(POINTS))
    assert (change <= made.slope * np.linalg.norm(steps, axis=1) + 1e-6).all()
    surface = POINTS[np.abs(made(POINTS)) < 0.01]
    assert len(surface) > 20
    away = np.array([np.linalg.norm(surface - p, axis=1).min() for p in POINTS[:500]])
    assert (np.abs(made(POINTS[:500])) / made.divisor <= away + 0.012).all()


def test_what_is_too_wide_is_refused():
    with pytest.raises(CompileError, match=r"at most 0\.9 of the way to the next copy"):
        Circle(1.2).wrap_cylinder(1.0, 0.2, count=6)
    with pytest.raises(CompileError, match="count must be 1 or more"):
        Circle(0.1).wrap_cylinder(1.0, 0.2, count=0)
