"""The Python objects of the names that scene code can call: built-ins and special forms.

The front end looks up the objects behind the author's names, so that a local name or an alias has
the right meaning.
"""

from __future__ import annotations

import builtins
import importlib
from dataclasses import dataclass
from typing import Any

from distal.ir.intrinsics import Intrinsic
from distal.lang.composed import Composed
from distal.lang.expressions import composed_value, is_symbolic
from distal.lang.runtime_access import alternatives, constant_evaluation, executor
from distal.lang.values import MatrixValue, VectorValue


@dataclass(frozen=True, slots=True)
class LangFunction:
    """A built-in function and its intrinsic. A call from Python is evaluated by the executor."""

    row: Intrinsic

    def __reduce__(self) -> Any:
        return _of_language, (self.row.name,)

    @property
    def __name__(self) -> str:
        return self.row.name

    @property
    def __doc__(self) -> str:  # type: ignore[override]  # a property, where object has a text
        return self.row.doc

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Return the value for numbers, vectors or arrays; for expressions, an expression.

        If Python has a built-in of this name, it is called instead, as in ``round(x, 2)`` or
        ``max(numbers, key=…)``; not for vectors, nor for several arguments with an array.
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


def _of_language(name: str) -> Any:
    """Return a built-in or a form by its name, for pickles."""
    return getattr(importlib.import_module("distal.lang"), name)


def _means_python(args: tuple[Any, ...]) -> bool:
    """Return whether Python's built-in of the same name is meant: there are no vectors."""
    if any(isinstance(arg, VectorValue) for arg in args):
        return False
    return len(args) == 1 or not any(hasattr(arg, "dtype") for arg in args)


def _is_constant(value: object) -> bool:
    return isinstance(value, int | float | VectorValue | MatrixValue)


@dataclass(frozen=True, slots=True)
class LangForm:
    """A call with special rules, such as ``select`` or ``gradient``; for scene code only.

    Attributes:
        name: Its name in scene code.
        signature: Its arguments, as text.
        doc: One sentence about what it does.
    """

    name: str
    signature: str
    doc: str

    def __reduce__(self) -> Any:
        return _of_language, (self.name,)

    @property
    def __name__(self) -> str:
        return self.name

    def __call__(self, *args: Any) -> Any:
        """Raise ``TypeError``: a form cannot be evaluated outside scene code."""
        raise TypeError(f"{self.name} works in scene code only: call it in a @func")


class SelectForm(LangForm):
    """``select``, which can be evaluated in Python for numbers, expressions and shapes."""

    def __call__(self, *args: Any) -> Any:
        """Return one of two numbers or shapes; with a parameter in it, an expression or a shape.

        Raises:
            TypeError: The condition or the operands are something else.
        """
        if len(args) != 3:
            return LangForm.__call__(self, *args)
        condition, *values = args
        if any(isinstance(v, Composed) for v in values):
            return alternatives.selected(condition, *values)
        if any(map(is_symbolic, args)):
            return composed_value(self.name, args)
        if isinstance(condition, bool) and all(isinstance(v, int | float) for v in values):
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
