"""Paths against Mitsuba 3, an independent renderer, on scenes that both render alike.

The light of Mitsuba is stored (``tools/gen_twins.py``): the mean of each tile of 8x8 pixels and its
standard error. Here several independent pictures give the same, and Student's t of the difference
is bounded for every tile and color, and for the whole picture. By chance one of all these
comparisons fails in one of a thousand sets of random numbers; the seeds are fixed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from tests.paths.twins import HEIGHT, TILE, TWINS, WIDTH, mean_and_error, tiles

STORED = np.load(Path(__file__).parent / "data" / "twins.npz")
RUNS, SPP = 24, 24
# Every tile of every scene and each whole picture, in three colors.
COMPARISONS = len(TWINS) * 3 * (WIDTH * HEIGHT // TILE**2 + 1)
FAMILY_WISE = 1e-3
SURPRISING = float(stats.t.ppf(1.0 - 0.5 * FAMILY_WISE / COMPARISONS, RUNS - 1))


@pytest.mark.parametrize("name", TWINS)
def test_the_light_is_that_of_mitsuba(name):
    twin = TWINS[name]
    scene = twin.ours()
    # Plain paths, there and here, do not find caustics of lamps without a size.
    has_caustics = all(lamp.has_size for lamp in twin.lamps)
    asked = {"size": (WIDTH, HEIGHT), "mode": "path", "spp": SPP, "caustics": has_caustics}
    pictures = [scene.render(**asked, seed=seed).linear[..., :3] for seed in range(RUNS)]
    light = tiles(np.stack(pictures))
    theirs, their_error = STORED[f"{name}: mean"], STORED[f"{name}: error"]
    mean, error = mean_and_error(light)
    off = np.abs(mean - theirs) - twin.apart * theirs
    surprise = off / np.hypot(error, their_error)
    assert surprise.max() < SURPRISING, worst(surprise, mean, theirs)
    mean, error = mean_and_error(light.mean(axis=(1, 2)))
    theirs = theirs.mean(axis=(0, 1))
    of_all = np.sqrt((their_error**2).sum(axis=(0, 1))) / (their_error[..., 0].size)
    surprise = (np.abs(mean - theirs) - twin.apart * theirs) / np.hypot(error, of_all)
    assert surprise.max() < SURPRISING, (mean, theirs, surprise)


def worst(surprise, mean, theirs):
    """What to say of the tile that is off most."""
    at = np.unravel_index(surprise.argmax(), surprise.shape)
    return f"tile {at}: {mean[at]:.5f} instead of {theirs[at]:.5f}, {surprise[at]:.1f} sigma"


def test_data_is_whole():
    assert sorted(STORED) == sorted(f"{n}: {w}" for n in TWINS for w in ("error", "mean"))
    for name in TWINS:
        mean, error = STORED[f"{name}: mean"], STORED[f"{name}: error"]
        assert mean.shape == error.shape == (HEIGHT // TILE, WIDTH // TILE, 3)
        assert np.median(error / mean) < 0.004
