"""Translate decorated Python functions to typed IR, and report every error at the author's line.

The packages depend downwards: ``lowering`` -> ``types`` -> ``signatures`` -> the modules of this
folder (values, scopes, source, problems). Only ``python_expressions`` is above ``lowering``.
"""

from distal.frontend.lowering.assembly import Assembly
from distal.frontend.lowering.lower import (
    SceneCode,
    has_overload,
    lower,
    lower_captured,
    lower_overload,
)
from distal.frontend.types.python_objects import type_of_value

__all__ = [
    "Assembly",
    "SceneCode",
    "has_overload",
    "lower",
    "lower_captured",
    "lower_overload",
    "type_of_value",
]
