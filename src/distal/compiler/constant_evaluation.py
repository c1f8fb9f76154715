"""Evaluate built-ins of plain values without a device: ``SUN = normalize(vec3(1, 2, 3))``.

Input: an intrinsic and Python numbers or vectors. Output: the value in 64 bits, computed by the
rules that fold constants in scene code; None where these rules leave the operation to a device. So
a scene's module can compute its constants with only the standard library installed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from distal.frontend.lowering.builtin_calls import call_with_constants
from distal.frontend.types.python_objects import RefusedError
from distal.ir.intrinsics import Intrinsic
from distal.ir.nodes import Compose, Const, Expr, Splat
from distal.ir.types import UINT, component_count
from distal.lang.values import VALUE_CLASSES, uint
from distal.passes.fold.fold import fold_expression


def compute(intrinsic: Intrinsic, args: Sequence[Any]) -> Any | None:
    """Return ``intrinsic(*args)``, or None if it cannot be computed here."""
    try:
        call = call_with_constants(intrinsic, args)
    except RefusedError:  # the result is NaN or infinite, for example
        return None
    return None if call is None else _python_value(fold_expression(call, 64))


def _python_value(value: Expr) -> Any | None:
    match value:
        case Const(number, type):
            return uint(number) if type is UINT else number
        case Splat(inner, type):
            parts = [_python_value(inner)] * component_count(type)
        case Compose(inner_parts, type):
            parts = [_python_value(p) for p in inner_parts]
        case _:
            return None
    return None if any(p is None for p in parts) else VALUE_CLASSES[type](*parts)
