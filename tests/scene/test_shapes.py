"""Shapes as objects: what they become, and what they answer."""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal import Box, Circle, CompileError, Plane, Scene, Shape, Sphere, Torus, time
from distal.lang import func, length, sin, slider, vec2, vec3
from distal.packages import PackageError
from distal.scene.lowering import known_bounds

POINTS = np.random.default_rng(7).uniform(-2.0, 2.0, (200, 3))


@func
def wobbly(p: vec3, depth: float) -> float:
    return length(p) - 1.0 - depth * sin(9.0 * p.x) * sin(9.0 * p.y)


@func
def celled(p: vec3, cell: vec3) -> float:
    return length(p) - 0.1 - 0.05 * cell.x


def test_a_shape_answers_distances_of_both_precisions():
    ball = Sphere(0.75)
    wanted = np.linalg.norm(POINTS, axis=1) - 0.75
    assert ball(POINTS).dtype == np.float64
    np.testing.assert_allclose(ball(POINTS), wanted, atol=1e-12)
    assert ball(POINTS.astype(np.float32)).dtype == np.float32
    assert ball((1.0, 0.0, 0.0)) == 0.25


def test_its_gradient_is_that_of_the_distance():
    shape = (Box(1.0) | Torus(0.75, 0.25).rotate(x=0.4)).translate(0.1, 0.2, 0.3)
    step = 1e-6
    columns = []
    for axis in np.eye(3):
        columns.append((shape(POINTS + step * axis) - shape(POINTS - step * axis)) / (2 * step))
    wanted = np.stack(columns, axis=1)
    off_creases = np.abs(np.linalg.norm(wanted, axis=1) - 1.0) < 1e-4
    assert off_creases.mean() > 0.95
    np.testing.assert_allclose(shape.gradient(POINTS)[off_creases], wanted[off_creases], atol=1e-5)


def test_parameters_and_time_move_it_and_its_box():
    height = slider("Height", 0.5, low=0.0, high=4.0)
    ball = Sphere(0.5).translate(0, height + np.sin(time), 0)
    at = np.array([[0.0, 2.0, 0.0]])
    assert ball(at)[0] == pytest.approx(1.0)
    assert ball(at, params={"height": 1.0})[0] == pytest.approx(0.5)
    assert ball(at, time=math.pi / 2)[0] == pytest.approx(0.0, abs=1e-6)
    low, high = ball.bounds(params={"height": 1.0})
    assert low == pytest.approx((-0.5, 0.5, -0.5))
    assert high == pytest.approx((0.5, 1.5, 0.5))
    assert [p.name for p in ball.parameters()] == ["height"]


def test_a_box_may_be_without_end():
    low, high = (Sphere() | Plane(-1.0)).bounds()
    assert low[0] == -math.inf and high[0] == math.inf


def test_claims_follow_the_operators():
    assert Sphere().translate(1, 0, 0).exact
    assert not (Sphere() | Box(1.0)).exact
    assert Sphere().slope == 1.0
    assert (Sphere() - Box(1.0)).slope == 1.0


def test_numbers_are_no_part_of_the_text():
    def text(radius, at):
        shape = Sphere(radius).translate(at, 0, 0) | Box(1.0).rotate(y=at)
        return distal.compile(Scene(shape)).text

    assert text(1.0, 2.0).replace("test_shapes.py", "") == text(0.25, -3.0).replace(
        "test_shapes.py", ""
    )


def test_equal_subtrees_become_one_function():
    def arm(at):
        return (Sphere(0.3) | Box(0.4).translate(0, at, 0)).translate(at, 0, 0)

    text = distal.compile(arm(1.0) | arm(2.0) | arm(3.0).rotate(y=1.0)).text
    assert text.count("float translate_distance(") == 1
    assert text.count("translate_distance(") == 4


def test_a_named_shape_is_a_function_of_that_name():
    handle = Torus(0.5, 0.1).translate(1, 0, 0).named("handle")
    assert "float handle_distance(vec3 p)" in distal.compile(Sphere() | handle).text


def test_an_own_function_is_a_shape():
    ball = Shape.from_function(wobbly, slope=1.5, bounds=((-1.2,) * 3, (1.2,) * 3), depth=0.05)
    wanted = (
        np.linalg.norm(POINTS, axis=1)
        - 1.0
        - 0.05 * np.sin(9 * POINTS[:, 0]) * np.sin(9 * POINTS[:, 1])
    )
    np.testing.assert_allclose(ball(POINTS), wanted, atol=1e-6)
    assert ball.slope == 1.5
    assert ball.bounds() == ((-1.2,) * 3, (1.2,) * 3)


def test_an_own_function_may_differ_from_cell_to_cell():
    row = Shape.from_function(celled, bounds=((-0.3,) * 3, (0.3,) * 3)).repeat(1.0, count=(3, 1, 1))
    centres = np.array([[-1.0, 0, 0], [0, 0, 0], [1.0, 0, 0]])
    np.testing.assert_allclose(row(centres), [-0.1, -0.15, -0.2], atol=1e-6)


def test_a_shape_is_a_function_of_scene_code():
    pair = Sphere(0.5) | Sphere(0.5).translate(2, 0, 0)

    @func
    def lifted(p: vec3) -> float:
        return pair(p - vec3(0.0, 1.0, 0.0)) - 0.1

    np.testing.assert_allclose(
        lifted(POINTS), pair(POINTS - np.array([0.0, 1.0, 0.0])) - 0.1, atol=1e-9
    )


def test_flat_shapes_answer_in_the_plane():
    disc = Circle(0.5).translate(1, 0)
    np.testing.assert_allclose(disc(np.array([[1.0, 0.0], [2.0, 0.0]])), [-0.5, 0.5])

    @func
    def own(p: vec2) -> float:
        return length(p) - 0.5

    assert isinstance(Shape.from_function(own), distal.Shape2D)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sphere(-1.0), "radius of Sphere must be above 0"),
        (lambda: Sphere() | Circle(), "joins a flat shape and a solid one"),
        (lambda: Sphere().union(Box(), blend="soap"), "there is no blend 'soap'"),
        (lambda: Sphere().rotate(x=1.0, axis=(0, 1, 0)), "a rotation is given in exactly one way"),
        (lambda: Sphere().symmetry("xw"), "symmetry takes letters of 'xyz'"),
        (lambda: Sphere().union("box"), "a union joins shapes"),
        (lambda: Scene([]), "a scene without shapes shows nothing"),
        (lambda: Scene(Circle()), "is a flat shape; a scene shows solids"),
        (lambda: Scene(Sphere(), tone_map="film"), "there is no tone map 'film'"),
        (lambda: Sphere().named(""), "a name is a text"),
        (lambda: Shape.from_function(print), "a shape is made from a @func"),
    ],
)
def test_mistakes_are_told_at_the_authors_line(make, message):
    with pytest.raises(CompileError) as caught:
        make()
    assert message in str(caught.value)
    assert "test_shapes.py" in str(caught.value)


@pytest.mark.parametrize("is_missing", [True, False])
def test_without_numpy_an_operator_is_made_all_the_same(monkeypatch, is_missing):
    def refused(module):
        raise PackageError(f"{module} cannot be loaded", is_missing=is_missing)

    monkeypatch.setattr(known_bounds, "imported", refused)
    assert Sphere(0.5).twist(1.25).node.rule.name == "twist"
