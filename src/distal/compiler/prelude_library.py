"""The prelude for passes: functions are lowered on demand and linked to a module under free names.

Input: the name of a prelude function and argument types. Output: IR functions. Implements
``distal.ir.library.Library``, the interface that passes require, with the front end.
"""

from __future__ import annotations

import importlib
from dataclasses import replace
from functools import cache

from distal.frontend import has_overload, lower_overload
from distal.ir.nodes import Call, Expr, Function, Module
from distal.ir.types import Type
from distal.ir.walk import map_expressions, rewrite


@cache
def _lowered(name: str, args: tuple[Type, ...]) -> tuple[Function, ...]:
    """Return the overload and its callees, callees first; empty if there is no such overload."""
    module, _, function = name.partition(".")
    func = getattr(importlib.import_module(f"distal.lang.prelude.{module}"), function)
    return lower_overload(func, args) if has_overload(func, args) else ()


class PreludeLibrary:
    """Links prelude functions into the successive modules of a single compilation."""

    def __init__(self) -> None:
        # Lowered prelude function -> the function as it was added to the module.
        self._linked: dict[Function, Function] = {}

    def find(self, name: str, args: tuple[Type, ...]) -> Function | None:
        """Return the lowered overload for exactly these types, or None."""
        functions = _lowered(name, args)
        return functions[-1] if functions else None

    def link(self, module: Module, name: str, args: tuple[Type, ...]) -> tuple[Module, str]:
        """Add an overload and its callees to the module.

        Args:
            module: The module to add to.
            name: The prelude function's name, such as ``elementary.sine``.
            args: The argument types of the overload.

        Returns:
            The new module, and the overload's name in it.
        """
        functions = _lowered(name, args)
        assert functions, f"the prelude has no {name} of {', '.join(map(str, args))}"
        present = {f.name: f for f in module.functions}
        added: list[Function] = []
        names: dict[str, str] = {}
        for function in functions:
            known = self._linked.get(function)
            if known is None or known.name not in present:
                known = _renamed(function, _free_name(function.name, present), names)
                self._linked[function] = known
                added.append(known)
                present[known.name] = known
            names[function.name] = known.name
        if added:
            module = replace(module, functions=(*added, *module.functions))
        return module, names[functions[-1].name]


def _free_name(wanted: str, taken: dict[str, Function]) -> str:
    name, count = wanted, 2
    while name in taken:
        name, count = f"{wanted}_{count}", count + 1
    return name


def _renamed(function: Function, name: str, callees: dict[str, str]) -> Function:
    """Return the function under another name, calling its callees by their new names."""
    memo: dict[Expr, Expr] = {}

    def call(e: Expr) -> Expr:
        if isinstance(e, Call) and callees.get(e.function, e.function) != e.function:
            return Call(callees[e.function], e.args, e.type, span=e.span)
        return e

    body = map_expressions(function.body, lambda e: rewrite(e, call, memo))
    return replace(function, name=name, body=body)
