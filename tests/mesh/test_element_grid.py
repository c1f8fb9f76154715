"""Distances to the nearest triangle or line, against all of them."""

import numpy as np
import pytest

from distal.mesh.element_grid import to_nearest
from distal.mesh.kernels import rows_of
from distal.mesh.outlines.arithmetic import distance_if_alike as distance_to_line
from distal.mesh.triangle_arithmetic import distance_if_alike as distance_to_triangle


def of_all(corners, places, normals):
    """The distance of each place to the nearest of all elements that face as it does."""
    ends = corners.shape[1]
    function = distance_to_triangle if ends == 3 else distance_to_line
    least = 1e-3 if normals is not None else -2.0
    given = np.zeros_like(places) if normals is None else normals
    found = []
    for place, normal in zip(places, given, strict=True):
        rows = [np.tile(vector, (len(corners), 1)) for vector in (place, normal)]
        columns = [corners[:, i] for i in range(ends)]
        found.append(rows_of(function, *rows, *columns, np.full(len(corners), least)).min())
    return np.array(found)


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("facing", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_nearest_of_many_is_the_nearest_of_all(dimensions, facing, seed):
    # Elements of a thousandth to the whole of the box; places among them, and far outside.
    random = np.random.default_rng(seed)
    reach = float(10.0 ** random.uniform(-2.0, 1.0))
    lengths = 10.0 ** random.uniform(-3.0, 0.5, (400, 1, 1))
    corners = random.uniform(-1.0, 1.0, (400, 1, dimensions))
    corners = corners + lengths * random.normal(size=(400, dimensions, dimensions))
    places = random.uniform(-1.5, 1.5, (40, dimensions))
    places[:3] *= np.array([1e3, 1e9, 1e15])[:, None]
    normals = None
    if facing:
        normals = random.normal(size=places.shape)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
    found, expected = to_nearest(corners, places, reach, normals), of_all(corners, places, normals)
    near = expected < reach
    assert near.any() and not near[:3].any()
    np.testing.assert_array_equal(found[near], expected[near])
    assert (found[~near] >= reach).all()


def test_nearest_of_nothing():
    corners = np.zeros((0, 3, 3))
    assert np.isinf(to_nearest(corners, np.zeros((2, 3)), 1.0)).all()
    assert len(to_nearest(np.zeros((1, 3, 3)), np.zeros((0, 3)), 1.0)) == 0
