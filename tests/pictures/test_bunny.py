"""The bunny: alike on both sides, fatter by its weight, turned by the camera, painted as given."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import distal

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SIZE = (120, 120)


@pytest.fixture(scope="module")
def scene():
    return distal.load("example:bunny")


@pytest.fixture
def shape(monkeypatch):
    """The bunny without its meadow."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    return importlib.import_module("bunny").bunny


def fur_share(scene, **params):
    """How much of the picture is neither sky nor grass."""
    seen = scene.render(size=SIZE, view="material", params=params).array[..., :3]
    green = seen[..., 1] > seen[..., 0]
    dark = seen.max(axis=2) < 0.11
    eyes_and_sky = dark & (seen[..., 2] > seen[..., 0])
    return float((~green & ~eyes_and_sky).mean())


def test_both_sides_are_alike(shape):
    points = np.random.default_rng(1).uniform((-1, 0, 0), (1, 2, 1), (500, 3))
    mirrored = points * (1.0, 1.0, -1.0)
    assert np.allclose(shape(points), shape(mirrored), atol=1e-5)


def test_it_sits_on_the_ground_and_its_ears_are_up(shape):
    assert shape(np.array([[-0.14, 0.56, 0.0], [0.56, 1.24, 0.0]])).max() < -0.2
    assert shape(np.array([[0.6, 0.06, 0.17]]))[0] < 0.0
    heights = np.linspace(0.0, 2.5, 200)
    wide = np.stack(np.meshgrid(np.linspace(-1, 1, 60), heights, np.linspace(0, 0.6, 25)), -1)
    inside = shape(wide.reshape(-1, 3)).reshape(wide.shape[:3]) < 0.0
    top = heights[inside.any(axis=(1, 2))].max()
    assert 1.9 < top < 2.2
    # Above the head there are two ears with air between them.
    row = shape(np.stack([np.full(81, 0.14), np.full(81, 1.9), np.linspace(-0.4, 0.4, 81)], 1))
    assert row[40] > 0.02
    assert row[:40].min() < 0.0


def test_weight_makes_it_fatter(scene):
    thin, usual, fat = (fur_share(scene, turn=1.57, weight=w) for w in (0.6, 1.0, 1.8))
    assert 0.02 < thin < 0.95 * usual < 0.8 * fat


def test_the_camera_turns(scene):
    right = scene.render(size=SIZE, view="material", params={"turn": 0.3}).array
    left = scene.render(size=SIZE, view="material", params={"turn": 0.3 - np.pi}).array
    front = scene.render(size=SIZE, view="depth", params={"turn": np.pi / 2}).array
    assert np.abs(right - left).mean() > 0.02
    # From in front the bunny is its own mirror image.
    assert np.abs(front - front[:, ::-1]).mean() < 0.002


def test_ears_are_pink_inside(scene):
    seen = scene.render(size=SIZE, view="material", params={"turn": 1.2}).array[..., :3]
    pink = np.array([0xE0, 0x9A, 0x94]) / 255.0
    near = np.abs(seen - pink).max(axis=2) < 0.03
    rows = np.nonzero(near)[0]
    assert (rows < SIZE[1] // 3).sum() > 10


def test_without_softness_it_is_made_of_pieces(scene):
    """A hard seam: normals jump between neighboring pixels of the body."""
    jumps = []
    for softness in (0.0, 1.0):
        params = {"turn": 1.0, "softness": softness}
        n = scene.render(size=(240, 240), view="normal", params=params).array[100:180, 60:140, :3]
        jumps.append(float((np.abs(np.diff(n, axis=1)).max(axis=2) > 0.15).mean()))
    assert jumps[0] > 1.3 * jumps[1]
