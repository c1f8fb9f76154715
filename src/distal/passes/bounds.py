"""Make the clamping of indices explicit where an index is not provably in range.

Input: a module whose every index is clamped in meaning. Output: the same, with ``min(max(i, 0), n -
1)`` in place of ``i`` unless its interval lies within 0 .. n - 1. Memory safety of compiled code
rests on this pass. Buffers, whose length is known when they are bound, stay with the backend.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from distal.ir.build import builtin, integer
from distal.ir.nodes import Const, Expr, For, Function, Index, Let, Module, Stmt
from distal.ir.types import INT, UINT, Type, index_count
from distal.ir.walk import expressions_in, map_statement, rewrite
from distal.passes.context import Context
from distal.passes.ranges import Ranges

# Prelude functions that bound their result, as (name, argument types): the intrinsic or operator.
_BOUNDING: Final[dict[tuple[str, tuple[Type, ...]], str]] = {
    ("integers.floor_remainder", (INT, INT)): "%",
    ("integers.floor_remainder", (UINT, UINT)): "%",
    ("choosing.clamped", (INT, INT, INT)): "clamp",
    ("choosing.clamped", (UINT, UINT, UINT)): "clamp",
}


def run(module: Module, context: Context) -> Module:
    """Clamp every index that needs it."""
    if not any(_indexes(f) for f in module.functions):
        return module
    meanings = _bounding_functions(module, context)
    functions = tuple(_IndexBounder(meanings).function(f) for f in module.functions)
    return replace(module, functions=functions)


def _indexes(function: Function) -> bool:
    return any(isinstance(e, Index) for e in expressions_in(function.body))


def _bounding_functions(module: Module, context: Context) -> dict[str, str]:
    """Which functions of the module are linked prelude functions that bound their result."""
    found: dict[str, str] = {}
    present = {f.name for f in module.functions}
    for (name, args), meaning in _BOUNDING.items():
        base = name.partition(".")[2]
        if not any(f.source_name.startswith(base) for f in module.functions):
            continue
        # Linking what is there adds nothing and returns its name; what it adds is not called.
        linked, function = context.library.link(module, name, args)
        if function in present and len(linked.functions) == len(module.functions):
            found[function] = meaning
    return found


class _IndexBounder:
    """One function, gone through in order so that every local is known where it is read."""

    def __init__(self, meanings: dict[str, str]) -> None:
        self._ranges = Ranges(meanings)
        self._memo: dict[Expr, Expr] = {}

    def function(self, function: Function) -> Function:
        return replace(function, body=self._block(function.body))

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        return tuple(self._statement(stmt) for stmt in body)

    def _statement(self, stmt: Stmt) -> Stmt:
        if isinstance(stmt, Let | For):
            self._ranges.enter(stmt)
        return map_statement(stmt, lambda e: rewrite(e, self._clamped, self._memo), self._block)

    def _clamped(self, e: Expr) -> Expr:
        if not isinstance(e, Index):
            return e
        count = index_count(e.base.type)
        if count is None:
            return e
        low, high = self._ranges.of(e.index)
        if low >= 0 and high < count:
            return e
        index = e.index
        if isinstance(index, Const):
            index = integer(min(max(int(index.value), 0), count - 1))
        else:
            index = index if low >= 0 else builtin("max", index, integer(0))
            index = index if high < count else builtin("min", index, integer(count - 1))
        return Index(e.base, index, e.type, span=e.span)
