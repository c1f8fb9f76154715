"""Assemble the module after its per-frame work was removed from the pixel code.

Input: the module before, its rewritten pixel functions and the per-frame values that they read.
Output: the module after, simplified: parameters that nothing reads are removed, per-frame values
have their final names, and values that are not transferred are computed where they are read.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from distal.ir.contents import contents
from distal.ir.nodes import Call, Expr, Function, Let, Module, PerFrame, Read, Stmt
from distal.ir.walk import (
    map_expressions,
    map_statement,
    names_read,
    per_frame_reads,
    per_frame_reads_in,
    rewrite,
    roots_in,
    substitute,
)
from distal.passes.fold.fold import fold_function
from distal.passes.naming import FreshNames, local_names, module_names
from distal.passes.per_frame.values import FrameValues
from distal.passes.reachable import called_in, callees, closure, drop_unused


def finished(
    before: Module,
    pixels: tuple[Function, ...],
    frame_values: FrameValues,
    limit: int | None,
    precision: int,
) -> Module:
    """Return the finished module.

    Args:
        before: The module before the pass.
        pixels: The rewritten functions that pixels run.
        frame_values: The per-frame values.
        limit: The largest number of components that the target can transfer; None: no limit.
        precision: The bits of a float, 32 or 64.
    """
    pixels = _without_unread_params(before.entry, pixels, precision)
    wanted = per_frame_reads_in(pixels)
    chosen = frame_values.chosen(wanted, limit)
    entries = frame_values.entries(wanted)
    values = {name: value for name, _, value in entries}
    renamed, frame_functions = _frame_functions(before, pixels, values, precision)
    values = {name: _with_callees(value, renamed) for name, value in values.items()}
    pixels = tuple(_with_steps(f, values, chosen) for f in pixels)
    placed = {f.name for f in frame_functions}
    needed = _needed(chosen, values, frozenset())
    module = replace(
        before,
        functions=(*frame_functions, *(f for f in pixels if f.name not in placed)),
        frame=tuple((name, value) for name, value in values.items() if name in needed),
    )
    return _named(drop_unused(module), {name: hint for name, hint, _ in entries})


def _without_unread_params(
    entry: str, functions: tuple[Function, ...], precision: int
) -> tuple[Function, ...]:
    """Fold each function, and remove unread parameters and the arguments passed to them."""
    kept: dict[str, list[int]] = {}
    shortened: set[str] = set()
    result: list[Function] = []
    memo: dict[Expr, Expr] = {}

    def shorter(e: Expr) -> Expr:
        if not isinstance(e, Call) or len(kept[e.function]) == len(e.args):
            return e
        args = tuple(e.args[i] for i in kept[e.function])
        return Call(e.function, args, e.type, span=e.span)

    for function in functions:
        called = {name for e in roots_in(function.body) for name in contents(e).callees}
        if not called.isdisjoint(shortened):
            body = map_expressions(function.body, lambda e: rewrite(e, shorter, memo))
            function = replace(function, body=body)
        function = fold_function(function, precision)
        read = names_read(function.body)
        kept[function.name] = [
            i
            for i, param in enumerate(function.params)
            if param.name in read or function.name == entry
        ]
        if len(kept[function.name]) < len(function.params):
            shortened.add(function.name)
            params = tuple(function.params[i] for i in kept[function.name])
            function = replace(function, params=params)
        result.append(function)
    return tuple(result)


def _frame_functions(
    before: Module, pixels: tuple[Function, ...], values: Mapping[str, Expr], precision: int
) -> tuple[dict[str, str], list[Function]]:
    """Return the functions that per-frame values call, and the new names of some of them.

    A function that pixels run in changed form gets a new name: its pixel version may have fewer
    parameters, read per-frame values that are not computed yet, or contain a constant that pixels
    pass at every call, and the frame does not.
    """
    needed = closure(before.functions, called_in(*values.values()))
    pixel = {f.name: f for f in pixels}
    names = FreshNames(module_names(before))
    renamed: dict[str, str] = {}
    result: list[Function] = []
    for function in before.functions:
        if function.name not in needed:
            continue
        twin = pixel.get(function.name)
        if twin is not None and twin.params == function.params:
            is_same = twin.body == fold_function(function, precision).body
            if is_same and not callees(function) & renamed.keys():
                result.append(twin)
                continue
        if twin is not None:
            renamed[function.name] = names.fresh(f"{function.name}_per_frame")
        body = map_expressions(function.body, lambda e: _with_callees(e, renamed))
        name = renamed.get(function.name, function.name)
        result.append(replace(function, name=name, body=body))
    return renamed, result


def _with_callees(e: Expr, renamed: Mapping[str, str]) -> Expr:
    def change(n: Expr) -> Expr:
        if isinstance(n, Call) and n.function in renamed:
            return Call(renamed[n.function], n.args, n.type, span=n.span)
        return n

    return rewrite(e, change, {}) if renamed else e


def _needed(roots: set[str], values: Mapping[str, Expr], given: frozenset[str]) -> set[str]:
    """Return ``roots`` and the values that they depend on, except the given values.

    The dependencies of given values are not followed.
    """
    found: set[str] = set()
    stack = list(roots)
    while stack:
        name = stack.pop()
        if name not in found and name not in given:
            found.add(name)
            stack.extend(per_frame_reads(values[name]))
    return found


def _with_steps(function: Function, values: Mapping[str, Expr], chosen: set[str]) -> Function:
    """Return the function with values that are not transferred computed at its start."""
    rest = per_frame_reads_in((function,)) - chosen
    if not rest:
        return function
    needed = _needed(rest, values, frozenset(chosen))
    local: dict[Expr, Expr] = {}
    steps: list[Stmt] = []
    for name, value in values.items():
        if name in needed:
            steps.append(Let(name, substitute(value, local, {}), span=function.span))
            local[PerFrame(name, value.type)] = Read(name, value.type)
    memo: dict[Expr, Expr] = {}
    body = map_expressions(function.body, lambda e: substitute(e, local, memo))
    return replace(function, body=(*steps, *body))


def _named(module: Module, hints: Mapping[str, str | None]) -> Module:
    """Replace temporary names by final ones: the author's if there is one and it is free."""
    names = FreshNames(
        {*module_names(module), *(n for f in module.functions for n in local_names(f))}
    )
    final: dict[str, str] = {}
    for mark, hint in hints.items():
        final[mark] = names.fresh(hint) if hint else names.numbered("frame")
    memo: dict[Expr, Expr] = {}

    def change(e: Expr) -> Expr:
        if isinstance(e, PerFrame):
            return PerFrame(final[e.name], e.type)
        if isinstance(e, Read) and e.name in final:
            return Read(final[e.name], e.type)
        return e

    def statement(stmt: Stmt) -> Stmt:
        if isinstance(stmt, Let) and stmt.name in final:
            value = rewrite(stmt.value, change, memo)
            return Let(final[stmt.name], value, span=stmt.span)
        return map_statement(stmt, lambda e: rewrite(e, change, memo), block)

    def block(body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        return tuple(map(statement, body))

    def has_marks(function: Function) -> bool:
        inside = map(contents, roots_in(function.body))
        return any(not final.keys().isdisjoint((*c.frames, *c.reads)) for c in inside)

    functions = tuple(
        replace(f, body=block(f.body)) if has_marks(f) else f for f in module.functions
    )
    frame = tuple((final[name], rewrite(value, change, memo)) for name, value in module.frame)
    return replace(module, functions=functions, frame=frame)
