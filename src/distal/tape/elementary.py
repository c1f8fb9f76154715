"""The elementary functions of tapes, as one scene function.

It selects by number, so that the runtime's text has one copy of each built-in. The number is the
same for all lanes: a branch, not a selection.
"""

from __future__ import annotations

from distal.lang.functions import Func
from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.scene_text import overload_of

_NAME = "elementary"


def elementary() -> Func:
    """Return the function of a position in ``operations.ELEMENTARY`` and two numbers."""
    lines = [f"def {_NAME}(number: int, x: float, y: float) -> float:", "    result = x"]
    for number, name in enumerate(ELEMENTARY):
        operands = ", ".join("xy"[: OPERATIONS[NUMBER[name]].operands])
        lines.append(f"    {'elif' if number else 'if'} number == {number}:")
        lines.append(f"        result = {name}({operands})")
    lines.append("    return result")
    return Func(overload_of("\n".join(lines) + "\n", _NAME))
