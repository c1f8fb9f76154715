"""Pictures that get ever more samples: their sums, when they end, and files that keep them."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from distal import PointLight, Scene, Sphere
from distal.devices.base import Cancelled
from distal.file_writer import SaveError
from distal.images.picture_files import read
from distal.lang.render_options import Refinement, RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime import film_files
from distal.runtime import passes as runtime_passes
from distal.runtime.accumulation import Film, accumulate
from distal.runtime.allocation import MOST_OF_A_PASS, next_pass

SIZE = (24, 16)
SEED = 7


def scene() -> Scene:
    return Scene(Sphere(), lights=PointLight((2, 3, 4), intensity=9.0, radius=1.0), floor=True)


def picture(spp=None, **options):
    return scene().render(size=SIZE, mode="path", spp=spp, seed=SEED, **options)


def passes(begun: int, samples: int, **options):
    """Yield the first sample and the number of samples of each pass of a picture of one tile."""
    film = Film.empty(4, 4)
    film.samples += begun
    refinement = Refinement(samples=samples, **options)
    while (following := next_pass(film, refinement)) is not None:
        assert following.places is None
        yield following.first, following.count
        film.samples += following.count


@pytest.mark.parametrize("samples", [1, 2, 3, 31, 100])
def test_passes_make_up_all_samples(samples):
    found = list(passes(0, samples))
    assert sum(count for _, count in found) == samples
    assert [first for first, _ in found] == [0, *np.cumsum([c for _, c in found])[:-1].tolist()]
    assert max(count for _, count in found) <= MOST_OF_A_PASS


@pytest.mark.parametrize("begun", [1, 2, 4, 16, 48])
def test_passes_go_on_as_if_they_had_not_been_broken_off(begun):
    whole = list(passes(0, 200))
    assert list(passes(begun, 200)) == [part for part in whole if part[0] >= begun]


@pytest.mark.parametrize("begun", [3, 7, 100])
def test_passes_go_on_from_any_number_of_samples(begun):
    found = list(passes(begun, 200))
    assert found[0][0] == begun and sum(count for _, count in found) == 200 - begun


def test_each_sample_is_a_pass_while_the_shutter_is_open():
    assert list(passes(0, 20, shutter=0.1)) == [(i, 1) for i in range(20)]


def test_a_film_has_the_mean_and_the_standard_error_of_its_samples():
    rng = np.random.default_rng(3)
    values = rng.gamma(2.0, 1.0, (400, 3, 5)).astype(np.float32)
    film = Film.empty(5, 3)
    for first, count in passes(0, 400):
        light = np.ones((3, 5, 4), np.float32)
        light[..., :3] = values[first : first + count].mean(axis=0)[..., None]
        film.add(light, count)
    assert (film.samples == 400).all()
    assert np.abs(film.light[..., 0] - values.mean(axis=0)).max() < 1e-5
    expected = values.std(axis=0, ddof=1) / 20.0
    errors = np.sqrt(film.variance)
    # The error is estimated from some 30 passes: within some 13 % of each pixel's, less on average.
    assert np.mean(errors / expected) == pytest.approx(1.0, abs=0.12)
    relative = errors / np.maximum(film.light[..., 0], 1.0)
    assert film.noise == pytest.approx(np.sqrt(np.mean(relative**2)), rel=1e-6)


def test_sums_do_not_drift():
    film = Film.empty(1, 1)
    light = np.full((1, 1, 4), 0.1, np.float32)
    light[..., 3] = 1.0
    for _ in range(20000):
        film.add(light, 16)
    assert film.light[0, 0, 0] == light[0, 0, 0]
    assert film.noise < 1e-9


def test_it_ends_at_a_limit_of_time():
    film = Film.empty(2, 2)

    def slow(asked, progress):
        time.sleep(0.01)
        return np.ones((2, 2, 4), np.float32)

    shares = []
    accumulate(film, slow, Refinement(samples=65536, time_limit=0.2), None, shares.append)
    assert 16 < film.samples.min() == film.samples.max() < 2000
    assert shares[-1] == 1.0 and shares == sorted(shares)


def test_it_ends_when_the_error_is_small():
    coarse, fine = (picture(noise=e).stats for e in (0.02, 0.005))
    assert coarse["noise"] <= 0.02 and fine["noise"] <= 0.005
    # Errors fall with the square root of the number of samples, or faster.
    assert 2 * coarse["samples"] < fine["samples"] <= 32 * coarse["samples"]


def test_the_same_seed_is_the_same_picture_with_any_number_of_threads():
    one, two = picture(8, threads=1), picture(8, threads=2)
    assert np.array_equal(one.linear, two.linear)
    assert not np.array_equal(one.linear, scene().render(size=SIZE, mode="path", spp=8).linear)


def test_frames_of_a_video_have_noise_of_their_own():
    assert not np.array_equal(picture(4).linear, picture(4, index=1).linear)


def test_a_film_goes_on(tmp_path):
    kept = tmp_path / "ball.film"
    part = picture(16, film=kept)
    assert part.stats["samples"] == 16
    whole = picture(48, film=kept)
    assert np.array_equal(whole.linear, picture(48).linear)
    again = picture(48, film=kept)  # nothing is left to do
    assert np.array_equal(whole.linear, again.linear)


def test_samples_are_kept_when_the_work_is_broken_off(tmp_path):
    kept, stop = tmp_path / "ball.film", threading.Event()

    def watch(share):
        if share > 0.3:
            stop.set()

    with pytest.raises(Cancelled):
        picture(512, film=kept, progress=watch, cancel=stop)
    with np.load(kept) as found:
        assert 16 <= found["samples"].max() < 512
    assert np.array_equal(picture(512, film=kept).linear, picture(512).linear)


RUN = """
from tests.paths.test_accumulation import picture
from distal.runtime import film_files
film_files._INTERVAL_S = film_files._INTERVAL_WRITES = 0.0
picture(60000, film={path!r})
"""


def test_samples_are_kept_when_the_process_is_killed(tmp_path):
    kept = tmp_path / "ball.film"
    root = Path(__file__).parents[2]
    process = subprocess.Popen([sys.executable, "-c", RUN.format(path=str(kept))], cwd=root)
    try:
        begin = time.monotonic()
        while not kept.exists() and process.poll() is None and time.monotonic() - begin < 120.0:
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    with np.load(kept) as found:
        samples = int(found["samples"].max())
    assert 1 <= samples < 60000
    more = -(-samples // 16) * 16 + 32
    assert np.array_equal(picture(more, film=kept).linear, picture(more).linear)


def test_a_film_of_another_picture_is_refused(tmp_path):
    kept = tmp_path / "ball.film"
    picture(2, film=kept)
    before = kept.read_bytes()
    message = f"{kept} keeps the samples of another picture: delete it or name another"
    for other in ({"seed": 8}, {"size": (16, 16)}, {"time": 1.0}):
        options = {"size": SIZE, "seed": SEED, **other}
        with pytest.raises(ValueError, match="another picture") as caught:
            scene().render(mode="path", spp=4, film=kept, **options)
        assert str(caught.value) == message
    assert kept.read_bytes() == before


def test_what_is_no_film_is_refused(tmp_path):
    kept = tmp_path / "ball.film"
    for content in (b"", b"PK\x03\x04garbage", b"words"):
        kept.write_bytes(content)
        with pytest.raises(ValueError, match="is not a film: delete it or name another"):
            picture(2, film=kept)
        assert kept.read_bytes() == content


def test_a_film_needs_a_folder(tmp_path):
    with pytest.raises(SaveError, match="there is no folder"):
        picture(2, film=tmp_path / "none" / "ball.film")


def test_slow_disks_are_written_to_less_often(tmp_path, monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(film_files.time, "monotonic", lambda: clock[0])
    file = film_files.FilmFile(tmp_path / "a.film", "key")

    def write(film):
        clock[0] += 3.0

    written = []
    monkeypatch.setattr(film_files.np, "savez", lambda *_, **__: write(written.append(clock[0])))
    for _ in range(400):
        clock[0] += 1.0
        file.keep(Film.empty(1, 1))
    assert written[0] == 10.0
    assert np.diff(written).min() >= 60.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mode": "paths"}, "there is no mode 'paths'; modes: direct, path"),
        ({"spp": 4}, "spp is for mode 'path'"),
        ({"caustics": False}, "caustics is for mode 'path'"),
        ({"mode": "direct", "noise": 0.1}, "noise is for mode 'path'"),
        ({"mode": "path", "spp": 0}, "a pixel has 1 to 65536 samples, not 0"),
        ({"mode": "path", "spp": 4, "samples": 8}, "spp=4 and samples=8 are the same: give one"),
        ({"mode": "path", "time_limit": 0}, "time_limit is a number above 0, not 0"),
        ({"mode": "path", "noise": float("nan")}, "noise is a number above 0, not nan"),
        (
            {"mode": "path", "view": "depth"},
            "mode 'path' computes light; the view 'depth' shows none",
        ),
    ],
)
def test_options_that_make_no_sense(options, message):
    with pytest.raises(ValueError, match=r".") as caught:
        scene().render(size=(4, 4), **options)
    assert str(caught.value) == message


def test_a_scene_may_ask_for_paths_itself(tmp_path):
    asks = Scene(Sphere(), mode="path")
    first = asks.render(size=(8, 8), samples=4)
    assert first.stats["samples"] == 4
    assert asks.render(size=(8, 8), mode="direct").stats.get("noise", "none") == "none"
    assert "noise" not in asks.render(size=(8, 8), view="depth").stats


def test_a_picture_knows_how_it_was_made(tmp_path):
    file = tmp_path / "ball.png"
    picture(4).save(file)
    origin = read(file).provenance
    assert (origin.mode, origin.samples) == ("path", 4)


def test_long_runs_do_not_drift(tmp_path):
    """10,000 samples in 8x8 pixels: both halves agree, and the sums are those of one run."""
    lamp = PointLight((2, 3, 4), intensity=9.0, radius=1.0)
    made = Scene(Sphere(), lights=lamp, floor=True)

    def film(samples):
        program, _ = made.program("color", None, mode="path")
        options = RenderOptions(
            size=(8, 8), seed=SEED, refinement=Refinement(samples=samples, film=kept)
        )
        executor().render(program, options)
        with np.load(kept) as found:
            return found["sums"].copy(), found["spread"].copy()

    kept = tmp_path / "split.film"
    half, half_spread = film(4992)  # a multiple of a pass
    whole, _ = film(10000)
    kept = tmp_path / "whole.film"
    unbroken, _ = film(10000)
    assert np.array_equal(whole, unbroken)
    first, second = half / 4992, (whole - half) / 5008
    deviation = np.sqrt(half_spread / (4992 / 16) / 4992)
    apart = (first - second)[..., :3] @ (0.2126, 0.7152, 0.0722)
    # The error of the difference is that of both halves.
    assert np.abs(apart / (np.sqrt(2.0) * deviation + 1e-9)).max() < 4.0
    assert np.abs(apart).mean() < 1e-3
    assert np.array_equal(first[..., 3], second[..., 3])


def test_bright_samples_are_clamped_and_it_is_said():
    plain, clamped = picture(32), picture(32, clamp=0.2)
    assert "clamp" not in plain.stats and clamped.stats["clamp"] == 0.2
    assert clamped.linear[..., :3].max() <= 0.2 + 1e-6 < plain.linear[..., :3].max()
    dark = plain.linear[..., :3].max(axis=-1) < 0.02
    assert np.allclose(plain.linear[dark], clamped.linear[dark], atol=2e-3)
    assert np.array_equal(picture(8, clamp=1e6).linear, picture(8).linear)


def test_previews_show_the_samples_so_far(monkeypatch):
    monkeypatch.setattr(runtime_passes, "PREVIEW_S", 0.0)
    monkeypatch.setattr(runtime_passes, "_PREVIEW_SHARE", 0.0)
    seen = []
    whole = picture(16, preview=seen.append)
    assert [made.stats["samples"] for made in seen] == [1, 2, 4, 8, 16]
    assert np.array_equal(seen[-1].linear, whole.linear)
    assert np.array_equal(seen[-1].array, whole.array)
    assert seen[0].linear.shape == whole.linear.shape


def test_previews_take_a_small_part_of_the_time(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(runtime_passes.time, "monotonic", lambda: clock[0])
    shown = []

    def slow(film):
        clock[0] += 1.0
        shown.append(clock[0])

    previews = runtime_passes.Previews(slow)
    for _ in range(200):
        clock[0] += 1.0
        previews.show(Film.empty(1, 1))
    assert 3.0 <= shown[0] <= 4.0 and np.diff(shown).min() >= 20.0


def test_a_preview_is_shown_when_the_work_is_broken_off():
    seen, stop = [], threading.Event()

    def watch(share):
        if share > 0.3:
            stop.set()

    with pytest.raises(Cancelled):
        picture(512, progress=watch, cancel=stop, preview=seen.append)
    assert len(seen) == 1 and seen[0].stats["samples"] >= 16
