"""Which parameters of a function steer it: how often a loop runs, which branch is taken.

Input: functions. Output: the positions of int and bool parameters that a loop's bounds or a
condition depend on, directly or through what the function calls. Such a parameter gets a version of
the function for each constant it is called with: loops then have constant bounds (GLSL ES 1.00
knows no others) and branches that are never taken disappear.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from distal.ir.nodes import Call, Expr, For, Function, If, Let, Read, Stmt, Var, While
from distal.ir.types import BOOL, INT
from distal.ir.walk import expressions_in, nodes_in, statements_in


class SteeringParameters:
    """The steering parameters of a module's functions, found on demand."""

    def __init__(self, functions: Mapping[str, Function]) -> None:
        self._functions = functions
        self._found: dict[str, frozenset[int]] = {}

    def of(self, name: str) -> frozenset[int]:
        """The positions of a function's steering parameters."""
        found = self._found.get(name)
        if found is None:
            self._found[name] = frozenset()  # what calls itself is refused elsewhere
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
        """What decides how the function goes on."""
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
    """The parameters that an expression depends on."""
    found: set[str] = set()
    for node in nodes_in(e):
        if isinstance(node, Read):
            found |= sources.get(node.name, set())
    return found
