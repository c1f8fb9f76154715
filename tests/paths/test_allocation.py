"""Samples that go where the error is."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, Plane, PointLight, Scene, Sphere, glass
from distal.lang.render_options import Refinement
from distal.runtime.accumulation import Film, accumulate
from distal.runtime.allocation import FEWEST_SAMPLES, TILE_PX, by_pixel, over_tiles, share_done

SIZE = (48, 40)


def noisy(rng, deviation):
    """A program whose samples are 0.5 with a standard deviation for each pixel."""

    def rendered(asked, progress):
        spread = deviation / np.sqrt(asked.count)
        light = np.ones((*spread.shape, 4), np.float32)
        light[..., :3] = (0.5 + spread * rng.standard_normal(spread.shape))[..., None]
        return light if asked.places is None else light.reshape(-1, 4)[asked.places]

    return rendered


def uneven() -> np.ndarray:
    deviation = np.full((64, 64), 0.05)
    deviation[:16, :16] = 2.0
    return deviation


def test_means_over_tiles_count_the_pixels_that_there_are():
    values = np.arange(20 * 35, dtype=float).reshape(20, 35)
    found = over_tiles(values)
    assert found.shape == (2, 3)
    assert found[1, 2] == pytest.approx(values[TILE_PX:, 2 * TILE_PX :].mean())
    spread = by_pixel(found > 300.0, 35, 20)
    assert spread.shape == values.shape and (spread[0, 0], spread[19, 34]) == (False, True)


def test_samples_go_where_the_error_is():
    film = Film.empty(64, 64)
    goal = 0.01
    rendered = noisy(np.random.default_rng(1), uneven())
    accumulate(film, rendered, Refinement(samples=65536, noise=goal), None, None)
    assert film.noise <= goal
    assert (film.samples[32:, 32:] <= 2 * FEWEST_SAMPLES).all()
    assert film.samples[0, 0] > 10 * FEWEST_SAMPLES
    # As many everywhere would be the mean variance over the squared error.
    uniform = np.mean(uneven() ** 2) / goal**2
    assert film.samples.mean() < 0.35 * uniform
    truth = np.sqrt(np.mean((film.light[..., 0] - 0.5) ** 2))
    assert truth == pytest.approx(goal, rel=0.2)


def test_the_share_that_is_done_grows_to_all():
    shares = []
    film = Film.empty(64, 64)
    refinement = Refinement(samples=65536, noise=0.02)
    accumulate(film, noisy(np.random.default_rng(2), uneven()), refinement, None, shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert share_done(film, refinement) > 0.5


def test_no_pixel_gets_more_than_the_largest_number():
    film = Film.empty(64, 64)
    refinement = Refinement(samples=200, noise=1e-4)
    accumulate(film, noisy(np.random.default_rng(3), uneven()), refinement, None, None)
    assert (film.samples == 200).all()


def test_the_mean_has_no_bias_from_when_it_stops():
    """Pictures of rare bright samples: what stops early has fewer of them, if not enough pixels
    decide together."""
    means = []
    for seed in range(40):
        rng = np.random.default_rng(seed)

        def rendered(asked, progress, rng=rng):
            found = 5.0 * rng.poisson(0.02 * asked.count, (48, 48)) / asked.count
            light = np.ones((48, 48, 4), np.float32)
            light[..., :3] = found[..., None]
            return light if asked.places is None else light.reshape(-1, 4)[asked.places]

        film = Film.empty(48, 48)
        accumulate(film, rendered, Refinement(samples=65536, noise=0.05), None, None)
        assert film.samples.max() > FEWEST_SAMPLES
        means.append(film.light[..., 0].mean())
    error = np.std(means) / np.sqrt(len(means))
    assert abs(np.mean(means) - 0.1) < 3.0 * error


def caustic() -> Scene:
    lamp = PointLight((1.0, 3.0, 0.5), intensity=12.0, radius=0.3)
    ball = Sphere(0.5).translate(y=0.7).paint(glass())
    camera = Camera((0.0, 2.0, 4.0), (0.0, 0.4, 0.0))
    block = Box((0.4, 0.4, 0.4)).translate((-1.0, 0.2, 0.0))
    return Scene(ball | block | Plane(), lights=lamp, camera=camera)


def test_a_picture_goes_on_where_its_samples_went(tmp_path):
    made = {"size": SIZE, "mode": "path", "noise": 0.012, "seed": 3, "layers": "samples"}
    whole = caustic().render(**made, spp=400)
    counts = whole.layers["samples"]
    assert len(np.unique(counts)) > 2
    kept = tmp_path / "caustic.film"
    caustic().render(**made, spp=112, film=kept)
    again = caustic().render(**made, spp=400, film=kept, threads=1)
    assert np.array_equal(again.linear, whole.linear)
    assert np.array_equal(again.layers["samples"], counts)
    # Without a limit of the error the tiles with the fewest samples come first.
    more = caustic().render(
        SIZE, mode="path", spp=int(counts.max()), film=kept, seed=3, layers="samples"
    )
    assert (more.layers["samples"] == counts.max()).all()
