"""The reference as a device: layouts in and out, progress, cancelling, control flow by lanes."""

from __future__ import annotations

import numpy as np
import pytest

from distal.devices.base import Cancelled
from distal.devices.reference import prepare
from distal.frontend import lower
from distal.ir.types import BOOL, FLOAT, INT, MAT2, VEC2, VEC3
from distal.lang import Frame, array, func, image, mat2, struct, vec2, vec3, vec4


@func
def collatz(start: int) -> int:
    n = start
    steps = 0
    if n < 1:
        return -1
    while n != 1:
        steps += 1
        if n % 2 == 0:
            n = n // 2
            continue
        n = 3 * n + 1
        if steps > 100:
            return 100
    return steps


def collatz_in_python(n: int) -> int:
    steps = 0
    if n < 1:
        return -1
    while n != 1:
        steps += 1
        if n % 2 == 0:
            n = n // 2
            continue
        n = 3 * n + 1
        if steps > 100:
            return 100
    return steps


def test_lanes_go_their_own_ways() -> None:
    starts = np.arange(-3, 40, dtype=np.int32)
    result = prepare(lower(collatz, (INT,))).evaluate([starts], {}, {})
    assert np.asarray(result).tolist() == [collatz_in_python(int(n)) for n in starts]


def test_a_loop_that_one_side_of_a_choice_never_ends_is_not_run_for_the_other() -> None:
    @func
    def guarded(n: int) -> int:
        return collatz(n) if n > 0 else 0

    result = prepare(lower(guarded, (INT,))).evaluate([np.array([0, 6], np.int32)], {}, {})
    assert np.asarray(result).tolist() == [0, 8]


def test_vectors_are_rows_of_points() -> None:
    @func
    def scaled(p: vec3, k: float) -> vec3:
        return p.zyx * k

    points = np.array([[1, 2, 3], [4, 5, 6]], np.float32)
    result = prepare(lower(scaled, (VEC3, FLOAT))).evaluate(
        [points, np.array([2], np.float32)], {}, {}
    )
    assert np.asarray(result).tolist() == [[6, 4, 2], [12, 10, 8]]


def test_matrices_are_rows_in_numpy_and_columns_inside() -> None:
    @func
    def column(m: mat2, v: vec2) -> vec2:
        return m @ v + m[1]

    matrix = np.array([[[1, 2], [3, 4]]], np.float32)
    vector = np.array([[5, 6]], np.float32)
    result = prepare(lower(column, (MAT2, VEC2))).evaluate([matrix, vector], {}, {})
    expected = matrix[0] @ vector[0] + matrix[0][:, 1]
    assert np.asarray(result).tolist() == [expected.tolist()]


def test_matrices_come_back_as_rows() -> None:
    @func
    def same(m: mat2) -> mat2:
        return m

    matrix = np.array([[[1, 2], [3, 4]], [[5, 6], [7, 8]]], np.float32)
    assert np.array_equal(prepare(lower(same, (MAT2,))).evaluate([matrix], {}, {}), matrix)


@struct
class Pair:
    height: float
    cells: array[int, 2]


def test_structs_and_arrays_come_back_in_parts() -> None:
    @func
    def pair(x: float) -> Pair:
        return Pair(x + 0.5, [int(x), 7])

    height, cells = prepare(lower(pair, (FLOAT,))).evaluate([np.array([1, 2], np.float32)], {}, {})
    assert np.asarray(height).tolist() == [1.5, 2.5]
    assert np.asarray(cells).tolist() == [[1, 7], [2, 7]]


def test_64_bits_are_64_bits() -> None:
    @func
    def third(x: float) -> float:
        return x / 3.0

    module = lower(third, (FLOAT,))
    wide = np.asarray(prepare(module, precision=64).evaluate([np.array([1.0])], {}, {}))
    assert wide.dtype == np.float64 and wide[0] == 1.0 / 3.0


@image
def corners(frame: Frame) -> vec4:
    return vec4(frame.coord, frame.resolution)


def test_the_first_row_is_the_top_of_the_picture() -> None:
    shown: list[float] = []
    kernel = prepare(lower(corners))
    picture = kernel.render(3, 2, {"resolution": (3.0, 2.0)}, {}, progress=shown.append)
    assert picture.shape == (2, 3, 4) and picture.dtype == np.float32
    assert picture[0, 0].tolist() == [0.5, 1.5, 3.0, 2.0]
    assert picture[1, 2].tolist() == [2.5, 0.5, 3.0, 2.0]
    assert shown[-1] == 1.0


def test_cancel_ends_an_endless_loop() -> None:
    @func
    def endless(go: bool) -> int:
        n = 0
        while go:
            n += 1
        return n

    asked = iter(range(1000))
    kernel = prepare(lower(endless, (BOOL,)))
    with pytest.raises(Cancelled):
        kernel.evaluate([np.array([True])], {}, {}, cancel=lambda: next(asked) > 10)
