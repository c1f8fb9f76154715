"""Pieces of C-like text with their precedence, joined with as few brackets as possible.

Input: texts of operands. Output: texts of operations. GLSL and WGSL require brackets in different
places; the output is valid in both. Does not depend on the IR.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from distal.diagnostics import Span


class Precedence(IntEnum):
    """The precedence of a text's outermost operator, the loosest first."""

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
    """An expression's text, and the precedence and symbol of its outermost operator."""

    text: str
    level: Precedence = Precedence.PRIMARY
    op: str = ""


class Line(NamedTuple):
    """One line of output, and the place in the author's code that it comes from."""

    text: str
    span: Span | None = None


def _needs_brackets(operand: Code, level: Precedence, op: str, *, right: bool) -> bool:
    """Return whether an operand of an infix operator needs brackets, by WGSL's stricter grammar."""
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
    # Operands of bit operators: only a chain of the same operator needs no brackets.
    return not (level is Precedence.BITS and operand.op == op and not right)


def literal_code(text: str) -> Code:
    """Return a literal as code; its text may have a sign or be a difference."""
    if " " in text:
        return Code(text, Precedence.SUM)
    return Code(text, Precedence.UNARY if text.startswith("-") else Precedence.PRIMARY)


def infix(op: str, level: Precedence, lhs: Code, rhs: Code) -> Code:
    """Return ``lhs op rhs``.

    Args:
        op: The operator's symbol.
        level: The operator's precedence.
        lhs: The left operand.
        rhs: The right operand.
    """
    left, right = (
        f"({side.text})" if _needs_brackets(side, level, op, right=at_right) else side.text
        for side, at_right in ((lhs, False), (rhs, True))
    )
    return Code(f"{left} {op} {right}", level, op)


def tight(code: Code) -> str:
    """Return the text as an operand of ``.``, ``[]`` or a sign, in brackets if needed."""
    return code.text if code.level is Precedence.PRIMARY else f"({code.text})"


def prefix(op: str, operand: Code) -> Code:
    """Return ``op operand``."""
    return Code(f"{op}{tight(operand)}", Precedence.UNARY)
