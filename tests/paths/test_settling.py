"""The estimated error of pixels whose samples are better distributed than independent ones."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang.render_options import Refinement
from distal.runtime.accumulation import Film
from distal.runtime.allocation import next_pass

SIDE = 64


def film_of(samples: np.ndarray) -> Film:
    """The film of samples, (number, height, width)."""
    count, height, width = samples.shape
    film = Film.empty(width, height)
    while (following := next_pass(film, Refinement(samples=count))) is not None:
        light = np.ones((height, width, 4), np.float32)
        part = samples[following.first : following.first + following.count]
        light[..., :3] = part.mean(axis=0)[..., None]
        film.add(light, following.count)
    return film


def points(rng: np.random.Generator, count: int, kind: str) -> np.ndarray:
    """The first points of a sequence in [0, 1) for each pixel: scrambled radical inverses."""
    if kind == "independent":
        return rng.random((count, SIDE, SIDE))
    bits = 24
    index = np.arange(count)[:, None, None]
    found, node = np.zeros((count, SIDE, SIDE)), np.zeros((count, SIDE, SIDE), np.uint64)
    keys = rng.integers(1 << 62, size=(SIDE, SIDE)).astype(np.uint64)
    for k in range(bits):
        digit = np.broadcast_to((index >> k) & 1, node.shape).astype(np.uint64)
        mixed = (node ^ keys) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(31)
        flip = ((mixed * np.uint64(0xBF58476D1CE4E5B9)) >> np.uint64(40)) & np.uint64(1)
        found += (digit ^ flip).astype(float) * 0.5 ** (k + 1)
        node = 2 * node + digit + 1
    return found


# Values by a point and a number of the pixel, both in [0, 1).
VALUES = {
    "smooth": lambda u, own: 1.0 + (0.5 + own) * u * u,
    "edge": lambda u, own: (u < own) * 1.0,
    "rare": lambda u, own: (u < 0.02 * own) * 100.0,
}
EXACT = {
    "smooth": lambda own: 1.0 + (0.5 + own) / 3.0,
    "edge": lambda own: own,
    "rare": lambda own: 2.0 * own,
}


@pytest.mark.parametrize("count", [64, 100, 256])
@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("kind", ["independent", "scrambled"])
def test_the_estimate_is_the_error(kind, value, count):
    rng = np.random.default_rng(5)
    estimates, errors = [], []
    for _ in range(4):
        own = rng.random((SIDE, SIDE))
        film = film_of(VALUES[value](points(rng, count, kind), own))
        estimates.append(film.variance.mean())
        errors.append(np.mean((film.light[..., 0] - EXACT[value](own)) ** 2))
    found = np.mean(estimates) / np.mean(errors)
    # The rate of few bright points is taken for that of noise: the error is stated too large.
    assert 0.8 < found < (5.0 if value == "rare" and kind == "scrambled" else 2.5), found


def test_smooth_pixels_are_known_to_settle_faster():
    rng = np.random.default_rng(6)
    film = film_of(VALUES["smooth"](points(rng, 256, "scrambled"), 0.5))
    assert film.variance.mean() < 0.1 * (film.sample_variance / film.samples).mean()


def test_small_pictures_are_taken_for_independent_samples():
    film = film_of(np.random.default_rng(7).random((64, 8, 8)))
    assert np.array_equal(film.effective_variance, film.sample_variance)


def test_tiles_with_other_numbers_of_samples():
    rng = np.random.default_rng(8)
    film = film_of(rng.random((32, SIDE, SIDE)))
    places = np.arange(SIDE * 16, dtype=np.int32)  # the upper row of tiles
    light = np.ones((len(places), 4), np.float32)
    for first in (32, 48):
        light[:, :3] = rng.random((16, len(places))).mean(axis=0)[:, None]
        film.add(light, 16, places)
        assert int(film.samples[0, 0]) == first + 16
    assert film.variance[:16].mean() == pytest.approx(1.0 / 12.0 / 64.0, rel=0.3)
    assert film.variance[16:].mean() == pytest.approx(1.0 / 12.0 / 32.0, rel=0.3)
