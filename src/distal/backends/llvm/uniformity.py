"""Find the locals of a function that may differ between lanes.

Input: a predicated function, and which of its parameters vary. Output: the names of the locals that
may differ between lanes; all others are computed once, in scalar registers.

A value varies if an operand varies. A Var also varies if it is assigned where lanes may have
diverged since its declaration: under a varying condition, or in a loop that lanes leave one by one.
The analysis starts with no varying locals, and repeats until it finds no more.
"""

from __future__ import annotations

from typing import assert_never

from distal.ir.nodes import (
    Assign,
    Break,
    Builtin,
    Const,
    Continue,
    Expr,
    For,
    Function,
    If,
    Let,
    PerFrame,
    Read,
    Resource,
    Return,
    Size,
    Stmt,
    Uniform,
    Var,
    While,
)
from distal.ir.walk import children, expressions, nodes_in, root_of, statements_in


class Uniformity:
    """The analysis of one function for one set of varying parameters.

    Attributes:
        function: The function.
        varying: The names of the locals and parameters that may differ between lanes.
        result_varies: Whether the returned value may differ between lanes.
        divergent_loops: The ids of the loop statements that lanes leave one by one.
    """

    def __init__(self, function: Function, varying: frozenset[str]) -> None:
        self.function = function
        self.varying = set(varying)
        self.result_varies = False
        self.divergent_loops: set[int] = set()
        self._depth: dict[str, int] = {}
        self._memo: dict[Expr, bool] = {}
        self._grew = True
        while self._grew:
            self._grew = False
            self._memo.clear()
            self._block(function.body, 0)

    def varies(self, e: Expr) -> bool:
        """Return whether an expression may differ between lanes."""
        known = self._memo.get(e)
        if known is None:
            match e:
                case Read(name):
                    known = name in self.varying
                case Const() | Uniform() | PerFrame() | Resource() | Size():
                    known = False
                case Builtin("anywhere"):
                    known = False
                case _:
                    known = any(self.varies(c) for c in children(e))
            self._memo[e] = known
        return known

    def _vary(self, name: str) -> None:
        if name not in self.varying:
            self.varying.add(name)
            self._memo.clear()
            self._grew = True

    def _block(self, block: tuple[Stmt, ...], depth: int) -> None:
        for stmt in block:
            self._statement(stmt, depth)

    def _statement(self, stmt: Stmt, depth: int) -> None:
        match stmt:
            case Let(name, value) | Var(name, value):
                self._depth[name] = depth
                if self.varies(value):
                    self._vary(name)
            case Assign(target, value):
                name = root_of(target).name
                # A target also varies if an index in it varies.
                if depth > self._depth[name] or self.varies(value) or self.varies(target):
                    self._vary(name)
            case If(condition, then, otherwise):
                inner = depth + self.varies(condition)
                self._block(then, inner)
                self._block(otherwise, inner)
            case For(name, start, stop, _, body):
                bounds = self.varies(start) or self.varies(stop)
                if bounds:
                    self._vary(name)
                self._loop(stmt, body, depth, diverges=bounds)
            case While(condition, body):
                self._loop(stmt, body, depth, diverges=self.varies(condition))
            case Return(value):
                if depth or self.varies(value):
                    self.result_varies = True
            case Break() | Continue():
                pass
            case _:
                assert_never(stmt)

    def _loop(self, stmt: Stmt, body: tuple[Stmt, ...], depth: int, *, diverges: bool) -> None:
        if diverges or self._exit_varies(body):
            self.divergent_loops.add(id(stmt))
        inner = depth + (id(stmt) in self.divergent_loops)
        self._block(body, inner)
        if self._exit_varies(body) and id(stmt) not in self.divergent_loops:
            self.divergent_loops.add(id(stmt))
            self._grew = True

    def _exit_varies(self, body: tuple[Stmt, ...]) -> bool:
        match body[-1:]:
            case (If(condition, (Break(),), ()),):
                return self.varies(condition)
            case _:
                return False


def reads_in(block: tuple[Stmt, ...]) -> dict[str, int]:
    """Return how often each local is read in a block; assigning to a whole local is not a read."""
    counts: dict[str, int] = {}
    for stmt in statements_in(block):
        roots = expressions(stmt)
        skip = root_of(stmt.target) if isinstance(stmt, Assign) else None
        if isinstance(stmt, Assign) and stmt.target is skip:
            roots = (stmt.value,)
        for e in nodes_in(*roots):
            if isinstance(e, Read):
                counts[e.name] = counts.get(e.name, 0) + 1
    return counts
