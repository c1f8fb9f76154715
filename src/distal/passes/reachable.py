"""Remove the functions and per-frame values that a module's entry does not need.

Input: a module. Output: the same module without functions that nothing calls and without per-frame
values that nothing reads.
"""

from __future__ import annotations

from dataclasses import replace

from distal.ir.contents import contents
from distal.ir.nodes import Expr, Function, Module
from distal.ir.walk import per_frame_reads, per_frame_reads_in, roots_in


def called_in(*roots: Expr) -> set[str]:
    """Return the functions that expressions call or refer to."""
    return {name for e in roots for name in contents(e).callees}


def callees(function: Function) -> set[str]:
    """Return the functions that a function calls or refers to directly."""
    return called_in(*roots_in(function.body))


def closure(functions: tuple[Function, ...], roots: set[str]) -> set[str]:
    """Return ``roots`` and everything they call; callees must precede callers in ``functions``."""
    found = set(roots)
    for function in reversed(functions):
        if function.name in found:
            found |= callees(function)
    return found


def drop_unused(module: Module) -> Module:
    """Return the module without functions and per-frame values that the entry does not reach."""
    called, read = _reached(module)
    if len(called) == len(module.functions) and len(read) == len(module.frame):
        return module
    functions = tuple(f for f in module.functions if f.name in called)
    frame = tuple((name, value) for name, value in module.frame if name in read)
    return replace(module, functions=functions, frame=frame)


def _reached(module: Module) -> tuple[set[str], set[str]]:
    """Return the functions that are called and the per-frame values that are read, transitively."""
    values = dict(module.frame)
    called, read = closure(module.functions, {module.entry}), set[str]()
    new_functions, new_values = called, read
    while True:
        functions = (f for f in module.functions if f.name in new_functions)
        found = per_frame_reads(*(values[name] for name in new_values))
        new_values = (found | per_frame_reads_in(functions)) - read
        if not new_values:
            return called, read
        read = read | new_values
        new_functions = closure(module.functions, called_in(*(values[n] for n in new_values)))
        new_functions -= called
        called = called | new_functions
