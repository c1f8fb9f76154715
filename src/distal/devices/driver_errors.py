"""Measure which built-in functions of a GPU's driver are too inaccurate (decision 18).

Input: an open GPU. Output: the names of the built-ins that a program should replace by their
careful functions, among those that have one. The errors are measured once for each open GPU, by a
separate kernel, at the same arguments and with the same limit as on a web page
(``web/src/trust.ts``; a test compares the two).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.ir.build import builtin, compare, number, read, select
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Builtin, CompareOp, EntryKind, Expr, Function, Module, Param, Return
from distal.ir.types import FLOAT
from distal.ir.walk import expressions_in

NAMES: Final = tuple(row.name for row in INTRINSICS.values() if row.careful)
COUNT: Final = 256  # number of arguments; they are exact in a shader, and cover the whole circle
STEP: Final = 25 / 32  # radians between angles, which reach ±99.6; arcs are measured from -1 to 1
# A 32-bit angle near 100 has an error of 4e-6, and its reduction in 32 bits adds as much again.
MOST: Final = 1e-5
_ANGLES: Final = ("sin", "cos")

Measured = Callable[[Module, list[NDArray[np.float32]]], Any]


def uses_rough(module: Module) -> bool:
    """Return whether a module calls a built-in that drivers may compute inaccurately."""
    return any(
        isinstance(e, Builtin) and e.name in NAMES
        for function in module.functions
        for e in expressions_in(function.body)
    )


def rough_names(run: Measured) -> frozenset[str]:
    """Return the built-ins whose error exceeds ``MOST``; ``run`` evaluates a module at points."""
    errors = measured_errors(run)
    return frozenset(name for name, error in errors.items() if not error <= MOST)


def measured_errors(run: Measured) -> dict[str, float]:
    """Return the largest error of each built-in; NaN if a value is NaN."""
    place = np.arange(COUNT) + 0.5 - COUNT / 2
    arguments = [place * (STEP if name in _ANGLES else 2.0 / COUNT) for name in NAMES]
    which = np.repeat(np.arange(len(NAMES)), COUNT).astype(np.float32)
    values = run(_module(), [which, np.concatenate(arguments).astype(np.float32)])
    errors = {}
    for name, x, row in zip(
        NAMES, arguments, np.reshape(values, (len(NAMES), COUNT)).astype(np.float64), strict=True
    ):
        exact = np.array([getattr(math, name)(a) for a in x])
        errors[name] = float(np.max(np.abs(row - exact)))
    return errors


def _module() -> Module:
    """Return a function of (which, x): the value of built-in number ``which`` at x."""
    which, x = read("which", FLOAT), read("x", FLOAT)
    value: Expr = builtin(NAMES[-1], x)
    for i, name in enumerate(NAMES[:-1]):
        here = compare(CompareOp.EQ, which, number(float(i)))
        value = select(here, builtin(name, x), value)
    params = (Param("which", FLOAT), Param("x", FLOAT))
    function = Function("measured", params, FLOAT, (Return(value),), "measured")
    return Module((function,), "measured", EntryKind.FUNCTION)
