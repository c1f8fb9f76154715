"""Scenes of other tools: their pictures, and the guarantees of their fields.

The golden pictures are rendered by a default ``Scene(shape)``. After a change of the default look:

    DISTAL_UPDATE_GOLDEN=1 .venv/bin/python -m pytest tests/scenes_of_others

Look at each picture before you commit it. The tolerance is that of all pictures
(``tests/pictures/comparison.py``), with ten times its share of differing pixels: 160 by 120 pixels
without antialiasing have many edges, and a pixel at an edge can change with the processor.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from PIL import Image

from distal import Scene, Shape
from tests.fields.seeds import seed_of
from tests.pictures.comparison import as_bytes, difference
from tests.scenes_of_others.scenes import SCENES

HERE: Final = Path(__file__).parent
SIZE: Final = (160, 120)
MOST_MEAN: Final = 1.0
MOST_FAR_OFF: Final = 0.02
# Rays that end differently with 160 and with 1000 steps.
MOST_UNFINISHED: Final = 0.002


@cache
def shape_of(name: str) -> Shape:
    return SCENES[name]()


def region(shape: Shape, margin: float) -> tuple[Any, Any]:
    low, high = (np.array(corner) for corner in shape.bounds())
    return low - margin, high + margin


@pytest.mark.parametrize("name", SCENES)
def test_the_picture_is_the_golden_one(name):
    found = as_bytes(Scene(shape_of(name)).render(SIZE).array)
    assert found.std() > 5.0, "the picture shows nothing"
    path = HERE / f"{name}.png"
    if os.environ.get("DISTAL_UPDATE_GOLDEN"):
        Image.fromarray(found).save(path, optimize=True)
    off = difference(found, np.asarray(Image.open(path).convert("RGB")))
    assert off.mean <= MOST_MEAN and off.far_off <= MOST_FAR_OFF, off


@pytest.mark.parametrize("name", SCENES)
def test_the_slope_is_never_exceeded_and_the_box_holds_the_surface(name):
    shape, rng = shape_of(name), np.random.default_rng(seed_of(name))
    low, high = region(shape, 0.2)
    p = rng.uniform(low, high, (3000, 3))
    d, g = shape(p), shape.gradient(p)
    near = p - d[:, None] * g / np.maximum((g * g).sum(axis=1), 1e-6)[:, None]
    p = np.concatenate([p, np.clip(near, low, high)])
    assert np.isfinite(shape(p)).all()
    assert np.linalg.norm(shape.gradient(p), axis=1).max() <= shape.slope * (1.0 + 1e-6)
    way = rng.normal(size=p.shape) * 10.0 ** rng.uniform(-4.0, -0.5, (len(p), 1))
    rise = np.abs(shape(p + way) - shape(p)) / np.linalg.norm(way, axis=1)
    assert rise.max() <= shape.slope * (1.0 + 1e-6)
    box = region(shape, 1e-6)
    inside = p[shape(p) < 0.0]
    assert len(inside) > 20
    assert ((inside >= box[0]) & (inside <= box[1])).all()


@pytest.mark.parametrize("name", SCENES)
def test_the_surface_is_closed(name):
    """Along each line, the ways in and out alternate, and the value is 0 at each.

    The volume inside is the same from three directions.
    """
    shape, rng = shape_of(name), np.random.default_rng(seed_of(f"lines through {name}"))
    low, high = region(shape, 0.05)
    shares = []
    for axis in range(3):
        starts = rng.uniform(low, high, (500, 1, 3))
        steps = np.linspace(low[axis], high[axis], 300)
        p = np.broadcast_to(starts, (500, 300, 3)).copy()
        p[..., axis] = steps
        values = shape(p)
        assert (values[:, 0] > 0.0).all() and (values[:, -1] > 0.0).all()
        shares.append(float((values < 0.0).mean()))
        line, at = np.nonzero((values[:, 1:] < 0.0) != (values[:, :-1] < 0.0))
        before, after = p[line, at], p[line, at + 1]
        starts_inside = values[line, at] < 0.0
        for _ in range(40):
            middle = 0.5 * (before + after)
            same = ((shape(middle) < 0.0) == starts_inside)[:, None]
            before, after = np.where(same, middle, before), np.where(same, after, middle)
        assert np.abs(shape(before)).max(initial=0.0) < 1e-6
    assert max(shares) < 1.25 * min(shares) + 0.01, shares


# The steepest, and those with the most small parts; each costs two more compilations.
STEEP: Final = ("knurling", "twisted_morph")


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize(
    ("name", "view"),
    [(name, view) for view in ("normal", "color") for name in (*STEEP, "castle")],
)
def test_rays_end_at_a_surface_or_outside(name, view):
    """More steps than the default change nothing, neither for the camera's rays nor for shadows."""
    few, many = (
        Scene(shape_of(name), steps=steps).render((80, 60), view=view).array[..., :3]
        for steps in (160, 1000)
    )
    changed = np.abs(few - many).max(axis=2) > 2.0 / 255.0
    assert changed.mean() <= MOST_UNFINISHED


def test_the_robot_has_33_parts():
    def parts(node: Any) -> int:
        copies = 2 if node.rule.name == "symmetry" else 1
        return copies * sum(map(parts, node.children)) if node.children else 1

    assert parts(shape_of("robot").node) == 33
