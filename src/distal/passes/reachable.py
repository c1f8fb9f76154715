"""Which functions a module's entry and its per-frame part still call.

What flows in: a module. What flows out: the same without functions that nothing calls.
"""

from __future__ import annotations

from dataclasses import replace

from distal.ir.nodes import Call, Expr, Function, FunctionRef, Module
from distal.ir.walk import expressions_in, nodes_in


def called_in(*roots: Expr) -> set[str]:
    """The functions that expressions call or mention."""
    return {
        e.function if isinstance(e, Call) else e.name
        for e in nodes_in(*roots)
        if isinstance(e, Call | FunctionRef)
    }


def callees(function: Function) -> set[str]:
    """The functions that a function calls directly."""
    return {
        e.function if isinstance(e, Call) else e.name
        for e in expressions_in(function.body)
        if isinstance(e, Call | FunctionRef)
    }


def closure(functions: tuple[Function, ...], roots: set[str]) -> set[str]:
    """``roots`` and everything they call; callees stand first in ``functions``."""
    found = set(roots)
    for function in reversed(functions):
        if function.name in found:
            found |= callees(function)
    return found


def drop_unused(module: Module) -> Module:
    """The module without functions that neither the entry nor the per-frame part reaches."""
    roots = {module.entry} | called_in(*(value for _, value in module.frame))
    found = closure(module.functions, roots)
    if len(found) == len(module.functions):
        return module
    return replace(module, functions=tuple(f for f in module.functions if f.name in found))
