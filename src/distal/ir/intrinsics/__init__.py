"""The table of built-in functions (intrinsics).

A declaration contains all facts about a built-in: its types, a one-sentence description, its
definition, cost, folding and derivative, the equivalent functions of Python and NumPy, its spelling
on each target, the allowed difference between targets, and the domain that tests sample. Type
checks, error hints, passes, backends, the generated stub, the parity tests and the reference page
read it from here. To add a built-in, add a declaration to the module of its subject.

The definition is either ``meaning`` (NumPy code; its first argument is the array module) or
``scene``: the name of a function in ``distal.lang.prelude``, written in scene code, which is then
the definition on every target. Spellings for a target family:

- ``None``: the target has the function under the same name and with the same meaning;
- a template: ``{0}`` is the first argument; arguments are already in parentheses where needed;
- ``SCENE``: the target calls the ``scene`` function;
- ``"@name"``: the target calls that other prelude function (the CPU's elementary functions).

The target families are glsl (ES 3.00, 3.30, Shadertoy), glsl100 (ES 1.00; ``None`` there means "as
glsl"), wgsl and llvm (``None`` there: the LLVM backend generates the code itself). The NumPy
reference runs ``meaning``, or the scene function.
"""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics.bits import BITS
from distal.ir.intrinsics.components import COMPONENTS
from distal.ir.intrinsics.declaration import SCENE, Intrinsic, Trend
from distal.ir.intrinsics.elementary import ELEMENTARY
from distal.ir.intrinsics.matrices import MATRIX_FUNCTIONS
from distal.ir.intrinsics.vectors import VECTOR_FUNCTIONS

INTRINSICS: Final[dict[str, Intrinsic]] = {
    intrinsic.name: intrinsic
    for intrinsic in (*(*COMPONENTS, *ELEMENTARY, *VECTOR_FUNCTIONS, *MATRIX_FUNCTIONS, *BITS),)
}


def python_functions(module: str) -> dict[str, str]:
    """Map the functions of a Python module to the names of the equivalent built-ins.

    ``module`` is "math", "numpy", or empty for Python's own functions.
    """
    return {
        function: intrinsic.name
        for intrinsic in INTRINSICS.values()
        for home, _, function in (name.rpartition(".") for name in intrinsic.python)
        if home == module
    }


__all__ = ["INTRINSICS", "SCENE", "Intrinsic", "Trend", "python_functions"]
