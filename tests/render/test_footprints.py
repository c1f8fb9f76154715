"""Footprints of pixels, and patterns averaged over them: closed forms, and many samples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    Material,
    OrthographicCamera,
    Plane,
    Scene,
    Sphere,
    checker,
    image_pattern,
    linear_gradient,
    metal,
    noise,
    pattern,
    stripes,
    waves,
)
from distal.lang import func, vec2, vec3
from distal.lang.runtime_access import executor
from distal.render import averages, camera, footprint, patterns

SIZE = (96, 72)
DARK: Any = dict(lights=[], background=(0.0, 0.0, 0.0), ambient_occlusion=0.0)


def asked(function: Any, *args: Any) -> Any:
    """A scene function's values by the reference."""
    return executor().call(function, args, {}, device="reference")


def glowing(varying: Any) -> Material:
    """A material that shows only a pattern."""
    return Material(diffuse=0.0, emission=varying)


def floor(varying: Any, **options: Any) -> Scene:
    view = options.pop("camera", Camera((3.0, 2.0, 5.0), (0.0, 1.4, 0.0)))
    return Scene(Plane().paint(glowing(varying)), camera=view, **{**DARK, **options})


def light(scene: Scene, samples: int | None = 1, size: tuple[int, int] = SIZE) -> Any:
    return scene.render(size, samples=samples).linear[..., 0].astype(float)


# Means over intervals


@pytest.mark.parametrize("width", [0.0, 1e-5, 1e-3, 0.3, 1.0, 2.0, 7.3, 1e4])
def test_means_are_integrals(width):
    """Against the mean of many values; of width 0 the value itself."""
    x = np.linspace(-3.1, 3.3, 29)
    parts = (np.arange(40000) + 0.5) / 40000 - 0.5
    inside = x[:, None] + width * parts[None, :]
    square = (1.0 - 2.0 * (np.floor(inside) % 2.0)).mean(1)
    ramp = np.clip(inside, 0.0, 1.0).mean(1)
    wave = np.sin(2.0 * np.pi * inside).mean(1)
    columns = np.stack([x, x, x], axis=1)
    found = asked(averages.square_mean, columns, np.full_like(columns, width))
    assert found[:, 0] == pytest.approx(square, abs=2e-3)
    assert asked(averages.ramp_mean, x, np.full_like(x, width)) == pytest.approx(ramp, abs=2e-3)
    fade = float(asked(averages.wave_fade, width))
    assert fade * np.sin(2.0 * np.pi * x) == pytest.approx(wave, abs=2e-3)


def test_noise_fades_to_nothing_and_starts_whole():
    fades = [float(asked(averages.noise_fade, width)) for width in (0.0, 0.5, 1.0, 2.0, 100.0)]
    assert fades[0] == 1.0
    assert fades == sorted(fades, reverse=True)
    assert fades[-1] < 1e-6


# The footprint of a pixel


@func
def cone_of_lens(uv: vec2, size: float) -> footprint.Cone:
    return footprint.pixel_cone(lambda at: camera.look_at(at, fov=0.8), uv, size)


@func
def cone_of_box(uv: vec2, size: float) -> footprint.Cone:
    return footprint.pixel_cone(lambda at: camera.orthographic(at, height=6.0), uv, size)


@func
def cone_of_fisheye(uv: vec2, size: float) -> footprint.Cone:
    return footprint.pixel_cone(lambda at: camera.fisheye(at, fov=3.0), uv, size)


def test_a_cone_has_the_width_of_a_pixel():
    size = 2.0 / 480.0
    lens = asked(cone_of_lens, (0.0, 0.0), size)
    assert (lens.width, lens.spread) == pytest.approx((0.0, size * math.tan(0.4)), rel=1e-3)
    box = asked(cone_of_box, (0.3, 0.4), size)
    assert (box.width, box.spread) == pytest.approx((3.0 * size, 0.0), rel=1e-3, abs=1e-7)
    # Radially 1.5 radians per unit of uv; around, sin(angle) / radius.
    fisheye = asked(cone_of_fisheye, (0.6, 0.0), size)
    around = math.sin(0.9) / 0.6
    expected = size * math.sqrt(0.5 * (1.5**2 + around**2))
    assert fisheye.spread == pytest.approx(expected, rel=5e-3)


@func
def sides(width: float, spread: float, direction: vec3, t: float, n: vec3) -> footprint.Footprint:
    return footprint.footprint_at(footprint.Cone(width, spread), direction, t, n)


