"""Patterns give the colors they say at places, and stand wherever colors and numbers do."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image as PillowImage

from distal.images.picture import Picture
from distal.ir.types import FLOAT
from distal.lang import Texture2D, func, slider, vec3
from distal.lang.expressions import time
from distal.render.material import Surface
from distal.scene.objects.materials import Material, glass, matte
from distal.scene.objects.patterns import (
    by_cell,
    checker,
    cube_map,
    image_pattern,
    linear_gradient,
    noise,
    palette,
    pattern,
    radial_gradient,
    stripes,
    waves,
)
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.scene.probing import emitted

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
GREY = 0.21586  # what 128 of 255 in sRGB is as light


@func
def hills(p: vec3, height: float) -> float:
    return p.y * height


@func
def shiny(p: vec3, amount: float) -> Surface:
    return Surface(specular=amount, diffuse=p.x)


@func
def sides(p: vec3, n: vec3) -> vec3:
    return n


def test_a_checker_takes_turns():
    floor = checker(RED, BLUE, size=0.5)
    for x, z, color in ((0.2, 0.2, RED), (0.7, 0.2, BLUE), (0.7, 0.7, RED), (-0.2, 0.2, BLUE)):
        assert emitted(floor, p=(x, 0.25, z)) == pytest.approx(color)


def test_patterns_between_two_colors():
    assert emitted(stripes(RED, BLUE, 0.5, (0, 1, 0)), p=(0, 0.75, 0)) == pytest.approx(BLUE)
    assert emitted(waves(RED, BLUE), p=(0.25, 0, 0)) == pytest.approx(BLUE)
    assert emitted(linear_gradient(RED, BLUE), p=(9, -0.5, 9)) == pytest.approx((0.75, 0.0, 0.25))
    assert emitted(radial_gradient(RED, BLUE, radius=4.0), p=(0, 3, 0)) == pytest.approx(
        (0.25, 0.0, 0.75)
    )
    r, g, b = emitted(noise(RED, BLUE), p=(0.3, 0.6, 0.9))
    assert 0.0 < r < 1.0 and g == 0.0 and r + b == pytest.approx(1.0)


def test_two_numbers_make_an_amount():
    rough = Material(roughness=checker(0.25, 0.75))
    assert float(emitted(rough, "roughness", FLOAT, p=(0.5, 0.5, 0.5))) == 0.25
    assert float(emitted(rough, "roughness", FLOAT, p=(1.5, 0.5, 0.5))) == 0.75
    grey = matte(checker(0.25, 0.75))
    assert emitted(grey, "color", p=(0.5, 0.5, 0.5)) == pytest.approx((0.25,) * 3)


def test_two_materials_make_a_material():
    floor = checker(glass(1.4), "#f00")
    assert isinstance(floor, Material)
    assert floor.refracts and floor.uses == {"p", "footprint"}
    assert float(emitted(floor, "transmission", FLOAT, p=(0.5, 0.5, 0.5))) == 1.0
    assert emitted(floor, "color", p=(1.5, 0.5, 0.5)) == pytest.approx(RED)


def test_patterns_of_patterns():
    fine = checker(RED, BLUE, size=0.25)
    made = checker(fine, "#fff", size=1.0)
    assert emitted(made, p=(0.3, 0.1, 0.1)) == pytest.approx(BLUE)
    swirl = palette(noise(0.0, 1.0))
    assert swirl.uses == {"p", "footprint"}
    assert emitted(swirl, p=(0.1, 0.2, 0.3)).shape == (3,)


def test_patterns_move_with_parameters_and_time():
    size = slider("Tile", 0.5, 0.1, 2.0)
    floor = checker(RED, BLUE, size=size * (1.0 + time))
    here = (0.7, 0.1, 0.1)
    assert emitted(floor, p=here) == pytest.approx(BLUE)
    assert emitted(floor, p=here, params={"tile": 2.0}) == pytest.approx(RED)
    assert emitted(floor, p=here, time=1.0) == pytest.approx(RED)


def test_repetitions_have_colors_of_their_own():
    colors = [emitted(by_cell(), cell=(float(i), 0.0, 0.0)) for i in range(8)]
    assert len({tuple(np.round(c, 3)) for c in colors}) == 8
    assert emitted(by_cell(seed=1.0), cell=(0, 0, 0)) != pytest.approx(colors[0])


def test_an_own_function_is_a_pattern_or_a_material():
    steep = pattern(hills, height=2.0)
    assert float(emitted(steep, "", FLOAT, p=(0, 0.25, 0))) == 0.5
    assert pattern(sides).uses == {"n"} or pattern(sides).uses == {"n", "p"}
    made = pattern(shiny, 0.25)
    assert isinstance(made, Material)
    assert made.reflects and made.refracts, "what it may do is not known"
    assert float(emitted(made, "specular", FLOAT, p=RED)) == 0.25


def test_pictures_are_decoded_into_light(tmp_path):
    pixels = np.full((2, 2, 3), 128, np.uint8)
    file = tmp_path / "grey.png"
    PillowImage.fromarray(pixels).save(file)
    shown = Picture(np.full((2, 2, 4), 128 / 255, np.float32))
    for image in (file, str(file), pixels, shown):
        found = emitted(image_pattern(image), p=(0.1, 0.2, 0.3))
        assert found == pytest.approx((GREY,) * 3, abs=1e-4)
    light = np.full((2, 2, 3), 0.5, np.float32)
    for image in (light, Texture2D(light)):
        assert emitted(image_pattern(image), p=RED) == pytest.approx((0.5,) * 3)


def test_pictures_lie_on_all_sides():
    half = np.zeros((2, 2, 3), np.float32)
    half[0] = RED  # the upper row
    half[1] = BLUE
    assert emitted(image_pattern(half, size=2.0), p=(0, 0.5, 0)) == pytest.approx(RED)
    triplanar = image_pattern(half, "triplanar", size=2.0)
    assert triplanar.uses == {"p", "n", "footprint"}
    assert emitted(triplanar, p=(0, -0.5, 0), n=(0, 0, 1)) == pytest.approx(BLUE)
    around = image_pattern(half, "spherical")
    assert emitted(around, p=(1.0, -1.0, 0)) == pytest.approx(BLUE)
    faces = [np.full((2, 2, 3), i / 8, np.float32) for i in range(6)]
    assert emitted(cube_map(faces), p=(0, 0, -2)) == pytest.approx((5 / 8,) * 3)


@pytest.mark.parametrize(
    ("make", "error", "message", "hint"),
    [
        (
            lambda: checker("#f00", "light blue"),
            SceneValueError,
            "'b of checker' takes a color like #rrggbb or tomato, not 'light blue'",
            "did you mean 'lightblue'?",
        ),
        (
            lambda: checker(size=0),
            SceneValueError,
            "'size of checker' must be above 0, not 0",
            None,
        ),
        (
            lambda: stripes(direction=(0, 0, 0)),
            SceneValueError,
            "stripes: direction is a vector of zeros, which points nowhere",
            None,
        ),
        (
            lambda: linear_gradient(start=(1, 1, 1), end=(1, 1, 1)),
            SceneValueError,
            "linear_gradient: start and end are the same place",
            None,
        ),
        (
            lambda: image_pattern("nothing.png", "cubic"),
            SceneValueError,
            "there is no mapping 'cubic' for an image_pattern",
            "one of planar, triplanar, spherical, cylindrical",
        ),
        (
            lambda: image_pattern(3),
            SceneTypeError,
            "'image of image_pattern' takes a picture, not int 3",
            "a picture's file, an array (height, width, 3), a Picture or a Texture2D",
        ),
        (
            lambda: cube_map(["a.png"]),
            SceneValueError,
            "'images of cube_map' takes six pictures, not 1",
            "in the order +x, -x, +y, -y, +z, -z",
        ),
        (
            lambda: pattern(lambda p: p),
            SceneTypeError,
            None,
            "write @func above it",
        ),
        (
            lambda: pattern(hills),
            SceneTypeError,
            "hills needs 'height'",
            "it takes height",
        ),
        (
            lambda: noise(octaves=2.5),
            SceneTypeError,
            "'octaves of noise' takes a whole number, not float 2.5",
            None,
        ),
    ],
)
def test_mistakes_say_what_is_wrong_and_what_mends_it(make, error, message, hint):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.hint == hint
    if message is not None:
        assert diagnostic.message == message


def test_a_picture_that_cannot_be_read_is_told_at_the_authors_line():
    with pytest.raises(SceneValueError, match=r"nothing\.png.*cannot be read") as caught:
        image_pattern("nothing.png")
    assert 'image_pattern("nothing.png")' in str(caught.value)
