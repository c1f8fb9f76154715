"""Indices for targets that only take constants and loop counters between brackets.

What flows in: an ``Index`` with any index, as a value or in an Assign's target. What flows out: a
chain of choices among the elements, clamped at both ends as every index is in meaning.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.ir.build import compare, integer, select
from distal.ir.nodes import (
    Assign,
    Binary,
    BinaryOp,
    CompareOp,
    Const,
    Expr,
    Field,
    If,
    Index,
    Let,
    Read,
    Stmt,
    Swizzle,
    Unary,
)
from distal.ir.types import index_count
from distal.ir.walk import nodes_in, rebuild
from distal.passes.naming import Names
from distal.passes.ranges import Ranges


def is_static_index(e: Index, ranges: Ranges, loops: set[str]) -> bool:
    """True when the index is made of constants and loop counters, and in range."""
    count = index_count(e.base.type)
    if count is None:
        return True  # a buffer, which the backend reads its own way
    low, high = ranges.of(e.index)
    return low >= 0 and high < count and all(_is_static(n, loops) for n in nodes_in(e.index))


def _is_static(e: Expr, loops: set[str]) -> bool:
    """GLSL ES 1.00, appendix A.5: constant-index-expressions."""
    match e:
        case Const() | Unary():
            return True
        case Read(name):
            return name in loops
        case Binary(BinaryOp.ADD | BinaryOp.SUB | BinaryOp.MUL):
            return True
        case _:
            return False


def picked_element(e: Index) -> Expr:
    """``base[index]`` as a chain of choices."""
    count = index_count(e.base.type)
    assert count is not None
    chain: Expr = Index(e.base, integer(count - 1), e.type, span=e.span)
    for k in range(count - 2, -1, -1):
        element = Index(e.base, integer(k), e.type, span=e.span)
        chain = select(compare(CompareOp.LE, e.index, integer(k)), element, chain)
    return chain


def assignments(assign: Assign, is_static: Callable[[Index], bool], names: Names) -> list[Stmt]:
    """The statement, or a ladder of Ifs that assigns the element a dynamic index means."""
    found = _outermost_dynamic(assign.target, is_static)
    if found is None:
        return [assign]
    count = index_count(found.base.type)
    assert count is not None
    index = Read(names.fresh("position"), found.index.type)
    value = Read(names.fresh("assigned"), assign.value.type)
    before: list[Stmt] = [
        Let(index.name, found.index, span=assign.span),
        Let(value.name, assign.value, span=assign.span),
    ]
    ladder: tuple[Stmt, ...] = ()
    for k in range(count - 1, -1, -1):
        element = Index(found.base, integer(k), found.type, span=found.span)
        target = _replaced(assign.target, found, element)
        one = tuple(assignments(Assign(target, value, span=assign.span), is_static, names))
        condition = compare(CompareOp.LE, index, integer(k))
        ladder = one if k == count - 1 else (If(condition, one, ladder, span=assign.span),)
    return [*before, *ladder]


def _outermost_dynamic(target: Expr, is_static: Callable[[Index], bool]) -> Index | None:
    match target:
        case Index(base):
            return _outermost_dynamic(base, is_static) or (None if is_static(target) else target)
        case Swizzle(base) | Field(base):
            return _outermost_dynamic(base, is_static)
        case _:
            return None


def _replaced(target: Expr, part: Expr, by: Expr) -> Expr:
    """The target with one part of its path replaced."""
    if target is part:
        return by
    match target:
        case Index(base, index):
            return rebuild(target, (_replaced(base, part, by), index))
        case Swizzle(base) | Field(base):
            return rebuild(target, (_replaced(base, part, by),))
        case _:
            return target
