"""Say which programs a driver would end early: Mesa's llvmpipe counts the turns of loops.

Input: a module after the passes, and an adapter. Output: a warning, if loops without a way out run
for more turns than the driver has. Does not depend on kernels.
"""

from __future__ import annotations

import warnings
from functools import cache
from typing import Final

from distal.devices.adapters import Adapter
from distal.ir.nodes import Break, Call, Const, For, If, Module, Return, Stmt, While
from distal.ir.walk import expressions, nodes_in, statements_in

# LP_MAX_TGSI_LOOP_ITERATIONS: of all loops of a pixel together, so that splitting does not help.
MOST_TURNS: Final = 65535


def warn_of_long_loops(module: Module, adapter: Adapter) -> None:
    """Warn if llvmpipe certainly ends the program's loops early."""
    if "llvmpipe" not in adapter.name.lower():
        return
    turns = certain_turns(module)
    if turns > MOST_TURNS:
        text = (
            f"{adapter.name} ends the loops of a pixel after {MOST_TURNS} turns together, and this "
            f"program needs {turns}: its result is wrong there; use device='cpu'"
        )
        warnings.warn(text, RuntimeWarning, stacklevel=2)


def certain_turns(module: Module) -> int:
    """Return how many turns the loops certainly run: those with constant bounds and no way out."""

    @cache
    def of_function(name: str) -> int:
        return of_block(module.function(name).body)

    def of_block(body: tuple[Stmt, ...]) -> int:
        total = 0
        for stmt in body:
            match stmt:
                case For(_, Const(start), Const(stop), step, inner) if not _leaves(inner):
                    total += len(range(int(start), int(stop), step)) * (1 + of_block(inner))
                case If() | While() | For():
                    pass
                case _:
                    calls = (e for e in nodes_in(*expressions(stmt)) if isinstance(e, Call))
                    total += sum(of_function(e.function) for e in calls)
        return total

    return of_function(module.entry)


def _leaves(body: tuple[Stmt, ...]) -> bool:
    """Return whether a loop's body may end the loop."""
    return _breaks(body) or any(isinstance(s, Return) for s in statements_in(body))


def _breaks(body: tuple[Stmt, ...]) -> bool:
    return any(
        isinstance(s, Break) or (isinstance(s, If) and (_breaks(s.then) or _breaks(s.otherwise)))
        for s in body
    )
