"""Small programs that random fields found to be wrong once."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import abs, atan2, exp, floor, func, mat2, sin, value_and_gradient, vec2
from tests.gradients.differences import differences
from tests.gradients.running import on_reference


@func
def scaled_matrix(p: vec2) -> float:
    m = (p.x + exp(sin(p.y + exp(sin(p.x + exp(sin(p.y + exp(sin(p.x * p.y))))))))) * mat2(
        p.x, p.y, p.y, 2.0
    )
    return (m @ p).x


@func
def divided_matrix(p: vec2) -> float:
    m = mat2(p.x, p.y, p.y, 2.0) / (2.0 + sin(exp(sin(exp(sin(p.x * p.y))))))
    return (m @ p).x


@pytest.mark.parametrize("field", [scaled_matrix, divided_matrix], ids=lambda f: f.name)
def test_the_number_that_scales_a_matrix_may_be_a_long_expression(field) -> None:
    @func
    def both(p: vec2) -> tuple[float, vec2]:
        return value_and_gradient(field, p)

    points = np.random.default_rng(1).uniform(-1.5, 1.5, (40, 2))
    measured = differences(lambda p: on_reference(field, p), points)
    assert measured.smooth.all()
    for _, gradient in (on_reference(both, points), both(points)):
        assert measured.disagreement(gradient).max() < 1.0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_sign_of_a_zero_turns_no_angle(dtype) -> None:
    @func
    def angle(y: float) -> float:
        return atan2(floor(abs(y)) * y, -0.3 - y * y)

    assert angle(np.array([-0.5, 0.5], dtype)).tolist() == [dtype(np.pi)] * 2
