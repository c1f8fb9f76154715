"""An author's function as a tone map and as a light's falloff, where the library has its own."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Camera, CompileError, PointLight, Scene, Sphere, SpotLight
from distal.lang import clamp, exp, func, slider, vec3
from distal.lang.runtime_access import executor
from tests.drivers import driver_picture

CAMERA = Camera((0.0, 0.0, 4.0))
SPHERE = Sphere(1.0)
SIZE = (32, 24)
DENSITY = slider("Density", 0.2, low=0, high=2)


@func
def reinhard(light: vec3) -> vec3:
    """As the library's."""
    return light / (1.0 + light)


@func
def film(light: vec3) -> vec3:
    """A curve of exposure and density."""
    return 1.0 - exp(-2.0 * light)


@func
def square(distance: float) -> float:
    """As the library's."""
    return 1.0 / (distance * distance)


@func
def foggy(distance: float) -> float:
    """Linear, in fog."""
    return exp(-DENSITY * distance) / distance


@func
def sharp(distance: float, reach: float = 3.0) -> float:
    """Nothing beyond a reach."""
    return clamp(reach - distance, 0.0, 1.0)


@func
def untyped(light: vec3):
    """It does not say what it returns."""
    return light


@func
def two(a: float, b: float) -> float:
    """It takes two distances."""
    return a + b


def light_of(lights, **given) -> np.ndarray:
    scene = Scene(SPHERE, lights, CAMERA, background="black", tone_map="none", ambient_occlusion=0)
    return scene.render(SIZE, samples=1, **given).linear[..., :3]


def encoded(tone_map, light: np.ndarray, device: str = "cpu") -> np.ndarray:
    display = Scene(SPHERE, tone_map=tone_map, exposure=1.5).display
    return np.asarray(executor().call(display, (light,), {}, device=device))


LIGHT = np.concatenate([np.geomspace(1e-3, 9.0, 30).reshape(10, 3), np.full((10, 1), 0.5)], axis=1)


@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_an_own_tone_map_is_applied_after_the_exposure(device: str):
    assert np.array_equal(encoded(reinhard, LIGHT, device), encoded("reinhard", LIGHT, device))
    linear = 1.0 - np.exp(-2.0 * 1.5 * LIGHT[:, :3])
    shown = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert encoded(film, LIGHT, device)[:, :3] == pytest.approx(shown, abs=2e-6)
    assert np.all(encoded(film, LIGHT, device)[:, 3] == 0.5)


def test_an_own_falloff_is_the_share_of_the_intensity():
    square_light = light_of(PointLight((1.0, 2.0, 3.0), 5.0))
    same = light_of(PointLight((1.0, 2.0, 3.0), 5.0, falloff=square))
    assert np.abs(same - square_light).max() < 1e-5
    fog = light_of(PointLight((1.0, 2.0, 3.0), 5.0, falloff=foggy), params={"Density": 0.7})
    lit = square_light.max(-1) > 1e-3
    # The nearest place of the sphere is sqrt(14) - 1 away.
    away = np.sqrt(14.0) - 1.0
    share = (fog.max(-1)[lit] / square_light.max(-1)[lit]).max()
    assert share == pytest.approx(away * np.exp(-0.7 * away), rel=0.02)


def test_a_spot_light_fades_by_its_falloff_within_its_cone():
    spot = SpotLight((0.0, 0.0, 3.5), intensity=2.0, angle=0.8, softness=0.0)
    plain, shaped = light_of(spot), light_of(spot.replace(falloff=sharp))
    middle = (12, 16)
    # 2.5 away from the middle of the sphere: half of the intensity, instead of 1 / 6.25.
    assert shaped[middle].max() / plain[middle].max() == pytest.approx(0.5 * 6.25, rel=0.02)
    assert not np.any(shaped[plain == 0.0])


def test_a_light_keeps_its_falloff_and_shows_its_arguments():
    lamp = PointLight((1.0, 2.0, 3.0), 5.0, falloff=square)
    there = lamp.translate(1, 0, 0)
    assert (there.falloff, there.position, there.intensity) == (square, (2.0, 2.0, 3.0), 5.0)
    assert lamp.replace(falloff=None).falloff is None
    assert "position=(1.0, 2.0, 3.0)" in repr(lamp)
    assert {square, reinhard} <= set(Scene(SPHERE, lamp, tone_map=reinhard).functions())
    names = [p.label for p in Scene(SPHERE, PointLight((1, 2, 3), falloff=foggy)).parameters()]
    assert names == ["Density"]


@pytest.mark.parametrize("target", ["glsl-330", "glsl-es300", "wgsl", "shadertoy"])
def test_own_functions_are_emitted_for_each_target(target: str):
    scene = Scene(SPHERE, PointLight((1, 2, 3), falloff=sharp), CAMERA, tone_map=film)
    text = distal.compile(scene, target=target).text
    assert "film" in text or "exp(" in text


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
def test_drivers_draw_what_own_functions_say(target: str):
    lamp = PointLight((1.0, 2.0, 3.0), 5.0, falloff=sharp)
    scene = Scene(SPHERE, lamp, CAMERA, background="black", tone_map=film)
    found = driver_picture(scene, target, SIZE)
    known = scene.render(SIZE, samples=1).array
    assert known[..., :3].max() > 0.3
    assert np.quantile(np.abs(found - known).max(-1), 0.99) < 2 / 255


REFUSED = {
    "no tone map": (
        lambda: Scene(SPHERE, tone_map=square),
        "'square' is no tone map: it takes float and returns float",
        "def square(light: vec3) -> vec3",
    ),
    "untyped": (
        lambda: Scene(SPHERE, tone_map=untyped),
        "'untyped' is no tone map: it takes vec3 and returns no declared type",
        "def untyped(light: vec3) -> vec3",
    ),
    "no falloff": (
        lambda: PointLight((1, 2, 3), falloff=film),
        "'film' is no falloff: it takes vec3 and returns vec3",
        "def film(distance: float) -> float",
    ),
    "two distances": (
        lambda: SpotLight((1, 2, 3), falloff=two),
        "'two' is no falloff: it takes float, float and returns float",
        "def two(distance: float) -> float",
    ),
    "no func": (
        lambda: PointLight((1, 2, 3), falloff=np.sqrt),
        "a falloff is a @func, not ufunc",
        "@func above def falloff(distance: float) -> float",
    ),
    "a number": (lambda: Scene(SPHERE, tone_map=3), "there is no tone map 3", "none, reinhard"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_function_of_another_kind_is_refused(name: str):
    wrong, message, hint = REFUSED[name]
    with pytest.raises(CompileError) as caught:
        wrong()
    assert message in str(caught.value)
    assert f"hint: {hint}" in str(caught.value)
    assert "test_own_functions.py" in str(caught.value)
