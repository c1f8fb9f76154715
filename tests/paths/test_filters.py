"""Reconstruction filters: their distributions, and what they do to an edge."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, Scene, emissive
from distal.lang import func, vec2, vec3
from distal.render import filters
from distal.render.filters import place_by_filter

# The filters in one dimension, as their sources have them, and where they end.
ENDS = {"tent": 1.0, "box": 0.5, "gaussian": 4.0, "blackman-harris": 2.0, "mitchell": 2.0}


def value(name: str, x):
    x = np.abs(x)
    if name == "tent":
        return np.maximum(1.0 - x, 0.0)
    if name == "box":
        return np.where(x < 0.5, 1.0, 0.0)
    if name == "gaussian":
        return np.exp(-0.5 * (x / 0.5) ** 2) / (0.5 * np.sqrt(2.0 * np.pi))
    if name == "blackman-harris":
        waves = (0.35875, 0.48829, 0.14128, 0.01168)
        window = sum(a * np.cos(k * np.pi * x / 2.0) for k, a in enumerate(waves))
        return np.where(x < 2.0, window / (4.0 * 0.35875), 0.0)
    b = c = 1.0 / 3.0
    near = (12 - 9 * b - 6 * c) * x**3 + (-18 + 12 * b + 6 * c) * x**2 + (6 - 2 * b)
    far = (-b - 6 * c) * x**3 + (6 * b + 30 * c) * x**2 + (-12 * b - 48 * c) * x + 8 * b + 24 * c
    return np.where(x < 1.0, near, np.where(x < 2.0, far, 0.0)) / 6.0


def placed(name: str):
    number = filters.NAMES.index(name)

    @func
    def place(u: vec2) -> vec3:
        found = place_by_filter(u, number)
        return vec3(found.offset, found.weight)

    side = (np.arange(1024) + 0.5) / 1024.0
    u = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2).astype(np.float32)
    return np.asarray(place(u), np.float64)


@pytest.mark.parametrize("name", filters.NAMES)
def test_the_integral_of_a_filter_is_1(name):
    assert placed(name)[:, 2].mean() == pytest.approx(1.0, abs=0.003)
    assert (len(set(placed(name)[:, 2].round(6).tolist())) > 1) == (name in filters.SIGNED)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("name", filters.NAMES)
def test_samples_are_distributed_as_the_filter(name, axis):
    found = placed(name)
    ends = np.linspace(-ENDS[name], ENDS[name], 33)
    sums, _ = np.histogram(found[:, axis], ends, weights=found[:, 2])
    fine = np.linspace(-ENDS[name], ENDS[name], 32 * 64 + 1)
    middle = 0.5 * (fine[1:] + fine[:-1])
    expected = value(name, middle).reshape(32, 64).sum(axis=1) * (fine[1] - fine[0])
    assert expected.sum() == pytest.approx(1.0, abs=1e-3)
    # 1024 strata along the axis.
    assert np.abs(sums / len(found) - expected).max() < 0.003


@pytest.mark.parametrize("name", filters.NAMES)
def test_an_edge_is_the_integral_of_the_filter(name):
    # The bright half plane begins at a quarter of the pixel in the middle.
    far = Camera((0.0, 0.0, 100.0), fov=2.0 * np.arctan(0.045))
    bright = Box((10.0, 20.0, 0.01)).translate(x=5.0 + 0.25).paint(emissive((1.0, 1.0, 1.0)))
    scene = Scene(bright, lights=(), camera=far, background=(0.0, 0.0, 0.0), floor=False)
    picture = scene.render((9, 9), mode="path", spp=1024, filter=name)
    row = picture.linear[:, :, 1].mean(axis=0)
    x = np.linspace(-6.0, 6.0, 24001)
    weights = value(name, x) * (x[1] - x[0])
    expected = [weights[x > 0.25 - (column - 4)].sum() for column in range(9)]
    assert np.abs(row - expected).max() < 0.004
    assert (row.min() < -0.005) == (name in filters.SIGNED)
    assert (picture.linear[..., 3] == 1.0).all()


def test_a_filter_with_negative_weights_is_not_for_alpha():
    with pytest.raises(ValueError, match="mitchell") as caught:
        Scene(Box()).render((4, 4), mode="path", filter="mitchell", transparent=True)
    assert str(caught.value) == (
        "the negative weights of filter 'mitchell' leave noise in alpha: give another filter to a "
        "transparent picture"
    )
