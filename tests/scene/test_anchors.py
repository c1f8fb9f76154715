"""Measured extents, and shapes that are put on others by them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal.lang import slider
from distal.runtime.standard_executor import StandardExecutor
from distal.scene.objects import extents

QUARTER = math.pi / 4.0
# The rim of a ball cut off at a height of 1/2, turned about x by 1/2.
RIM = 0.5 * math.cos(0.5) + math.sqrt(0.75) * math.sin(0.5)


@pytest.mark.parametrize(
    ("shape", "high"),
    [
        # exact outside: asked from far away
        (distal.Box(1, 2, 3).rotate(z=QUARTER), (1.5 * math.sqrt(0.5), 1.5 * math.sqrt(0.5), 1.5)),
        (distal.Torus(1.0, 0.25).rotate(x=QUARTER), (1.25, math.sqrt(0.5) + 0.25, None)),
        (distal.Sphere(1) | distal.Box(1).translate(1, 0, 0), (1.5, 1.0, 1.0)),
        (distal.Ring(1.0, thickness=0.2, opening=1.0).rotate(0.0) | distal.Circle(1.5), (1.5, 1.5)),
        # searched
        (distal.Box(2) - distal.Sphere(1.2).translate(0, 1, 0), (1.0, 1.0, 1.0)),
        ((distal.Sphere(1) - distal.Box(4).translate(0, 2.5, 0)).rotate(x=0.5), (1.0, RIM, 1.0)),
        (distal.Ellipsoid((1, 2, 0.5)).rotate(z=QUARTER), (math.sqrt(2.5), math.sqrt(2.5), 0.5)),
    ],
)
def test_extents_are_closed_forms(shape, high):
    low, found = shape.extents()
    known = [(a, b) for a, b in zip(found, high, strict=True) if b is not None]
    assert [a for a, _ in known] == pytest.approx([b for _, b in known], abs=2e-6)
    box = shape.bounds()
    assert all(a >= b - 1e-9 for a, b in zip(low, box[0], strict=True))
    assert all(a <= b + 1e-9 for a, b in zip(found, box[1], strict=True))


def test_shapes_that_are_exact_outside_are_measured_without_numpy(monkeypatch):
    monkeypatch.setattr(extents, "executor", StandardExecutor)
    monkeypatch.setattr(extents, "imported", lambda name: pytest.fail(f"{name} was asked for"))
    low, high = distal.Box(1, 2, 3).rotate(z=QUARTER).extents()
    assert high == pytest.approx((1.5 * math.sqrt(0.5), 1.5 * math.sqrt(0.5), 1.5), abs=2e-6)
    assert low == pytest.approx([-h for h in high])


def test_a_shape_stands_on_each_side():
    below = distal.Box(2, 4, 6).translate(1, 0, 0)
    sides = {"top": (1, 2.0, 0), "bottom": (1, -2.0, 1), "right": (0, 2.0, 0)}
    sides |= {"left": (0, 0.0, 1), "front": (2, 3.0, 0), "back": (2, -3.0, 1)}
    for side, (axis, at, end) in sides.items():
        placed = distal.Box(1).translate(5, 6, 7).on(below, side).extents()
        assert placed[end][axis] == pytest.approx(at, abs=1e-6)
        middles = [(a + b) / 2.0 for a, b in zip(*placed, strict=True)]
        others = [i for i in range(3) if i != axis]
        assert [middles[i] for i in others] == pytest.approx(
            [(1.0, 0.0, 0.0)[i] for i in others], abs=1e-6
        )


def test_a_rotated_shape_stands_on_its_corner_not_on_its_box():
    ball = distal.Ellipsoid((1, 2, 0.5)).rotate(z=QUARTER)
    placed = ball.on(distal.Box(1), gap=0.25)
    moved = placed.bounds()[0][1] - ball.bounds()[0][1]
    assert moved == pytest.approx(0.75 + math.sqrt(2.5), abs=4e-6)
    assert ball.bounds()[0][1] < -math.sqrt(2.5) - 0.1


def test_a_gap_may_be_a_parameter():
    gap = slider("Gap", 0.5, low=0.0, high=1.0)
    placed = distal.Sphere(0.5).on(distal.Box(1), gap=gap)
    assert placed.bounds()[0][1] == pytest.approx(1.0)
    assert placed.bounds(params={"gap": 0.0})[0][1] == pytest.approx(0.5)


def test_shapes_are_aligned():
    placed = distal.Box(0.5).translate(z=3).align(distal.Box(2), x="low", y="high")
    assert placed.bounds() == ((-1.0, 0.5, 2.75), (-0.5, 1.0, 3.25))
    middle = distal.Circle(0.5).align(distal.Rectangle(2, 4).translate(1, 1), y="center")
    assert np.allclose(middle.bounds(), ((-0.5, 0.5), (0.5, 1.5)))


def test_parameters_that_leave_the_extents_work():
    hole = slider("Hole", 0.2, low=0.1, high=0.4)
    part = distal.Box(1) - distal.Cylinder(hole, 2.0)
    assert distal.Sphere(0.5).on(part).bounds()[0][1] == pytest.approx(0.5, abs=1e-6)


SIZE = slider("Size", 1.0, low=0.5, high=2.0)
MISTAKES = [
    (lambda b: b.on(distal.Box(1, SIZE, 1)), "extents of 'Box' follow the parameter 'Size'"),
    (lambda b: b.on(distal.Box(1).translate(y=distal.time)), "'translate' follow the time"),
    (lambda b: b.on(distal.Box(1) - distal.Box(SIZE).translate(y=0.5)), "the parameter 'Size'"),
    (lambda b: b.on(distal.Plane()), "needs shapes that end, and 'Plane' is infinite"),
    (lambda b: b.on(distal.Box(1), "up"), "there is no side 'up'"),
    (lambda b: b.on(distal.Circle(1)), "on() takes another solid shape, not 'Circle'"),
    (lambda b: b.on("top"), "on() takes another shape, not 'top'"),
    (lambda b: b.align(distal.Box(1)), "align() needs an axis"),
    (lambda b: b.align(distal.Box(1), x="left"), "x of align() is 'low', 'center' or 'high'"),
    (lambda b: (b & b.translate(9, 0, 0)).extents(), "found nothing of 'intersection'"),
]


@pytest.mark.parametrize(("make", "message"), MISTAKES)
def test_mistakes_are_named(make, message):
    with pytest.raises((ValueError, TypeError)) as caught:
        make(distal.Box(0.5))
    assert message in str(caught.value)
    assert "test_anchors.py" in str(caught.value)
