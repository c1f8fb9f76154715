"""``@struct``: make a class with annotated fields, and methods, a value type of scene code.

In Python it is an ordinary dataclass. Its annotations are evaluated when scene code first uses
the struct, so the type of a field can be defined later in the file. A ``@func`` in the class is a
method, or with ``@staticmethod`` above it a function that the class holds; both can be called from
Python and from scene code. Other functions of the class are Python's alone.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from types import FunctionType
from typing import Any, Final, TypeVar, cast

from distal.lang.functions import Func

C = TypeVar("C", bound=type)
METHODS: Final = "__distal_methods__"  # an attribute of a struct's class: its methods by name


@dataclass(frozen=True, slots=True)
class StructNames:
    """The namespaces in which the annotations of a struct are looked up."""

    module: Mapping[str, Any]
    enclosing: Mapping[str, Any]


class Method:
    """A ``@func`` of a struct's class: read from a value, it is bound to the value."""

    def __init__(self, func: Func) -> None:
        self.func = func
        self.__doc__ = func.__doc__
        self.__wrapped__ = func

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        """Return the function; from a value, with the value as its first argument."""
        return self.func if instance is None else partial(self.func, instance)


def struct(cls: C) -> C:
    """Make a class with annotated fields (defaults allowed) a struct of scene code.

    A ``@func`` in the class is a method; its first parameter needs no annotation.

    Raises:
        TypeError: ``cls`` is not a class.
    """
    if not isinstance(cls, type):
        raise TypeError("@struct stands above a class with annotated fields")
    made = _dataclass(cls)
    frame = sys._getframe(1)
    enclosing = {} if frame.f_locals is frame.f_globals else dict(frame.f_locals)
    made.__distal_struct__ = StructNames(frame.f_globals, enclosing)  # type: ignore[attr-defined]
    _adopt_methods(made, enclosing)
    return made


def is_struct(value: object) -> bool:
    """Return whether an object is the class of a struct."""
    return isinstance(value, type) and "__distal_struct__" in vars(value)


def _adopt_methods(cls: type, enclosing: Mapping[str, Any]) -> None:
    """Make each ``@func`` of the class a method of the struct."""
    methods: dict[str, Func] = {}
    plain = False  # whether it has functions of Python, for messages about them
    for name, member in list(vars(cls).items()):
        is_static = isinstance(member, staticmethod)
        function = member.__func__ if is_static else member
        if not isinstance(function, Func):
            plain = plain or (isinstance(function, FunctionType) and not name.startswith("__"))
            continue
        # Annotations of a method may name the struct itself, which is in no namespace yet.
        names = {**enclosing, cls.__name__: cls}
        function.overloads = [
            replace(o, enclosing={**names, **o.enclosing}, struct=cls, takes_self=not is_static)
            for o in function.overloads
        ]
        if not is_static:
            methods[name] = function
            setattr(cls, name, Method(function))
    if methods or plain:
        setattr(cls, METHODS, methods)


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
