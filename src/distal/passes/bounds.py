"""Make the clamping of indices explicit where an index is not provably in range.

Input: a module in which every index is implicitly clamped. Output: the same module with
``min(max(i, 0), n - 1)`` instead of ``i`` unless the interval of ``i`` lies within 0 .. n - 1. The
memory safety of compiled code depends on this pass. Indices of buffers, whose length is known only
when data is bound to them, are clamped by the backend.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from distal.ir.build import builtin, integer
from distal.ir.contents import contents
from distal.ir.nodes import Const, Expr, For, Function, Index, Let, Module, Stmt
from distal.ir.types import INT, UINT, Type, index_count
from distal.ir.walk import map_statement, rewrite, roots_in
from distal.passes.context import Context
from distal.passes.ranges import Ranges

# Prelude functions with a bounded result, (name, argument types) -> the intrinsic or operator.
_BOUNDING: Final[dict[tuple[str, tuple[Type, ...]], str]] = {
    ("integers.floor_remainder", (INT, INT)): "%",
    ("integers.floor_remainder", (UINT, UINT)): "%",
    ("choosing.clamped", (INT, INT, INT)): "clamp",
    ("choosing.clamped", (UINT, UINT, UINT)): "clamp",
}


def run(module: Module, context: Context) -> Module:
    """Clamp every index that is not provably in range."""
    indexing = {f.name for f in module.functions if any(map(_indexes, roots_in(f.body)))}
    if not indexing:
        return module
    meanings = _bounding_functions(module, context)
    functions = tuple(
        _IndexBounder(meanings).function(f) if f.name in indexing else f for f in module.functions
    )
    return replace(module, functions=functions)


def _indexes(e: Expr) -> bool:
    return Index in contents(e).kinds


def _bounding_functions(module: Module, context: Context) -> dict[str, str]:
    """Return the module's functions that are linked from ``_BOUNDING``, with their operations."""
    found: dict[str, str] = {}
    present = {f.name for f in module.functions}
    for (name, args), meaning in _BOUNDING.items():
        base = name.partition(".")[2]
        if not any(f.source_name.startswith(base) for f in module.functions):
            continue
        # Linking a function that is present adds nothing and returns its name; otherwise the module
        # does not call it.
        linked, function = context.library.link(module, name, args)
        if function in present and len(linked.functions) == len(module.functions):
            found[function] = meaning
    return found


class _IndexBounder:
    """Bounds the indices of one function, visiting each local before its reads."""

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
        return map_statement(stmt, self._bounded, self._block)

    def _bounded(self, e: Expr) -> Expr:
        return rewrite(e, self._clamped, self._memo) if _indexes(e) else e

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
