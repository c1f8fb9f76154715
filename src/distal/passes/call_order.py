"""Sort functions so that each callee precedes its callers.

Input: functions in any order, and the entry. Output: the functions that the entry reaches, each
after its callees, otherwise in the order in which they are called. The same program always gives
the same order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from distal.ir.contents import contents
from distal.ir.nodes import Function
from distal.ir.walk import roots_in


def in_call_order(functions: Iterable[Function], entry: str) -> tuple[Function, ...]:
    """Return the functions that ``entry`` reaches, callees first."""
    known = {f.name: f for f in functions}
    done: dict[str, Function] = {}
    opened: set[str] = set()
    stack = [(entry, False)]
    while stack:
        name, ready = stack.pop()
        if name in done:
            continue
        if ready:
            done[name] = known[name]
            continue
        assert name not in opened, f"{name} calls itself"
        opened.add(name)
        stack.append((name, True))
        stack.extend((callee, False) for callee in reversed(_callees(known, name)))
    return tuple(done.values())


def _callees(known: Mapping[str, Function], name: str) -> list[str]:
    roots = roots_in(known[name].body)
    return list(dict.fromkeys(callee for e in roots for callee in contents(e).callees))
