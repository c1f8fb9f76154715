"""The elementary functions of tapes and their derivatives, as one scene function.

It selects by number, so that the runtime's text has one copy of each built-in. The number is the
same for all lanes: a branch, not a selection. The derivatives are those of the compiler
(``ir/intrinsics/derivatives.py``).
"""

from __future__ import annotations

from distal.lang.functions import Func
from distal.tape.operations import ELEMENTARY, NUMBER, OPERATIONS
from distal.tape.scene_text import overload_of

_NAME = "elementary"


def elementary() -> Func:
    """Return the function of a position in ``operations.ELEMENTARY`` and two numbers x and y.

    Its result is the value, and the derivatives along x and y.
    """
    lines = [f"def {_NAME}(number: int, x: float, y: float) -> vec3:"]
    lines += ["    value = x", "    slope = vec2(1.0, 0.0)"]
    callees = {}
    for number, name in enumerate(ELEMENTARY):
        function = f"{name}_of"
        operands = ", ".join(f"p.{axis}" for axis in "xy"[: OPERATIONS[NUMBER[name]].operands])
        text = f"def {function}(p: vec2) -> float:\n    return {name}({operands})\n"
        callees[function] = Func(overload_of(text, function))
        lines.append(f"    {'elif' if number else 'if'} number == {number}:")
        lines.append(f"        value, slope = value_and_gradient({function}, vec2(x, y))")
    lines.append("    return vec3(value, slope.x, slope.y)")
    return Func(overload_of("\n".join(lines) + "\n", _NAME, callees))
