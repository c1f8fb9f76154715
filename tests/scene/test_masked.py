"""Operators limited to a region: which shape is where, the border, slopes, messages."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Circle, CompileError, Plane, Rectangle, Scene, Sphere, cell, matte

POINTS = np.random.default_rng(4).uniform(-1.6, 1.6, (6000, 3))
BODY = Box(1.0, 2.4, 1.0)
REGION = Sphere(0.9).translate(0.2, 0.3, 0.0)


def test_each_shape_is_on_its_side():
    made = BODY.where(REGION, lambda s: s.twist(1.5))
    inside, a, b = REGION(POINTS) < 0.0, BODY(POINTS) < 0.0, BODY.twist(1.5)(POINTS) < 0.0
    assert np.array_equal(made(POINTS) < 0.0, np.where(inside, b, a))
    with_blend = BODY.where(REGION, BODY.twist(1.5), blend=0.05)
    far = np.abs(REGION(POINTS)) > 0.3
    assert np.array_equal(with_blend(POINTS)[far] < 0.0, np.where(inside, b, a)[far])


def test_the_border_is_no_surface_inside():
    """Without what both have in common, the value would be 0 all along the border."""
    made = BODY.where(Plane(y=0), BODY.twist(1.5))
    x, z = np.meshgrid(np.linspace(-0.3, 0.3, 9), np.linspace(-0.3, 0.3, 9))
    border = np.stack([x.ravel(), np.zeros(81), z.ravel()], axis=1)
    assert made(border).max() < -0.05


def test_a_shape_that_is_not_changed_is_the_same():
    same = BODY.where(REGION, BODY, blend=0.0)
    assert np.array_equal(same(POINTS) < 0.0, BODY(POINTS) < 0.0)
    blended = BODY.where(REGION, BODY, blend=0.05)
    on = POINTS[np.abs(BODY(POINTS)) < 0.01]
    assert len(on) > 20
    assert np.abs(blended(on)).max() < 0.06


@pytest.mark.parametrize("blend", [0.0, 0.1])
def test_values_are_continuous_and_the_slope_holds(blend):
    made = BODY.where(REGION, lambda s: s.bend(0.4), blend=blend)
    steps = np.random.default_rng(5).normal(size=POINTS.shape) * 0.01
    change = np.abs(made(POINTS + steps) - made(POINTS))
    assert (change <= made.slope * np.linalg.norm(steps, axis=1) + 1e-6).all()


def test_materials_and_flat_shapes_and_cells():
    red, blue = matte("red"), matte("blue")
    made = BODY.paint(red).where(Plane(y=0), lambda s: s.paint(blue))
    picture = Scene(made, background="white").render((40, 60), samples=1, view="color").array
    assert picture[15, 20, 0] > picture[15, 20, 2]
    assert picture[42, 20, 2] > picture[42, 20, 0]
    flat = Rectangle(2.0, 1.0).where(Circle(0.3), lambda s: s.scale(0.1))
    assert flat((0.2, 0.0)) > 0.0 > flat((0.05, 0.0))
    row = (
        Box(0.4)
        .where(Plane(y=0.1), lambda s: s.rotate(y=0.3 * cell.x))
        .repeat(1.0, count=(3, 1, 1))
    )
    assert row((0.0, 0.0, 0.0)) < 0.0


def test_what_is_wrong_is_said():
    with pytest.raises(CompileError, match="a region of where is a shape, not 3"):
        BODY.where(3, BODY)  # type: ignore[arg-type]
    with pytest.raises(CompileError, match="what is shown there of where is a shape, not None"):
        BODY.where(REGION, lambda s: None)  # type: ignore[arg-type, return-value]
    with pytest.raises(CompileError, match="a region of where is a flat shape; the shape is a so"):
        BODY.where(Circle(1.0), BODY)
    with pytest.raises(CompileError, match="'blend of where' must be 0 or more, not -1"):
        BODY.where(REGION, BODY, blend=-1.0)
