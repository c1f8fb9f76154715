"""Scenes of objects: the first raymarcher agrees with the library called by hand; sdfray's show
the light that its article's formulas give, and their sliders move them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import distal
from tests.pictures.comparison import difference

LIBRARY = str(Path(__file__).parents[2] / "benchmarks/raymarcher_library.py")
SDFRAY = sorted(name for name in distal.gallery() if name.startswith("sdfray_"))


@pytest.mark.parametrize("time", [0.0, 2.9, 11.3])
def test_objects_draw_what_the_library_draws(time):
    objects, library = (
        distal.load(source).render(size=(160, 120), samples=1, time=time).array
        for source in ("example:raymarcher_objects", LIBRARY)
    )
    assert difference(objects, library).is_agreement
    # The box of the objects is tighter, so that shadow rays begin and step at other places.
    assert np.percentile(np.abs(objects - library), 99.9) < 1e-3


def test_the_softness_of_objects_is_the_shaders_blend():
    # smooth=0.05 of the cubic blend is the first shader's k of 0.3: 6 times as much.
    scene = distal.load("example:raymarcher_objects")
    points = np.random.default_rng(3).uniform(-1.2, 1.2, (200, 3)).astype(np.float32)
    original = distal.load("example:raymarcher", "scene")
    expected = [original(p, 0.0) for p in points]
    assert np.allclose(scene.shape(points), expected, atol=1e-5)


def test_the_sphere_shows_the_light_of_the_inverse_square_law():
    pixels = distal.load("example:sdfray_default_sphere").render(size=(641, 481), samples=1).linear
    # In the middle the sphere's normal faces the eye; red is at (2, 2.5, -1) from there.
    red = 10.0 / np.dot((2, 2.5, -1), (2, 2.5, -1)) ** 1.5
    assert np.allclose(pixels[240, 320, :3], (0.8 * (0.1 + red), 0.08, 0.08), atol=2e-3)
    assert (pixels[0, 0, :3] == 0.0).all()
    # As in the article: red from the right, green from the left, only ambient light below.
    right, left, below = pixels[200, 380, :3], pixels[200, 260, :3], pixels[310, 300, :3]
    assert right[0] > 2.0 * right[1] and left[1] > 2.0 * left[0]
    assert np.allclose(below, 0.08, atol=2e-3)


def test_clear_shapes_show_what_is_behind_them():
    scene = distal.load("example:sdfray_row")
    inside = (slice(52, 66), slice(74, 86))  # within the ball
    clear, shut = (
        scene.render(size=(160, 120), samples=1, params={"transmission": t}).linear[inside][..., :3]
        for t in (0.9, 0.0)
    )
    assert clear.mean() > 3.0 * shut.mean()


@pytest.mark.sample(2)
@pytest.mark.parametrize("example", SDFRAY)
def test_pictures_are_whole_and_every_slider_moves_them(example):
    scene = distal.load(f"example:{example}")
    before = scene.render(size=(80, 60), time=0.4)
    assert np.isfinite(before.linear).all()
    assert before.array[..., :3].std() > 0.05
    for parameter in scene.parameters():
        other = parameter.high if parameter.default != parameter.high else parameter.low
        value = "#ff8080" if parameter.kind.value == "color" else other
        after = scene.render(size=(80, 60), time=0.4, params={parameter.name: value})
        assert difference(before.array, after.array).mean > 0.05, parameter.name
