"""Find the parameters that control a function's loops and branches (steering parameters).

Input: functions. Output: the positions of the int and bool parameters on which a loop bound or a
condition depends, directly or through a called function. The function is specialised for each
constant passed to such a parameter: loops then have constant bounds (GLSL ES 1.00 allows no other)
and branches that are never taken disappear.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from distal.ir.nodes import Call, Expr, For, Function, If, Let, Read, Stmt, Var, While
from distal.ir.types import BOOL, INT
from distal.ir.walk import expressions_in, nodes_in, statements_in


class SteeringParameters:
    """The steering parameters of a module's functions, computed on demand."""

    def __init__(self, functions: Mapping[str, Function]) -> None:
        self._functions = functions
        self._found: dict[str, frozenset[int]] = {}

    def of(self, name: str) -> frozenset[int]:
        """Return the positions of a function's steering parameters."""
        found = self._found.get(name)
        if found is None:
            self._found[name] = frozenset()  # recursion is reported elsewhere
            found = self._found[name] = self._find(self._functions[name])
        return found

    def _find(self, function: Function) -> frozenset[int]:
        candidates = {
            p.name: i for i, p in enumerate(function.params) if p.type is INT or p.type is BOOL
        }
        if not candidates:
            return frozenset()
        sources: dict[str, set[str]] = {name: {name} for name in candidates}
        for stmt in statements_in(function.body):
            if isinstance(stmt, Let | Var):
                sources[stmt.name] = _read(stmt.value, sources)
        steering: set[str] = set()
        for root in self._roots(function.body):
            steering |= _read(root, sources)
        return frozenset(candidates[name] for name in steering)

    def _roots(self, body: tuple[Stmt, ...]) -> Iterator[Expr]:
        """Yield the expressions that control the execution of the function."""
        for stmt in statements_in(body):
            match stmt:
                case If(condition) | While(condition):
                    yield condition
                case For(_, start, stop):
                    yield start
                    yield stop
                case _:
                    pass
        for e in expressions_in(body):
            if isinstance(e, Call):
                yield from (e.args[i] for i in self.of(e.function))


def _read(e: Expr, sources: Mapping[str, set[str]]) -> set[str]:
    """Return the parameters that an expression depends on."""
    found: set[str] = set()
    for node in nodes_in(e):
        if isinstance(node, Read):
            found |= sources.get(node.name, set())
    return found
