"""Traverse and transform expressions and statements without a case for every node class."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import chain
from operator import attrgetter
from typing import Any, Final, assert_never, get_args

from distal.ir.contents import contents, nodes_of
from distal.ir.nodes import (
    Assign,
    Break,
    Const,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Index,
    Let,
    PerFrame,
    Read,
    Resource,
    Return,
    Stmt,
    Swizzle,
    Uniform,
    Var,
    While,
)
from distal.ir.operands import OPERANDS, REBUILT


def children(e: Expr) -> tuple[Expr, ...]:
    """Return the operands of an expression, left to right."""
    return OPERANDS[type(e)](e)


def rebuild(e: Expr, operands: tuple[Expr, ...]) -> Expr:
    """Return ``e`` with other operands of the same types; ``e`` itself when they are unchanged."""
    kind = type(e)
    return e if operands == OPERANDS[kind](e) else REBUILT[kind](e, operands)


def rewrite(e: Expr, change: Callable[[Expr], Expr], memo: dict[Expr, Expr]) -> Expr:
    """Rewrite bottom up: call ``change`` once for each node, after its operands were rewritten.

    Args:
        e: The expression.
        change: Returns the replacement of a node.
        memo: The nodes rewritten so far; extended.
    """
    done = memo.get(e)
    if done is None:
        operands = tuple(rewrite(c, change, memo) for c in children(e))
        done = change(rebuild(e, operands))
        memo[e] = done
    return done


def substitute(e: Expr, replacements: dict[Expr, Expr], memo: dict[Expr, Expr]) -> Expr:
    """Replace whole nodes, such as Reads, by other expressions; top down, each node once.

    Args:
        e: The expression.
        replacements: The node to replace -> its replacement.
        memo: The nodes processed so far; extended.
    """
    done = memo.get(e)
    if done is None:
        done = replacements.get(e)
        if done is None:
            done = rebuild(e, tuple(substitute(c, replacements, memo) for c in children(e)))
        memo[e] = done
    return done


def nodes_in(*roots: Expr) -> Sequence[Expr]:
    """Return every distinct node of the expressions, including ``roots``; operands before users."""
    return nodes_of(roots[0]) if len(roots) == 1 else _nodes_of_all(roots)


def _nodes_of_all(roots: Iterable[Expr]) -> list[Expr]:
    # The nodes of an expression are all there or all missing before it: no order is broken.
    return list(dict.fromkeys(chain.from_iterable(map(nodes_of, roots))))


def expressions(stmt: Stmt) -> tuple[Expr, ...]:
    """Return the expressions directly in a statement (including the target of an Assign)."""
    return _EXPRESSIONS[type(stmt)](stmt)


def blocks(stmt: Stmt) -> tuple[tuple[Stmt, ...], ...]:
    """Return the blocks directly inside a statement."""
    found = _BLOCKS.get(type(stmt))
    return () if found is None else found(stmt)


# Tables instead of match statements, as in ``ir.operands``.
_EXPRESSIONS: Final[dict[type, Callable[[Any], tuple[Expr, ...]]]] = {
    **dict.fromkeys((Let, Var, Return), lambda s: (s.value,)),
    Assign: attrgetter("target", "value"),
    **dict.fromkeys((If, While), lambda s: (s.condition,)),
    For: attrgetter("start", "stop"),
    **dict.fromkeys((Break, Continue), lambda s: ()),
}
_BLOCKS: Final[dict[type, Callable[[Any], tuple[tuple[Stmt, ...], ...]]]] = {
    If: attrgetter("then", "otherwise"),
    **dict.fromkeys((For, While), lambda s: (s.body,)),
}
assert set(_EXPRESSIONS) == set(get_args(Stmt)), "a statement without expressions"


def statements_in(body: tuple[Stmt, ...]) -> list[Stmt]:
    """Return every statement of a block and of the blocks inside it, in order."""
    found: list[Stmt] = []
    _append_statements(body, found)
    return found


def _append_statements(body: tuple[Stmt, ...], found: list[Stmt]) -> None:
    for stmt in body:
        found.append(stmt)
        if type(stmt) in _BLOCKS:
            for block in _BLOCKS[type(stmt)](stmt):
                _append_statements(block, found)


def expressions_in(body: tuple[Stmt, ...]) -> Sequence[Expr]:
    """Return every distinct expression node of a block, including the blocks inside it."""
    return _nodes_of_all(roots_in(body))


def roots_in(body: tuple[Stmt, ...]) -> Iterator[Expr]:
    """Yield the expressions directly in the statements of a block and of the blocks inside it."""
    for stmt in statements_in(body):
        yield from expressions(stmt)


def is_unchanging(e: Expr, variables: Collection[str]) -> bool:
    """Return whether a leaf node has the same value everywhere in a function.

    ``variables`` are the locals that an Assign may change.
    """
    if isinstance(e, Read):
        return e.name not in variables
    return isinstance(e, Const | Uniform | PerFrame | Resource)


def per_frame_reads(*roots: Expr) -> set[str]:
    """Return the names of the per-frame values that the expressions read."""
    return {name for e in roots for name in contents(e).frames}


def per_frame_reads_in(functions: Iterable[Function]) -> set[str]:
    """Return the names of the per-frame values that the functions read directly."""
    return {name for f in functions for e in roots_in(f.body) for name in contents(e).frames}


def names_read(body: tuple[Stmt, ...]) -> set[str]:
    """Return the parameters and locals that a block reads, including the blocks inside it."""
    return {name for e in roots_in(body) for name in contents(e).reads}


def map_statement(
    stmt: Stmt,
    expr: Callable[[Expr], Expr],
    block: Callable[[tuple[Stmt, ...]], tuple[Stmt, ...]],
) -> Stmt:
    """Return the statement with its expressions (also the target of an Assign) and blocks mapped.

    Args:
        stmt: The statement.
        expr: Maps each expression directly in the statement.
        block: Maps each block directly inside the statement.
    """
    span = stmt.span
    match stmt:
        case Let(name, value):
            mapped = expr(value)
            return stmt if mapped is value else Let(name, mapped, span=span)
        case Var(name, value):
            mapped = expr(value)
            return stmt if mapped is value else Var(name, mapped, span=span)
        case Return(value):
            mapped = expr(value)
            return stmt if mapped is value else Return(mapped, span=span)
        case Assign(target, value):
            return Assign(expr(target), expr(value), span=span)
        case If(condition, then, otherwise):
            return If(expr(condition), block(then), block(otherwise), span=span)
        case While(condition, body):
            return While(expr(condition), block(body), span=span)
        case For(name, start, stop, step, body):
            return For(name, expr(start), expr(stop), step, block(body), span=span)
        case Break() | Continue():
            return stmt
        case _:
            assert_never(stmt)


def map_expressions(body: tuple[Stmt, ...], expr: Callable[[Expr], Expr]) -> tuple[Stmt, ...]:
    """Return a block with the expressions of its statements mapped, including inner blocks."""
    return tuple(map_statement(s, expr, lambda inner: map_expressions(inner, expr)) for s in body)


def root_of(target: Expr) -> Read:
    """Return the Var that the target of an Assign belongs to."""
    while not isinstance(target, Read):
        assert isinstance(target, Swizzle | Index | Field)
        target = target.base
    return target


def map_indices(target: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """Map the indices in the target of an Assign; the rest of the target is kept."""
    match target:
        case Index(base, index):
            return rebuild(target, (map_indices(base, change), change(index)))
        case Swizzle(base) | Field(base):
            return rebuild(target, (map_indices(base, change),))
        case _:
            return target
