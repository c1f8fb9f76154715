"""Samples of a pixel: their places, their mean, and the pixels that get more of them."""

from __future__ import annotations

import math
import threading
from typing import Any

import numpy as np
import pytest

from distal import Camera, Material, Plane, Scene, Sphere, checker
from distal.devices.base import Cancelled
from distal.lang import Frame, cos, func, image, select, vec2, vec3, vec4
from distal.lang.runtime_access import executor
from distal.render import film
from distal.render.camera import Ray
from distal.render.footprint import Cone
from distal.scene.rerender import difference, plan_rerender, rerender

AHEAD = (0.0, 0.0, -1.0)
SIZE = (48, 36)
COUNTS = (*range(1, 65), 81, 100, 255, 256, 1000, 4096, 46341, 65536)


def asked(function: Any, *args: Any) -> Any:
    """A scene function's values by the reference."""
    return executor().call(function, args, {}, device="reference")


def offsets(count: int) -> Any:
    """The offsets of all samples of a pixel, as the loop of ``gathered`` makes them."""
    step = int(asked(film.lattice_step, count))
    columns = np.arange(count)
    return asked(film.sample_offset, columns, columns * step % count, count).reshape(count, 2)


def ball() -> Scene:
    floor = Plane(-1.0).paint(checker(size=0.7))
    return Scene(Sphere(0.8) | floor, camera=Camera((0.0, 1.0, 5.0)), shadows=False)


# Places


def test_offsets_have_a_tent_distribution():
    """The tent's share up to an offset is the number that it was made of."""
    u = np.linspace(0.001, 0.999, 41)
    x = asked(film.tent, 2.0 * u - 1.0)
    below = np.where(x < 0.0, 0.5 * (1.0 + x) ** 2, 1.0 - 0.5 * (1.0 - x) ** 2)
    assert below == pytest.approx(u, abs=1e-9)


@pytest.mark.parametrize("count", COUNTS)
def test_samples_are_centred_and_stratified_in_both_coordinates(count):
    found = offsets(count).astype(np.float32)
    assert math.fsum(found[:, 0]) == 0.0
    assert math.fsum(found[:, 1]) == 0.0
    if count > 1:
        strata = asked(film.tent, (2.0 * np.arange(count) + 1.0 - count) / count)
        for axis in range(2):
            assert np.sort(found[:, axis]) == pytest.approx(strata, abs=2e-4 / count**0.5)


@pytest.mark.parametrize("count", COUNTS[1:])
def test_the_step_is_the_coprime_number_nearest_to_the_golden_ratio(count):
    step = int(asked(film.lattice_step, count))
    golden = count * (math.sqrt(5.0) - 1.0) / 2.0
    assert math.gcd(step, count) == 1
    nearest = min(abs(k - golden) for k in range(1, count + 1) if math.gcd(k, count) == 1)
    assert abs(step - golden) == pytest.approx(nearest)


# Mean


@func
def pixel(coord: vec2, samples: int, transparent: bool) -> vec4:
    """A camera that shows its direction, a picture that begins right of 0.1 and glows by y."""
    return film.exposed(
        coord,
        vec2(30.0, 20.0),
        lambda uv: Ray(vec3(uv, 0.0), vec3(AHEAD)),
        lambda ray, cone: vec4(
            ray.origin.x, ray.origin.y, 1.0, 0.75 if ray.origin.x > 0.1 else -1.0
        ),
        lambda uv, size: Cone(0.0, 0.0),
        samples,
        film.lattice_step(samples),
        transparent,
    )


