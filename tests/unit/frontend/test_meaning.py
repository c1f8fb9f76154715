"""Scene code means what Python means: each function here runs both ways."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import pytest

from distal.lang import func, struct
from tests.unit.frontend.evaluation import value


@func
def early_return(x: float) -> float:
    if x > 2.0:
        return x * 10.0
    elif x > 1.0:
        return x * 20.0
    return x


@func
def nested_loops(x: float) -> float:
    total = 0.0
    for i in range(5):
        for j in range(i, 10, 3):
            if j == 6:
                continue
            if i == 4:
                break
            total += x * float(i) - float(j)
    return total


@func
def counting_down(x: float) -> float:
    total = 0.0
    for i in range(10, -4, -3):
        total = total * 2.0 + float(i) * x
    return total


SIZES = [0.5, 1.5, 2.5]


@struct
class Line:
    start: float
    slope: float = 2.0

    @func
    def at(self, x: float) -> float:
        return self.start + self.slope * x

    @func
    def moved(self, by: float, *more: float) -> Line:
        moved = Line(self.start + by, self.slope)
        for step in more:
            moved = Line(moved.start + step, moved.slope)
        return moved

    @staticmethod
    @func
    def level(height: float) -> Line:
        return Line(height, slope=0.0)


@func
def methods(x: float) -> float:
    line = Line(x).moved(1.0, 2.0, *SIZES)
    return line.at(2.0) - Line.level(x).at(7.0) * Line.at(line, 0.5)


@func
def enumerated(x: float) -> float:
    for i, size in enumerate(SIZES):
        x = x * float(i + 1) + size
    for i, size in enumerate(SIZES, start=int(x)):
        x += size * float(i)
    return x


@func
def zipped(x: float) -> float:
    for a, b, c in zip(SIZES, (x, 3.0), range(9, 0, -2), strict=False):
        x = x * 0.5 + a * b - float(c)
    for i, (a, b) in enumerate(zip(SIZES, SIZES, strict=True)):
        for c in (x, 2.0):
            if i == 1:
                break
            x += a * b * c
    return x


@func
def weighted(first: float, *rest: float, factor: float = 1.0) -> float:
    for i, more in enumerate(rest):
        first += more * float(i + 1) * factor
    return first / float(len(rest))


@func
def starred(x: float) -> float:
    pair = (x, 2.0)
    return weighted(*pair, *SIZES, factor=0.5) + weighted(x, *[*pair, x]) + max(*pair, 3.0)


@func
def unnamed_counters(x: float) -> float:
    for _ in range(4):
        for _ in range(3):
            x = x * 1.5 + 1.0
        for _ in range(2):
            for _ in range(2):
                x -= 0.25
    return x


@func
def empty_range(x: float) -> float:
    for i in range(5, 2):
        x += float(i)
    return x


@func
def while_break(x: float) -> float:
    n = 0
    while True:
        x = x * 1.5 + 1.0
        n += 1
        if x > 50.0 or n > 20:
            break
    return x + float(n)


@func
def while_with_power_in_condition(x: float) -> float:
    while (x + 1.0) ** 2 < 100.0:
        x += 0.75
        if x > 8.5:
            continue
        x += 0.25
    return x


@func
def parameter_changes(x: float) -> float:
    x = x + 1.0
    x *= 2.0
    return x


@func
def assigned_in_branches(x: float) -> float:
    if x > 1.0:
        y = x
        z = y + 1.0
    else:
        y = -x
        z = y - 1.0
    return y * z


@func
def one_name_in_two_loops(x: float) -> float:
    total = 0.0
    for i in range(3):
        d = x + float(i)
        total += d
    for i in range(3):
        d = x * float(i)
        total -= d
    return total


@func
def swap(x: float) -> float:
    a = x
    b = 2.0
    for _ in range(3):
        a, b = b + 1.0, a
    return a * 10.0 + b


@func
def chained_assignment(x: float) -> float:
    a = b = x + 1.0
    a += 1.0
    return a * b


@func
def chained_comparison(x: float) -> float:
    return 1.0 if 0.5 < x * x <= 4.0 != x else 0.0


@func
def conditions(x: float) -> float:
    flag = (x > 1.0 and not x > 2.0) or x < -1.0
    return (1.0 if flag else 2.0) if x != 0.0 else 3.0


@func
def powers(x: float) -> float:
    return x**2 + x**3 - x**7 + (x + 3.0) ** -2 + x**0 + 2**3 + 2**-1


@func
def floats_floored(x: float) -> float:
    return x // 0.7 + x % 0.7 + (-x) // 0.37 + x % -2.5


@func
def math_functions(x: float) -> float:
    return (
        math.sin(x) + math.sqrt(abs(x)) * math.pi - math.atan2(x, 2.0) + min(x, 1, 0.5, max(x, 2))
    )


@func
def lists(x: float) -> float:
    values = [0.0] * 4
    for i in range(len(values)):
        values[i] = x * float(i)
    values[3] += 100.0
    total = 0.0
    for v in values:
        total = total * 0.5 + v
    return total + values[1]


@func
def nested_function(x: float) -> float:
    k = 2.0

    def scaled(y: float, by: float = 3.0) -> float:
        return y * by + k

    k = 5.0
    return scaled(x) + scaled(1.0, by=x)


@func
def lambdas(x: float) -> float:
    add = lambda a, b=2.0: a + b * x  # noqa: E731
    return add(1.0) + add(x, 3.0)


@func
def pair(x: float, y: float) -> tuple[float, float]:
    return x + y, x - y


@func
def tuples(x: float) -> float:
    s, d = pair(x, 2.0)
    both = pair(s, d)
    (a, b), c = both, 1.0
    return a * 100.0 + b * 10.0 + c + both[0] + pair(1.0, x)[1]


@func
def literals(x: float) -> float:
    return 2 * x + 7 // 2 + 1 / 4 - (3 - 5) * x + (1 << 4) + 0x10


@func
def returned_literal(x: float):  # type: ignore[no-untyped-def]
    if x > 0.0:
        return x
    return 0


FLOAT_FUNCTIONS = [
    *(early_return, nested_loops, counting_down, empty_range, while_break, parameter_changes),
    unnamed_counters,
    *(while_with_power_in_condition, assigned_in_branches, one_name_in_two_loops, swap),
    *(chained_assignment, chained_comparison, conditions, powers, floats_floored, lists),
    *(math_functions, nested_function, lambdas, tuples, literals, returned_literal),
    methods,
    enumerated,
    zipped,
    starred,
]


@pytest.mark.parametrize("scene", FLOAT_FUNCTIONS, ids=lambda f: f.name)
@pytest.mark.parametrize("x", [-2.25, -0.5, 0.0, 0.75, 1.5, 2.0, 3.125])
def test_floats(scene: Any, x: float) -> None:
    assert value(scene, x) == pytest.approx(_python(scene)(x), rel=1e-12, abs=1e-12)


def _python(scene: Any) -> Any:
    """The plain function, calling plain functions."""
    return _with_plain_names(scene, dict(scene.python_function.__globals__))


def _with_plain_names(scene: Any, names: dict[str, Any]) -> Any:
    function = scene.python_function
    for name, found in list(names.items()):
        names[name] = getattr(found, "python_function", found)
    names["Line"] = _plain_line(names)
    made = type(function)(function.__code__, names, function.__name__, function.__defaults__)
    made.__kwdefaults__ = function.__kwdefaults__
    return made


def _plain_line(names: dict[str, Any]) -> Any:
    """The struct with the methods that Python runs."""

    @dataclass
    class Plain:
        start: float
        slope: float = 2.0

    plain: Any = Plain
    for name in ("at", "moved", "level"):
        written = getattr(Line, name).python_function
        function = type(written)(written.__code__, names, name)
        setattr(plain, name, staticmethod(function) if name == "level" else function)
    return plain


@func
def int_arithmetic(a: int, b: int) -> int:
    return a // b * 100 + a % b * 10 + a**2 - (a ^ b) + (a & 6) - (b | 1) + ~a


@func
def int_shifts(a: int, b: int) -> int:
    return (a << 3) + (a >> 1) + (1 << (b & 7)) - (a >> (b & 3))


@func
def int_bools(a: int, b: int) -> int:
    return int(a > b) * 4 + int(bool(a)) * 2 + int((a > 0) ^ (b > 0)) + abs(min(a, b, 3))


@func
def int_to_float(a: int, b: int) -> int:
    return int(a / b) * 10 + int(float(a) * 1.5)


@pytest.mark.parametrize(
    "scene", [int_arithmetic, int_shifts, int_bools, int_to_float], ids=lambda f: f.name
)
@pytest.mark.parametrize("a", [-7, -1, 0, 3, 8])
@pytest.mark.parametrize("b", [-3, -1, 2, 5])
def test_ints(scene: Any, a: int, b: int) -> None:
    assert value(scene, a, b) == _python(scene)(a, b)
