"""Estimate the longest chain of dependent instructions of each function.

Input: functions, callees first, and their costs. Output: numbers that are compared with the
functions' costs: a function with many more instructions than its longest chain keeps the processor
busy by itself.
"""

from __future__ import annotations

from collections.abc import Iterable

from distal.backends.llvm.costs import LaneCosts, width
from distal.ir.nodes import Assign, Call, Expr, Function, Let, Read, Return, Stmt, Var
from distal.ir.walk import blocks, children, expressions, nodes_in, root_of


class Chains:
    """The longest chains of a module's functions, computed on demand."""

    def __init__(self, functions: Iterable[Function], costs: LaneCosts) -> None:
        self._functions = {f.name: f for f in functions}
        self._costs = costs
        self._found: dict[str, int] = {}

    def of(self, name: str) -> int:
        """Return the length of a function's longest chain; the body of a loop is counted once."""
        found = self._found.get(name)
        if found is None:
            found = self._found[name] = _Chain(self, self._costs).length(self._functions[name].body)
        return found


class _Chain:
    """The chain of one function: for each local, the instructions before its value is known."""

    def __init__(self, chains: Chains, costs: LaneCosts) -> None:
        self._chains = chains
        self._costs = costs
        self._known_after: dict[str, int] = {}
        self._longest = 0

    def length(self, body: tuple[Stmt, ...]) -> int:
        """Return the length of the longest chain of a body."""
        self._block(body, 0)
        return max(1, self._longest)

    def _block(self, body: tuple[Stmt, ...], begins: int) -> None:
        """Visit the statements of a block that begins after so many instructions of a chain."""
        for stmt in body:
            after = max([begins, *(self._expression(e) for e in expressions(stmt))])
            match stmt:
                case Let(name) | Var(name):
                    self._known_after[name] = after
                case Assign(target):
                    name = root_of(target).name
                    self._known_after[name] = max(after, self._known_after.get(name, 0))
                case _:
                    for block in blocks(stmt):
                        self._block(block, after)
            if isinstance(stmt, Return):
                self._longest = max(self._longest, after)

    def _expression(self, root: Expr) -> int:
        after: dict[Expr, int] = {}
        for e in nodes_in(root):
            if isinstance(e, Read):
                after[e] = self._known_after.get(e.name, 0)
            else:
                begins = max([after[c] for c in children(e)], default=0)
                after[e] = begins + self._instructions(e)
        return after[root]

    def _instructions(self, e: Expr) -> int:
        """Return the instructions of a node itself that wait for each other."""
        if isinstance(e, Call):
            return self._chains.of(e.function)
        cost = self._costs.node(e)
        # The components of a vector do not wait for each other.
        return cost if cost <= 1 else max(1, cost // width(e))
