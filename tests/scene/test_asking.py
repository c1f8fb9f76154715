"""Asking shapes in other words: grids of points, lists of shapes, methods by other names."""

from __future__ import annotations

import functools
import operator

import numpy as np
import pytest

from distal import Box, Circle, Sphere, Torus

GRID = np.stack(np.meshgrid(np.linspace(-1, 1, 4), np.linspace(-1, 1, 5), 0.25), -1)


def test_a_grid_of_points_gives_a_grid():
    ball = Sphere(0.5)
    assert GRID.shape == (5, 4, 1, 3)
    np.testing.assert_allclose(ball(GRID), np.linalg.norm(GRID, axis=-1) - 0.5)
    np.testing.assert_allclose(ball.gradient(GRID), GRID / np.linalg.norm(GRID, axis=-1)[..., None])
    assert Circle()(GRID[..., :2]).shape == (5, 4, 1)


def test_points_of_another_shape_are_told_what_is_taken():
    with pytest.raises(TypeError, match=r"takes \(p: vec3\) -> float"):
        Sphere()(GRID[..., :2])
    with pytest.raises(TypeError, match=r"one array of points with 3 numbers each; 3 arguments"):
        Sphere()(1.0, 2.0, 3.0)


def test_a_list_of_shapes_is_joined_like_the_shapes():
    balls = [Sphere(0.3).translate(0.5 * i, 0, 0) for i in range(4)]
    joined = balls[0].union(balls[1:], smooth=0.05)
    np.testing.assert_array_equal(joined(GRID), balls[0].union(*balls[1:], smooth=0.05)(GRID))
    reduced = functools.reduce(operator.or_, balls)
    np.testing.assert_array_equal(balls[0].union(balls[1:])(GRID), reduced(GRID))
    np.testing.assert_array_equal(balls[0].union(b for b in balls)(GRID), reduced(GRID))
    np.testing.assert_array_equal(
        Box(1.0).difference(balls)(GRID), (Box(1.0) - balls[0].union(balls[1:]))(GRID)
    )


@pytest.mark.parametrize(
    ("join", "message"),
    [
        (lambda: sum([Sphere(), Box()]), "joined by |, not by +"),
        (lambda: Sphere() + Box(), "a.union(list)"),
        (lambda: Sphere().union(Box(), 0.1), "smooth=0.1 is given by name"),
        (lambda: Sphere().union([Box(), "ring"]), "a union joins shapes, not 'ring'"),
    ],
)
def test_what_joins_nothing_is_told_what_does(join, message):
    with pytest.raises(TypeError) as raised:
        join()
    assert message in str(raised.value)


@pytest.mark.parametrize(
    ("shape", "name", "message"),
    [
        (Sphere(), "move", "'Sphere' has no 'move'; there is translate(x, y, z)"),
        (Sphere(), "color", "'Sphere' has no 'color'; there is paint(material or color)"),
        (Sphere() | Box(), "extrude", "'Shape' has no 'extrude': it is for flat shapes"),
        (Circle(), "twist", "'Circle' has no 'twist': it is for solids"),
        (Torus(), "save", "there is render((640, 480)).save(file), and mesh().save(file)"),
        (Torus(), "nonsense", "'Torus' has no 'nonsense'"),
    ],
)
def test_methods_by_other_names_are_told_the_right_one(shape, name, message):
    with pytest.raises(AttributeError) as raised:
        getattr(shape, name)
    assert message in str(raised.value)


def test_scaling_takes_parts_by_name():
    wide = Sphere().scale(x=2.0)
    assert wide.bounds() == ((-2.0, -1.0, -1.0), (2.0, 1.0, 1.0))
    assert Sphere().scale(np.array([2.0, 1.0, 1.0])).bounds() == wide.bounds()
    assert Circle().scale(y=3.0).bounds() == ((-1.0, -3.0), (1.0, 3.0))
