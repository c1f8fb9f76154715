"""``Shape2D.fill``: pictures of flat shapes without a camera."""

from __future__ import annotations

import math
import threading

import numpy as np
import pytest

from distal import Circle, Rectangle, Shape, VoronoiLines
from distal.devices.base import Cancelled
from distal.lang import slider
from distal.lang.srgb import encode_srgb
from distal.runtime import function_tapes
from distal.scene.tree.errors import SceneValueError
from distal.tape.tape import TapeError


def test_a_disk_covers_its_area():
    picture = Circle(0.5).fill((200, 100), box=((-2.0, -1.0), (2.0, 1.0)))
    share = picture.linear[..., 0].mean()
    assert abs(share * 8.0 - math.pi * 0.25) < 2e-3
    assert picture.array.shape == (100, 200, 4)
    assert (picture.array[..., 3] == 1).all()


def test_y_points_up_and_x_to_the_right():
    shape = Circle(0.2).translate(0.5, 0.7)
    picture = shape.fill((100, 100), box=((-1, -1), (1, 1)))
    rows, columns = np.nonzero(picture.array[..., 0] > 0.5)
    assert abs(columns.mean() + 0.5 - 75) < 0.5
    assert abs(rows.mean() + 0.5 - 15) < 0.5


def test_it_frames_the_shape():
    picture = Rectangle((3.0, 1.0)).translate(10.0, 20.0).fill((330, 330), samples=1).array[..., 0]
    columns = np.nonzero(picture.any(axis=0))[0]
    rows = np.nonzero(picture.any(axis=1))[0]
    assert (columns.min(), columns.max()) == (15, 314)
    assert (rows.min(), rows.max()) == (115, 214)


@pytest.mark.parametrize("samples", [1, 4, 9])
def test_a_shape_without_a_tape_is_evaluated_by_its_kernel(samples, monkeypatch):
    shape = Circle(0.6).translate(0.1, 0.2) - Rectangle((0.3, 0.2)).rotate(0.3)
    options = {"size": (97, 70), "box": ((-1, -1), (1, 1)), "samples": samples}
    fast = shape.fill(**options)
    assert "no_tape" not in fast.stats
    other = Circle(0.6).translate(0.1, 0.2) - Rectangle((0.3, 0.2)).rotate(0.3)

    def refuse(*_):
        raise TapeError("it is a test")

    monkeypatch.setattr(function_tapes, "tape_of", refuse)
    slow = other.fill(**options)
    assert slow.stats["no_tape"] == "it is a test"
    # A sample on the edge may be on either side of it by rounding.
    assert (fast.array != slow.array).any(axis=-1).mean() < 1e-3


def test_noise_has_no_tape_but_a_picture():
    picture = VoronoiLines().fill((64, 64))
    reason = "it computes with whole numbers that differ from point to point"
    assert picture.stats["no_tape"] == reason
    assert 0 < picture.array[..., 0].mean() < 1


def test_parameters_change_the_picture():
    shape = Circle(slider("Radius", 0.2, low=0.1, high=0.9))
    box = ((-1, -1), (1, 1))
    areas = [
        shape.fill((100, 100), params={"radius": r}, box=box).linear[..., 0].mean() * 4
        for r in (0.2, 0.5, 0.8, 0.5)
    ]
    assert np.allclose(areas, [math.pi * r * r for r in (0.2, 0.5, 0.8, 0.5)], atol=5e-3)
    assert shape.fill((10, 10), params={"radius": 0.5}).provenance.parameters == {"radius": 0.5}


def test_edges_mix_light_not_codes():
    picture = Circle(0.5).fill((60, 60), inside="#ff0000", outside="#0000ff", samples=4)
    linear = picture.linear[..., :3]
    assert np.allclose(linear[..., 0] + linear[..., 2], 1.0, atol=1e-5)
    half = float(encode_srgb.python_function(0.5))
    assert np.isclose(picture.array[..., 0], half, atol=1e-6).any()


def test_a_file_is_filled_without_compilation(monkeypatch):
    monkeypatch.setattr(function_tapes, "run_passes", None)
    disk = Shape.from_vm("x var-x\ny var-y\na abs x\nb abs y\nc max a b\nr const 0.5\nd sub c r")
    picture = disk.fill((64, 64), samples=1)
    assert picture.array[..., 0].sum() == 32 * 32
    assert picture.stats["operations"] == 7
    assert picture.provenance.view == "fill"


def test_what_is_wrong_is_refused():
    circle = Circle(0.5)
    with pytest.raises(SceneValueError, match="samples are a square number from 1 to 256, not 5"):
        circle.fill(samples=5)
    with pytest.raises(SceneValueError, match="a box is two corners"):
        circle.fill(box=((1, 1), (-1, -1)))
    with pytest.raises(SceneValueError, match="a box is two corners"):
        circle.fill(box=3)
    with pytest.raises(TypeError, match="size is"):
        circle.fill(size=3)
    with pytest.raises(ValueError, match="'inside'"):
        circle.fill(inside=(2.0, 0.0, 0.0))


def test_cancel_stops_both_ways():
    stop = threading.Event()
    stop.set()
    for shape in (VoronoiLines(), Circle(0.5)):
        with pytest.raises(Cancelled):
            shape.fill((4000, 4000), cancel=stop)
