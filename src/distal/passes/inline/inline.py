"""Inline: replace calls by the callee's statements, if the target requires it.

Input: a module. Output: a module with fewer and longer functions; functions that nothing calls any
more are removed, on every target.

A call in a loop gains most: loop-invariant values then move out of the loop, and a field is called
from a few loops only. Elsewhere a large callee stays a function, so that the size of the code
depends on the number of loops and not on the number of calls (otherwise a field of N shapes, called
from six places, would be compiled six times). A call that may be skipped is never moved before its
statement: in a branch of a Select, in the right operand of ``and`` and in a ``while``'s condition,
a cheap callee becomes an expression, and any other stays a call.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from distal.diagnostics import Span
from distal.ir.contents import calls_in, contents
from distal.ir.nodes import (
    Assign,
    Call,
    Expr,
    For,
    Function,
    Let,
    Logical,
    Module,
    Read,
    Select,
    Stmt,
    Var,
    While,
)
from distal.ir.walk import (
    children,
    map_statement,
    nodes_in,
    rebuild,
    root_of,
    roots_in,
    statements_in,
    substitute,
)
from distal.passes.context import Context
from distal.passes.cost import Costs, block_cost, size
from distal.passes.fold.constants import is_plain
from distal.passes.inline.straighten import RESULT, Straight, straighten
from distal.passes.naming import FreshNames, local_names
from distal.passes.reachable import drop_unused

SMALL: Final = 60  # inlined at every call (a polynomial sine has size 30)
IN_LOOP: Final = 500  # inlined into loops; the raymarcher's whole scene is about 200
ONCE: Final = 2000  # inlined if there is only one call
CALLER: Final = 6000  # the largest size of a function after inlining
CHEAP: Final = 60  # the largest cost of an expression that may be computed but not used


def run(module: Module, context: Context) -> Module:
    """Inline into every function, callees first."""
    module = drop_unused(module)
    if not context.target.inline:
        return module
    sites = _call_sites(module)
    costs: dict[str, int] = {}
    callees: dict[str, _Callee] = {}
    functions: list[Function] = []
    for function in module.functions:
        inlined = _Inliner(function, callees, sites).function()
        functions.append(inlined)
        costs[function.name] = block_cost(inlined.body, costs)
        straight = straighten(inlined, FreshNames(local_names(inlined)).fresh(RESULT), Costs(costs))
        if straight is not None and not function.apart:
            callees[function.name] = _Callee(inlined, straight, costs[function.name])
    return drop_unused(replace(module, functions=tuple(functions)))


def _call_sites(module: Module) -> Counter[str]:
    """Return the number of statements that call each function."""
    sites: Counter[str] = Counter()
    for function in module.functions:
        for root in roots_in(function.body):
            sites.update(calls_in(root))
    return sites


class _Callee:
    def __init__(self, function: Function, straight: Straight, cost: int) -> None:
        self.function = function
        self.straight = straight
        self.cost = cost
        self.size = size(function.body)


class _Inliner:
    """Inlines calls into one function."""

    def __init__(
        self, function: Function, callees: Mapping[str, _Callee], sites: Mapping[str, int]
    ) -> None:
        self._function = function
        self._callees = callees
        self._sites = sites
        self._names = FreshNames(local_names(function))
        self._size = size(function.body)
        self._mutable = set(_assigned(function.body))
        self._here: Span | None = None  # the place of the statement around the current call
        # Inlined calls -> their values, for each block around the current place.
        self._available: list[dict[Expr, Expr]] = [{}]

    def function(self) -> Function:
        """Return the function with calls inlined."""
        return replace(self._function, body=self._block(self._function.body, in_loop=False))

    def _block(self, body: tuple[Stmt, ...], *, in_loop: bool) -> tuple[Stmt, ...]:
        self._available.append({})
        result: list[Stmt] = []
        for stmt in body:
            result.extend(self._statement(stmt, in_loop))
        self._available.pop()
        return tuple(result)

    def _statement(self, stmt: Stmt, in_loop: bool) -> list[Stmt]:
        before: list[Stmt] = []
        outside, self._here = self._here, stmt.span or self._here
        loop = in_loop or isinstance(stmt, For | While)
        # A while's condition is computed in each iteration: none of it may move before the loop.
        eager = not isinstance(stmt, While)
        memo: dict[Expr, Expr] = {}
        changed = map_statement(
            stmt,
            lambda e: self._expr(e, in_loop or isinstance(stmt, While), eager, before, memo),
            lambda block: self._block(block, in_loop=loop),
        )
        self._here = outside
        return [*before, changed]

    def _expr(
        self, root: Expr, in_loop: bool, eager: bool, before: list[Stmt], done: dict[Expr, Expr]
    ) -> Expr:
        if not contents(root).callees:
            return done.get(root, root)
        nodes = [e for e in nodes_in(root) if e not in done]
        always = set(always_computed(root)) if eager else set()
        for e in nodes:
            changed = rebuild(e, tuple([done[c] for c in children(e)]))
            if isinstance(changed, Call):
                changed = self._call(changed, in_loop, e in always, before)
            done[e] = changed
        return done[root]

    def _call(self, call: Call, in_loop: bool, eager: bool, before: list[Stmt]) -> Expr:
        callee = self._callees.get(call.function)
        if callee is None or not self._wanted(callee, in_loop):
            return call
        for scope in self._available:
            if call in scope:
                return scope[call]
        if eager:
            value = self._insert(callee, call, before)
            if not contents(call).reads & self._mutable:
                self._available[-1][call] = value
        elif callee.straight.only_lets and callee.cost <= CHEAP:
            value = _as_expression(callee, call)
        else:
            return call
        self._size += callee.size
        return value

    def _wanted(self, callee: _Callee, in_loop: bool) -> bool:
        if callee.size > SMALL and self._size + callee.size > CALLER:
            return False
        if self._sites[callee.function.name] == 1:
            return callee.size <= ONCE
        return callee.size <= (IN_LOOP if in_loop else SMALL)

    def _insert(self, callee: _Callee, call: Call, before: list[Stmt]) -> Expr:
        """Append the callee's statements to ``before``, with new names; return the call's value."""
        reads: dict[Expr, Expr] = {}
        renaming = _Renaming(self._names, reads, self._own_place())
        for param, arg in zip(callee.function.params, call.args, strict=True):
            if is_plain(arg):
                reads[Read(param.name, param.type)] = arg
            else:
                name = self._names.fresh(param.name)
                before.append(Let(name, arg, span=renaming.place(callee.function.span)))
                reads[Read(param.name, param.type)] = Read(name, param.type)
        inserted = renaming.block(callee.straight.body)
        before.extend(inserted)
        self._mutable.update(_assigned(inserted))
        return renaming.expr(callee.straight.value)

    def _own_place(self) -> Span | None:
        """Return the place of the current call, if it is in the file of this function."""
        own, here = self._function.span, self._here
        return here if here is not None and own is not None and here.file == own.file else None


class _Renaming:
    """Copies a callee's statements with its parameters replaced and its locals renamed.

    Args:
        names: The names of the caller.
        reads: What the callee reads -> the expressions of the caller.
        around: The place of the call; statements of other files get it, because the lines of a text
            point to the file of the function that they are in. None keeps all places.
    """

    def __init__(self, names: FreshNames, reads: dict[Expr, Expr], around: Span | None) -> None:
        self._names = names
        self._reads = reads
        self._around = around
        self._memo: dict[Expr, Expr] = {}
        self._renamed: dict[str, str] = {}

    def expr(self, e: Expr) -> Expr:
        """Return the expression in the caller's names."""
        replaced = self._memo
        for n in nodes_in(e):
            if n in replaced:
                continue
            if isinstance(n, Read) and n not in self._reads:
                self._reads[n] = Read(self._renamed[n.name], n.type)
            found = self._reads.get(n)
            replaced[n] = found or rebuild(n, tuple([replaced[c] for c in children(n)]))
        return replaced[e]

    def block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        """Return the statements in the caller's names."""
        return tuple(self._statement(s) for s in body)

    def place(self, span: Span | None) -> Span | None:
        """Return the place of a copied statement."""
        around = self._around
        return span if around is None or (span and span.file == around.file) else around

    def _statement(self, stmt: Stmt) -> Stmt:
        span = self.place(stmt.span)
        match stmt:
            case Let(name, value):
                value = self.expr(value)
                return Let(self._fresh(name), value, span=span)
            case Var(name, value):
                value = self.expr(value)
                return Var(self._fresh(name), value, span=span)
            case For(name, start, stop, step, body):
                start, stop = self.expr(start), self.expr(stop)
                name = self._fresh(name)
                return For(name, start, stop, step, self.block(body), span=span)
            case _:
                changed = map_statement(stmt, self.expr, self.block)
                return changed if span is stmt.span else replace(changed, span=span)

    def _fresh(self, name: str) -> str:
        fresh = self._renamed[name] = self._names.fresh(name)
        return fresh


def _as_expression(callee: _Callee, call: Call) -> Expr:
    """Return the value of a callee that consists of Lets, with each Let substituted."""
    reads: dict[Expr, Expr] = {
        Read(p.name, p.type): arg for p, arg in zip(callee.function.params, call.args, strict=True)
    }
    for stmt in callee.straight.body:
        assert isinstance(stmt, Let)
        reads[Read(stmt.name, stmt.value.type)] = substitute(stmt.value, reads, {})
    return substitute(callee.straight.value, reads, {})


def _assigned(body: tuple[Stmt, ...]) -> Iterator[str]:
    for stmt in statements_in(body):
        if isinstance(stmt, Assign):
            yield root_of(stmt.target).name


def always_computed(root: Expr) -> Iterator[Expr]:
    """Yield the nodes that every evaluation of ``root`` computes.

    Leaves out the operands that a Select or ``and`` may skip.
    """
    seen: set[Expr] = set()
    stack = [root]
    while stack:
        e = stack.pop()
        if e in seen:
            continue
        seen.add(e)
        yield e
        match e:
            case Select(condition):
                stack.append(condition)
            case Logical(_, lhs):
                stack.append(lhs)
            case _:
                stack.extend(children(e))
