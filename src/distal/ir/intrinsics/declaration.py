"""What the declaration of a built-in function holds.

Input: one ``Intrinsic(...)`` for each built-in, in the modules beside this one. Output: the columns
that type checks, passes, backends, generated files and tests read. A declaration without its cost,
folding, derivative or Python names is a type error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any, Final, TypeAlias

from distal.ir import limits
from distal.ir.intrinsics.derivatives import Rule
from distal.ir.intrinsics.folding import Fold
from distal.ir.signatures import Signature

Interval: TypeAlias = tuple[float, float]

SCENE: Final = "@"

# Often used values of columns: domains, names of arguments, tolerances, results.
R: Final[Interval] = (-10.0, 10.0)
UNIT: Final[Interval] = (-1.0, 1.0)
ONE: Final = ("x",)
TWO: Final = ("a", "b")
# Tolerances are what the parity tests measure between the reference, our vector code and Mesa's
# drivers (``DISTAL_PARITY_REPORT``), times 2 to 4. The loosest are Mesa's: asin and acos are off
# by 4e-4, atan by 2e-5 of its value. exp, log, sin and the like are off by at most 8e-7 of the
# value plus 5e-7; ours alone by 1.6e-7 (``tests/parity/test_elementary.py``).
CLOSE_RTOL: Final = 2e-6
CLOSE_ATOL: Final = 1e-6
ANYWHERE: Final[Interval] = (-math.inf, math.inf)
NOT_NEGATIVE: Final[Interval] = (0.0, math.inf)
# A driver's own function may overshoot.
WITHIN_ONE: Final[Interval] = (-1.01, 1.01)
WIDER: Final = 2e-6  # relative: more than the error of any target's arithmetic
ZERO_TO_ONE: Final[Interval] = (0.0, 1.0 + WIDER)


@dataclass(frozen=True, slots=True)
class Intrinsic:
    """A built-in function.

    Attributes:
        name: How an author writes it.
        doc: One sentence; angles in radians.
        args: The names of the arguments.
        signatures: The types it takes; tried in order.
        domain: For each argument, the closed interval that tests sample (floats; ints likewise).
        cost: Scalar operations for each component of the first argument, roughly
            (``distal.passes.cost``).
        fold: Its result for constant arguments, or ``folding.not_folded``.
        derivative: The rule for its derivative; None where the result is no float.
        python: The functions of Python and NumPy that mean the same in scene code and between
            expressions: ``abs``, ``math.fabs``, ``numpy.fabs``.
        meaning: NumPy definition, or None when ``scene`` is the definition.
        scene: The prelude function that defines it or can replace it.
        rtol: Relative disagreement allowed between any two targets; 0 means equal bits.
        atol: Absolute disagreement allowed.
        glsl: Spelling; see the package's text.
        glsl100: Spelling for GLSL ES 1.00 where it differs from ``glsl``.
        glsl_scalars: Positions of arguments that GLSL also takes as scalars beside vectors.
        wgsl: Spelling.
        llvm: Spelling.
        careful: The prelude function that replaces it on targets whose drivers are inexact
            (``Target.rough``); elsewhere, and where a host trusts its driver, they spell it as
            their family does.
        held: The interval to which the only argument is clamped before anything else; ``meaning``
            and the prelude's functions need to mean something only there.
        guarded: Targets that spell it themselves do so only where that certainly means the same
            (``passes.decompose.edges``); elsewhere they call the ``scene`` function too.
        results: An interval that holds every result on every target.
        edges: What it gives where mathematics has no answer or many, in a sentence. Elsewhere, and
            wherever this is empty, ordinary numbers (``limits.ORDINARY``) give a finite number.
        reach: Up to which magnitude of its arguments that holds.
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

    def spelling(self, family: str) -> str | None:
        """The spelling for a target family, with ``SCENE`` filled in as ``@name``."""
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
