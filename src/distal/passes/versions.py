"""Give each value one name: reads of a variable are distinguished by the value it holds.

Input: a function's body. Output: its regions, with every read of a Var renamed to ``name#3``, with
a new number wherever the value may have changed, so that equal nodes have equal values wherever
both are in scope (static single assignment without phi nodes: after a branch and around a loop a
Var simply gets a new number). A Let whose value an earlier Let in scope already has is removed, and
its reads become reads of the earlier one. ``plain`` removes the numbers again. ``births`` maps each
local and each numbered value to the region that creates it.
"""

from __future__ import annotations

from collections.abc import Iterable

from distal.ir.contents import contents
from distal.ir.nodes import (
    Assign,
    Break,
    Continue,
    Expr,
    For,
    Function,
    If,
    Let,
    Read,
    Return,
    Stmt,
    Var,
    While,
)
from distal.ir.walk import children, map_indices, nodes_in, rebuild, root_of, statements_in
from distal.passes.regions import Region

MARK = "#"  # not part of any name in a module


def assigned_in(body: Iterable[Stmt]) -> set[str]:
    """Return the Vars that a block assigns, including the blocks inside it."""
    return {root_of(s.target).name for s in statements_in(tuple(body)) if isinstance(s, Assign)}


class Versions:
    """Numbers the values of the Vars of one function."""

    def __init__(self, function: Function) -> None:
        self._mutable = assigned_in(function.body)
        self._count = 0
        # The name of a Var or of a removed Let -> the name that a read of it has at this point.
        self._now: dict[str, str] = {}
        self._available: list[dict[Expr, str]] = []
        self._region = Region(None, 0)
        self.births = {param.name: self._region for param in function.params}
        self.root = self._region
        self._fill(self.root, function.body)

    def _fresh(self, names: Iterable[str]) -> None:
        for name in sorted(names):
            if name in self._mutable:
                self._count += 1
                self._now[name] = f"{name}{MARK}{self._count}"
                self.births[self._now[name]] = self._region

    def _expr(self, root: Expr) -> Expr:
        if self._now.keys().isdisjoint(contents(root).reads):
            return root
        memo: dict[Expr, Expr] = {}
        for e in nodes_in(root):
            if isinstance(e, Read):
                name = self._now.get(e.name)
                memo[e] = e if name is None else Read(name, e.type)
            else:
                memo[e] = rebuild(e, tuple([memo[c] for c in children(e)]))
        return memo[root]

    def _fill(self, region: Region, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        """Number a block and store its statements in ``region``."""
        outer, self._region = self._region, region
        self._available.append({})
        numbered: list[Stmt] = []
        for stmt in body:
            done = self._statement(stmt, len(numbered))
            if done is not None:
                numbered.append(done)
        region.body = tuple(numbered)
        self._available.pop()
        self._region = outer
        return region.body

    def _statement(self, stmt: Stmt, position: int) -> Stmt | None:
        span = stmt.span
        match stmt:
            case Let(name, value):
                return self._let(stmt, name, self._expr(value))
            case Var(name, value):
                value = self._expr(value)
                self.births[name] = self._region
                self._fresh((name,))
                return Var(name, value, span=span)
            case Assign(target, value):
                value, where = self._expr(value), map_indices(target, self._expr)
                self._fresh((root_of(target).name,))
                return Assign(where, value, span=span)
            case Return(value):
                return Return(self._expr(value), span=span)
            case If():
                return self._if(stmt, position)
            case For():
                return self._for(stmt, position)
            case While():
                return self._while(stmt, position)
            case Break() | Continue():
                return stmt

    def _let(self, stmt: Let, name: str, value: Expr) -> Let | None:
        for scope in self._available:
            known = scope.get(value)
            if known is not None:
                self._now[name] = known
                return None
        self._available[-1][value] = name
        self.births[name] = self._region
        return Let(name, value, span=stmt.span)

    def _if(self, stmt: If, position: int) -> If:
        condition, before = self._expr(stmt.condition), dict(self._now)
        ways = (Region(self._region, position), Region(self._region, position))
        self._region.inner[position] = ways
        then = self._fill(ways[0], stmt.then)
        self._now = dict(before)
        otherwise = self._fill(ways[1], stmt.otherwise)
        self._now = before
        self._fresh(assigned_in((stmt,)))
        return If(condition, then, otherwise, span=stmt.span)

    def _for(self, stmt: For, position: int) -> For:
        start, stop = self._expr(stmt.start), self._expr(stmt.stop)
        outer, inside = self._region, Region(self._region, position, repeats=True)
        outer.inner[position] = (inside,)
        changed = assigned_in(stmt.body)
        self._region = inside
        self.births[stmt.name] = inside
        self._fresh(changed)
        body = self._fill(inside, stmt.body)
        self._region = outer
        self._fresh(changed)
        return For(stmt.name, start, stop, stmt.step, body, span=stmt.span)

    def _while(self, stmt: While, position: int) -> While:
        outer, head = self._region, Region(self._region, position, repeats=True, is_head=True)
        inside = Region(head, 0, repeats=True)
        outer.inner[position] = (head,)
        head.inner[0] = (inside,)
        changed = assigned_in(stmt.body)
        self._region = head
        self._fresh(changed)
        condition = self._expr(stmt.condition)
        body = self._fill(inside, stmt.body)
        self._region = outer
        self._fresh(changed)
        return While(condition, body, span=stmt.span)


def plain(e: Expr) -> Expr:
    """Return the expression with the version numbers removed from its names."""
    if not any(MARK in name for name in contents(e).reads):
        return e
    memo: dict[Expr, Expr] = {}
    for n in nodes_in(e):
        if isinstance(n, Read):
            name, mark, _ = n.name.partition(MARK)
            memo[n] = Read(name, n.type) if mark else n
        else:
            memo[n] = rebuild(n, tuple([memo[c] for c in children(n)]))
    return memo[e]
