"""How much work an expression or a block is, roughly in vector instructions.

Decides whether code under a condition is worth a branch around it.
"""

from __future__ import annotations

from distal.ir.nodes import (
    Binary,
    BinaryOp,
    Builtin,
    Call,
    Compare,
    Const,
    Expr,
    For,
    Function,
    Index,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    While,
)
from distal.ir.types import component_count, is_static, kind_of
from distal.ir.walk import blocks, children, expressions, nodes_in

_DIVISION = 8  # also of a square root: vector dividers take about eight multiplications' time
_HEAVY = frozenset(("sqrt", "inversesqrt", "length"))


class Costs:
    """Costs within one module; a call costs what its function costs, a loop counts as endless."""

    LOOP = 1000

    def __init__(self, functions: tuple[Function, ...]) -> None:
        self._functions: dict[str, int] = {}
        for function in functions:
            self._functions[function.name] = 20 + self.block(function.body)

    def expression(self, *roots: Expr) -> int:
        """The cost of expressions, what they share counted once."""
        return sum(self._node(e) for e in nodes_in(*roots))

    def block(self, block: tuple[Stmt, ...]) -> int:
        """The cost of running every statement of a block once."""
        total = 0
        for stmt in block:
            total += self.expression(*expressions(stmt))
            total += sum(map(self.block, blocks(stmt)))
            if isinstance(stmt, For | While):
                total += self.LOOP
        return total

    def _node(self, e: Expr) -> int:
        match e:
            case Const() | Read() | Uniform() | PerFrame() | Resource() | Swizzle():
                return 0
            case Call(function):
                return self._functions[function]
            case Texel() | Sample():
                return 30
            case Binary(op) if op in (BinaryOp.DIV, BinaryOp.FLOOR_DIV, BinaryOp.MOD):
                return _DIVISION * _width(e)
            case Builtin(name):
                return (_DIVISION if name in _HEAVY else 1) * max(map(_width, children(e)))
            case MatMul():
                return 16
            case Index(base):
                return 1 if is_static(base.type) else 4
            case Binary() | Unary() | Compare() | Logical() | Select():
                return _width(e)
            case _:
                return 0


def _width(e: Expr) -> int:
    return component_count(e.type) if kind_of(e.type) else 4
