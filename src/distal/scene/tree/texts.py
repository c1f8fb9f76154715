"""Objects as text that evaluates to an equal object, for ``repr``: ``Sphere(radius=2.0)``.

Input: the objects' arguments. Output: Python code in terms of the names of ``distal`` and
``distal.lang``. What has no such text (a ``@func``, an array, a long expression) stands in angle
brackets, and so does what is left out of a long text; such a text does not evaluate.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

from distal.lang.expressions import Expression
from distal.lang.parameters import Parameter
from distal.lang.values import VectorValue

# The most items of a list, of which those in the middle are left out, and letters of a text.
_MOST_ITEMS: Final = 12
_MOST_LETTERS: Final = 200
# The most shapes in a text, and how deep they may stand in each other.
_MOST_SHAPES: Final = 24
_DEEPEST: Final = 12


class TextWriter:
    """Writes one text; it is short, however large the object is.

    Attributes:
        shapes_left: How many shapes may still be written.
        depth: How many objects the one that is written stands in.
    """

    def __init__(self) -> None:
        self.shapes_left = _MOST_SHAPES
        self.depth = 0

    def text(self, value: Any) -> str:
        """Return a value as an author writes it."""
        written = getattr(value, "_written", None)
        if written is not None:
            return self._deeper(written)
        if isinstance(value, bool | int | type(None)):
            return repr(value)
        if isinstance(value, float):
            return repr(float(value)) if math.isfinite(value) else f'float("{float(value)}")'
        if isinstance(value, str | os.PathLike):
            text = os.fspath(value)
            return repr(text) if len(text) <= _MOST_LETTERS else f"<text of {len(text)} letters>"
        if isinstance(value, Mapping):
            pairs = [(self.text(name), each) for name, each in value.items()]
            return f"{{{self._joined(pairs, lambda p: f'{p[0]}: {self.text(p[1])}')}}}"
        if isinstance(value, list | tuple):
            items = self._joined(value, self.text)
            comma = "," if isinstance(value, tuple) and len(value) == 1 else ""
            return f"[{items}]" if isinstance(value, list) else f"({items}{comma})"
        if isinstance(value, Parameter | VectorValue):
            return repr(value)
        if isinstance(value, Expression) and not repr(value).startswith("<"):
            return repr(value)
        return _in_brackets(value)

    def call(self, function: Any, arguments: Mapping[str, Any]) -> str:
        """Return a call of a class or a function.

        Args:
            function: Its name, or itself. Its ``written_as`` is the name that authors call it by.
                With a dot before it, it is a method of its first argument, which takes the others
                by position, or with ``by_name`` by name; a function with ``by_position`` takes none
                by name.
            arguments: By name.
        """
        name = function if isinstance(function, str) else name_of(function)
        is_method = name.startswith(".")
        by_name = hasattr(function, "by_name" if is_method else "by_position") is is_method
        values = iter(arguments.items())
        receiver = self.text(next(values)[1]) if is_method else ""
        texts = [f"{n}={self.text(v)}" if by_name else self.text(v) for n, v in values]
        return f"{receiver}{name}({', '.join(texts)})"

    def several(self, values: Sequence[Any], separator: str) -> str:
        """Return the texts of values, those in the middle left out if there are many."""
        return self._joined(values, self.text, separator)

    def _deeper(self, written: Callable[[TextWriter], str]) -> str:
        self.depth += 1
        try:
            return "<…>" if self.depth > _DEEPEST else written(self)
        finally:
            self.depth -= 1

    @staticmethod
    def _joined(values: Sequence[Any], text: Callable[[Any], str], separator: str = ", ") -> str:
        return separator.join(shortened(values, text, "more"))


def shortened(values: Sequence[Any], text: Callable[[Any], str], what: str) -> Iterable[str]:
    """Yield the texts of values; of many, of some at both ends, and between them their number.

    Args:
        values: The values.
        text: Returns the text of one.
        what: What stands behind the number.
    """
    left_out = len(values) - _MOST_ITEMS
    if left_out <= 1:
        yield from map(text, values)
        return
    half = _MOST_ITEMS // 2
    yield from map(text, values[:half])
    yield f"<{left_out:,} {what}>"
    yield from map(text, values[-half:])


def name_of(function: Any) -> str:
    """Return the name that authors call a class or function by."""
    written_as: str | None = getattr(function, "written_as", None)
    if written_as is not None:
        return written_as
    owner = getattr(function, "__self__", None)
    name: str = function.__name__
    return f"{owner.__name__}.{name}" if isinstance(owner, type) else name


def _in_brackets(value: Any) -> str:
    """Return what a value is that has no text which evaluates."""
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return f"<array {tuple(value.shape)}>"
    text = repr(value)
    if len(text) > _MOST_LETTERS or "\n" in text:
        text = f"{type(value).__name__} of {len(text)} letters"
    return text if text.startswith("<") else f"<{text}>"
