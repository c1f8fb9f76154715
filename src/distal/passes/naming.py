"""Choose names that are not taken.

Input: the names already taken, and a wanted name. Output: the wanted name, or the wanted name with
the first free number appended. Deterministic: the same names in the same order give the same
result.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from distal.ir.nodes import For, Function, Let, Module, Var
from distal.ir.walk import statements_in


class FreshNames:
    """A growing set of taken names."""

    def __init__(self, taken: Iterable[str]) -> None:
        self._taken = set(taken)
        self._next: dict[str, int] = {}

    def fresh(self, wanted: str) -> str:
        """Return and reserve ``wanted`` if it is free, else ``wanted_2``, ``wanted_3`` ..."""
        name = wanted
        if name in self._taken:
            count = self._next.get(wanted, 2)
            while f"{wanted}_{count}" in self._taken:
                count += 1
            self._next[wanted] = count + 1
            name = f"{wanted}_{count}"
        self._taken.add(name)
        return name

    def numbered(self, stem: str) -> str:
        """Return and reserve the first free name of ``stem_0``, ``stem_1`` ..."""
        count = self._next.get(f"{stem}#", 0)
        while f"{stem}_{count}" in self._taken:
            count += 1
        self._next[f"{stem}#"] = count + 1
        name = f"{stem}_{count}"
        self._taken.add(name)
        return name


def local_names(function: Function) -> Iterator[str]:
    """Yield the parameters and locals of a function."""
    for param in function.params:
        yield param.name
    for stmt in statements_in(function.body):
        if isinstance(stmt, Let | Var | For):
            yield stmt.name


def module_names(module: Module) -> Iterator[str]:
    """Yield the names of a module's functions, uniforms, resources and per-frame values."""
    yield from (f.name for f in module.functions)
    yield from (u.name for u in module.uniforms)
    yield from (r.name for r in module.resources)
    yield from (name for name, _ in module.frame)
