"""Nested placements agree with moving the points by matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import Box, Ellipsoid, HalfSpace, InfiniteCylinder, Plane, Shape
from tests.fields.rows import Doubles

SIZE = (0.4, 0.7, 1.1)


def _axis_angle(axis: Doubles, angle: float) -> Doubles:
    """Rodrigues' formula."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def _quaternion(axis: Doubles, angle: float) -> tuple[float, ...]:
    return (*(np.sin(0.5 * angle) * axis).tolist(), float(np.cos(0.5 * angle)))


def _step(shape: Shape, rng: np.random.Generator) -> tuple[Shape, Doubles]:
    """The shape placed once more, and the matrix (4, 4) that this moves its points by."""
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    angle, offset = float(rng.uniform(-3.0, 3.0)), rng.uniform(-1.0, 1.0, 3)
    turn, matrix = np.eye(3), np.eye(4)
    match int(rng.integers(7)):
        case 0:
            shape, matrix[:3, 3] = shape.translate(*offset.tolist()), offset
        case 1:
            shape, turn = shape.rotate(angle, axis=tuple(axis)), _axis_angle(axis, angle)
        case 2:
            name = "xyz"[rng.integers(3)]
            shape = shape.rotate(**{name: angle})
            turn = _axis_angle(np.eye(3)["xyz".index(name)], angle)
        case 3:
            angles = rng.uniform(-3.0, 3.0, 3)
            shape = shape.rotate(**dict(zip("xyz", angles.tolist(), strict=True)))
            about = [_axis_angle(np.eye(3)[i], angles[i]) for i in range(3)]
            turn = about[2] @ about[1] @ about[0]
        case 4:
            turn = _axis_angle(axis, angle)
            shape = shape.rotate(quaternion=_quaternion(axis, angle))
        case 5:
            turn = _axis_angle(axis, angle)
            shape = shape.rotate(matrix=turn.tolist())
        case _:
            factor = float(rng.uniform(0.5, 2.0))
            shape, turn = shape.scale(factor), factor * np.eye(3)
    matrix[:3, :3] = turn
    return shape, matrix


def _nested(shape: Any, steps: int, seed: int) -> tuple[Any, Doubles]:
    rng, whole = np.random.default_rng(seed), np.eye(4)
    for _ in range(steps):
        shape, matrix = _step(shape, rng)
        whole = matrix @ whole
    return shape, whole


@pytest.mark.parametrize("seed", range(24))
def test_nested_placements_are_matrices(seed: int):
    base = Box(SIZE).translate(0.2, -0.1, 0.3) - Ellipsoid((0.3, 0.5, 0.2))
    shape, matrix = _nested(base, 2 + seed % 4, seed)
    local = np.random.default_rng(seed).uniform(-1.5, 1.5, (300, 3))
    world = local @ matrix[:3, :3].T + matrix[:3, 3]
    factor = np.cbrt(np.linalg.det(matrix[:3, :3]))
    np.testing.assert_allclose(shape(world), factor * base(local), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_the_box_follows(seed: int):
    shape, matrix = _nested(Box(SIZE), 4, seed)
    corners = np.stack(np.meshgrid(*[(-0.5 * s, 0.5 * s) for s in SIZE]), -1).reshape(-1, 3)
    moved = corners @ matrix[:3, :3].T + matrix[:3, 3]
    low, high = map(np.array, shape.bounds())
    assert (low <= moved.min(axis=0) + 1e-5).all()
    assert (high >= moved.max(axis=0) - 1e-5).all()
    assert shape.exact
    assert shape.slope == pytest.approx(1.0)


def test_a_turn_takes_one_direction_to_another():
    rng = np.random.default_rng(8)
    for _ in range(8):
        a, b = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        ball = Box(0.2, 0.2, 0.2).translate(*(2.0 * a).tolist()).orient(tuple(a), tuple(b))
        assert ball(2.0 * b[None])[0] == pytest.approx(-0.1, abs=1e-12)


def test_rotate_then_translate_is_not_translate_then_rotate():
    shape = Box(SIZE)
    quarter = 0.5 * np.pi
    first = shape.rotate(z=quarter).translate(x=1.0)
    second = shape.translate(x=1.0).rotate(z=quarter)
    assert first(np.array([[1.0, 0.0, 0.0]]))[0] == pytest.approx(-0.2)
    assert second(np.array([[0.0, 1.0, 0.0]]))[0] == pytest.approx(-0.2)


def test_a_box_without_an_end_keeps_its_other_sides_after_a_quarter_turn():
    """The rounding of a cosine times an infinite side is no extent."""
    inf, rod = np.inf, InfiniteCylinder(0.25)
    assert rod.bounds() == ((-0.25, -inf, -0.25), (0.25, inf, 0.25))
    for lying in (rod.rotate(z=np.pi / 2.0), rod.orient((1.0, 0.0, 0.0))):
        assert np.allclose(lying.bounds(), ((-inf, -0.25, -0.25), (inf, 0.25, 0.25)))
    assert np.allclose(rod.rotate(z=0.3).bounds()[1], (inf, inf, 0.25))
    cut = HalfSpace((0.0, -1.0, 0.0), -0.5) & Box(2.0) & Plane(0.7)
    assert np.allclose(cut.bounds(), ((-1.0, 0.5, -1.0), (1.0, 0.7, 1.0)))
    assert HalfSpace((0.6, 0.8, 0.0), 0.5).bounds() == ((-inf,) * 3, (inf,) * 3)
