"""The sea: both marches show one sea, one at a third of the cost; waves keep their bounds."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import distal

ROOT = Path(__file__).resolve().parents[2]
SIZE = (160, 100)


@pytest.fixture(scope="module")
def scenes():
    return {name: distal.load(f"example:{name}") for name in ("sea", "sea_sphere_tracing")}


@pytest.mark.parametrize("swell", [0.1, 0.5, 1.0])
def test_waves_keep_within_their_box_and_slope(scenes, swell):
    shape = scenes["sea"].shape
    points = np.random.default_rng(2).uniform(-300, 300, (20000, 3))
    points[:, 1] = 0.0
    params = {"swell": swell}
    heights = -shape(points, params=params, time=3.0)
    low, high = shape.bounds(params=params)
    assert low[1] < heights.min() < 0.6 * low[1]
    assert 0.6 * high[1] < heights.max() < high[1]
    steep = np.linalg.norm(shape.gradient(points, params=params, time=3.0), axis=1)
    assert steep.max() <= slope_at(scenes, swell)
    assert steep.max() - 1.0 > 0.2 * (slope_at(scenes, swell) - 1.0)


def slope_at(scenes, swell):
    """The bound that the shape declares at its own swell, at another one."""
    steepest = np.sqrt(scenes["sea"].shape.slope ** 2 - 1.0) / 0.5
    return np.sqrt(1.0 + (steepest * swell) ** 2)


def test_the_sea_is_level_on_average(scenes):
    points = np.random.default_rng(3).uniform(-3000, 3000, (20000, 3))
    points[:, 1] = 0.0
    assert abs(scenes["sea"].shape(points).mean()) < 0.005


def test_both_marches_see_one_sea(scenes):
    """Light glitters: single pixels differ by nature, so blocks of eight by ten are compared."""
    pictures = []
    for scene in scenes.values():
        array = scene.render(size=SIZE, time=1.7, samples=4).array[..., :3]
        pictures.append(array.reshape(10, 10, 20, 8, 3).mean(axis=(1, 3)))
    apart = np.abs(pictures[0] - pictures[1])
    assert apart.mean() < 1 / 255
    assert apart.max() < 12 / 255


@pytest.mark.parametrize("size", [(320, 200), (640, 400)])
def test_the_hybrid_march_costs_a_third(monkeypatch, size):
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    bench_march = importlib.import_module("bench_march")
    means = []
    for march_by in (bench_march.by_hybrid, bench_march.by_spheres):
        told = march_by.render(size=size, samples=1, time=1.7).array
        means.append(told[..., 0][told[..., 2] > 0].mean())
    assert means[1] > 3.0 * means[0]


def test_the_sun_glitters_below_itself(scenes):
    picture = scenes["sea"].render(size=SIZE, samples=4).array[..., :3]
    bright = (picture.min(axis=2) > 0.8).astype(int)
    disc = np.nonzero(bright[:41])
    glitter = np.nonzero(bright[43:])
    assert len(disc[0]) > 20
    assert len(glitter[0]) > 10
    assert abs(disc[1].mean() - np.median(glitter[1])) < 8


def test_the_cost_is_a_picture(scenes):
    """Sky is free; skimmed waves cost sphere tracing more; the legend ends at the most steps."""
    hybrid, spheres = (s.render(size=SIZE, view="steps").array[..., :3] for s in scenes.values())
    assert np.abs(hybrid[:30] - hybrid[0, 0]).max() < 1e-3
    water = slice(45, 80)
    assert (spheres[water] != hybrid[water]).any()
    assert spheres[water, :, 2].mean() > hybrid[water, :, 2].mean()


def test_three_sample_normals_are_the_scenes_choice(scenes):
    assert scenes["sea"].normals == "forward"
    assert scenes["sea"].march == "heightfield"
