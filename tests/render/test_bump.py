"""Bumps: the shading of a raised floor is that of a floor that is really tilted."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    CompileError,
    DistantLight,
    Plane,
    Scene,
    Sphere,
    cell,
    glass,
    matte,
    noise,
    place,
    union,
)
from distal.lang import func, sin, slider, vec3
from distal.render.bump import bumped_normal
from tests import webgl
from tests.browser import BrowserUnavailableError
from tests.pictures.comparison import difference

SIZE = (96, 72)
SLOPE = 0.5
GREY = matte((0.5, 0.5, 0.5))
CAMERA = Camera((0.0, 5.0, 0.01), (0.0, 0.0, 0.0))


def brightness(material, light=(-0.6, 0.8, 0.0), shape=None, **options):
    shape = Box(4.0, 1.0, 4.0).translate(0, -0.5, 0) if shape is None else shape
    lamp = DistantLight(direction=light, intensity=1.0)
    scene = Scene(shape.paint(material), lights=[lamp], background=(0, 0, 0), camera=CAMERA)
    linear = scene.render((9, 9), samples=options.pop("samples", 1), **options).linear
    return float(np.asarray(linear)[3:6, 3:6, :3].mean())


def expected(light, slope=SLOPE):
    n = np.array([-slope, 1.0, 0.0]) / np.hypot(1.0, slope)
    return 0.5 * max(float(n @ np.array(light)), 0.0)


@pytest.mark.parametrize("light", [(-0.6, 0.8, 0.0), (0.6, 0.8, 0.0), (0.0, 0.6, 0.8)])
@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_a_floor_that_rises_along_x_is_lit_as_a_slope(light, device):
    found = brightness(GREY.bump(SLOPE * place.x), light, device=device)
    assert found == pytest.approx(expected(light), abs=2e-3)


def test_paths_show_the_same():
    light = (-0.6, 0.8, 0.0)
    found = brightness(GREY.bump(SLOPE * place.x), light, mode="path", samples=64)
    assert found == pytest.approx(expected(light), abs=0.01)


def test_the_relief_turns_and_moves_with_the_shape():
    """Turned by half a turn about y, the floor rises towards -x."""
    floor = Box(4.0, 1.0, 4.0).translate(0, -0.5, 0).paint(GREY.bump(SLOPE * place.x))
    light = (-0.6, 0.8, 0.0)
    turned = brightness(None or GREY.bump(SLOPE * place.x), light)
    lamp = DistantLight(direction=(-0.6, 0.8, 0.0), intensity=1.0)
    scene = Scene(floor.rotate(y=np.pi), lights=[lamp], background=(0, 0, 0), camera=CAMERA)
    found = float(scene.render((9, 9), samples=1).linear[3:6, 3:6, :3].mean())
    assert turned == pytest.approx(expected(light), abs=2e-3)
    assert found == pytest.approx(expected((0.6, 0.8, 0.0)), abs=2e-3)


def test_a_bump_on_a_bump_and_a_mixture_add_up():
    light = (-0.6, 0.8, 0.0)
    twice = GREY.bump(0.25 * place.x).bump(0.25 * place.x)
    assert brightness(twice, light) == pytest.approx(expected(light), abs=2e-3)
    half = GREY.mix(GREY.bump(SLOPE * place.x), 0.5)
    assert brightness(half, light) == pytest.approx(expected(light, 0.25), abs=2e-3)


def test_other_heights_functions_patterns_cells_parameters():
    @func
    def ramp(p: vec3) -> float:
        return 0.5 * p.x

    light = (-0.6, 0.8, 0.0)
    assert brightness(GREY.bump(ramp), light) == pytest.approx(expected(light), abs=2e-3)
    rise = slider("Rise", 0.5, low=0.0, high=1.0)
    by_slider = GREY.bump(rise * place.x)
    assert brightness(by_slider, light, params={"Rise": 0.0}) == pytest.approx(0.4, abs=2e-3)
    row = Box(0.9, 1.0, 0.9).translate(0, -0.5, 0).paint(GREY.bump(0.5 * cell.x * place.x))
    tiles = row.repeat(1.0, 0.0, 0.0, count=(3, 1, 1))
    lamp = DistantLight(direction=(-0.6, 0.8, 0.0), intensity=1.0)
    scene = Scene(tiles, lights=[lamp], background=(0, 0, 0), camera=CAMERA)
    picture = scene.render((90, 30), samples=1).linear
    seen = [float(picture[15, x, 0]) for x in (34, 45, 56)]
    assert seen == pytest.approx([expected(light, s) for s in (0.0, 0.5, 1.0)], abs=4e-3)
    assert brightness(GREY.bump(noise(0.0, 0.0)), light) == pytest.approx(0.4, abs=2e-3)


def test_parts_of_a_table_have_their_bumps():
    light = (-0.6, 0.8, 0.0)
    floor = Box(4.0, 1.0, 4.0).translate(0, -0.5, 0).paint(GREY.bump(SLOPE * place.x))
    many = union([floor, *(Sphere(0.1).translate(3 + i, 0, 3) for i in range(20))])
    lamp = DistantLight(direction=(-0.6, 0.8, 0.0), intensity=1.0)
    scene = Scene(many, lights=[lamp], background=(0, 0, 0), camera=CAMERA)
    found = float(scene.render((9, 9), samples=1).linear[4, 4, 0])
    assert found == pytest.approx(expected(light), abs=2e-3)


def test_without_a_bump_the_normal_is_the_same_number():
    n = np.array([[0.6, 0.8, 0.0], [0.0, 1.0, 0.0]])
    found = bumped_normal(n, np.zeros((2, 3)), np.array([[0.0, 1.0, 0.0]] * 2))
    assert np.array_equal(np.asarray(found), n)


def test_a_normal_stays_turned_to_the_eye():
    rng = np.random.default_rng(1)
    n, tilt, view = (rng.normal(size=(500, 3)) for _ in range(3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    view /= np.linalg.norm(view, axis=1)[:, None]
    view *= np.sign((view * n).sum(axis=1))[:, None]
    found = np.asarray(bumped_normal(n, 5.0 * tilt, view))
    assert np.abs(np.linalg.norm(found, axis=1) - 1.0).max() < 1e-6
    assert ((found * view).sum(axis=1) > 0.0).all()


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl", "wgsl-compute", "shadertoy"])
def test_texts_of_all_languages(target):
    @func
    def waves(p: vec3) -> float:
        return 0.02 * sin(30.0 * p.x)

    scene = Scene(Sphere(1.0).paint(GREY.bump(waves)) | Plane(y=-1))
    text = distal.compile(scene, target=target).text
    assert "bumped_normal" in text or "tilt" in text
    assert (
        "tilted_surface" not in distal.compile(Scene(Sphere(1.0).paint(GREY)), target=target).text
    )


def test_glass_is_drawn_and_colors_are_refused():
    picture = Scene(Sphere(1.0).paint(glass().bump(0.02 * np.sin(30 * place.y)))).render((24, 18))
    assert np.isfinite(picture.linear).all()
    with pytest.raises(CompileError, match="'height of bump' takes a number"):
        GREY.bump("red")  # type: ignore[arg-type]
    with pytest.raises(CompileError, match="'height of bump' takes a float; noise gives a vec3"):
        GREY.bump(noise("red", "blue"))


@pytest.mark.parametrize("driver", ["swiftshader", "mesa"])
def test_chromium_shades_the_same(driver):
    @func
    def grooves(p: vec3) -> float:
        return 0.02 * sin(22.0 * p.x)

    def scene(ball, floor):
        slab = Box(6.0, 0.2, 6.0).translate(0, -1.1, 0)
        return Scene(
            Sphere(1.0).paint(ball) | slab.paint(floor),
            lights=[DistantLight(direction=(-0.6, 0.8, 0.3), intensity=1.0)],
            camera=Camera((0.0, 2.5, 5.0), (0.0, 0.0, 0.0)),
        )

    bumped = scene(GREY.bump(grooves), matte("#a63").bump(noise(0.0, 0.1)))
    try:
        found = webgl.run_webgl(distal.compile(bumped, target="glsl-es300"), SIZE, driver=driver)
    except BrowserUnavailableError as missing:
        pytest.skip(f"bumps are not drawn in a browser: {missing}")
    assert difference(found, bumped.render(size=SIZE, samples=1).array).is_agreement
    smooth = scene(GREY, matte("#a63"))
    assert not difference(found, smooth.render(size=SIZE, samples=1).array).is_agreement
