"""Replace dynamic indices for targets that allow only constant ones (arrays are structs there).

Input: an ``Index`` with any index, as a value or in the target of an Assign. Output: a chain of
Selects among the elements (or of Ifs), clamped at both ends as every index is defined to be.
"""

from __future__ import annotations

from distal.ir.build import compare, integer, select
from distal.ir.nodes import (
    Assign,
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
)
from distal.ir.types import Buffer, index_count
from distal.ir.walk import rebuild
from distal.passes.naming import FreshNames
from distal.passes.ranges import Ranges


def settled_index(e: Index, ranges: Ranges) -> Index:
    """Return the Index with a constant index if the index has only one possible value."""
    count = index_count(e.base.type)
    position = ranges.constant(e.index)
    if count is None or position is None:
        return e
    inside = integer(min(max(position, 0), count - 1))
    return Index(e.base, inside, e.type, span=e.span)


def _is_settled(e: Index) -> bool:
    """Return whether the index is a constant, or the base a buffer (left to the backend)."""
    return isinstance(e.index, Const) or isinstance(e.base.type, Buffer)


def picked_element(e: Index) -> Expr:
    """Return ``base[index]`` as a chain of Selects."""
    if _is_settled(e):
        return e
    count = index_count(e.base.type)
    assert count is not None
    chain: Expr = Index(e.base, integer(count - 1), e.type, span=e.span)
    for k in range(count - 2, -1, -1):
        element = Index(e.base, integer(k), e.type, span=e.span)
        chain = select(compare(CompareOp.LE, e.index, integer(k)), element, chain)
    return chain


def assignments(assign: Assign, names: FreshNames) -> list[Stmt]:
    """Return the statement, or a chain of Ifs that assigns to the element selected at run time."""
    found = _outermost_dynamic(assign.target)
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
        one = tuple(assignments(Assign(target, value, span=assign.span), names))
        condition = compare(CompareOp.LE, index, integer(k))
        ladder = one if k == count - 1 else (If(condition, one, ladder, span=assign.span),)
    return [*before, *ladder]


def _outermost_dynamic(target: Expr) -> Index | None:
    match target:
        case Index(base):
            return _outermost_dynamic(base) or (None if _is_settled(target) else target)
        case Swizzle(base) | Field(base):
            return _outermost_dynamic(base)
        case _:
            return None


def _replaced(target: Expr, part: Expr, by: Expr) -> Expr:
    """Return the target with one part of its path replaced."""
    if target is part:
        return by
    match target:
        case Index(base, index):
            return rebuild(target, (_replaced(base, part, by), index))
        case Swizzle(base) | Field(base):
            return rebuild(target, (_replaced(base, part, by),))
        case _:
            return target
