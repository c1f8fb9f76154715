"""The class ``Intrinsic``: the declaration of a built-in function.

Input: one ``Intrinsic(...)`` for each built-in, in the other modules of this package. Output: the
attributes that type checks, passes, backends, generated files and tests read. A declaration without
cost, folding, derivative or Python names is a type error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from enum import Enum
from typing import Any, Final, TypeAlias

from distal.ir import limits
from distal.ir.intrinsics.derivatives import Rule
from distal.ir.intrinsics.folding import Fold
from distal.ir.signatures import Signature

Interval: TypeAlias = tuple[float, float]

SCENE: Final = "@"

# Frequent values of attributes: domains, names of arguments, tolerances, results.
R: Final[Interval] = (-10.0, 10.0)
UNIT: Final[Interval] = (-1.0, 1.0)
ONE: Final = ("x",)
TWO: Final = ("a", "b")
# Tolerances are the differences that the parity tests measure between the reference, our vector
# code and Mesa's drivers (``DISTAL_PARITY_REPORT``), times 2 to 4. The largest are Mesa's: asin
# and acos have errors of 4e-4, atan of 2e-5 of its value. exp, log, sin and other elementary
# functions have errors of at most 8e-7 of the value plus 5e-7; ours alone of 1.6e-7
# (``tests/parity/test_elementary.py``).
CLOSE_RTOL: Final = 2e-6
CLOSE_ATOL: Final = 1e-6
ANYWHERE: Final[Interval] = (-math.inf, math.inf)
NOT_NEGATIVE: Final[Interval] = (0.0, math.inf)
# The function of a driver may exceed 1 slightly.
WITHIN_ONE: Final[Interval] = (-1.01, 1.01)
WIDER: Final = 2e-6  # relative; larger than the error of any target's arithmetic
ZERO_TO_ONE: Final[Interval] = (0.0, 1.0 + WIDER)


class Trend(Enum):
    """How the result of a built-in follows from its arguments."""

    RISING = "rising"  # never decreases
    FALLING = "falling"  # never increases
    WAVE = "wave"  # slope at most 1, values from -1 to 1
    EVEN = "even"  # falls to 0 and rises from there
    BRANCHES = "branches"  # rises between poles that are pi apart
    MONOTONE = "monotone"  # along each argument, it never decreases or never increases
    ANGLE = "angle"  # the same, where y is not around 0 with x below 0
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Intrinsic:
    """The declaration of a built-in function.

    Attributes:
        name: The name in scene code.
        doc: One sentence; angles in radians.
        args: The names of the arguments.
        signatures: The accepted types; tried in order.
        domain: For each argument, the closed interval that tests sample (floats and ints).
        cost: Approximate scalar operations for each component of the first argument
            (``distal.passes.cost``).
        fold: Computes the result for constant arguments, or ``folding.not_folded``.
        derivative: The rule for its derivative; None where the result is not a float.
        python: The equivalent functions of Python and NumPy, accepted in scene code and between
            expressions: ``abs``, ``math.fabs``, ``numpy.fabs``.
        meaning: NumPy definition, or None when ``scene`` is the definition.
        scene: The prelude function that defines it or can replace it.
        rtol: Allowed relative difference between any two targets; 0 means equal bits.
        atol: Allowed absolute difference.
        glsl: Spelling; see the docstring of the package.
        glsl100: Spelling for GLSL ES 1.00 where it differs from ``glsl``.
        glsl_scalars: Positions of arguments that GLSL also accepts as scalars next to vectors.
        wgsl: Spelling.
        llvm: Spelling.
        careful: The prelude function that replaces it on targets whose drivers are inaccurate
            (``Target.rough``). Other targets, and hosts that trust their driver, use the spelling
            of their family.
        held: The interval to which the only argument is clamped first; ``meaning`` and the
            prelude's functions have to be defined only on this interval.
        guarded: Targets with a spelling of their own use it only where it provably gives the same
            result (``passes.decompose.edges``); otherwise they too call the ``scene`` function.
        results: An interval that contains every result on every target.
        edges: One sentence: the result where the mathematical function has no value or several.
            Otherwise, and wherever this is empty, ordinary numbers (``limits.ORDINARY``) give a
            finite number.
        reach: The largest magnitude of arguments for which the result is finite.
        trend: How the result follows from the argument, for interval arithmetic.
        hidden: Not a name of the language: only prelude code and passes use it.
    """

    name: str
    doc: str
    args: tuple[str, ...]
    signatures: tuple[Signature, ...]
    domain: tuple[Interval, ...]
    _: KW_ONLY
    cost: int
    fold: Fold
    derivative: Rule | None
    python: tuple[str, ...]
    meaning: Callable[..., Any] | None = None
    scene: str | None = None
    rtol: float = 0.0
    atol: float = 0.0
    glsl: str | None = None
    glsl100: str | None = None
    glsl_scalars: tuple[int, ...] = ()
    wgsl: str | None = None
    llvm: str | None = None
    careful: str | None = None
    hidden: bool = False
    held: limits.Held | None = None
    guarded: bool = False
    results: Interval = ANYWHERE
    edges: str = ""
    reach: float = limits.ORDINARY
    trend: Trend = Trend.UNKNOWN

    def spelling(self, family: str) -> str | None:
        """Return the spelling for a target family; ``SCENE`` becomes ``@`` and the function's name.

        Raises:
            KeyError: There is no such family.
        """
        column: str | None
        match family:
            case "glsl":
                column = self.glsl
            case "glsl100":
                column = self.glsl if self.glsl100 is None else self.glsl100
            case "wgsl":
                column = self.wgsl
            case "llvm":
                column = self.llvm
            case "numpy":
                column = SCENE if self.meaning is None else None
            case _:
                raise KeyError(family)
        return f"@{self.scene}" if column == SCENE else column
