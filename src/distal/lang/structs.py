"""``@struct``: a class with annotated fields becomes a value type of scene code.

From Python it is an ordinary dataclass. Its annotations are resolved when scene code first uses
it, so a field may name a struct that is defined further down.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeVar, cast

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
    made = _dataclass(cls)
    frame = sys._getframe(1)
    enclosing = {} if frame.f_locals is frame.f_globals else dict(frame.f_locals)
    made.__distal_struct__ = StructNames(frame.f_globals, enclosing)  # type: ignore[attr-defined]
    return made


def _annotations(cls: type) -> dict[str, Any]:
    try:
        return dict(cls.__annotations__)
    except NameError:
        # From Python 3.14 on they are evaluated now, and one names what is defined further down.
        lazy: Any = importlib.import_module("annotationlib")
        return dict(lazy.get_annotations(cls, format=lazy.Format.STRING))


def _dataclass(cls: C) -> C:
    """A dataclass whose annotations are left alone.

    As texts they would be looked up in the class's module, which a file run by itself has not.
    """
    annotations = _annotations(cls)
    cls.__annotations__ = dict.fromkeys(annotations, Any)
    made = cast("Any", dataclass)(cls)
    made.__annotations__ = annotations
    for field in fields(made):
        field.type = annotations.get(field.name, field.type)
    return cast("C", made)
