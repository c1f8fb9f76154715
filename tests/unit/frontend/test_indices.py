"""An index is clamped however its value comes about: by the input, a local, a call or a loop."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import Buffer, func, mat3, vec3

TABLE = Buffer([10.0, 20.0, 30.0])
SIZES = [10.0, 20.0, 30.0]
BELOW, ABOVE = -1, 3


@func
def below() -> int:
    return BELOW


@func
def given(x: float, i: int) -> float:
    values = [x, x * 2.0, x * 3.0]
    return values[i] + vec3(x, x * 2.0, x * 3.0)[i] + SIZES[i] + TABLE[i]


@func
def by_local(x: float) -> float:
    i = BELOW
    values = [x, x * 2.0, x * 3.0]
    return values[i] + vec3(x, x * 2.0, x * 3.0)[i] + SIZES[i] + TABLE[i]


@func
def by_call(x: float) -> float:
    return given(x, below())


@func
def by_argument(x: float) -> float:
    return given(x, -1)


@func
def by_loop(x: float) -> float:
    total = 0.0
    for i in range(-1, 0):
        total += given(x, i)
    return total


@func
def by_closure(x: float) -> float:
    i = -1

    def picked(values: vec3) -> float:
        return values[i]

    return picked(vec3(x, x * 2.0, x * 3.0)) + SIZES[i] + TABLE[i] + x


@func
def columns(x: float) -> float:
    i = -1
    m = mat3(vec3(x, 0.0, 0.0), vec3(0.0, 5.0, 0.0), vec3(0.0, 0.0, 7.0))
    return m[i][i] + x + SIZES[i] + TABLE[i]


@func
def assigned(x: float) -> float:
    i = -1
    values = [0.0, 0.0, 0.0]
    v = vec3(0.0)
    values[i] = x
    v[i] = x
    return values[0] + v.x + SIZES[i] + TABLE[i]


@pytest.mark.parametrize(
    "function", [by_local, by_call, by_argument, by_loop, by_closure, columns, assigned]
)
def test_an_index_below_zero_is_the_first(function: object) -> None:
    x = np.array([1.5, -2.0], dtype=np.float32)
    assert np.array_equal(function(x), 2 * x + 20.0)  # type: ignore[operator]
    for index in (-1, -3, -(2**31)):
        assert np.array_equal(given(x, index), 2 * x + 20.0)
    assert np.array_equal(given(x, ABOVE), 6 * x + 60.0)
