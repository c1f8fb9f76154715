"""Expressions of equal structure: the same but for their constant floats.

Input: expressions. Output: the constants, the structure that is left, and the expression with other
values for its constants. ``0.3 * sin(time + 0.1)`` and ``0.2 * sin(time + 0.7)`` have equal
structure.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from distal.ir.nodes import Const, Expr
from distal.ir.types import FLOAT
from distal.ir.walk import children, rebuild

# The most constants that are found in an expression, each occurrence counted; with more of them it
# is a structure of its own.
MOST_CONSTANTS: Final = 64
_ZERO: Final = Const(0.0, FLOAT)


class ConstantLifter:
    """Splits expressions into structure and constants, once for each node."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Expr, Expr, tuple[float, ...]]] = {}

    def split(self, e: Expr) -> tuple[Expr, tuple[float, ...]]:
        """Return the structure and the constants, each occurrence, left to right.

        The structure is the expression with 0 for each constant, the same object for equal
        structures.
        """
        found = self._known.get(id(e))
        if found is None:
            structure, constants = self._found(e)
            found = self._known[id(e)] = (e, structure, constants)  # keeps e alive, with its id
        return found[1], found[2]

    def _found(self, e: Expr) -> tuple[Expr, tuple[float, ...]]:
        if isinstance(e, Const):
            return (_ZERO, (e.value,)) if e.type is FLOAT else (e, ())
        below = [self.split(c) for c in children(e)]
        constants = tuple([value for _, values in below for value in values])
        if len(constants) > MOST_CONSTANTS:
            return e, ()
        return rebuild(e, tuple([structure for structure, _ in below])), constants


def with_values(e: Expr, values: Iterator[Expr | None], lifter: ConstantLifter) -> Expr:
    """Return an expression with other values for its constants, left to right; None keeps one."""
    if not lifter.split(e)[1]:
        return e
    if isinstance(e, Const):
        return next(values) or e
    return rebuild(e, tuple([with_values(c, values, lifter) for c in children(e)]))
