"""What numbers do at the ends of their range, on every level this processor runs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import host_levels
from distal.frontend import lower
from distal.ir import build
from distal.ir.nodes import EntryKind, Function, Module, Param, Read, Return
from distal.ir.types import FLOAT
from distal.lang import abs, func, inversesqrt, length, slider, sqrt, uint, vec3

LEVELS = [level.name for level in host_levels()]
INF = np.float32(np.inf)
TINY = np.float32(1e-42)  # below the normal numbers
EDGES = np.array(
    [0.0, -0.0, 1.0, -1.0, 2.0, 3.0, 49.0, 1e-30, 1e30, 3e38, INF, -INF, np.nan, 0.1, TINY],
    np.float32,
)


@func
def root(x: float) -> float:
    return sqrt(x)


@func
def inverse_root(x: float) -> float:
    return inversesqrt(x)


@func
def size(v: vec3) -> float:
    return length(v)


@func
def third(x: float) -> float:
    return x / 3.0


@func
def over(x: float, y: float) -> float:
    return x / y


@func
def divided(a: int, b: int) -> tuple[int, int]:
    return a // b, a % b


@func
def divided_unsigned(a: uint, b: uint) -> tuple[uint, uint]:
    return a // b, a % b


@func
def by_constants(a: int) -> tuple[int, int, int, int]:
    return a // 8, a % 8, a // -7, a % -7


@func
def whole(x: float) -> tuple[int, uint]:
    return int(x), uint(x)


@func
def magnitude(a: int) -> int:
    return abs(a)


def run(function: Any, level: str, *args: Any, uniforms: Any = None) -> Any:
    kernel = cpu.prepare(lower(function), features=level, cache=Cache(None))
    return kernel.evaluate(args, uniforms or {}, {})


@pytest.mark.parametrize("level", LEVELS)
def test_roots_at_the_ends(level: str) -> None:
    with np.errstate(all="ignore"):
        result, exact = run(root, level, EDGES), np.sqrt(np.maximum(EDGES, 0.0))
        small = EDGES == TINY
        np.testing.assert_allclose(result[~small], exact[~small], rtol=2e-7)
        # What is left to put right there has few digits itself.
        np.testing.assert_allclose(result[small], exact[small], rtol=3e-5)
        inverse = run(inverse_root, level, EDGES)
        held = np.maximum(EDGES, np.finfo(np.float32).smallest_normal)
        np.testing.assert_allclose(inverse, 1 / np.sqrt(held), rtol=3e-7)


@pytest.mark.parametrize("level", LEVELS)
def test_roots_within_one_unit_in_the_last_place_and_whole_ones_exact(level: str) -> None:
    x = np.exp(np.random.default_rng(3).uniform(-80, 80, 100_000)).astype(np.float32)
    exact = np.sqrt(x.astype(np.float64))
    assert np.max(np.abs(run(root, level, x) - exact) / np.spacing(exact.astype(np.float32))) <= 1.0
    squares = np.arange(4096, dtype=np.float32) ** 2
    np.testing.assert_array_equal(run(root, level, squares), np.arange(4096))


@pytest.mark.parametrize("level", LEVELS)
def test_lengths_of_nothing_and_of_infinity(level: str) -> None:
    v = np.float32([[0, 0, 0], [3, 4, 12], [INF, 0, 0], [np.nan, 1, 1], [2e19, 2e19, 0]])
    result = run(size, level, v)
    np.testing.assert_array_equal(result, np.float32([0, 13, INF, np.nan, INF]))


@pytest.mark.parametrize("level", LEVELS)
def test_quotients_are_correctly_rounded(level: str) -> None:
    with np.errstate(all="ignore"):
        np.testing.assert_array_equal(run(third, level, EDGES), EDGES / np.float32(3))
        x, y = (grid.ravel() for grid in np.meshgrid(EDGES, EDGES))
        np.testing.assert_array_equal(run(over, level, x, y), x / y)
    x = np.random.default_rng(4).normal(size=100_000).astype(np.float32) * np.float32(1e3)
    np.testing.assert_array_equal(run(third, level, x), x / np.float32(3))


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("divisor", [3.0, -0.3, 0.0, 1e-30, 1e30, 3e38, np.inf, np.nan, 49.0])
def test_quotients_by_a_number_that_all_lanes_share(level: str, divisor: float) -> None:
    amount = slider("Amount", 1.0)

    @func
    def shared(x: float) -> float:
        return x / amount

    x = np.concatenate([EDGES, np.random.default_rng(5).normal(size=9000).astype(np.float32)])
    x = x[x != TINY]  # quotients below the normal numbers keep fewer digits
    result = run(shared, level, x, uniforms={"amount": divisor})
    with np.errstate(all="ignore"):
        expected = x / np.float32(divisor)
    normal = ~(np.abs(expected) < 1.2e-38) | (expected == 0)
    np.testing.assert_allclose(result[normal], expected[normal], rtol=2e-7 if divisor > 1e37 else 0)


@pytest.mark.parametrize("level", LEVELS)
def test_whole_numbers_divide_as_python_does(level: str) -> None:
    ends = np.array([0, 1, -1, 2, 7, -7, 3, 1000003, 2**31 - 1, -(2**31)], np.int32)
    a, b = (grid.ravel() for grid in np.meshgrid(ends, ends))
    quotient, rest = run(divided, level, a, b)
    for x, y, q, r in zip(a.tolist(), b.tolist(), quotient.tolist(), rest.tolist(), strict=True):
        expected = (x, 0) if y == 0 else (x // y, x % y)
        wrapped = (expected[0] + 2**31) % 2**32 - 2**31
        assert (q, r) == (wrapped, expected[1]), (x, y)
    c, d = a.view(np.uint32), b.view(np.uint32)
    quotient, rest = run(divided_unsigned, level, c, d)
    for x, y, q, r in zip(c.tolist(), d.tolist(), quotient.tolist(), rest.tolist(), strict=True):
        assert (q, r) == ((x, 0) if y == 0 else (x // y, x % y)), (x, y)
    results = run(by_constants, level, ends)
    for got, want in zip(results, (ends // 8, ends % 8, ends // -7, ends % -7), strict=True):
        np.testing.assert_array_equal(got, want)
    np.testing.assert_array_equal(run(magnitude, level, ends), np.abs(ends))


@pytest.mark.parametrize("level", LEVELS)
def test_floats_become_whole_numbers_within_their_range(level: str) -> None:
    x = np.float32([0.9, -0.9, 3e9, -3e9, 5e9, np.nan, INF, -INF, 2147483520.0])
    signed, unsigned = run(whole, level, x)
    assert signed.tolist() == [
        *(0, 0, 2**31 - 1, -(2**31), 2**31 - 1, 0, 2**31 - 1, -(2**31), 2147483520)
    ]
    assert unsigned.tolist() == [*(0, 0, 3000000000, 0, 2**32 - 1, 0, 2**32 - 1, 0, 2147483520)]


def test_minimum_of_nan_is_the_first_operand_and_of_a_nan_first_also() -> None:
    """``b if b < a else a``, as GLSL and x86 have it."""
    a, b = Read("a", FLOAT), Read("b", FLOAT)
    body = (Return(build.builtin("min", a, b)),)
    function = Function("least", (Param("a", FLOAT), Param("b", FLOAT)), FLOAT, body, "least")
    module = Module((function,), "least", EntryKind.FUNCTION)
    for level in LEVELS:
        kernel = cpu.prepare(module, features=level, cache=Cache(None))
        first = np.float32([np.nan, 1.0, 2.0, 5.0])
        second = np.float32([1.0, np.nan, 3.0, 4.0])
        result = kernel.evaluate((first, second), {}, {})
        np.testing.assert_array_equal(result, np.float32([np.nan, 1.0, 2.0, 4.0]))
