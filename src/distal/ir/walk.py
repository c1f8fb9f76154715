"""Going through expressions and statements without naming every node.

``children`` and ``rebuild`` are the only functions that know every node's operands; passes that
treat most nodes alike use them.
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


# A table, not a match: passes need this of every node many times, and trying one class after the
# other took a third of their time.
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
    """The operands of an expression, left to right."""
    return _OPERANDS[type(e)](e)


def rebuild(e: Expr, operands: tuple[Expr, ...]) -> Expr:
    """The same expression with other operands of the same types; ``e`` itself when unchanged."""
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
    """Rewrite bottom up: ``change`` sees each node once, its operands already rewritten."""
    done = memo.get(e)
    if done is None:
        operands = tuple(rewrite(c, change, memo) for c in children(e))
        done = change(rebuild(e, operands))
        memo[e] = done
    return done


def substitute(e: Expr, replacements: dict[Expr, Expr], memo: dict[Expr, Expr]) -> Expr:
    """Replace whole nodes, such as Reads, by other expressions; top down, each once."""
    done = memo.get(e)
    if done is None:
        done = replacements.get(e)
        if done is None:
            done = rebuild(e, tuple(substitute(c, replacements, memo) for c in children(e)))
        memo[e] = done
    return done


def nodes_in(*roots: Expr) -> Iterator[Expr]:
    """Every distinct node below and including ``roots``, operands before users."""
    seen: set[Expr] = set()
    # A node in a tuple of its own comes by for the second time, its operands are done.
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
    """The expressions directly in a statement (an Assign's target included)."""
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
    """The blocks inside a statement."""
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
    """Every statement of a block and of the blocks inside it, in order."""
    for stmt in body:
        yield stmt
        for block in blocks(stmt):
            yield from statements_in(block)


def expressions_in(body: tuple[Stmt, ...]) -> Iterator[Expr]:
    """Every distinct expression node of a block, blocks inside it included."""
    seen: set[Expr] = set()
    for stmt in statements_in(body):
        for e in nodes_in(*expressions(stmt)):
            if e not in seen:
                seen.add(e)
                yield e


def is_unchanging(e: Expr, variables: Collection[str]) -> bool:
    """True for a leaf that means the same everywhere in a function.

    ``variables`` are the locals that an Assign may change.
    """
    if isinstance(e, Read):
        return e.name not in variables
    return isinstance(e, Const | Uniform | PerFrame | Resource)


def per_frame_reads(*roots: Expr) -> set[str]:
    """The names of the per-frame values that expressions read."""
    return {e.name for e in nodes_in(*roots) if isinstance(e, PerFrame)}


def per_frame_reads_in(functions: Iterable[Function]) -> set[str]:
    """The names of the per-frame values that functions read themselves."""
    found = set()
    for function in functions:
        found |= {e.name for e in expressions_in(function.body) if isinstance(e, PerFrame)}
    return found


def names_read(body: tuple[Stmt, ...]) -> set[str]:
    """The parameters and locals that a block reads, blocks inside it included."""
    return {e.name for e in expressions_in(body) if isinstance(e, Read)}


def map_statement(
    stmt: Stmt,
    expr: Callable[[Expr], Expr],
    block: Callable[[tuple[Stmt, ...]], tuple[Stmt, ...]],
) -> Stmt:
    """The statement with its expressions and its blocks mapped (targets of Assign too)."""
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
    """A block with the expressions of its statements mapped, inner blocks included."""
    return tuple(map_statement(s, expr, lambda inner: map_expressions(inner, expr)) for s in body)


def root_of(target: Expr) -> Read:
    """The Var that an Assign's target is a part of."""
    while not isinstance(target, Read):
        assert isinstance(target, Swizzle | Index | Field)
        target = target.base
    return target


def map_indices(target: Expr, change: Callable[[Expr], Expr]) -> Expr:
    """An Assign's target with its indices mapped: the Var itself is written, not computed."""
    match target:
        case Index(base, index):
            return rebuild(target, (map_indices(base, change), change(index)))
        case Swizzle(base) | Field(base):
            return rebuild(target, (map_indices(base, change),))
        case _:
            return target
