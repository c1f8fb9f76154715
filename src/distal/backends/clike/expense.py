"""Estimate the cost of expressions, to decide whether to compute both sides of a selection.

Input: a module's functions. Output: numbers of operations. Does not depend on languages or drivers.
"""

from __future__ import annotations

from typing import Final

from distal.ir.nodes import Call, Expr, For, Module, While
from distal.ir.walk import expressions_in, nodes_in, statements_in

# If both branches have at most this number of operations, both are computed, and one is selected.
EAGER_OPERATIONS: Final = 40


class Expense:
    """Counts the operations that an expression may run; a loop counts as ``LOOP``."""

    LOOP = 10**6

    def __init__(self, module: Module) -> None:
        self._functions: dict[str, int] = {}
        for function in module.functions:
            loops = any(isinstance(s, For | While) for s in statements_in(function.body))
            self._functions[function.name] = (
                self.LOOP if loops else sum(map(self._own, expressions_in(function.body)))
            )

    def _own(self, e: Expr) -> int:
        return 1 + (self._functions.get(e.function, 0) if isinstance(e, Call) else 0)

    def of(self, e: Expr) -> int:
        """Return the number of operations of an expression and of the functions that it calls."""
        return sum(map(self._own, nodes_in(e)))
