"""Traverse and transform expressions and statements without a case for every node class.

``children`` and ``rebuild`` are the only functions that know the operands of every node class;
passes that treat most nodes alike use them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from typing import Any, Final, assert_never, get_args

from distal.ir.nodes import (
    Apply,
    Assign,
    Binary,
    Break,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    Function,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    Var,
    While,
)


def _none(e: Any) -> tuple[Expr, ...]:
    return ()


def _both_sides(e: Any) -> tuple[Expr, ...]:
    return (e.lhs, e.rhs)


# A table instead of a match statement: passes look this up many times for every node, and testing
# one class after another took a third of their time.
_OPERANDS: Final[dict[type, Callable[[Any], tuple[Expr, ...]]]] = {
    **dict.fromkeys((Const, Read, Uniform, PerFrame, Resource), _none),
    **dict.fromkeys((Binary, Compare, Logical, MatMul), _both_sides),
    FunctionRef: lambda e: tuple(e.captures),
    Unary: lambda e: (e.operand,),
    Select: lambda e: (e.condition, e.yes, e.no),
    Splat: lambda e: (e.value,),
    Cast: lambda e: (e.value,),
    Compose: lambda e: tuple(e.parts),
    Construct: lambda e: tuple(e.parts),
    Swizzle: lambda e: (e.base,),
    Field: lambda e: (e.base,),
    Index: lambda e: (e.base, e.index),
    Builtin: lambda e: tuple(e.args),
    Call: lambda e: tuple(e.args),
    Apply: lambda e: (e.function, *e.args),
    Gradient: lambda e: (e.function, e.point),
    Sample: lambda e: (e.texture, e.coord),
    Texel: lambda e: (e.texture, e.index),
    Size: lambda e: (e.resource,),
}
assert set(_OPERANDS) == set(get_args(Expr)), "a node without operands"


def children(e: Expr) -> tuple[Expr, ...]:
    """Return the operands of an expression, left to right."""
    return _OPERANDS[type(e)](e)


def rebuild(e: Expr, operands: tuple[Expr, ...]) -> Expr:
    """Return ``e`` with other operands of the same types; ``e`` itself when they are unchanged."""
    if operands == children(e):
        return e
    span = e.span
    match e:
        case Const() | Read() | Uniform() | PerFrame() | Resource():
            return e
        case FunctionRef(name, _, type):
            return FunctionRef(name, operands, type, span=span)
        case Unary(op, _, type):
            return Unary(op, operands[0], type, span=span)
        case Binary(op, _, _, type):
            return Binary(op, operands[0], operands[1], type, span=span)
        case Compare(op, _, _, type):
            return Compare(op, operands[0], operands[1], type, span=span)
        case Logical(op, _, _, type):
            return Logical(op, operands[0], operands[1], type, span=span)
        case MatMul(_, _, type):
            return MatMul(operands[0], operands[1], type, span=span)
        case Select(_, _, _, type):
            return Select(operands[0], operands[1], operands[2], type, span=span)
        case Splat(_, type):
            return Splat(operands[0], type, span=span)
        case Cast(_, type):
            return Cast(operands[0], type, span=span)
        case Compose(_, type):
            return Compose(operands, type, span=span)
        case Construct(_, type):
            return Construct(operands, type, span=span)
        case Swizzle(_, lanes, type):
            return Swizzle(operands[0], lanes, type, span=span)
        case Field(_, name, type):
            return Field(operands[0], name, type, span=span)
        case Index(_, _, type):
            return Index(operands[0], operands[1], type, span=span)
        case Builtin(name, _, type):
            return Builtin(name, operands, type, span=span)
        case Call(name, _, type):
            return Call(name, operands, type, span=span)
        case Apply(_, _, type):
            return Apply(operands[0], operands[1:], type, span=span)
        case Gradient(_, _, with_value, type):
            return Gradient(operands[0], operands[1], with_value, type, span=span)
        case Sample(_, _, type):
            return Sample(operands[0], operands[1], type, span=span)
        case Texel(_, _, type):
            return Texel(operands[0], operands[1], type, span=span)
        case Size(_, type):
            return Size(operands[0], type, span=span)
        case _:
            assert_never(e)


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


def nodes_in(*roots: Expr) -> Iterator[Expr]:
    """Yield every distinct node of the expressions, including ``roots``; operands before users."""
    return _unseen(roots, set())


def _unseen(roots: tuple[Expr, ...], seen: set[Expr]) -> Iterator[Expr]:
    """Yield the nodes of expressions that are not in ``seen``, and add them to it."""
    # A node is pushed again inside a one-element tuple; it is yielded when the tuple is popped,
    # after its operands.
    stack: list[Any] = list(reversed(roots))
    while stack:
        e = stack.pop()
        if type(e) is tuple:
            yield e[0]
        elif e not in seen:
            seen.add(e)
            operands = _OPERANDS[type(e)](e)
            if operands:
                stack.append((e,))
                stack.extend(operands[::-1])
            else:
                yield e


def expressions(stmt: Stmt) -> tuple[Expr, ...]:
    """Return the expressions directly in a statement (including the target of an Assign)."""
    match stmt:
        case Let(_, value) | Var(_, value) | Return(value):
            return (value,)
        case Assign(target, value):
            return (target, value)
        case If(condition) | While(condition):
            return (condition,)
        case For(_, start, stop):
            return (start, stop)
        case Break() | Continue():
            return ()
        case _:
            assert_never(stmt)


def blocks(stmt: Stmt) -> tuple[tuple[Stmt, ...], ...]:
    """Return the blocks directly inside a statement."""
    match stmt:
        case If(_, then, otherwise):
            return (then, otherwise)
        case For(_, _, _, _, body) | While(_, body):
            return (body,)
        case Let() | Var() | Assign() | Break() | Continue() | Return():
            return ()
        case _:
            assert_never(stmt)


def statements_in(body: tuple[Stmt, ...]) -> Iterator[Stmt]:
    """Yield every statement of a block and of the blocks inside it, in order."""
    for stmt in body:
        yield stmt
        for block in blocks(stmt):
            yield from statements_in(block)


def expressions_in(body: tuple[Stmt, ...]) -> Iterator[Expr]:
    """Yield every distinct expression node of a block, including the blocks inside it."""
    seen: set[Expr] = set()
    for stmt in statements_in(body):
        yield from _unseen(expressions(stmt), seen)


def is_unchanging(e: Expr, variables: Collection[str]) -> bool:
    """Return whether a leaf node has the same value everywhere in a function.

    ``variables`` are the locals that an Assign may change.
    """
    if isinstance(e, Read):
        return e.name not in variables
    return isinstance(e, Const | Uniform | PerFrame | Resource)


def per_frame_reads(*roots: Expr) -> set[str]:
    """Return the names of the per-frame values that the expressions read."""
    return {e.name for e in nodes_in(*roots) if isinstance(e, PerFrame)}


def per_frame_reads_in(functions: Iterable[Function]) -> set[str]:
    """Return the names of the per-frame values that the functions read directly."""
    found = set()
    for function in functions:
        found |= {e.name for e in expressions_in(function.body) if isinstance(e, PerFrame)}
    return found


def names_read(body: tuple[Stmt, ...]) -> set[str]:
    """Return the parameters and locals that a block reads, including the blocks inside it."""
    return {e.name for e in expressions_in(body) if isinstance(e, Read)}


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
            return Let(name, expr(value), span=span)
        case Var(name, value):
            return Var(name, expr(value), span=span)
        case Return(value):
            return Return(expr(value), span=span)
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
