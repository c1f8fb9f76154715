"""Interning: one object for each distinct node or type, so that equality is identity.

A plain frozen dataclass hashes its whole tree each time its hash is needed, recursively; this takes
exponential time for an expression with shared parts. An interned node is looked up only once, when
it is created, by the identities of its children.
"""

from __future__ import annotations

# The step in C that ``weakref.WeakValueDictionary`` makes: remove a key if its reference is dead.
from _weakref import _remove_dead_weakref as _remove_dead  # type: ignore[attr-defined]
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Self, TypeVar, cast, dataclass_transform
from weakref import ref

_Class = TypeVar("_Class", bound="Interned")


class _Reference(ref[Any]):
    """A weak reference to an object that knows the object's key."""

    __slots__ = ("key",)

    key: Any


_TABLE: dict[Any, _Reference] = {}


def _forget(reference: _Reference) -> None:
    # A new node may have been stored under the key between the death of the old one and this call:
    # one step, so that no other thread can store it between a look and the removal.
    _remove_dead(_TABLE, reference.key)


class Interned:
    """Base of classes whose constructor returns the single object with the given field values.

    The fields before ``span`` identify a node and are passed by position. ``span`` is not part of
    the identity: the object keeps the first span it was created with. An expression's span is
    therefore only used to narrow the span of the statement that contains it (see
    ``distal.ir.nodes``).
    """

    # Not a metaclass: passes test the classes of nodes all the time, and a test for a class whose
    # metaclass is not ``type`` takes three times as long.
    __slots__ = ()

    # A class whose first field is a plain number sets this, to separate dictionary keys such as 0,
    # 0.0 and False, which compare equal.
    discriminate: ClassVar[Any] = None

    _setters: ClassVar[tuple[Callable[[Any, Any], None], ...]] = ()
    _set_span: ClassVar[Callable[[Any, Any], None] | None] = None

    def __new__(cls, *args: Any, span: Any = None) -> Self:
        """Return the existing object with these field values, or create it."""
        key = (cls, args, cls.discriminate(args[0])) if cls.discriminate else (cls, args)
        reference = _TABLE.get(key)
        found: Self | None = reference() if reference is not None else None
        if found is None:
            found = object.__new__(cls)
            for set_field, value in zip(cls._setters, args, strict=True):
                set_field(found, value)
            if cls._set_span is not None:
                cls._set_span(found, span)
            mine = _Reference(found, _forget)
            mine.key = key
            # Threads may make one node at the same time: all of them return the one in the table.
            while (reference := _TABLE.setdefault(key, mine)) is not mine:
                other: Self | None = reference()
                if other is not None:
                    return other
                _remove_dead(_TABLE, key)
        return found

    def __reduce__(self) -> tuple[type[Self], tuple[Any, ...]]:
        """Pickle the class and the fields: another process interns the node too."""
        names = (f.name for f in fields(cast(Any, self)) if f.name != "span")
        return type(self), tuple(getattr(self, name) for name in names)


@dataclass_transform(eq_default=False, frozen_default=True, field_specifiers=(field,))
def interned(cls: type[_Class]) -> type[_Class]:
    """Make a class of immutable objects with the fields that it declares."""
    made = dataclass(frozen=True, slots=True, eq=False, weakref_slot=True, init=False)(cls)
    names = [f.name for f in fields(cast(Any, made))]
    # The slots are set directly, because objects of the class refuse attributes.
    setters = {name: getattr(made, name).__set__ for name in names}
    made._set_span = setters.pop("span", None)
    made._setters = tuple(setters.values())
    return made


def discriminate_number(value: bool | int | float) -> tuple[type, str]:
    """Return a key that distinguishes the constants 0.0, -0.0, 0 and False."""
    return type(value), repr(value)
