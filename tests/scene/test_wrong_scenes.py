"""Scenes that would show something else than meant are told so, and what is meant is taken."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    CompileError,
    Ellipsoid,
    Heightfield,
    PointLight,
    Rectangle,
    Scene,
    Shape,
    Sphere,
    VolumeField,
    by_cell,
    checker,
    glass,
    matte,
    time,
)
from distal.lang import func, slider, vec3

BALLS = [Sphere(0.3).translate(i, 0, 0) for i in range(3)]


def test_paint_of_cells_stands_inside_the_repetition():
    painted = Sphere(0.3).paint(matte(by_cell()))
    Scene(painted.repeat(1.0))
    Scene(painted.repeat_polar(1))
    Scene(painted.translate(1, 0, 0).array([(0, 0, 0), (3, 0, 0)]))
    Scene(Sphere().paint(by_cell()))  # a material may be used where nothing repeats
    for repeated in (
        Sphere(0.3).repeat(1.0),
        Sphere(0.3).repeat(1.0, neighbors=1),
        Sphere(0.3).translate(1, 0, 0).repeat_polar(4).rotate(x=1.0),
    ):
        with pytest.raises(ValueError, match="paints what is repeated already") as raised:
            Scene(repeated.paint(matte(by_cell())))
        assert "paint first, then repeat" in str(raised.value)


def test_what_does_not_fit_its_cell_is_told_how_large_it_is():
    petal = Ellipsoid((0.5, 0.1, 0.2)).translate(0.7, 0, 0)
    with pytest.raises(ValueError, match="no bound on its slope") as raised:
        Scene(petal.repeat(1.0))
    assert "its box goes from (0.2, -0.1, -0.2) to (1.2, 0.1, 0.2)" in str(raised.value)


SPACING = slider("Spacing", 4.0, low=0.5, high=8.0)
# It has a bound on its slope only if the spacing is larger than the box.
TOO_NARROW = Box(1.0).repeat(SPACING, count=(3, 1, 1))
TWISTED = TOO_NARROW.twist(0.3)
BENT = TOO_NARROW.translate(1.0, 0.0, 0.0).bend(0.2)


@pytest.mark.parametrize(
    "shape",
    [
        TWISTED,
        TOO_NARROW | TWISTED,
        TWISTED | TOO_NARROW,
        BENT | TWISTED | TOO_NARROW,
        (TOO_NARROW.paint("#f00") | TWISTED).twist(0.1) | BENT,
        Sphere().union(TWISTED, TOO_NARROW, smooth=0.1).scale(2.0),
    ],
)
def test_the_operator_that_loses_the_slope_is_named_where_a_part_is_shared(shape):
    scene = Scene(shape)
    scene.render((4, 4))
    with pytest.raises(ValueError, match="repeat limited gives this shape no bound") as raised:
        scene.render((4, 4), params={"Spacing": 0.6})
    assert "TOO_NARROW = Box(1.0).repeat(SPACING" in str(raised.value)


def test_shapes_and_lights_come_in_any_row():
    lights = (PointLight((i, 2.0, 3.0)) for i in range(2))
    scene = Scene((ball for ball in BALLS), lights=lights)
    assert len(scene.lights) == 2
    assert len(Scene(np.array(BALLS), floor=False).shape.node.children) == 3


def test_a_material_that_was_not_called_is_told():
    for made, name in ((glass, "glass"), (checker, "checker")):
        with pytest.raises(TypeError, match="a material or a color") as raised:
            Sphere().paint(made)
        assert f"call it: {name}()" in str(raised.value)
    with pytest.raises(TypeError, match="a material or a color") as raised:
        Sphere().paint(Sphere())
    assert "write matte" in str(raised.value)


@pytest.mark.parametrize(
    ("plane", "message"),
    [
        ((0, 0, 1), "a plane is a normal and an offset, not (0, 0, 1)"),
        (0.5, "a plane is a normal and an offset, not 0.5"),
        (((0, 0, 2), 0.5), "'normal of slice' must be a vector of length 1"),
        (((0, 0, 1), "high"), "'offset of slice' takes a number"),
    ],
)
def test_a_slice_needs_a_plane(plane, message):
    with pytest.raises((TypeError, ValueError)) as raised:
        Scene(Sphere()).render((8, 8), view="slice", plane=plane)
    assert message in str(raised.value)


def test_an_array_is_a_picture_or_a_volume():
    hill = np.full((8, 8), 0.5, np.float32)
    assert Heightfield(hill, height=1.0)((0.0, 0.5, 0.0)) == pytest.approx(0.0, abs=1e-6)
    grid = np.mgrid[-1:1:16j, -1:1:16j, -1:1:16j]
    ball = np.sqrt((grid**2).sum(axis=0)) - 0.5
    assert VolumeField(ball, size=2.0)((0.5, 0.0, 0.0)) == pytest.approx(0.0, abs=0.05)
    with pytest.raises(TypeError, match="takes a") as raised:
        Heightfield([[0.5, 0.5]])
    assert "or an array, or the name of a picture's file" in str(raised.value)


def test_degrees_are_doubted_where_radians_are_meant():
    for turn in (
        lambda: Sphere().rotate(y=90),
        lambda: Sphere().rotate(45.0, axis=(0, 1, 0)),
        lambda: Rectangle(1.0).rotate(-180),
    ):
        with pytest.warns(UserWarning, match=r"angles are radians.*write -?\d+ \* deg") as told:
            turn()
        assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for angle in (0, 15, 31.4, 12.0 * np.pi, 2 * time, np.radians(90)):
            Sphere().rotate(y=angle)


@func
def says_vector(p: vec3) -> vec3:
    return p


@func
def is_vector(p: vec3):
    return p


@func
def counts(p: vec3) -> int:
    return 1


@func
def makes_a_ball(p: vec3) -> float:
    return Sphere(1.0)(p)


def test_a_field_that_gives_no_distance_never_runs():
    for field, kind in ((says_vector, "vec3"), (is_vector, "vec3"), (counts, "int")):
        for asked in (lambda shape: shape((0, 0, 0)), lambda shape: shape.gradient((0, 0, 0))):
            with pytest.raises(CompileError, match=f"must be float, but this is {kind}"):
                asked(Shape.from_function(field))


def test_a_shape_is_made_outside_of_functions():
    with pytest.raises(CompileError) as raised:
        Shape.from_function(makes_a_ball)((0, 0, 0))
    assert "make it outside of the function, shape = Sphere(…)" in str(raised.value)


def test_a_scene_does_not_change():
    scene = Scene(Sphere())
    with pytest.raises(AttributeError, match="a scene does not change"):
        scene.camera = Camera((0, 0, 2))
    developed = scene.replace(exposure=2.0, tone_map="aces")
    assert developed.tone_map == "aces"
    with pytest.raises(AttributeError, match="a scene does not change"):
        developed.tone_map = "none"


def test_a_picture_is_an_array():
    picture = Scene(Sphere()).render((8, 6))
    np.testing.assert_array_equal(np.asarray(picture), picture.array)
    assert np.array(picture, np.float64).shape == (6, 8, 4)