def test_a_footprint_lies_on_the_surface_and_is_longer_by_the_cosine():
    rng = np.random.default_rng(3)
    for _ in range(20):
        n, direction = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        found = asked(sides, 0.02, 0.01, tuple(direction), 3.0, tuple(n))
        across, along = np.array(found.across), np.array(found.along)
        assert across @ n == pytest.approx(0.0, abs=1e-6)
        assert along @ n == pytest.approx(0.0, abs=1e-6)
        assert across @ along == pytest.approx(0.0, abs=1e-6)
        assert across @ direction == pytest.approx(0.0, abs=1e-6)
        assert np.linalg.norm(across) == pytest.approx(0.05, rel=1e-4)
        assert np.linalg.norm(along) == pytest.approx(0.05 / abs(n @ direction), rel=1e-4)
    above = asked(sides, 0.02, 0.01, (0.0, -1.0, 0.0), 3.0, (0.0, 1.0, 0.0))
    assert np.linalg.norm(np.array(above.along)) == pytest.approx(0.05)
    assert np.linalg.norm(np.array(above.across)) == pytest.approx(0.05)


def test_a_ray_goes_on_with_the_width_that_it_has():
    @func
    def bounced(t: float) -> float:
        return footprint.continued(footprint.Cone(0.1, 0.02), t).width

    assert asked(bounced, 5.0) == pytest.approx(0.2)


@func
def shown_width(footprint: float) -> float:
    return footprint


@pytest.mark.parametrize(
    ("shape", "factor"),
    [
        (lambda s: s, 1.0),
        (lambda s: s.scale(2.0), 0.5),
        (lambda s: s.scale(0.25).rotate(y=0.7).translate(0.0, 0.0, 0.0), 4.0),
        (lambda s: s.symmetry(across=(1.0, 0.0, 0.0)), 1.0),
        (lambda s: s.rotate(x=0.3, y=0.2).rotate(y=-0.2).rotate(x=-0.3), 1.0),
    ],
)
def test_a_footprint_is_in_the_coordinates_of_the_painted_shape(shape, factor):
    """The author's function takes the width of the pixel; a scaled shape is painted first."""
    view = OrthographicCamera((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), height=4.0)
    painted = Plane().paint(glowing(pattern(shown_width)))
    found = light(Scene(shape(painted), camera=view, **DARK))
    assert found == pytest.approx(np.full(found.shape, factor * 4.0 / SIZE[1]), rel=2e-2)


