"""The scene function of a ``.vm`` file: written and parsed when a target first needs it.

Input: the operations of a file. Output: a ``Func``, which every target compiles, and which knows
its operations, so that the tape runtime needs no compilation.
"""

from __future__ import annotations

import builtins
import keyword
import re
from typing import Any

from distal import lang
from distal.lang.functions import Func
from distal.tape.scene_text import overload_of
from distal.tape.vm_file import VmProgram


class VmFunction(Func):
    """A function of a point that is read from a ``.vm`` file.

    Attributes:
        program: The operations.
    """

    def __init__(self, program: VmProgram) -> None:
        self.program, self.remade = program, (VmFunction, program)
        name = f"{_identifier(program.name)}_operations"
        self.__name__ = self.__qualname__ = name
        self.__module__ = __name__
        self.__doc__ = f"The function of '{program.name}.vm'."

    def __getattr__(self, name: str) -> Any:
        # The text of 7,900 operations takes 0.15 s to write and parse: only when it is needed.
        if name != "overloads":
            raise AttributeError(name)
        overloads = [overload_of(self.program.scene_code(self.name), self.name)]
        self.overloads = overloads
        return overloads


def point_function(program: VmProgram) -> Func:
    """Return a short function that calls the function of a file.

    Its signature is known without the text of the file's function.
    """
    inner = VmFunction(program)
    point = "vec2" if program.flat else "vec3"
    name = _identifier(program.name)
    text = f"def {name}(p: {point}) -> float:\n    return {inner.name}(p)\n"
    made = Func(overload_of(text, name, {inner.name: inner}))
    made.__dict__.update(program=program, remade=(point_function, program))
    return made


def program_of(function: Func) -> VmProgram | None:
    """Return the operations of a function that ``point_function`` made; None for others."""
    found: VmProgram | None = function.__dict__.get("program")
    return found


def _identifier(name: str) -> str:
    """Return a name of a Python function."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII).strip("_") or "model"
    known = keyword.iskeyword(plain) or hasattr(lang, plain) or hasattr(builtins, plain)
    taken = plain[0].isdigit() or known
    return f"vm_{plain}" if taken else plain
