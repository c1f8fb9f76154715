"""Interning: one object for each distinct node or type, so that equality is identity.

A plain frozen dataclass hashes its whole tree each time its hash is needed, recursively; this takes
exponential time for an expression with shared parts. An interned node is looked up only once, when
it is created, by the identities of its children.
"""

from __future__ import annotations

from typing import Any
from weakref import KeyedRef, ref

_TABLE: dict[Any, KeyedRef[Any, Any]] = {}


def _forget(reference: KeyedRef[Any, Any]) -> None:
    # A new node may have been stored under the key between the death of the old one and this call.
    if _TABLE.get(reference.key) is reference:
        del _TABLE[reference.key]


class Interned(type):
    """Metaclass whose call returns the single object with the given field values.

    The fields before ``span`` identify a node and are passed by position. ``span`` is not part of
    the identity: the object keeps the first span it was created with. An expression's span is
    therefore only used to narrow the span of the statement that contains it (see
    ``distal.ir.nodes``).
    """

    def __call__(cls, *args: Any, span: Any = None) -> Any:
        """Return the existing object with these field values, or create it."""
        key = (cls, args, cls.discriminate(args[0])) if cls.discriminate else (cls, args)
        reference: ref[Any] | None = _TABLE.get(key)
        found = reference() if reference is not None else None
        if found is None:
            found = super().__call__(*args) if span is None else super().__call__(*args, span=span)
            _TABLE[key] = KeyedRef(found, _forget, key)
        return found

    # A class whose first field is a plain number sets this, to separate dictionary keys such as 0,
    # 0.0 and False, which compare equal.
    discriminate: Any = None


def discriminate_number(value: bool | int | float) -> tuple[type, str]:
    """Return a key that distinguishes the constants 0.0, -0.0, 0 and False."""
    return type(value), repr(value)
