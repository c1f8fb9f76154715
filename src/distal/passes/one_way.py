"""Split Ifs with two branches into two Ifs, for drivers whose compile time doubles with each.

Input: functions just before a backend writes them. Output: functions with the same meaning; where
the two branches of an If may be equally long, its condition is bound to a local first, and each
branch gets its own If. Two returns at the end of a function count as such branches too.

The reason: SwiftShader follows the blocks of a loop to find its back edge. From a block that two
paths of equal length reach, it continues twice, so its time is 2 to the power of the number of such
Ifs, over a loop and everything that the loop calls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import assert_never

from distal.ir.nodes import (
    Assign,
    Break,
    Continue,
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
    Var,
    While,
)
from distal.ir.types import BOOL
from distal.passes.context import Context
from distal.passes.naming import FreshNames, local_names
from distal.passes.predicate import zero

_Block = tuple[Stmt, ...]


def run(module: Module, context: Context) -> Module:
    """Split the Ifs of every function, if the target requires it."""
    if not context.target.one_way:
        return module
    return replace(module, functions=tuple(map(parted, module.functions)))


def parted(function: Function) -> Function:
    """Return the function without an If whose two branches may be equally long."""
    names = FreshNames(local_names(function))
    return replace(function, body=_parted(_joined(function, names), names))


def _joined(function: Function, names: FreshNames) -> _Block:
    """Return the body; if it ends in two branches that return, they assign to a result instead."""
    *before, last = function.body
    after: list[Stmt] = []
    while before and isinstance(before[-1], Let | Var | Assign):
        after.insert(0, before.pop())
    match before, last:
        case [*earlier, If(condition, (*then, Return(yes) as first), ()) as fork], Return(no):
            if not (_lengths(then) and _lengths(after)):
                return function.body
            name = names.fresh("result")
            result = Read(name, function.result)
            ways = If(
                condition,
                (*then, Assign(result, yes, span=first.span)),
                (*after, Assign(result, no, span=last.span)),
                span=fork.span,
            )
            start = Var(name, zero(function.result), span=fork.span)
            return (*earlier, start, ways, Return(result, span=last.span))
        case _:
            return function.body


def _parted(block: _Block, names: FreshNames) -> _Block:
    done: list[Stmt] = []
    for stmt in block:
        match stmt:
            case If(condition, then, otherwise):
                then, otherwise = _parted(then, names), _parted(otherwise, names)
                fork = If(condition, then, otherwise, span=stmt.span)
                twins = then and otherwise and _lengths(then) & _lengths(otherwise)
                done += _two(fork, names) if twins else [fork]
            case For() | While():
                done.append(replace(stmt, body=_parted(stmt.body, names)))
            case Let() | Var() | Assign() | Break() | Continue() | Return():
                done.append(stmt)
            case _:
                assert_never(stmt)
    return tuple(done)


def _two(fork: If, names: FreshNames) -> list[Stmt]:
    """Return the branches as two Ifs. A local holds the condition, as the first may change it."""
    name = names.fresh("first")
    first = Read(name, BOOL)
    return [
        Let(name, fork.condition, span=fork.span),
        If(first, fork.then, (), span=fork.span),
        If(Unary(UnaryOp.NOT, first, BOOL), fork.otherwise, (), span=fork.span),
    ]


def _lengths(block: Sequence[Stmt]) -> frozenset[int]:
    """Return the possible numbers of branches on paths through a block.

    Empty if a path leaves the block, or if the block contains a loop.
    """
    found = frozenset([0])
    for stmt in block:
        match stmt:
            case Let() | Var() | Assign():
                continue
            case If(_, then, otherwise):
                through, around = _lengths(then), _lengths(otherwise)
                if not (through and around):
                    return frozenset()
                # The branches to the first block, through it, and to the block where paths join.
                ways = {2 + n for n in through} | {(2 if otherwise else 1) + n for n in around}
                found = frozenset(a + b for a in found for b in ways)
            case _:
                return frozenset()
    return found
