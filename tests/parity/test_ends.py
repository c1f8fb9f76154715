"""Every function of numbers at the ends of its range, and its slope, against mathematics.

Arguments are values that are read, never literals. The oracle is Python's ``math`` in 64 bits, of
the argument as the language holds it; slopes are closed forms. Tolerances: a relative error of
2e-6 or the row's own tolerance, for exponentials and powers times the size of the exponent. GPUs
flush subnormal numbers to 0, so what 0 gives is right too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from distal.ir import limits
from distal.ir.build import builtin, components, compose
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Expr, Function, FunctionRef, Gradient, Param, Read, Return
from distal.ir.types import FLOAT, FunctionType, Kind, vector_of
from distal.lang import func, gradient, vec2
from distal.lang import pow as power
from tests.parity import test_edges
from tests.parity.programs import Case, program
from tests.parity.sampling import SAMPLES
from tests.parity.test_edges import Edges, results

BIG = limits.ORDINARY
ULP = 2.0**-23
_SIZES = (
    0.0,
    1e-40,
    2.0**-126,
    1e-30,
    1e-20,
    1e-12,
    1e-5,
    0.3,
    0.5,
    1.0 - ULP / 2.0,
    1.0,
    1.0 + ULP,
    1.5,
    2.0,
    3.0,
    7.5,
    10.0,
    19.0,
    60.0,
    86.0,
    99.0,
    126.0,
    200.0,
    9999.0,
    1e10,
    1e15,
    BIG,
)
ONE = tuple(float(np.float32(s * x)) for x in _SIZES for s in (1.0, -1.0))


def _held(x: float, low: float, high: float) -> float:
    return min(max(x, low), high)


def _exponential(x: float) -> float:
    return math.exp(_held(x, -800.0, 87.0))


def _normal(x: float) -> float:
    return max(x, limits.SMALLEST)


def _angle(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: function(x) if abs(x) <= 200.0 else math.nan


def _inside(x: float, slope: float) -> float:
    return slope if x > limits.SMALLEST else 0.0


def _hyperbolic(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: function(_held(x, -87.0, 87.0))


def _arc(x: float) -> float:
    return 1.0 / math.sqrt((1.0 - x) * (1.0 + x)) if abs(x) < 1.0 else 0.0


Pair = tuple[Callable[[float], float], Callable[[float], float]]
# The value and the slope; NaN where nothing is promised.
OF_ONE: dict[str, Pair] = {
    "abs": (abs, lambda x: float((x > 0) - (x < 0))),
    "sign": (lambda x: float((x > 0) - (x < 0)), lambda x: 0.0),
    "floor": (math.floor, lambda x: 0.0),
    "ceil": (math.ceil, lambda x: 0.0),
    "round": (round, lambda x: 0.0),
    "trunc": (math.trunc, lambda x: 0.0),
    "fract": (lambda x: min(x - math.floor(x), limits.BELOW_ONE), lambda x: 1.0),
    "sqrt": (lambda x: math.sqrt(max(x, 0.0)), lambda x: 0.5 / math.sqrt(x) if x > 0.0 else 0.0),
    "inversesqrt": (lambda x: 1.0 / math.sqrt(_normal(x)),
                    lambda x: _inside(x, max(-0.5 * _normal(x)**-1.5, -limits.LARGEST_POWER))),
    "exp": (_exponential, _exponential),
    "exp2": (lambda x: 2.0 ** _held(x, -800.0, 126.0),
             lambda x: 2.0 ** _held(x, -800.0, 126.0) * math.log(2.0)),
    "log": (lambda x: math.log(_normal(x)), lambda x: _inside(x, 1.0 / _normal(x))),
    "log2": (lambda x: math.log2(_normal(x)),
             lambda x: _inside(x, 1.0 / math.log(2.0) / _normal(x))),
    "sin": (_angle(math.sin), _angle(math.cos)),
    "cos": (_angle(math.cos), _angle(lambda x: -math.sin(x))),
    "tan": (_angle(math.tan), _angle(lambda x: 1.0 + math.tan(x) ** 2)),
    "asin": (lambda x: math.asin(_held(x, -1.0, 1.0)), _arc),
    "acos": (lambda x: math.acos(_held(x, -1.0, 1.0)), lambda x: -_arc(x)),
    "atan": (math.atan, lambda x: 1.0 / (1.0 + x * x)),
    "sinh": (_hyperbolic(math.sinh), _hyperbolic(math.cosh)),
    "cosh": (_hyperbolic(math.cosh), _hyperbolic(math.sinh)),
    "tanh": (math.tanh, lambda x: _hyperbolic(math.cosh)(x) ** -2),
    "radians": (math.radians, lambda x: math.radians(1.0)),
    "degrees": (math.degrees, lambda x: math.degrees(1.0)),
}  # fmt: skip


def _power(x: float, y: float) -> float:
    if x < limits.SMALLEST:
        return 1.0 if y == 0.0 else limits.LARGEST_POWER if y < 0.0 else 0.0
    exponent = y * math.log2(x)
    return limits.LARGEST_POWER if exponent >= 126.0 else x**y if exponent > -1000.0 else 0.0


def _power_along_x(x: float, y: float) -> float:
    if not x > limits.SMALLEST:
        return 0.0
    most = limits.LARGEST_POWER
    return _held(y * _power(x, y - 1.0), -most, most)


def _power_along_y(x: float, y: float) -> float:
    if not x > limits.SMALLEST:
        return 0.0
    most = limits.LARGEST_POWER
    return _held(_power(x, y) * math.log(x), -most, most)


def _remainder(a: float, b: float) -> float:
    return a % b


def _around(y: float, x: float) -> float:
    square = x * x + y * y
    return 1.0 / square if square > limits.SMALLEST else 0.0


Triple = tuple[Callable[[float, float], float], ...]
OF_TWO: dict[str, Triple] = {
    "pow": (_power, _power_along_x, _power_along_y),
    "atan2": (lambda y, x: math.atan2(y + 0.0, x + 0.0),
              lambda y, x: x * _around(y, x), lambda y, x: -y * _around(y, x)),
    "mod": (_remainder, lambda a, b: 1.0, lambda a, b: math.nan),
    "min": (min, lambda a, b: float(a <= b), lambda a, b: float(b < a)),
    "max": (max, lambda a, b: float(a >= b), lambda a, b: float(b > a)),
    "step": (lambda e, x: float(x >= e), lambda e, x: 0.0, lambda e, x: 0.0),
}  # fmt: skip
_BASES = (0.0, -2.0, 1e-30, 1e-6, 0.01, 0.5, 1.0 - ULP, 1.0, 1.0 + ULP, 2.5, 3.0, 100.0, 1e6, 1e18)
_EXPONENTS = (-3.5, -1.0, -0.01, 0.0, 1.0 / 70.0, 0.5, 1.0, 2.0, 7.3, 40.0, 70.0, 96.0)
_PLACES = (0.0, 1e-25, 1e-15, -1e-15, 0.7, -0.7, 2.1, 1.0, -1.0, 1e6, 1e15)
PAIRS = {
    "pow": [(x, y) for x in _BASES for y in _EXPONENTS],
    "mod": [(k * b + d, b) for b in (0.7, -0.7, 3.0, 1e-6, 1e10)
            for k in (-3.0, 0.0, 1.0, 3.0, 77.0) for d in (0.0, 0.25 * b, -1e-12 * b)],
}  # fmt: skip


def _pairs(name: str) -> list[tuple[float, ...]]:
    found = PAIRS.get(name) or [(a, b) for a in _PLACES for b in _PLACES]
    return [tuple(float(np.float32(x)) for x in pair) for pair in found]


def _rows() -> Iterator[tuple[str, list[tuple[float, ...]], tuple[Callable[..., float], ...]]]:
    """Each row of numbers, what it is asked, and its value and slopes."""
    for name, pair in OF_ONE.items():
        yield name, [(x,) for x in ONE], pair
    for name, triple in OF_TWO.items():
        yield name, _pairs(name), triple


@cache
def ends(_: int) -> Edges:
    """Values and gradients of each row as one picture, in parts of as many samples as it has."""
    cases, functions = [], []
    for name, asked, _ in _rows():
        count = len(asked[0])
        point = vector_of(Kind.FLOAT, count)
        read = Read("p", point)
        value = builtin(name, *components(read))
        functions.append(
            Function(f"{name}_ends", (Param("p", point),), FLOAT, (Return(value),), name)
        )
        of = FunctionRef(f"{name}_ends", (), FunctionType((point,), FLOAT))

        def slope(a, of: Expr = of, point=point) -> Expr:
            place = a[0] if len(a) == 1 else compose(point, *a)
            return Gradient(of, place, False, point)

        for first in range(0, len(asked), SAMPLES):
            part = asked[first : first + SAMPLES]
            whole = np.array((part * SAMPLES)[:SAMPLES], np.float32)
            bits = [np.ascontiguousarray(column).view(np.uint32) for column in whole.T]
            case = Case(name, (FLOAT,) * count, lambda a, n=name: builtin(n, *a), bits)
            cases += [case, replace(case, expression=slope)]
    packed = program(cases)
    module = replace(packed.module, functions=(*functions, *packed.module.functions))
    return Edges(tuple(cases), (), replace(packed, module=module))


def _flushed(x: float) -> float:
    return 0.0 if abs(x) < limits.SMALLEST else x


def _wrong(name: str, oracle, args: tuple[float, ...], got: float, relative: float) -> float | None:
    """What a number should be, or None if it is."""
    row = INTRINSICS[name]
    if oracle is _remainder:
        a, b = args
        off = abs(got - a % b)
        near = min(off, abs(b) - off) <= ULP * (abs(a) + abs(b))  # 0 and b are one place
        end = float(np.nextafter(np.float32(b), np.float32(0.0)))
        return None if near and min(end, 0.0) <= got <= max(end, 0.0) else a % b
    wanted = {oracle(*args), oracle(*map(_flushed, args))}
    for value in wanted:
        size = 1.0
        if name == "pow" and args[0] > 0.0:
            size += abs(args[1] * math.log2(args[0]))  # the exponent is rounded
        if name in ("sin", "cos", "tan"):
            size += abs(args[0])
        if name in ("exp", "sinh", "cosh"):
            size += min(abs(args[0]), 87.0)  # a driver takes the power of 2 with a rounded exponent
        atol = 1e-6 if name == "cosh" else row.atol  # its slope is sinh
        allowed = relative * size * abs(value) + atol * (1.0 if abs(value) < 1e3 else 0.0)
        if math.isnan(value) or abs(_flushed(value) - got) <= allowed + 2.0 * limits.SMALLEST:
            return None
    return wanted.pop()


OWN = ("reference", "llvm")
TARGETS = (*OWN, "glsl-330", "glsl-es300", "wgsl-compute")


@pytest.mark.parametrize("target", TARGETS)
def test_values_and_slopes(target: str) -> None:
    found = {}
    for case, numbers in zip(ends(32).cases, results(target, ends), strict=True):
        found.setdefault(case.name, []).append(numbers)
    messages = []
    for name, asked, oracles in _rows():
        # The halves of a row's cases are values, the others gradients.
        values = np.concatenate(found[name][0::2], axis=1)
        slopes = np.concatenate(found[name][1::2], axis=1)
        for i, args in enumerate(asked):
            for oracle, got in zip(oracles, (*values[:, i], *slopes[:, i]), strict=True):
                relative = max(INTRINSICS[name].rtol, 2e-6)
                wanted = _wrong(name, oracle, args, float(got), relative)
                if wanted is not None:
                    messages.append(f"{name}{args}: {got}, not {wanted}")
    assert not messages, f"{len(messages)}:\n" + "\n".join(messages[:60])


def test_every_row_of_numbers_is_asked() -> None:
    rows = {
        row.name
        for row in INTRINSICS.values()
        if not row.hidden
        and row.derivative is not None
        and len(row.args) < 3
        and any(p == (FLOAT,) * len(p) for s in row.signatures for p, _ in s.instances())
    }
    assert rows - {*OF_ONE, *OF_TWO} <= test_edges.BITS, rows - {*OF_ONE, *OF_TWO}


@func
def root_of_power(x: float, y: float) -> float:
    return power(power(x, y), 1.0 / y)


@func
def slope_of_root(x: float, y: float) -> float:
    return gradient(lambda q: root_of_power(q, y), x)


@func
def norm(p: vec2, y: float) -> float:
    return power(power(p.x, y) + power(p.y, y), 1.0 / y)


@func
def slope_of_norm(p: vec2, y: float) -> vec2:
    return gradient(lambda q: norm(q, y), p)


@func
def slope_of_power(x: float, y: float) -> float:
    return gradient(lambda q: power(q, y), x)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_a_root_of_a_power_has_slope_one(kind: type) -> None:
    x = np.array([0.3, 1.0, 3.0, 3.0, 100.0, 1e3, 100.0], kind)
    y = np.array([70.0, 96.0, 70.0, 40.0, 10.0, 12.0, 18.0], kind)
    assert slope_of_root(x, y) == pytest.approx(
        np.ones(7), rel=2e-4 if kind is np.float32 else 1e-12
    )
    found = slope_of_norm(np.array([[100.0, 100.0]], kind), kind(10.0))
    assert found == pytest.approx(np.full((1, 2), 2.0**-0.9), rel=1e-4)


def test_slopes_of_powers_in_64_bits() -> None:
    x = np.array([3.0, 1e-60, 1e-60, 1e30, 1.0 + 2.0**-52])
    y = np.array([400.0, 0.5, -3.0, 8.5, 1e6])
    exact = [float(b) * float(a) ** (float(b) - 1.0) for a, b in zip(x, y, strict=True)]
    assert slope_of_power(x, y) == pytest.approx(exact, rel=1e-11)
