"""``@struct``: make a class with annotated fields a value type of scene code.

In Python it is an ordinary dataclass. Its annotations are evaluated when scene code first uses
the struct, so the type of a field can be defined later in the file.
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
    """The namespaces in which the annotations of a struct are looked up."""

    module: Mapping[str, Any]
    enclosing: Mapping[str, Any]


def struct(cls: C) -> C:
    """Make a class with annotated fields (defaults allowed) a struct of scene code.

    Raises:
        TypeError: ``cls`` is not a class.
    """
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
        # Since Python 3.14 annotations are evaluated here; one names a type that is defined later.
        lazy: Any = importlib.import_module("annotationlib")
        return dict(lazy.get_annotations(cls, format=lazy.Format.STRING))


def _dataclass(cls: C) -> C:
    """Make a dataclass without evaluating the annotations of the class.

    ``dataclass`` looks up annotations given as text in the module of the class; a file that is run
    directly has no such module.
    """
    annotations = _annotations(cls)
    cls.__annotations__ = dict.fromkeys(annotations, Any)
    made = cast("Any", dataclass)(cls)
    made.__annotations__ = annotations
    for field in fields(made):
        field.type = annotations.get(field.name, field.type)
    return cast("C", made)
