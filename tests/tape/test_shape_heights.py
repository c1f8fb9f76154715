"""``Shape.heights``: solids seen along an axis."""

from __future__ import annotations

import math
import threading

import numpy as np
import pytest

from distal import Box, Gyroid, HeightMap, Shape, Sphere, Torus
from distal.devices.base import Cancelled
from distal.lang import slider
from distal.runtime import function_tapes
from distal.scene.tree.errors import SceneValueError
from distal.tape.tape import TapeError

CUBE = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
# Where a small ball at (0.5, 0.3, 0.1) is seen: to the right, up, toward the viewer.
SIDES = {
    "+x": (-0.1, 0.3, 0.5),
    "-x": (0.1, 0.3, -0.5),
    "+y": (0.5, -0.1, 0.3),
    "-y": (0.5, 0.1, -0.3),
    "+z": (0.5, 0.3, 0.1),
    "-z": (-0.5, 0.3, -0.1),
}


@pytest.mark.parametrize("side", SIDES)
def test_each_side(side):
    right, up, toward = SIDES[side]
    found = Sphere(0.15).translate(0.5, 0.3, 0.1).heights((100, 100), side=side, box=CUBE)
    assert isinstance(found, HeightMap)
    rows, columns = np.nonzero(np.isfinite(found.heights))
    assert abs((columns.mean() + 0.5) / 50 - 1 - right) < 0.01
    assert abs(1 - (rows.mean() + 0.5) / 50 - up) < 0.01
    assert abs(np.nanmax(found.heights) - (toward + 0.15)) < 1e-3
    top = np.unravel_index(np.nanargmax(found.heights), found.heights.shape)
    axis = "xyz".index(side[1])
    assert found.normals[top][axis] * (1 if side[0] == "+" else -1) > 0.99


def test_a_wide_picture_shows_the_box_in_its_middle():
    found = Box((1.0, 0.5, 0.2)).heights((330, 110), box=((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    rows, columns = np.nonzero(np.isfinite(found.heights))
    assert (columns.min(), columns.max()) == (110, 219)
    assert abs(rows.max() - rows.min() + 1 - 55) <= 1
    assert np.allclose(found.heights[rows, columns], 0.1, atol=1e-6)


def test_it_frames_the_shape():
    found = Sphere(2.0).translate(5.0, 6.0, 7.0).heights((110, 110))
    columns = np.nonzero(np.isfinite(found.heights))[1]
    assert abs(columns.min() - 5) <= 1 and abs(columns.max() - 104) <= 1
    assert abs(np.nanmax(found.heights) - 9.0) < 2e-3


@pytest.mark.parametrize("side", ["+z", "-y"])
def test_a_shape_without_a_tape_is_evaluated_by_its_kernel(side, monkeypatch):
    def shape() -> Shape:
        return (Torus(0.6, 0.2) - Sphere(0.4).translate(0.5, 0.1, 0.2)).rotate(x=0.4)

    options = {"size": (37, 29), "box": CUBE, "side": side}
    fast = shape().heights(**options)
    assert "no_tape" not in fast.stats

    def refuse(*_):
        raise TapeError("it is a test")

    monkeypatch.setattr(function_tapes, "tape_of", refuse)
    slow = shape().heights(**options)
    assert slow.stats["no_tape"] == "it is a test"
    both = np.isfinite(fast.heights) & np.isfinite(slow.heights)
    assert both.mean() > 0.2
    # A sample on the surface may be on either side of it by rounding.
    assert (np.isfinite(fast.heights) != np.isfinite(slow.heights)).mean() < 2e-3
    same = both & (np.abs(fast.heights - slow.heights) < 1e-5)
    assert same.sum() >= both.sum() - 2
    assert np.abs(fast.normals - slow.normals)[same].max() < 1e-3


def test_noise_has_no_tape_but_heights():
    ball = Sphere(0.7).warp(0.1, 2.0)
    found = ball.heights((24, 24), box=CUBE)
    assert (
        found.stats["no_tape"] == "it computes with whole numbers that differ from point to point"
    )
    assert 0.2 < np.isfinite(found.heights).mean() < 0.6


def test_parameters_and_a_gyroid():
    ball = Sphere(slider("Radius", 0.2, low=0.1, high=0.9))
    for radius in (0.3, 0.7, 0.3):
        found = ball.heights((64, 64), params={"radius": radius}, box=CUBE)
        area = np.isfinite(found.heights).mean() * 4
        assert abs(area - math.pi * radius**2) < 0.05
        assert found.provenance.parameters == {"radius": radius}
    assert np.isfinite((Gyroid(0.5, 0.1) & Sphere(0.9)).heights((64, 64)).heights).any()


def test_the_picture_shows_the_normals():
    found = Sphere(0.5).heights((40, 40), box=CUBE)
    picture = found.picture()
    hit = np.isfinite(found.heights)
    assert (picture.array[..., 3] == hit).all()
    assert np.abs(picture.array[hit][:, :3] - (0.5 + 0.5 * found.normals[hit])).max() < 1e-6
    assert (picture.layers["height"][hit] == found.heights[hit]).all()
    assert picture.provenance.view == "heights"


def test_a_file_needs_no_compilation(monkeypatch):
    monkeypatch.setattr(function_tapes, "run_passes", None)
    text = "x var-x\ny var-y\nz var-z\na max x y\nb max a z\nr const 0.5\nd sub b r"
    found = Shape.from_vm(text).heights((64, 64), box=CUBE)
    assert np.allclose(found.heights[20:, :40], 0.5)
    assert np.isnan(found.heights[:14]).all()
    assert found.stats["operations"] == 7


def test_what_is_wrong_is_refused():
    ball = Sphere(0.5)
    with pytest.raises(SceneValueError, match="a side is one of"):
        ball.heights(side="front")
    with pytest.raises(SceneValueError, match="a box is two corners"):
        ball.heights(box=((-1, -1), (1, 1)))
    with pytest.raises(TypeError, match="size is"):
        ball.heights(size=3)


def test_cancel_stops_both_ways():
    stop = threading.Event()
    stop.set()
    for shape in (Sphere(0.7).warp(0.1, 2.0), Sphere(0.5)):
        with pytest.raises(Cancelled):
            shape.heights((2000, 2000), cancel=stop)
