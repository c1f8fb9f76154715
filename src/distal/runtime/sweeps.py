"""Intervals of the results of a function, at all times and for all values of its parameters.

Input: a function, and values of its arguments, many rows at once. Output: two ends for each float
of the result, one row for each row of arguments. They hold for every time and for the declared
ranges of parameters; where nothing is known, they are infinite. The follower of ``tape.from_ir``
computes with intervals (``tape.interval_rules``) in place of operations of a tape.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.backends import get_target
from distal.backends.llvm.lanes import leaf_count
from distal.compiler.driver import run_passes
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import Origin, UniformDeclaration
from distal.ir.types import FLOAT, INT, Kind, component_count
from distal.runtime.function_tapes import buffers_of
from distal.runtime.lowered import Lowered
from distal.tape.from_ir import PRECISION, followed
from distal.tape.interval_rules import Ends, interval_of, is_elementary
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.tape import TapeError

# The values of a parameter, (n,) or (n, components); or their lower and their upper ends.
Column: TypeAlias = "NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.float64]]"

# Before common functions are put into their callers, which makes expressions longer.
_LAST_PASS: Final = "specialise-prelude"
# What elementary functions may differ from exact results, for each unit of the result and in all.
_WIDER: Final = 1e-5


@dataclass(frozen=True, slots=True, eq=False)
class _Swept(Varying):
    """A scalar that is anywhere between two ends.

    Attributes:
        low: The lower end, one for each row or one for all.
        high: The upper end.
        name: The operation that it is the result of.
        operands: The operands of this operation.
    """

    low: Any
    high: Any
    name: str = ""
    operands: tuple[Scalar, ...] = ()


def swept(low: Any, high: Any, name: str = "", operands: tuple[Scalar, ...] = ()) -> _Swept:
    """Return the scalar with these ends; an end that is no number is infinite."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    unknown = np.isnan(low) | np.isnan(high)
    low, high = np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high)
    return _Swept(0, low, high, name, operands)


class _IntervalScalars(Scalars):
    """Computes with intervals."""

    def operation(self, name: str, *operands: Scalar) -> Varying:
        """Return the interval of an operation."""
        known = _related(name, operands)
        if known is not None:
            return known
        ends = [_ends(operand) for operand in operands]
        with np.errstate(all="ignore"):
            low, high = _elementary(name, ends) if is_elementary(name) else interval_of(name, *ends)
        return swept(low, high, name, operands)

    def cast(self, a: Scalar, source: Kind, target: Kind) -> Scalar:
        """Return a scalar converted to another kind; a whole number is its own float."""
        if isinstance(a, Varying) and target is Kind.FLOAT:
            return a
        return super().cast(a, source, target)


def _ends(scalar: Scalar) -> Ends:
    if isinstance(scalar, _Swept):
        return scalar.low, scalar.high
    assert not isinstance(scalar, Varying)
    return np.float64(scalar), np.float64(scalar)  # type: ignore[return-value]


def _related(name: str, operands: Sequence[Scalar]) -> Varying | None:
    """Return the interval of an operation on operands that depend on each other; else None.

    They are ``a - b * floor(a / b)``, which is from 0 to b, and ``(a - b) + b``, as in the matrix
    of a rotation about an axis.
    """
    if name == "add":
        for parts, b in ((_made_by(operands[i], "sub"), operands[1 - i]) for i in (0, 1)):
            if parts and parts[1] is b:
                return swept(*_ends(parts[0]))
    if name != "sub":
        return None
    a, taken = operands
    if _made_by(taken, "floor")[:1] == (a,):
        return swept(0.0, 1.0)
    factors = _made_by(taken, "mul")
    for whole, b in (factors, factors[::-1]) if factors else ():
        for quotient in _made_by(whole, "floor"):
            parts = _made_by(quotient, "div")
            if parts and parts[0] is a and _same(parts[1], b):
                low, high = _ends(b)
                return swept(np.minimum(low, 0.0), np.maximum(high, 0.0))
    return None


def _made_by(scalar: Scalar, name: str) -> tuple[Scalar, ...]:
    """Return the operands of the operation that a scalar is the result of, if it has this name."""
    return scalar.operands if isinstance(scalar, _Swept) and scalar.name == name else ()


def _same(a: Scalar, b: Scalar) -> bool:
    return a is b or (not isinstance(a, Varying) and a == b)


def _elementary(name: str, operands: Sequence[Ends]) -> Ends:
    """Return the interval of an elementary function, as exact as on any target."""
    row = INTRINSICS.get(name)
    if row is not None and row.held is not None:
        ((low, high),) = operands
        least, most = row.held.limits(32)
        operands = ((np.clip(low, least, most), np.clip(high, least, most)),)
    low, high = interval_of(name, *operands)
    return _widened(low, high, _WIDER if row is None else max(_WIDER, row.rtol + row.atol))


def _widened(low: Any, high: Any, by: float) -> Ends:
    return low - by * (1.0 + np.abs(low)), high + by * (1.0 + np.abs(high))


def sweep(lowered: Lowered, columns: Sequence[Column]) -> list[Ends]:
    """Return the two ends of each float of a function's result.

    Args:
        lowered: The function.
        columns: The values of each parameter, or their ends.
    """
    module = run_passes(lowered.module, get_target("llvm"), PRECISION, after=_LAST_PASS)
    entry = module.function(module.entry)
    args = [_of_column(column) for column in columns]
    varying = (u for u in module.uniforms if u.origin is not Origin.NUMBER)
    uniforms = {u.name: tuple(swept(*ends) for ends in ends_of_uniform(u)) for u in varying}
    try:
        found = followed(module, args, uniforms, buffers_of(module), _IntervalScalars())
    except TapeError:
        # It has something without an interval.
        return [(np.array(-np.inf), np.array(np.inf))] * leaf_count(entry.result)
    return [_ends(scalar) for scalar in found]


def _of_column(column: Column) -> tuple[Scalar, ...]:
    """Return the scalars of a parameter, one for each component."""
    low, high = column if isinstance(column, tuple) else (column, column)
    if low.ndim == 1:
        return (swept(low, high),)
    return tuple(map(swept, low.T, high.T))


def ends_of_uniform(uniform: UniformDeclaration) -> list[tuple[float, float]]:
    """Return what each component of a parameter or of the time is between."""
    about: dict[str, Any] = dict(uniform.interface)
    low, high = about.get("low"), about.get("high")
    if uniform.type is INT and about.get("options"):
        low, high = 0, len(about["options"]) - 1
    if uniform.type not in (FLOAT, INT):
        low = high = None
    ends = -np.inf if low is None else low, np.inf if high is None else high
    return [ends] * component_count(uniform.type)
