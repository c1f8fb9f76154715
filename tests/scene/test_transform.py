"""Placing a shape by a matrix."""

import numpy as np
import pytest

from distal import Box, Shape, Sphere
from distal.lang import slider
from distal.scene.tree.errors import SceneTypeError, SceneValueError

# No mirror image of it is itself.
SHAPE = Box((1.0, 0.6, 0.4)) | Sphere(0.3).translate(0.6, 0.2, 0.1) | Sphere(0.2).translate(y=0.5)
PLACES = np.random.default_rng(3).uniform(-3.0, 3.0, (800, 3))
OFFSET = np.array((0.5, -0.25, 1.0))


def turn(seed):
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def placed(linear, rows=3):
    matrix = np.concatenate([linear, OFFSET[:, None]], axis=1)
    return matrix if rows == 3 else np.concatenate([matrix, [[0.0, 0.0, 0.0, 1.0]]])


MIRROR = np.diag((1.0, 1.0, -1.0))
EXACT = [
    (np.eye(3), 1.0),
    (MIRROR, 1.0),
    (-2.0 * np.eye(3), 2.0),
    (np.eye(3)[[1, 2, 0]], 1.0),
    *((turn(i) @ MIRROR if i % 2 else turn(i), 1.0) for i in range(4)),
    (0.4 * turn(7), 0.4),
    (3.0 * turn(8) @ MIRROR, 3.0),
]


@pytest.mark.parametrize(("linear", "factor"), EXACT)
def test_what_keeps_angles_is_exact(linear, factor):
    for rows in (3, 4):
        shape = SHAPE.transform(placed(linear, rows))
        found = shape(PLACES @ linear.T + OFFSET)
        assert found == pytest.approx(factor * SHAPE(PLACES), abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_any_other_matrix_gives_lower_bounds(seed):
    random = np.random.default_rng(seed)
    linear = random.normal(size=(3, 3))
    factors = np.linalg.svd(linear)[1]
    shape = SHAPE.transform(placed(linear).tolist())
    p = PLACES @ linear.T + OFFSET
    found, before = shape(p), SHAPE(PLACES)
    assert ((found < 0.0) == (before < 0.0)).all()
    # As the smallest factor shrinks it, or more where the box says more; never above the largest.
    assert (np.abs(found) >= factors[-1] * np.abs(before) - 1e-9)[before > 0.0].all()
    assert (found <= factors[0] * before + 1e-9)[before > 0.0].all()
    step = random.normal(size=p.shape) * 0.05
    assert (np.abs(shape(p + step) - found) <= np.linalg.norm(step, axis=1) + 1e-9).all()
    low, high = shape.bounds()
    inside = p[found < 0.0]
    assert ((inside >= low) & (inside <= high)).all()


def test_nearly_equal_factors():
    linear = turn(5) @ np.diag((1.0, 1.0 + 1e-3, 1.0))
    shape = SHAPE.transform(placed(linear))
    near = np.abs(SHAPE(PLACES)) < 1.0
    assert shape(PLACES @ linear.T + OFFSET)[near] == pytest.approx(SHAPE(PLACES)[near], abs=2e-3)


SINGULAR = np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 0.0]])
WRONG = [
    (np.eye(3), "the matrix of transform is three or four rows of four numbers"),
    (3.0, "the matrix of transform is three or four rows of four numbers"),
    ("abcd", "the matrix of transform is three or four rows of four numbers"),
    (placed(SINGULAR), "the matrix of transform flattens the shape"),
    (placed(np.zeros((3, 3))), "the matrix of transform flattens the shape"),
    (placed(np.diag((1.0, 1.0, np.nan))), "a number of the matrix of transform is not finite"),
    (placed(np.diag((1.0, 1.0, np.inf))), "a number of the matrix of transform is not finite"),
    (placed(np.eye(3), 4).T, r"the last row of the matrix .* not \(0.5, -0.25, 1, 1\)"),
    (2.0 * placed(np.eye(3), 4), r"the last row of the matrix .* not \(0, 0, 0, 2\)"),
]


@pytest.mark.parametrize(("matrix", "message"), WRONG)
def test_other_matrices_are_refused(matrix, message):
    with pytest.raises(SceneValueError, match=message) as caught:
        SHAPE.transform(matrix)
    assert "test_transform.py" in str(caught.value)


@pytest.mark.parametrize("value", [slider("A", 1.0), "1", True, None])
def test_its_numbers_are_plain(value):
    matrix = placed(np.eye(3)).tolist()
    matrix[0][0] = value
    with pytest.raises(SceneTypeError, match="takes plain numbers"):
        SHAPE.transform(matrix)


def test_a_mirror_image_is_no_rotation():
    with pytest.raises(SceneValueError, match="transform takes the other kind"):
        SHAPE.rotate(matrix=MIRROR)
    assert isinstance(SHAPE.transform(placed(MIRROR)), Shape)