@pytest.mark.parametrize("samples", [1, 7, 8])
def test_a_pixel_is_the_mean_of_what_is_there(samples):
    """Straight alpha: weighted by it. Opaque: all count but rays that found no way out."""
    for coord in ((16.4, 12.3), (20.0, 3.0), (2.0, 3.0)):
        uv = (2.0 * (np.array(coord) + offsets(samples)) - [30.0, 20.0]) / 20.0
        seen = np.concatenate([uv, np.ones((samples, 1))], axis=1)
        there = uv[:, 0] > 0.1
        for transparent, weight in ((True, 0.75), (False, 1.0)):
            found = asked(pixel, np.array([coord]), samples, transparent)[0]
            mean = seen[there].mean(0) if there.any() else np.zeros(3)
            assert found[:3] == pytest.approx(mean, abs=1e-5)
            assert found[3] == pytest.approx(weight * there.mean(), abs=1e-6)


def test_samples_do_not_move_the_picture():
    """The middle of a bright spot stays where it is, for every number of samples."""
    view = Camera((0.3, 0.2, 5.0))
    glow = Scene(Sphere(0.5).paint("#000"), [], view, (1.0, 1.0, 1.0), floor=False)
    x = np.arange(SIZE[0]) + 0.5
    middles = []
    for samples in (1, 2, 3, 8):
        dark = 1.0 - glow.render(SIZE, samples=samples).linear[..., 0].astype(float)
        middles.append((dark.sum(0) * x).sum() / dark.sum())
    assert middles[1:] == pytest.approx([middles[0]] * 3, abs=0.06)


# Images


@image
def edge(frame: Frame) -> vec4:
    """White left of the middle of column 10, black and half transparent right of it."""
    white = frame.coord.x < 10.5
    return vec4(vec3(select(white, 1.0, 0.0)), select(white, 1.0, 0.5))


@image
def ripples(frame: Frame) -> vec3:
    return vec3(0.5 + 0.5 * cos(0.9 * frame.coord.x), 0.3, frame.coord.y / frame.resolution.y)


@pytest.mark.parametrize("device", ["cpu", "reference"])
def test_an_image_is_averaged_in_linear_light_weighted_by_alpha(device):
    picture = edge.render((20, 3), samples=64, device=device)
    linear = picture.linear[1]
    assert linear[:9] == pytest.approx(np.broadcast_to([1, 1, 1, 1], (9, 4)), abs=1e-5)
    assert linear[12:] == pytest.approx(np.broadcast_to([0, 0, 0, 0.5], (8, 4)), abs=1e-5)
    assert linear[10, 3] == pytest.approx(0.75)
    # Half of the samples are white with alpha 1, half black with alpha 0.5.
    assert linear[10, :3] == pytest.approx([2.0 / 3.0] * 3, abs=1e-4)
    assert picture.provenance.samples == 64


def test_an_image_has_one_sample_unless_asked():
    once = ripples.render(SIZE)
    assert once.provenance.samples == 1
    assert np.array_equal(once.array, ripples.render(SIZE, samples=1).array)
    many = ripples.render(SIZE, samples=16)
    assert not np.array_equal(once.array, many.array)
    reference = ripples.render(SIZE, samples=16, device="reference")
    assert many.array == pytest.approx(reference.array, abs=1e-4)
    assert many.array[..., 2] == pytest.approx(once.array[..., 2], abs=2e-2)


# Adaptive


def wanted(picture: Any) -> tuple[Any, Any]:
    """Which pixels differ from a neighbor by more than the contrast: surely, and perhaps."""
    shown = np.clip(picture.array[..., :3].astype(float), 0.0, 1.0)
    linear = np.where(shown > 0.04045, ((shown + 0.055) / 1.055) ** 2.4, shown / 12.92)
    alpha = picture.array[..., 3].astype(float)
    most = np.zeros(alpha.shape)
    for values in (linear @ [0.2126, 0.7152, 0.0722] * alpha, alpha):
        around = np.pad(values, 1, mode="edge")
        for dy in range(3):
            for dx in range(3):
                part = around[dy : dy + values.shape[0], dx : dx + values.shape[1]]
                most = np.maximum(most, np.abs(part - values))
    return most > film.CONTRAST + 1e-4, most > film.CONTRAST - 1e-4


