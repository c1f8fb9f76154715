"""Check whether the Python objects that a lowered program captured are still the same.

Scene code captures constants when it is lowered. A later call can skip the lowering only if every
name that its functions use still refers to the same object. A notebook often rebinds names.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields
from enum import Enum
from types import CodeType, ModuleType
from typing import Any, Final

from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.functions import Func, Overload, is_library
from distal.lang.names import LangForm, LangFunction
from distal.lang.parameters import Parameter
from distal.lang.resources import Buffer, TextureValue
from distal.lang.values import MatrixValue, VectorValue


class _Missing:
    """The value of a name that is not bound."""


_MISSING: Final = _Missing()
# Immutable values: an identity comparison is enough.
_UNCHANGING: Final = (
    *(bool, int, float, str, bytes, type(None), type, Enum, _Missing),
    *(VectorValue, MatrixValue, Parameter, Expression, Composed),
    *(LangFunction, LangForm, Buffer, TextureValue),
)


class Captured:
    """The objects that the names used by some functions refer to, recorded at construction.

    Attributes:
        overloads: The functions.
    """

    def __init__(self, overloads: Iterable[Overload]) -> None:
        self.overloads = tuple(overloads)
        # Functions of the library do not change, and a scene uses hundreds of them: skip them.
        self._authors = tuple(o for o in self.overloads if not is_library(o))
        self._objects = tuple(self._now())
        self._lasting = all(map(_lasts, self._objects))

    def is_fresh(self) -> bool:
        """Return whether all recorded objects are unchanged; False if this is not known."""
        if not self._lasting:
            return False
        now = tuple(self._now())
        return len(now) == len(self._objects) and all(map(_same, now, self._objects))

    def _now(self) -> Iterator[Any]:
        for overload in self._authors:
            python = overload.python
            names = tuple(_names(python.__code__))
            for cell in python.__closure__ or ():
                try:
                    yield from _with_members(cell.cell_contents, names)
                except ValueError:  # a name that is bound later
                    yield _MISSING
            for name in names:
                yield from _with_members(python.__globals__.get(name, _MISSING), names)
            defaults = (*(python.__defaults__ or ()), *(python.__kwdefaults__ or {}).values())
            for default in defaults:
                yield from _with_members(default, names)


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _with_members(value: Any, names: tuple[str, ...]) -> Iterator[Any]:
    yield value
    if isinstance(value, Func):
        yield from value.overloads
    if isinstance(value, tuple):
        for item in value:
            yield from _with_members(item, names)
    if _is_struct(value):
        # A struct's value may be changed in place from Python.
        for field in fields(value):
            yield from _with_members(getattr(value, field.name), names)
    if isinstance(value, ModuleType | type):
        # ``settings.radius``: the module or class stays, its members may change.
        yield from (vars(value).get(name, _MISSING) for name in names)


def _is_struct(value: Any) -> bool:
    return "__distal_struct__" in vars(type(value))


def _lasts(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(map(_lasts, value))
    if isinstance(value, (*_UNCHANGING, Func, Overload, ModuleType)):
        return True
    if _is_struct(value):  # its fields are compared too
        return True
    if getattr(value, "shape", None) == ():  # NumPy's numbers, but not its arrays of one number
        return not hasattr(value, "__setitem__")
    # Builtins, objects of ``typing``, descriptors: scene code never uses them as constants.
    return callable(value) or hasattr(value, "__origin__") or hasattr(type(value), "__get__")


def _same(a: Any, b: Any) -> bool:
    return a is b
