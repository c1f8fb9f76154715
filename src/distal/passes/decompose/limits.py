"""Reject what a target cannot express at all, and give loops the form that it requires.

Input: a node or statement, the target, and the author's operation to name in an error. Output:
nothing, or a CompileError that names the target and the fix. Inside a prelude function the error
names the author's operation that needs the function.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.ir.build import compare, integer
from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Break,
    Builtin,
    CompareOp,
    Continue,
    Expr,
    For,
    If,
    Let,
    Read,
    Size,
    Stmt,
    Texel,
    Unary,
    UnaryOp,
    While,
)
from distal.ir.target import Target
from distal.ir.types import INT, Array, Buffer, Kind, Struct, Type, kind_of
from distal.lang.source_places import is_library
from distal.passes.naming import FreshNames
from distal.passes.ranges import Ranges

_BIT_ROWS: Final = frozenset(
    ("float_bits_to_int", "float_bits_to_uint", "int_bits_to_float", "uint_bits_to_float")
)
_BIT_OPS: Final = frozenset((BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR, BinaryOp.SHL, BinaryOp.SHR))
# A longer loop is rejected if its actual length is known only at run time.
_LONGEST_CLAMPED_LOOP: Final = 65536

_OTHER_TARGET: Final = "compile for another target, such as glsl-es300"


@dataclass(frozen=True, slots=True)
class Blame:
    """A place, the name of the operation there if useful, and the function that it is in."""

    span: Span | None
    what: str
    function: str = ""


def _refusal(target: Target, lacks: str, blame: Blame, hint: str) -> CompileError:
    span = blame.span
    if span is not None and is_library(span.file):
        # The author did not write that line, and cannot change it; ``run`` finds one that needs it.
        needs = ", which the library needs here"
        return CompileError.at(
            ErrorCode.TARGET, f"{target.name} has no {lacks}{needs}", None, _OTHER_TARGET
        )
    needs = f", which '{blame.what}' needs" if blame.what else ""
    return CompileError.at(
        ErrorCode.TARGET, f"{target.name} has no {lacks}{needs}", blame.span, hint
    )


def refuse_expression(e: Expr, target: Target, blame: Blame) -> None:
    """Check that the target has the operation and the type of ``e``.

    Args:
        e: The expression.
        target: The target to compile for.
        blame: The place to report.

    Raises:
        CompileError: The target lacks the operation or the type.
    """
    if not target.unsigned:
        _refuse_bits(e, target, blame)
    if not target.texel_fetch and isinstance(e, Texel | Size):
        if isinstance(e, Size) and isinstance(e.resource.type, Buffer):
            return
        what = "single texels" if isinstance(e, Texel) else "texture sizes"
        raise _refusal(target, what, blame, f"use sample, or {_OTHER_TARGET}")


def _refuse_bits(e: Expr, target: Target, blame: Blame) -> None:
    if _has_uint(e.type):
        raise _refusal(target, "unsigned integers", blame, f"use int, or {_OTHER_TARGET}")
    bits = (
        (isinstance(e, Binary) and e.op in _BIT_OPS and kind_of(e.type) is not Kind.BOOL)
        or (isinstance(e, Unary) and e.op is UnaryOp.INVERT)
        or (isinstance(e, Builtin) and e.name in _BIT_ROWS)
    )
    if bits:
        raise _refusal(target, "bit operations", blame, _OTHER_TARGET)


def _has_uint(type: Type) -> bool:
    match type:
        case Struct(_, fields):
            return any(_has_uint(t) for _, t in fields)
        case Array(element) | Buffer(element):
            return _has_uint(element)
        case _:
            return kind_of(type) is Kind.UINT


def refuse_statement(stmt: Stmt, target: Target, blame: Blame) -> None:
    """Check that the target has the statement.

    Args:
        stmt: The statement.
        target: The target to compile for.
        blame: The place to report.

    Raises:
        CompileError: The target lacks the statement.
    """
    if isinstance(stmt, While) and not target.dynamic_loops:
        raise CompileError.at(
            ErrorCode.TARGET,
            f"{target.name} has no while loops",
            blame.span,
            "for i in range(N): with 'if not ...: break' as the first line",
        )


def constant_loop(
    loop: For, ranges: Ranges, names: FreshNames, target: Target, blame: Blame, before: list[Stmt]
) -> For:
    """Return the loop with constant bounds.

    A bound that is not constant is replaced by the constant limit of its range, and the loop then
    breaks early or skips the first iterations.

    Args:
        loop: The loop.
        ranges: The ranges of the function's locals.
        names: The taken names.
        target: The target to compile for.
        blame: The place to report.
        before: Gets the statements to insert before the loop.

    Raises:
        CompileError: No constant limit is known for a bound, or the loop would be too long.
    """
    start, stop = ranges.constant(loop.start), ranges.constant(loop.stop)
    if start is not None and stop is not None:
        return replace(loop, start=integer(start), stop=integer(stop))
    up = loop.step > 0
    first = ranges.of(loop.start)[0 if up else 1]
    last = ranges.of(loop.stop)[1 if up else 0]
    steppable = start is not None or abs(loop.step) == 1
    if not steppable or abs(last - first) > _LONGEST_CLAMPED_LOOP:
        raise CompileError.at(
            ErrorCode.TARGET,
            f"{target.name} needs loop bounds that are known when compiling",
            blame.span,
            "range(min(n, 64)) with a constant, or for i in range(64): if i >= n: break",
        )
    i = Read(loop.name, INT)
    guards: list[Stmt] = []
    if start is None:
        bound = _bound_before(f"{loop.name}_start", loop.start, loop, names, before)
        early = compare(CompareOp.LT if up else CompareOp.GT, i, bound)
        guards.append(If(early, (Continue(span=loop.span),), (), span=loop.span))
    if stop is None:
        bound = _bound_before(f"{loop.name}_stop", loop.stop, loop, names, before)
        late = compare(CompareOp.GE if up else CompareOp.LE, i, bound)
        guards.append(If(late, (Break(span=loop.span),), (), span=loop.span))
    body = (*guards, *loop.body)
    return replace(loop, start=integer(first), stop=integer(last), body=body)


def _bound_before(name: str, value: Expr, loop: For, names: FreshNames, before: list[Stmt]) -> Expr:
    """Bind a loop bound before the loop, and return a read of it."""
    fresh = names.fresh(name)
    before.append(Let(fresh, value, span=loop.span))
    return Read(fresh, INT)
