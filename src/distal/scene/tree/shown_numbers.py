"""Numbers of shapes, lights, cameras and materials as text, for a notebook or a debugger.

Input: checked numbers by name. Output: a text such as ``(radius=1, offset=(1, 2, 3))``. Evaluates
nothing: what depends on parameters is named by them.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import ended
from distal.lang.expressions import Expression
from distal.lang.places import POINT
from distal.scene.tree.conversion import Number
from distal.scene.tree.varying import VaryingNumber

_MOST_NUMBERS: Final = 6


def listed(values: Mapping[str, Any], constants: Mapping[str, Any] | None = None) -> str:
    """Return numbers and constants by name, in brackets; an empty text if there are none.

    Args:
        values: Values by name; those that are no numbers are left out.
        constants: Python values by name: of these, numbers and switches are shown.
    """
    shown = [f"{name}={_text(v)}" for name, v in values.items() if isinstance(v, Number)]
    shown += [
        f"{name}={value}"
        for name, value in (constants or {}).items()
        if isinstance(value, bool | int | float)
    ]
    shown += [
        f"{name}=by {'place' if POINT in value.uses else 'cell'}"
        for name, value in (constants or {}).items()
        if isinstance(value, VaryingNumber)
    ]
    more = ["…"] if len(shown) > _MOST_NUMBERS else []
    return f"({', '.join([*shown[:_MOST_NUMBERS], *more])})" if shown else ""


def placed(place: Span) -> str:
    """Return the file's name and the line of a place."""
    return f"{Path(place.file).name}:{place.line}"


def _text(number: Number) -> str:
    value = number.value
    if isinstance(value, Expression):
        names = [parameter.name for parameter in value.parameters]
        return "/".join(names) or "time"
    if isinstance(value, tuple):
        return f"({', '.join(f'{ended(component):g}' for component in value)})"
    return f"{ended(value):g}"
