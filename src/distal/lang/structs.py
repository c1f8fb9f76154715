"""``@struct``: a class with annotated fields becomes a value type of scene code.

From Python it is an ordinary dataclass. Its annotations are resolved when scene code first uses
it, so a field may name a struct that is defined further down.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

C = TypeVar("C", bound=type)


@dataclass(frozen=True, slots=True)
class StructNames:
    """Where the names in a struct's annotations are looked up."""

    module: Mapping[str, Any]
    enclosing: Mapping[str, Any]


def struct(cls: C) -> C:
    """Make a class with annotated fields (defaults allowed) a struct of scene code."""
    if not isinstance(cls, type):
        raise TypeError("@struct stands above a class with annotated fields")
    made = dataclass(cls)
    frame = sys._getframe(1)
    enclosing = {} if frame.f_locals is frame.f_globals else dict(frame.f_locals)
    made.__distal_struct__ = StructNames(frame.f_globals, enclosing)  # type: ignore[attr-defined]
    return made
