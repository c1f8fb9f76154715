"""Ints of constants are those of values: what the compiler computes wraps as at run time.

A generator writes expressions of ints twice, with literals and with parameters that have the same
values. Python's ints, wrapped after each operator, are a third opinion.
"""

from __future__ import annotations

import operator
import random
from collections.abc import Callable
from typing import Any, Final

import numpy as np
import pytest

from distal import CompileError
from distal.ir.constant_arithmetic import wrap
from distal.ir.types import Kind
from tests.gradients.running import scope_of

NUMBERS: Final = (0, 1, -1, 2, 7, -7, 31, 46341, 65535, 65536, -65537, 2654435761 % 2**31, 2**30,
                  2**31 - 1, -(2**31))  # fmt: skip
OPERATORS: Final[dict[str, Callable[[int, int], int]]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "//": operator.floordiv,
    "%": operator.mod,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    "<<": operator.lshift,
    ">>": operator.rshift,
}
COUNT: Final = 60
HEADER: Final = "from distal.lang import abs, func\n"


class Writer:
    """Writes one expression with literals and with parameters."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.values: list[int] = []

    def number(self, value: int) -> tuple[str, str, int]:
        self.values.append(value)
        return f"({value})", f"n{len(self.values) - 1}", value

    def expression(self, depth: int) -> tuple[str, str, int]:
        """The text with literals, the text with parameters, and the value."""
        if depth == 0:
            return self.number(self.random.choice(NUMBERS))
        kind = self.random.random()
        literal, named, value = self.expression(depth - 1)
        if kind < 0.2:
            sign, change = self.random.choice((("-", operator.neg), ("~", operator.invert)))
            return f"({sign}{literal})", f"({sign}{named})", wrap(change(value), Kind.INT)
        symbol = self.random.choice(list(OPERATORS))
        if symbol in ("<<", ">>"):
            other = self.number(self.random.randrange(32))
        else:
            other = self.expression(self.random.randrange(depth))
        if symbol in ("//", "%") and other[2] == 0:
            other = self.number(3)
        result = wrap(OPERATORS[symbol](value, other[2]), Kind.INT)
        return f"({literal} {symbol} {other[0]})", f"({named} {symbol} {other[1]})", result


def test_constants_are_what_values_give() -> None:
    lines, drawn = [HEADER], []
    for seed in range(COUNT):
        writer = Writer(seed)
        literal, named, value = writer.expression(3)
        names = ", ".join(f"n{i}: int" for i in range(len(writer.values)))
        lines.append(f"@func\ndef constant_{seed}() -> int:\n    return {literal}\n")
        lines.append(f"@func\ndef value_{seed}({names}) -> int:\n    return {named}\n")
        drawn.append((literal, writer.values, value))
    scope: dict[str, Any] = scope_of("\n".join(lines), "whole_constants")
    for seed, (literal, values, value) in enumerate(drawn):
        assert scope[f"constant_{seed}"]() == value, literal
        if seed % 6 == 0:  # each is compiled on its own
            given = [np.array([v], np.int32) for v in values]
            assert scope[f"value_{seed}"](*given).tolist() == [value], literal


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 << 31", -(2**31)),
        ("65536 * 65536", 0),
        ("46341 * 46341", 46341 * 46341 - 2**32),
        ("2147483647 + 1", -(2**31)),
        ("-(-2147483648)", -(2**31)),
        ("abs(-2147483648)", -(2**31)),
        ("(1 << 31) >> 31", -1),
        ("2 ** 31", -(2**31)),
        ("-2147483648 // -1", -(2**31)),
        ("int(3e9)", 2**31 - 1),
        ("int(-3e9)", -(2**31)),
    ],
)
def test_constants_that_wrap(text: str, value: int) -> None:
    scope = scope_of(f"{HEADER}@func\ndef f() -> int:\n    return {text}\n", "wrapping")
    assert scope["f"]() == value


@pytest.mark.parametrize("text", ["65536 * 65536 == 0", "1 << 31 < 0", "2147483647 + 1 < 3"])
def test_constants_are_compared_as_ints(text: str) -> None:
    scope = scope_of(f"{HEADER}@func\ndef f() -> bool:\n    return {text}\n", "compared")
    assert scope["f"]()


@pytest.mark.parametrize("text", ["2147483648", "-2147483649", "7 // (65536 * 65536)", "1 << 32"])
def test_what_is_written_must_fit(text: str) -> None:
    scope = scope_of(f"{HEADER}@func\ndef f() -> int:\n    return {text}\n", "fitting")
    with pytest.raises(CompileError):
        scope["f"]()


def test_a_float_of_constants_is_exact() -> None:
    scope = scope_of(f"{HEADER}@func\ndef f() -> float:\n    return 65536 * 65536 * 0.5\n", "exact")
    assert scope["f"]() == 2.0**31
