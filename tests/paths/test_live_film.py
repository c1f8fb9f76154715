"""The film of live pictures: a mean in 32-bit floats that neither drifts nor forgets."""

from __future__ import annotations

import numpy as np

from distal.lang import func, pcg, uint, vec4
from distal.render.live_film import film_after, film_light

COUNT = 10_000


@func
def sample_of(seed: int, number: int) -> vec4:
    """Light from 0 to 1, one time in 128 a hundred times as bright."""
    bits = pcg(uint(seed * 65536 + number))
    light = float(int(bits % uint(4096))) / 4096.0
    bright = 100.0 if bits % uint(128) == uint(7) else 1.0
    return vec4(light * bright, light, 1.0 - light, 1.0)


@func
def film_of(seed: int, scale: float) -> vec4:
    film = vec4(0.0)
    for i in range(COUNT):
        film = film_after(film, scale * sample_of(seed, i), i, 1)
    return film


@func
def film_in_passes(seed: int, scale: float) -> vec4:
    """The same samples, in passes of one, then of three."""
    film = film_after(vec4(7.0), scale * sample_of(seed, 0), 0, 1)
    for i in range(40):
        first = 1 + 3 * i
        three = sample_of(seed, first) + sample_of(seed, first + 1) + sample_of(seed, first + 2)
        film = film_after(film, scale * three / 3.0, first, 3)
    return film


@func
def sum_of(seed: int, scale: float) -> vec4:
    total = vec4(0.0)
    for i in range(121):
        total += scale * sample_of(seed, i)
    return total / 121.0


def test_ten_thousand_samples_are_as_in_64_bits() -> None:
    seeds = np.arange(16, dtype=np.int32)
    short = film_of(seeds, np.ones(16, np.float32))
    long = film_of(seeds, np.ones(16, np.float64))
    assert long.dtype == np.float64 and short.dtype == np.float32
    # Each update rounds by at most 6e-8, to any side: 3e-6 as a standard deviation.
    assert np.abs(short / long - 1.0).max() < 1e-5


def test_passes_may_have_any_number_of_samples() -> None:
    seeds = np.arange(16, dtype=np.int32)
    ones = np.ones(16, np.float64)
    # What the film had before the first pass does not count.
    np.testing.assert_allclose(film_in_passes(seeds, ones), sum_of(seeds, ones), rtol=1e-12)


def test_light_of_pixels_without_alpha_counts_nothing() -> None:
    half = film_after(vec4(0.4, 0.4, 0.4, 1.0), vec4(0.0), 1, 1)
    np.testing.assert_allclose(half, (0.2, 0.2, 0.2, 0.5), rtol=1e-6)
    np.testing.assert_allclose(film_light(vec4(*half)), (0.4, 0.4, 0.4, 0.5), rtol=1e-6)
