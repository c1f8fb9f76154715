"""Photons against closed forms, and against long plain paths under wide lamps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    DistantLight,
    Environment,
    Material,
    Plane,
    PointLight,
    Scene,
    Sphere,
    SpotLight,
    glass,
    matte,
    metal,
    mirror,
    plastic,
)
from distal.devices import adapters
from distal.devices.base import DeviceError
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.render.paths import MOST_SEGMENTS
from distal.runtime import photons as photon_passes
from distal.runtime.photons import _joined, _sorted
from distal.scene.lowering.photon_functions import bundling_parts, casts_caustics
from tests.paths.test_integrator import spotted

BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)
FLOOR = Plane().paint(matte((0.6, 0.5, 0.4)))
BALL = Sphere(0.5).translate(y=0.6)
SIZE = (40, 32)


def lit(shape: Any, light: Any, **options: Any) -> Scene:
    """A scene under one light, seen from above."""
    camera = Camera((0.3, 3.0, 2.4), target=(0.0, 0.2, 0.0), fov_deg=42.0)
    options = {"camera": camera, "background": BLACK, "floor": False, **options}
    return Scene(shape, lights=[light], **options)


def tiles(scene: Scene, spp: int, seed: int, *, caustics: bool) -> Any:
    """The means of tiles of 8x8 pixels."""
    picture = scene.render(size=SIZE, mode="path", spp=spp, seed=seed, caustics=caustics)
    rows = picture.linear[..., :3].reshape(SIZE[1] // 8, 8, SIZE[0] // 8, 8, 3)
    return rows.astype(float).mean(axis=(1, 3))


LAMP = PointLight((1.0, 3.0, 0.8), intensity=10.0, radius=0.9)
SUN = DistantLight((0.5, 1.0, 0.3), angle=0.5)
GOLD = metal((1.0, 0.7, 0.4), 0.2)
CASES = {
    "glass below an occluder": (
        FLOOR | BALL.paint(glass()) | Sphere(0.35).translate(0.5, 1.5, 0.4).paint(matte(WHITE)),
        LAMP,
    ),
    "a mirror and a metal": (
        FLOOR
        | Box((1.2, 1.2, 0.1)).rotate(y=0.6).translate(-0.4, 0.6, -0.4).paint(mirror())
        | BALL.translate(0.6, 0.0, 0.3).paint(GOLD),
        SUN,
    ),
    "smooth coats": (
        Plane().paint(plastic("tomato", 0.0)) | BALL.paint(Material(diffuse=0.4, specular=0.5)),
        LAMP,
    ),
    "a lamp in a shell of glass": (
        FLOOR | (Sphere(0.7) - Sphere(0.6)).translate(y=0.9).paint(glass(color="#80c0a0")),
        PointLight((0.1, 0.9, 0.0), intensity=0.5, radius=0.25),
    ),
    "glass in glass near a lamp": (
        FLOOR
        | BALL.paint(glass(), priority=1)
        | Box((0.9, 0.5, 0.9)).translate(y=0.5).paint(glass(1.2)),
        PointLight((0.0, 1.8, 0.0), intensity=1.0, radius=0.4),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_both_ways_find_the_same_light(name):
    shape, light = CASES[name]
    scene = lit(shape, light)
    count = 5
    found = np.array([tiles(scene, 32, s, caustics=True) for s in range(count)])
    plain = np.array([tiles(scene, 128, 50 + s, caustics=False) for s in range(count)])
    assert casts_caustics(scene)
    # The whole picture, and each tile; sigma of few samples is not exact.
    whole = found.mean(axis=(1, 2)), plain.mean(axis=(1, 2))
    sigma = np.sqrt(sum(w.var(axis=0, ddof=1) / count for w in whole))
    apart = whole[0].mean(axis=0) - whole[1].mean(axis=0)
    assert (np.abs(apart) <= 4.5 * sigma + 1e-3 * plain.mean()).all(), (apart, sigma)
    errors = np.sqrt((found.var(axis=0, ddof=1) + plain.var(axis=0, ddof=1)) / count)
    scores = (found.mean(axis=0) - plain.mean(axis=0)) / (errors + 2e-3 * plain.mean())
    assert math.sqrt(np.mean(scores**2)) < 1.4, scores[..., 1].round(1)


def test_an_environment_with_a_bright_place():
    light = Environment(spotted(), intensity=1.5)
    scene = lit(FLOOR | BALL.paint(glass()), light)
    assert casts_caustics(scene)
    found = np.array([tiles(scene, 32, s, caustics=True) for s in range(4)])
    plain = np.array([tiles(scene, 512, 50 + s, caustics=False) for s in range(4)])
    sigma = np.sqrt((found.var(axis=0, ddof=1) + plain.var(axis=0, ddof=1)) / 4)
    scores = (found.mean(axis=0) - plain.mean(axis=0)) / (sigma + 2e-3 * plain.mean())
    assert math.sqrt(np.mean(scores**2)) < 1.6, scores[..., 1].round(1)


@pytest.mark.parametrize("ior", [1.2, 2.0])
def test_a_pane_lets_light_through(ior):
    # All inner reflections together: (1 - F) / (1 + F). The light has no size: no path meets it.
    pane = Box((0.8, 0.05, 0.8)).translate(y=1.0).paint(glass(ior))
    floor = Plane().paint(matte((0.02,) * 3))
    camera = Camera((0.0, 0.5, 0.0), target=(0.0, 0.0, 0.0), up=(0, 0, -1), fov_deg=50.0)
    scene = lit(floor | pane, DistantLight((0, 1, 0), intensity=50.0), camera=camera)
    light = scene.render(size=(32, 32), mode="path", spp=64).linear[..., 1]
    mirrored = ((ior - 1.0) / (ior + 1.0)) ** 2
    assert light.mean() == pytest.approx((1.0 - mirrored) / (1.0 + mirrored), rel=0.02)
    dark = scene.render(size=(32, 32), mode="path", spp=4, caustics=False).linear[..., 1]
    assert dark.mean() < 0.01


def powers(scene: Scene, count: int) -> Any:
    """The power of each photon of a scene, in the unit of its lights; 0 of those that are lost."""
    view = scene.view("color", paths=True, caustics=True)
    photons = executor()._photons(view.photons, "cpu", RenderOptions(size=(64, 64)))
    tables = photons.tables(0, 1, 64 * 64, 0.0)
    numbers = {**tables.numbers, "First_sample": 0}
    found = photons.deposits.run(np.arange(count, dtype=np.int32), numbers, 0.0)
    return found[2][:, 1].astype(float) * (found[3] >= 0)


@pytest.mark.parametrize(
    ("material", "kept"), [(glass(), 1.0), (mirror((0.5,) * 3), 0.5), (glass(1.0), 1.0)], ids=str
)
def test_a_ball_passes_on_all_the_light_that_it_gets(material, kept):
    # A lamp and a ball in a matte room: each photon ends on its wall.
    room = Sphere(6.0) - Sphere(5.0)
    scene = lit(
        room | Sphere(0.8).paint(material), PointLight((0.0, 2.5, 0.0), intensity=3.0, radius=0.0)
    )
    angle = math.asin(0.8 / 2.5)
    expected = kept * 3.0 * math.pi * 2.0 * math.pi * (1.0 - math.cos(angle))
    found = powers(scene, 2**16)
    # The photons that pass beside the ball are counted by paths: they end at the first wall.
    assert found.mean() == pytest.approx(expected, rel=0.01)


def test_the_same_bits_with_any_threads_and_after_a_break(tmp_path):
    scene = lit(FLOOR | BALL.paint(glass()), LAMP)
    asked = {"size": SIZE, "mode": "path"}
    one = scene.render(**asked, spp=12, threads=1).linear
    assert (scene.render(**asked, spp=12, threads=2).linear == one).all()
    kept = tmp_path / "a.film"
    scene.render(**asked, spp=4, film=kept)
    assert (scene.render(**asked, spp=12, film=kept).linear == one).all()
    assert (scene.render(**asked, spp=12, seed=1).linear != one).any()


def test_stages_follow_every_photon_to_its_end(monkeypatch):
    scene = lit(
        FLOOR | BALL.paint(glass()) | Box(0.5).translate(0.0, 1.0, 0.0).paint(glass()), LAMP
    )
    asked = {"size": SIZE, "mode": "path", "spp": 4}
    staged = scene.render(**asked).linear
    monkeypatch.setattr(photon_passes, "_STAGES", (MOST_SEGMENTS,))
    assert (scene.render(**asked).linear == staged).all()
    monkeypatch.setattr(photon_passes, "_STAGES", (2,))
    assert (scene.render(**asked).linear != staged).any()


def test_photons_start_where_a_lamp_shines():
    # All cross the top of the box around the ball; its shadow covers 0.625 of that.
    scene = lit(FLOOR | BALL.paint(glass()), PointLight((0.0, 5.0, 0.0), intensity=1.0))
    assert 0.55 < (powers(scene, 2**14) > 0.0).mean() < 0.63


def test_what_bundles_light():
    def parts(*shapes: Any) -> int:
        return len(bundling_parts(lit(shapes, LAMP)))

    assert parts(FLOOR, BALL) == 0
    assert parts(BALL.paint(glass()), BALL.paint(mirror()), BALL.paint(metal(roughness=0.1))) == 3
    assert parts(BALL.paint(metal(roughness=0.5)), BALL.paint(plastic("red", 0.1))) == 0
    assert parts(BALL.paint(plastic("red", 0.0))) == 1
    # The outermost paint counts, of unions too.
    assert parts(FLOOR, (BALL | BALL.translate(x=1.5)).paint(glass())) == 2
    assert parts(FLOOR, (BALL.paint(glass()) | FLOOR).paint(matte(WHITE))) == 0
    assert not casts_caustics(lit(BALL.paint(glass()), LAMP, shadows=False))


def test_a_mirror_without_bounds_is_left_to_paths():
    # Photons have no target; the light that the plane mirrors is found by paths.
    wall = Box((2.0, 2.0, 0.1)).translate(y=1.0).paint(matte(WHITE))
    scene = lit(Plane().paint(mirror()) | wall, LAMP)
    found = tiles(scene, 16, 0, caustics=True)
    assert (found == tiles(scene, 16, 0, caustics=False)).all()
    assert found.mean() > 0.1


def test_a_wide_spot_light():
    light = SpotLight((0.5, 3.0, 0.5), intensity=10.0, angle=0.9, radius=0.3)
    scene = lit(FLOOR | BALL.paint(glass()), light)
    found = np.mean([tiles(scene, 32, s, caustics=True).mean() for s in range(4)])
    plain = np.mean([tiles(scene, 256, s, caustics=False).mean() for s in range(4)])
    assert found == pytest.approx(plain, rel=0.02)


def test_photons_stand_in_the_slots_of_their_cells():
    generator = np.random.default_rng(4)
    count, slots, maps = 500, 16, 3
    place, arrival, power = generator.normal(size=(3, maps, count, 3)).astype(np.float32)
    slot = generator.integers(-1, slots, (maps, count)).astype(np.int32)
    power[:, ::7] = 0.0
    power[:, 3::50] = np.nan
    parts = zip(place, arrival, power, slot, strict=True)
    places, arrivals, starts = _joined([_sorted(*part, slots) for part in parts]).values()
    kept = np.isfinite(power).all(axis=2) & (power != 0.0).any(axis=2)
    for m in range(maps):
        for s in range(slots + 1):
            i = m * (slots + 1) + s
            found = slice(starts[i], starts[i + 1])
            expected = (slot[m] == s % slots) & kept[m]
            assert (places[found, :3] == place[m][expected]).all()
            colors = arrivals.reshape(-1, 2, 4)[found, 1, :3] * places[found, 3:]
            assert np.allclose(colors, power[m][expected], rtol=1e-6)
    assert starts[-1] == len(places)


def test_photons_fly_on_the_device_of_the_picture(monkeypatch):
    try:
        adapters.opened(adapters.chosen())
    except DeviceError as error:
        pytest.skip(str(error))
    monkeypatch.setattr("distal.runtime.executor.is_software", lambda device: False)
    scene = lit(FLOOR | BALL.paint(mirror()), LAMP)
    asked = {"size": SIZE, "mode": "path", "spp": 16}
    there, here = (scene.render(**asked, device=device).linear for device in ("gpu", "cpu"))
    off = np.abs(there - here).max(axis=2)
    assert there.mean() == pytest.approx(here.mean(), rel=1e-3)
    assert (off > 0.02).mean() < 0.01


@pytest.mark.parametrize("ior", [1.1, 1.5])
def test_caustics_inside_of_glass_are_those_of_paths(ior):
    """Radiance counts divided by the square of the index, in photons as in paths."""
    ball = Sphere(1.0).paint(glass(ior), priority=1)
    inner = Sphere(0.6).paint(matte("white"), priority=2)
    lamp = PointLight((0.0, 4.0, 0.5), intensity=20.0, radius=1.2)
    scene = lit(ball | inner, lamp, camera=Camera((0.0, 2.0, 4.0), fov_deg=30.0))
    plain = tiles(scene, 256, 1, caustics=False)
    found = tiles(scene, 64, 2, caustics=True)
    assert found.mean() == pytest.approx(plain.mean(), rel=0.04)