def test_a_repeated_shape_has_no_wider_footprints_at_the_borders():
    """A column of pixels is a thousandth from the border of two repetitions."""
    pixel = 4.0 / SIZE[1]
    x = 0.501 - 0.5 * pixel
    view = OrthographicCamera((x, 5.0, 0.2), (x, 0.0, 0.2), (0.0, 0.0, -1.0), height=4.0)
    tile = (
        Box(1.2, 1.0, 1.2).paint(glowing(pattern(shown_width))).repeat(1.0, 9.0, 1.0, neighbors=1)
    )
    found = light(Scene(tile, camera=view, floor=False, **DARK))
    assert found[:, SIZE[0] // 2] == pytest.approx(np.full(SIZE[1], pixel), rel=2e-2)
    assert found == pytest.approx(np.full(found.shape, pixel), rel=2e-2)


def test_more_samples_have_smaller_footprints():
    view = OrthographicCamera((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), height=4.0)
    scene = floor(pattern(shown_width), camera=view)
    assert light(scene, 16) == pytest.approx(light(scene, 1) / 4.0, rel=1e-3)


def test_a_mirrored_ray_counts_the_whole_path():
    """Down to a mirror and back up to a ceiling: a footprint of the sum of both distances."""
    view = Camera((0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov=0.02)
    mirror = Plane().paint(metal("#ffffff", 0.0))
    ceiling = Box(9.0, 1.0, 9.0).translate(y=3.5).paint(glowing(pattern(shown_width)))
    found = light(Scene(mirror | ceiling, camera=view, **DARK), size=(9, 9))[4, 4]
    assert found == pytest.approx(4.0 * 2.0 * math.tan(0.01) / 9.0, rel=2e-2)


# Pictures


def test_a_checker_at_the_horizon_is_as_good_as_with_sixteen_samples():
    """Against 1024 samples: the error of one is below that of 16 without footprints (0.01)."""

    @func
    def hard(p: vec3) -> float:
        return 1.0 - patterns.checker(p)

    exact = light(floor(pattern(hard)), 1024)
    error = float(np.sqrt(np.mean((light(floor(checker(1.0, 0.0))) - exact) ** 2)))
    unfiltered = float(np.sqrt(np.mean((light(floor(pattern(hard))) - exact) ** 2)))
    assert error < 0.05
    assert error < 0.3 * unfiltered


@pytest.mark.parametrize(
    "varying",
    [
        checker(1.0, 0.0, size=0.5),
        stripes(1.0, 0.0, size=0.3, direction=(1.0, 0.0, 0.4)),
        waves(1.0, 0.0, size=0.4, direction=(0.2, 0.0, 1.0)),
        noise(1.0, 0.0, size=0.5),
    ],
    ids=["checker", "stripes", "waves", "noise"],
)
def test_patterns_keep_their_mean_and_end_in_it(varying):
    """The mean of the picture does not change; the row below the horizon is even."""
    scene = floor(varying)
    once, many = light(scene, 1), light(scene, 256)
    below = slice(SIZE[1] // 2 - 4, None)
    assert once[below].mean() == pytest.approx(many[below].mean(), abs=0.01)
    horizon = int(np.argmax(once.mean(1) > 0.2))
    assert once[horizon + 1].std() < 0.06
    assert once[horizon + 1].mean() == pytest.approx(0.5, abs=0.06)


def test_a_moving_camera_does_not_shimmer():
    """Pictures of four cameras, a quarter of a pixel apart, differ little from each other."""

    @func
    def hard(p: vec3) -> float:
        return patterns.checker(p, 0.5)

    def spread(varying: Any) -> float:
        pictures = []
        for i in range(4):
            turn = 0.25 * i * 2.0 * math.tan(math.radians(20.0)) / SIZE[1]
            view = Camera((3.0, 2.0, 5.0), (5.0 * turn, 1.4 + 3.0 * turn, 0.0))
            pictures.append(light(floor(varying, camera=view))[: SIZE[1] // 2])
        return float(np.std(pictures, axis=0).mean())

    assert spread(checker(1.0, 0.0, size=0.5)) < 0.35 * spread(pattern(hard))


def test_a_steep_gradient_is_an_even_edge():
    """Between 0 and 1 lie values by the share of the pixel, as many samples give."""
    edge = linear_gradient(0.0, 1.0, start=(0.0, 0.0, 0.0), end=(1e-3, 0.0, 2e-4))
    view = OrthographicCamera((0.0, 5.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), height=4.0)
    found, many = light(floor(edge, camera=view)), light(floor(edge, camera=view), 256)
    assert np.abs(found - many).max() < 0.2
    assert ((found > 0.05) & (found < 0.95)).any()


def test_a_far_picture_is_averaged():
    """A picture of stripes, one texel each, on a floor: eight samples in a row of pixels."""
    texels = np.zeros((64, 64, 3), np.float32)
    texels[:, ::2] = 1.0
    view = Camera((3.0, 2.0, 5.0), (0.0, 1.4, 0.0))

    def error(footprint_of: float) -> float:
        varying = image_pattern(texels, size=footprint_of)
        wall = Box(40.0, 40.0, 0.1).rotate(x=1.5).paint(glowing(varying))
        scene = Scene(wall, camera=view, **DARK)
        once, many = light(scene), light(scene, 256)
        return float(np.sqrt(np.mean((once - many) ** 2)))

    assert error(4.0) < 0.2


# Fog


def test_a_floor_in_fog_ends_in_the_background_without_a_seam():
    """Where the author gives no color, fog has that of the horizon, in every direction."""

    @func
    def sky(direction: vec3) -> vec3:
        return vec3(0.3 + 0.2 * direction.x, 0.4 - 0.3 * direction.y, 0.5 + 0.1 * direction.z)

    for where in ((0.0, 1.0, 0.0), (4.0, 1.0, 3.0)):
        view = Camera((0.0, 1.0, 5.0), where)
        scene = Scene(Plane(), [], view, sky, fog_density=0.2, ambient_occlusion=0.0)
        found = scene.render(SIZE, samples=1).linear[..., :3]
        middle = SIZE[1] // 2
        steps = np.abs(np.diff(found[middle - 6 : middle + 3], axis=0)).max()
        assert steps < 0.02
    black = Scene(Plane(), [], view, sky, fog=(0, 0, 0), fog_density=0.2).render(SIZE, samples=1)
    assert np.abs(np.diff(black.linear[middle - 6 : middle + 3, :, :3], axis=0)).max() > 0.2


def test_fog_is_seen_in_a_mirror_in_the_direction_of_the_mirror_image():
    """Red in front of the mirror; the ground in the mirror lies in the other direction: green."""

    @func
    def sky(direction: vec3) -> vec3:
        return vec3(1.0, 0.0, 0.0) if direction.z < 0.0 else vec3(0.0, 1.0, 0.0)

    wall = Box(4.0, 4.0, 0.1).translate(y=2.0).paint(metal("#ffffff", 0.0))
    view = Camera((0.0, 1.2, 6.0), (0.0, 1.1, 0.0))
    scene = Scene(Plane() | wall, [], view, sky, fog_density=0.05)
    found = scene.render(SIZE, samples=1).linear[SIZE[1] // 2 + 6, SIZE[0] // 2]
    assert found[0] == pytest.approx(1.0 - math.exp(-0.05 * 5.95), rel=0.02)
    assert found[1] > 0.2


def test_fog_without_a_color_is_no_number_of_the_scene():
    assert "fog" not in Scene(Sphere(), background="#888").numbers
    assert "fog" in Scene(Sphere(), fog="#888").numbers
