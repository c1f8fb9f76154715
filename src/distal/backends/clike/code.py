"""Pieces of C-like text that know how tightly they bind, and are joined with few brackets.

Input: texts of operands. Output: texts of operations. GLSL and WGSL disagree on where brackets are
needed; these suit both. It knows nothing of the IR.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from distal.diagnostics import Span


class Precedence(IntEnum):
    """How tightly the outermost operator of a text binds."""

    TERNARY = 0
    OR = 1
    AND = 2
    BITS = 3
    RELATION = 4
    SHIFT = 5
    SUM = 6
    PRODUCT = 7
    UNARY = 8
    PRIMARY = 9


class Code(NamedTuple):
    """An expression's text, and its outermost operator."""

    text: str
    level: Precedence = Precedence.PRIMARY
    op: str = ""


class Line(NamedTuple):
    """One line of output and the author's place it comes from."""

    text: str
    span: Span | None = None


def _needs_brackets(operand: Code, level: Precedence, op: str, *, right: bool) -> bool:
    """Whether an operand of an infix operator is bracketed: WGSL's grammar, the stricter one."""
    inner = operand.level
    if inner is Precedence.PRIMARY:
        return False
    if inner is Precedence.UNARY:
        return right and level is not Precedence.RELATION and operand.text.startswith("-")
    if inner is Precedence.TERNARY:
        return True
    if level in (Precedence.SUM, Precedence.PRODUCT):
        return inner < level or (right and inner is level)
    if level is Precedence.RELATION:
        return inner not in (Precedence.SUM, Precedence.PRODUCT)
    if level in (Precedence.AND, Precedence.OR):
        return (
            inner in (Precedence.AND, Precedence.OR, Precedence.BITS, Precedence.SHIFT)
            and inner is not level
        )
    # Operands of bit operators: only a chain of the very same operator stands without.
    return not (level is Precedence.BITS and operand.op == op and not right)


def literal_code(text: str) -> Code:
    """A literal, which may have a sign, or be a difference."""
    if " " in text:
        return Code(text, Precedence.SUM)
    return Code(text, Precedence.UNARY if text.startswith("-") else Precedence.PRIMARY)


def infix(op: str, level: Precedence, lhs: Code, rhs: Code) -> Code:
    """``lhs op rhs``."""
    left, right = (
        f"({side.text})" if _needs_brackets(side, level, op, right=at_right) else side.text
        for side, at_right in ((lhs, False), (rhs, True))
    )
    return Code(f"{left} {op} {right}", level, op)


def tight(code: Code) -> str:
    """The text as an operand of the tightest operators: dots, indices, signs."""
    return code.text if code.level is Precedence.PRIMARY else f"({code.text})"


def prefix(op: str, operand: Code) -> Code:
    """``op operand``."""
    return Code(f"{op}{tight(operand)}", Precedence.UNARY)
