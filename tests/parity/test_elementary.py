"""Our elementary functions against NumPy in 64 bits: the errors that their texts promise."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.backends.numpy.interpreter import Interpreter
from distal.compiler.prelude_library import PreludeLibrary
from distal.frontend import lower_overload
from distal.ir.nodes import EntryKind, Module
from distal.ir.target import FramePlace, Target
from distal.ir.types import FLOAT
from distal.lang.prelude import careful, elementary
from distal.passes.context import Context
from distal.passes.decompose import decompose

Reals = NDArray[np.float64]
POINTS = 100001

# What the vector backend is given: no elementary function of its own.
VECTOR_CPU = Target("vector", "llvm", FramePlace.NONE)

EXACT: dict[str, Callable[..., Reals]] = {
    "sine": np.sin,
    "cosine": np.cos,
    "tangent": np.tan,
    "exponential": np.exp,
    "exponential_base_2": np.exp2,
    "logarithm": np.log,
    "logarithm_base_2": np.log2,
    "arc_sine": np.arcsin,
    "arc_cosine": np.arccos,
    "arc_tangent": np.arctan,
    "hyperbolic_sine": np.sinh,
    "hyperbolic_cosine": np.cosh,
    "hyperbolic_tangent": np.tanh,
    "power": np.power,
    "arc_tangent_2": np.arctan2,
}


def run(name: str, *args: Reals, room: ModuleType = elementary) -> Reals:
    """A prelude function of floats, as the vector backend gets it, in 32 bits."""
    functions = lower_overload(getattr(room, name), (FLOAT,) * len(args))
    module = Module(functions, functions[-1].name, EntryKind.FUNCTION)
    module = decompose.run(module, Context(VECTOR_CPU, PreludeLibrary()))
    values = [a.astype(np.float32) for a in args]
    result = Interpreter(module, {}, {}).run(module.entry, values)
    assert isinstance(result, np.ndarray)
    return result.astype(np.float64)


def spread(low: float, high: float) -> Reals:
    """Points of the interval that are 32 bit floats."""
    return np.linspace(low, high, POINTS).astype(np.float32).astype(np.float64)


@pytest.mark.parametrize(
    ("name", "low", "high", "ulps"),
    [
        ("sine", -1.57, 1.57, 2.0),
        ("cosine", -1.57, 1.57, 2.0),
        ("tangent", -1.4, 1.4, 3.0),
        ("exponential", -87.0, 88.0, 1.0),
        ("exponential_base_2", -126.0, 127.4, 1.5),
        ("logarithm", 0.5, 2.0, 1.5),
        ("logarithm", 1e-3, 1e4, 1.5),
        ("logarithm_base_2", 0.5, 2.0, 2.5),
        ("arc_sine", -1.0, 1.0, 2.5),
        ("arc_cosine", -1.0, 1.0, 1.5),
        ("arc_tangent", -100.0, 100.0, 2.5),
        ("hyperbolic_sine", -10.0, 10.0, 3.0),
        ("hyperbolic_cosine", -10.0, 10.0, 3.0),
        ("hyperbolic_tangent", -10.0, 10.0, 4.0),
    ],
)
def test_error_in_units_of_the_last_place(name: str, low: float, high: float, ulps: float) -> None:
    x = spread(low, high)
    exact = EXACT[name](x)
    unit = np.spacing(np.abs(exact).astype(np.float32)).astype(np.float64)
    assert np.max(np.abs(run(name, x) - exact) / unit) <= ulps


@pytest.mark.parametrize("name", ["sine", "cosine"])
@pytest.mark.parametrize(("reach", "error"), [(100.0, 1.5e-7), (1e4, 1e-6)])
def test_absolute_error_far_from_zero(name: str, reach: float, error: float) -> None:
    x = spread(-reach, reach)
    assert np.max(np.abs(run(name, x) - EXACT[name](x))) <= error


@pytest.mark.parametrize("name", ["sine", "cosine"])
@pytest.mark.parametrize(("reach", "error"), [(10.0, 2.5e-7), (100.0, 2.5e-7), (1e4, 1e-6)])
def test_absolute_error_of_the_careful_ones(name: str, reach: float, error: float) -> None:
    x = spread(-reach, reach)
    assert np.max(np.abs(run(name, x, room=careful) - EXACT[name](x))) <= error


def test_error_of_the_tangent_by_quotient() -> None:
    x = spread(-1.4, 1.4)
    exact = np.tan(x)
    off = np.abs(run("tangent_by_quotient", x) - exact) / (1.0 + np.abs(exact))
    assert np.max(off) <= 1e-6


def test_power() -> None:
    random = np.random.default_rng(1)
    x = random.uniform(0.001, 8.0, POINTS).astype(np.float32).astype(np.float64)
    y = random.uniform(0.0, 8.0, POINTS).astype(np.float32).astype(np.float64)
    assert np.max(np.abs(run("power", x, y) / np.power(x, y) - 1.0)) < 1e-5


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [(0, 0, 1), (-1, 0, 1), (0, 2, 0), (-1, 2, 0), (0, 1e-3, 0), (1, 5, 1), (2, 200, 2.0**126)],
)
def test_power_at_its_edges(x: float, y: float, expected: float) -> None:
    assert run("power", np.array([float(x)]), np.array([float(y)])).tolist() == [expected]


def test_arc_tangent_2_in_all_quadrants() -> None:
    random = np.random.default_rng(2)
    y, x = random.uniform(-10.0, 10.0, (2, POINTS)).astype(np.float32).astype(np.float64)
    assert np.max(np.abs(run("arc_tangent_2", y, x) - np.arctan2(y, x))) < 5e-7
    y, x = np.array([[0, 0], [0, -1], [1, 0], [-1, 0], [0, 1]], np.float64).T
    half = np.pi / 2
    expected = [0, np.pi, half, -half, 0]
    assert run("arc_tangent_2", y, x) == pytest.approx(expected, abs=1e-6)


def test_exponentials_below_the_range() -> None:
    x = np.array([-200.0, -150.0, -1e30])
    assert run("exponential", x).tolist() == [0.0, 0.0, 0.0]
    assert run("exponential_base_2", x).tolist() == [0.0, 0.0, 0.0]


def rounded(exact: Reals) -> Reals:
    return exact.astype(np.float32).astype(np.float64)


@pytest.mark.parametrize("fused", [False, True], ids=["in steps", "fused"])
def test_the_sine_stays_within_one(fused: bool) -> None:
    """Of every float of the rest, to where rounding leaves it, on processors with FMA too."""
    first, last = np.array([1.4, 2.2], np.float32).view(np.int32)
    r = np.arange(first, last, dtype=np.int32).view(np.float32).astype(np.float64)

    def joined(a: Reals, b: Reals, c: Reals) -> Reals:
        return rounded(a * b + c) if fused else rounded(rounded(a * b) + c)

    s = rounded(r * r)
    p = np.full_like(r, np.float32(elementary.SINE_9))
    for coefficient in (-0.00019809778, 0.008333069, -0.1666666):
        p = joined(s, p, np.float64(np.float32(coefficient)))
    sine = joined(rounded(r * s), p, r)
    if not fused:  # the formula is the one that runs
        few = slice(None, None, 97)
        assert np.array_equal(sine[few], run("sine_near_zero", r[few]))
    assert sine.min() > 0.8 and sine.max() <= 1.0


@pytest.mark.parametrize("name", ["sine", "cosine"])
@pytest.mark.parametrize("room", [elementary, careful], ids=["elementary", "careful"])
def test_far_sines_are_as_good_as_their_angle(name: str, room: ModuleType) -> None:
    """To 2^22, where floats are half apart: within one such step, and within -1 and 1."""
    size = np.geomspace(1e4, 2.0**22, POINTS).astype(np.float32).astype(np.float64)
    x = np.concatenate([size, -size])
    found = run(name, x, room=room)
    assert np.max(np.abs(found - EXACT[name](x)) - np.abs(x) * 2.0**-23) <= 1e-6
    assert np.max(np.abs(found)) <= 1.0
