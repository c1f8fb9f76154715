"""Give each statement of the author a local with what the statement itself computes.

Input: a module after the passes. Output: the same program, in which conditions, bounds of loops,
assigned and returned values are locals of their own, so that a writer can measure the computation
of a line apart from the blocks inside it. Does not depend on any text.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final, assert_never

from distal.diagnostics import Span
from distal.ir.nodes import (
    Assign,
    Break,
    Const,
    Continue,
    Expr,
    For,
    Function,
    If,
    Let,
    Module,
    Read,
    Return,
    Stmt,
    Unary,
    UnaryOp,
    Uniform,
    Var,
    While,
)
from distal.ir.types import BOOL

# No name of Python has a space: it is no name of the author.
OWN: Final = "own value"
_LEAVES: Final = (Const, Read, Uniform)


def with_own_values(module: Module, is_placed: Callable[[Span | None], bool]) -> Module:
    """Return a module whose placed statements compute their values in locals of their own.

    Args:
        module: The module.
        is_placed: Whether a statement at a place is one of those that are measured.
    """
    functions = (_OwnValues(is_placed).function(f) for f in module.functions)
    return replace(module, functions=tuple(functions))


class _OwnValues:
    def __init__(self, is_placed: Callable[[Span | None], bool]) -> None:
        self._is_placed = is_placed
        self._count = 0

    def function(self, fn: Function) -> Function:
        return replace(fn, body=self._block(fn.body))

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        return tuple(made for stmt in body for made in self._statement(stmt))

    def _own(self, value: Expr, span: Span | None) -> tuple[list[Stmt], Expr]:
        """Return the declaration of a local with a value, and a read of it."""
        if not self._is_placed(span) or isinstance(value, _LEAVES):
            return [], value
        self._count += 1
        local = f"{OWN} {self._count}"
        return [Let(local, value, span=span)], Read(local, value.type)

    def _statement(self, stmt: Stmt) -> list[Stmt]:
        match stmt:
            case Let() | Var() | Break() | Continue():
                return [stmt]
            case Assign(_, value):
                made, value = self._own(value, stmt.span)
                return [*made, replace(stmt, value=value)]
            case Return(value):
                made, value = self._own(value, stmt.span)
                return [*made, replace(stmt, value=value)]
            case If(condition, then, otherwise):
                made, condition = self._own(condition, stmt.span)
                then, otherwise = self._block(then), self._block(otherwise)
                return [*made, replace(stmt, condition=condition, then=then, otherwise=otherwise)]
            case For(_, start, stop):
                made, start = self._own(start, stmt.span)
                more, stop = self._own(stop, stmt.span)
                body = self._block(stmt.body)
                return [*made, *more, replace(stmt, start=start, stop=stop, body=body)]
            case While():
                return [self._while(stmt)]
            case _:
                assert_never(stmt)

    def _while(self, stmt: While) -> While:
        """Return a loop that computes its condition in its body, each time that it is asked."""
        body = self._block(stmt.body)
        made, condition = self._own(stmt.condition, stmt.span)
        if not made:
            return replace(stmt, body=body)
        ends = If(Unary(UnaryOp.NOT, condition, BOOL), (Break(),), ())
        return replace(stmt, condition=Const(True, BOOL), body=(*made, ends, *body))
