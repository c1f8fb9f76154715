"""What a name of the language is, as a Python object.

The front end finds these objects behind the author's names; nothing is decided by spelling.
"""

from __future__ import annotations

import builtins
from dataclasses import dataclass
from typing import Any

from distal.ir.intrinsics import Intrinsic
from distal.lang.expressions import composed_value, is_symbolic
from distal.lang.runtime_access import constant_evaluation, executor
from distal.lang.values import MatrixValue, VectorValue


@dataclass(frozen=True, slots=True)
class LangFunction:
    """A built-in, with its intrinsic. Called from Python it computes through the executor."""

    row: Intrinsic

    @property
    def __name__(self) -> str:
        return self.row.name

    @property
    def __doc__(self) -> str:  # type: ignore[override]  # a property, where object has a text
        return self.row.doc

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The value for numbers, vectors or arrays; of expressions, an expression.

        ``round(x, 2)``, ``max(numbers, key=…)`` and the like in a scene's module mean Python's own.
        """
        if any(map(is_symbolic, args)):
            if kwargs:
                raise TypeError(f"{self.row.name}() takes no keyword arguments")
            return composed_value(self.row.name, args)
        python = getattr(builtins, self.row.name, None)
        if python is not None and (kwargs or _means_python(args)):
            return python(*args, **kwargs)
        if not kwargs and all(map(_is_constant, args)):
            value = constant_evaluation.compute(self.row, args)
            if value is not None:
                return value
        return executor().call(self, args, kwargs)

    def __repr__(self) -> str:
        return f"<built-in {self.row.name}>"


def _means_python(args: tuple[Any, ...]) -> bool:
    """Whether a call of a name that Python has too is none of the language's: no vectors in it."""
    if any(isinstance(arg, VectorValue) for arg in args):
        return False
    return len(args) == 1 or not any(hasattr(arg, "dtype") for arg in args)


def _is_constant(value: object) -> bool:
    return isinstance(value, int | float | VectorValue | MatrixValue)


@dataclass(frozen=True, slots=True)
class LangForm:
    """A call with rules of its own, such as ``select`` or ``gradient``; scene code only.

    Attributes:
        name: How an author writes it.
        signature: Its arguments, as text.
        doc: What it does, in a sentence.
    """

    name: str
    signature: str
    doc: str

    @property
    def __name__(self) -> str:
        return self.name

    def __call__(self, *args: Any) -> Any:
        """Refuse: there is nothing to compute outside scene code."""
        raise TypeError(f"{self.name} works in scene code only: call it in a @func")


class SelectForm(LangForm):
    """``select``: of plain numbers it is known without a device."""

    def __call__(self, *args: Any) -> Any:
        """One of two numbers; refused of anything else, as every form is outside scene code."""
        if len(args) == 3 and isinstance(args[0], bool):
            condition, *values = args
            if all(isinstance(v, int | float) for v in values):
                return values[0] if condition else values[1]
        return LangForm.__call__(self, *args)


select = SelectForm(
    "select",
    "select(condition, yes, no)",
    "yes where the condition holds, else no; a bvec picks each component.",
)
gradient = LangForm(
    "gradient", "gradient(field, p)", "The exact derivative of a float function at p."
)
value_and_gradient = LangForm(
    "value_and_gradient",
    "value_and_gradient(field, p)",
    "The value of a float function at p and its derivative there, from one evaluation.",
)
sample = LangForm("sample", "sample(texture, coord)", "The filtered value of a texture, a vec4.")
texel = LangForm("texel", "texel(texture, index)", "One texel, a vec4; the index is clamped.")
size = LangForm("size", "size(resource)", "The size of a texture in texels, or of a buffer.")

FORMS = (select, gradient, value_and_gradient, sample, texel, size)