@pytest.mark.parametrize("transparent", [False, True])
def test_adaptive_pixels_have_nine_samples_and_the_others_one(transparent):
    once, eight, found = (
        ball().render(SIZE, samples=samples, transparent=transparent) for samples in (1, 8, None)
    )
    surely, perhaps = wanted(once)
    assert 0.05 < surely.mean() < 0.9
    assert np.array_equal(found.linear[~perhaps], once.linear[~perhaps])
    assert np.array_equal(found.array[~perhaps], once.array[~perhaps])
    alpha = (once.linear[..., 3:] + 8.0 * eight.linear[..., 3:]) / 9.0
    light = once.linear[..., :3] * once.linear[..., 3:]
    light = (light + 8.0 * eight.linear[..., :3] * eight.linear[..., 3:]) / 9.0
    assert found.linear[surely][:, 3:] == pytest.approx(alpha[surely], abs=1e-5)
    expected = light[surely] / np.maximum(alpha[surely], 1e-6)
    assert found.linear[surely][:, :3] == pytest.approx(expected, abs=1e-4)
    share = found.stats["samples"]
    assert 1.0 + 8.0 * surely.mean() <= share <= 1.0 + 8.0 * perhaps.mean()


def test_adaptive_sampling_is_the_default_and_better_than_four_samples():
    picture = ball().render(SIZE)
    assert picture.provenance.samples is None
    exact = ball().render(SIZE, samples=256).linear
    errors = [
        float(np.sqrt(np.mean((ball().render(SIZE, samples=n).linear - exact) ** 2)))
        for n in (1, 4, None)
    ]
    assert errors[2] < errors[1] < errors[0]


def test_a_picture_without_contrast_is_rendered_once():
    calm = Scene(
        Plane(),
        [],
        background=(0.3, 0.3, 0.3),
        default_material=Material(emission=(0.2, 0.2, 0.2)),
        camera=Camera((0, 3, 0.1)),
    )
    picture = calm.render(SIZE)
    assert picture.stats["samples"] == 1.0
    assert np.array_equal(picture.array, calm.render(SIZE, samples=1).array)


def test_other_views_and_layers_have_one_sample():
    scene = ball()
    for view in ("normal", "steps"):
        assert np.array_equal(
            scene.render(SIZE, view=view).array, scene.render(SIZE, view=view, samples=1).array
        )
    some, once = (
        scene.render(SIZE, samples=n, layers=("depth", "material")).layers for n in (None, 1)
    )
    assert all(np.array_equal(some[name], once[name]) for name in some)


def test_devices_and_frozen_numbers_agree():
    picture = ball().render(SIZE)
    for options in ({"device": "reference"}, {"freeze": True}):
        other = ball().render(SIZE, **options)
        apart = np.abs(other.linear - picture.linear).max(-1)
        assert (apart > 2e-3).mean() < 0.01


def test_progress_covers_both_passes_and_cancel_stops_either():
    shares: list[float] = []
    ball().render((200, 150), progress=shares.append)
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] <= 0.5 < shares[-1] == 1.0
    stop = threading.Event()
    for until in (0.01, 0.5):
        stop.clear()

        def halt(share: float, until: float = until) -> None:
            if share >= until:
                stop.set()

        with pytest.raises(Cancelled):
            ball().render((200, 150), device="reference", progress=halt, cancel=stop)


@pytest.mark.parametrize("suffix", ["png", "exr"])
def test_rerender_repeats_an_adaptive_picture(suffix, tmp_path):
    source = tmp_path / "scene.py"
    source.write_text(
        "from distal import *\nscene = Scene(Sphere(0.8) | Plane(-1.0).paint(checker()))\n"
    )
    from distal.loading import load  # noqa: PLC0415 (with the source)

    picture = load(str(source)).render(SIZE)
    path = tmp_path / f"made.{suffix}"
    picture.with_provenance(source="scene.py").save(path)
    plan = plan_rerender(path)
    assert plan.record.provenance.samples is None
    assert difference(plan, rerender(plan)).is_none
    assert not difference(plan, rerender(plan, samples=1)).is_none
