"""The one table of built-in functions.

A declaration is everything that is known of a built-in: its types, its one-sentence meaning, its
definition, cost, folding and derivative, the functions of Python and NumPy that mean the same, how
each target spells it, how far targets may differ, where tests sample it. Type checks, error hints,
passes, backends, the generated stub, the parity tests and the reference page read it here. To add a
built-in, add a declaration to the module of its theme.

The definition is either ``meaning`` (NumPy, taking the array module as its first argument) or
``scene``: the name of a function in ``distal.lang.prelude``, scene code, which then is the meaning
on every target. Spellings for a target family:

- ``None``: the target has it under the same name, meaning the same;
- a template: ``{0}`` is the first argument; arguments arrive bracketed where needed;
- ``SCENE``: the target calls the ``scene`` function;
- ``"@name"``: the target calls that other prelude function (the CPU's elementary functions).

The target families are glsl (ES 3.00, 3.30, Shadertoy), glsl100 (ES 1.00; ``None`` there means "as
glsl"), wgsl and llvm (``None`` there: the LLVM backend makes it itself). The NumPy reference runs
``meaning``, or the scene function.
"""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics.bits import BITS
from distal.ir.intrinsics.components import COMPONENTS
from distal.ir.intrinsics.declaration import SCENE, Intrinsic
from distal.ir.intrinsics.elementary import ELEMENTARY
from distal.ir.intrinsics.matrices import MATRIX_FUNCTIONS
from distal.ir.intrinsics.vectors import VECTOR_FUNCTIONS

INTRINSICS: Final[dict[str, Intrinsic]] = {
    intrinsic.name: intrinsic
    for intrinsic in (*(*COMPONENTS, *ELEMENTARY, *VECTOR_FUNCTIONS, *MATRIX_FUNCTIONS, *BITS),)
}


def python_functions(module: str) -> dict[str, str]:
    """The functions of a Python module that mean a built-in, to its name.

    ``module`` is "math", "numpy", or empty for Python's own functions.
    """
    return {
        function: intrinsic.name
        for intrinsic in INTRINSICS.values()
        for home, _, function in (name.rpartition(".") for name in intrinsic.python)
        if home == module
    }


__all__ = ["INTRINSICS", "SCENE", "Intrinsic", "python_functions"]
