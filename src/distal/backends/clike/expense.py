"""What expressions cost to run, so that a language knows whether it may compute both of a choice.

Input: a module's functions. Output: numbers of operations. Knows no language and no driver.
"""

from __future__ import annotations

from typing import Final

from distal.ir.nodes import Call, Expr, For, Module, While
from distal.ir.walk import expressions_in, nodes_in, statements_in

# Up to so many operations in a branch, both branches are computed and one is picked.
EAGER_OPERATIONS: Final = 40


class Expense:
    """How many operations an expression may run; a loop counts as very many."""

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
        """Operations of an expression with the functions that it calls."""
        return sum(map(self._own, nodes_in(e)))
