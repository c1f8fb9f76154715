"""The slope of terrain follows from its data: never more than declared, never far less."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Heightfield
from distal.lang import Texture2D, slider
from tests.fields.seeds import seed_of

SIZE = (3.0, 5.0)


def rough(rng):
    return rng.random((24, 17), np.float32)


def smooth(rng):
    z, x = np.mgrid[0:40, 0:30] / 8.0
    return (0.5 + 0.5 * np.sin(x) * np.cos(z + rng.random())).astype(np.float32)


def stepped(rng):
    """A cliff between two columns, and a lower one between two rows."""
    data = np.zeros((12, 12), np.float32)
    data[:, 7:] = 1.0
    data[4:, :] += 0.25
    return data


GROUNDS = [
    pytest.param(make, factor, height, id=f"{make.__name__}-{factor:g}-{height:g}")
    for make in (rough, smooth, stepped)
    for factor, height in ((1.0, 1.0), (1e-4, 1.0), (1e4, 3.0), (1.0, -2.0))
]


def dense(ground, rng):
    """Points in the middle of cells and next to their corners: the steepest are at corners."""
    rows, columns = ground.shape
    corner = np.stack([rng.integers(0, columns, 4000), rng.integers(0, rows, 4000)], axis=1)
    place = corner + rng.choice([-1e-3, 1e-3, 0.3], corner.shape)
    share = (place + 0.5) / (columns, rows) - 0.5
    height = rng.normal(size=4000)
    return np.stack([share[:, 0] * SIZE[0], height, -share[:, 1] * SIZE[1]], axis=1)


@pytest.mark.parametrize(("make", "factor", "height"), GROUNDS)
def test_the_slope_is_never_exceeded_and_reached_to_a_root_of_2(make, factor, height):
    rng = np.random.default_rng(seed_of("heights"))
    ground = factor * make(rng)
    shape = Heightfield(ground, SIZE, height)
    assert shape.slope == 1.0
    p = dense(ground, rng)
    gradient = shape.gradient(p)
    steepness = np.linalg.norm(gradient, axis=1)
    assert steepness.max() <= 1.0 + 1e-6
    # The ground's own steepness, from its gradient: the bound is at most the root of 2 above it,
    # because the steepest places along x and along z may differ.
    rise = np.linalg.norm(gradient[:, ::2], axis=1) / gradient[:, 1]
    declared = np.sqrt(1.0 / gradient[:, 1].min() ** 2 - 1.0)
    assert rise.max() <= declared * (1.0 + 1e-6)
    assert declared < 1.5 * rise.max()


def test_a_value_is_never_more_than_the_distance_to_the_ground():
    rng = np.random.default_rng(seed_of("distances to the ground"))
    ground = rough(rng)
    shape = Heightfield(ground, SIZE, 2.0)
    x, z = (rng.uniform(-0.5 * s, 0.5 * s, 60000) for s in SIZE)
    level = np.stack([x, 0.0 * x, z], axis=1)
    # The value at height 0 is the height times a factor; the factor is the derivative along y.
    y = -shape(level) / shape.gradient(level)[:, 1]
    p = rng.uniform((-1.5, 0.0, -2.5), (1.5, 3.0, 2.5), (300, 3))
    value = shape(p)
    nearest = [np.linalg.norm(level + y[:, None] * (0, 1, 0) - q, axis=1).min() for q in p]
    outside = value > 0.0
    assert outside.sum() > 50
    assert (value[outside] <= np.array(nearest)[outside] + 1e-9).all()


def test_flat_ground_is_exact():
    shape = Heightfield(np.full((4, 4), 0.5), 2.0, height=3.0)
    assert shape((0.3, 4.0, 0.2)) == pytest.approx(2.5)
    single = Heightfield(np.full((1, 1), 0.5), 2.0, height=3.0)
    assert single((0.3, 4.0, 0.2)) == pytest.approx(2.5)


def test_the_bound_follows_height_and_size_that_change():
    height = slider("Height", 1.0, low=0.1, high=5.0)
    shape = Heightfield(stepped(None), SIZE, height)
    p = dense(stepped(None), np.random.default_rng(1))
    for value in (0.2, 1.0, 4.0):
        steepness = np.linalg.norm(shape.gradient(p, params={"height": value}), axis=1)
        assert 0.99 < steepness.max() <= 1.0 + 1e-6


def test_lists_are_measured_like_arrays():
    data = [[0.0, 0.75], [0.25, 0.5]]
    p = np.random.default_rng(2).normal(size=(50, 3))
    lists, arrays = Heightfield(Texture2D(data)), Heightfield(np.array(data, np.float32))
    np.testing.assert_array_equal(lists(p), arrays(p))
    assert arrays.node.numbers["rise"].plain == (0.75, 0.25)


def test_heights_are_finite_and_files_are_there():
    ground = np.zeros((3, 4))
    ground[1, 2] = np.nan
    with pytest.raises(ValueError, match="the height in row 1, column 2 is nan") as raised:
        Heightfield(ground)
    assert "every height must be a finite number" in str(raised.value)
    with pytest.raises(ValueError, match="cannot be read"):
        Heightfield("nowhere.png")
    with pytest.raises(TypeError, match="Heightfield has no 'rise'"):
        Heightfield(np.zeros((3, 4)), rise=(1.0, 1.0))
