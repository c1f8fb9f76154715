"""One object for each distinct node or type, so that equality is identity.

A plain frozen dataclass hashes its whole tree each time its hash is needed, which is exponential
for an expression that shares its parts, and recursive. An interned node is looked up by the
identities of its children, once, when it is made.
"""

from __future__ import annotations

from typing import Any
from weakref import KeyedRef, ref

_TABLE: dict[Any, KeyedRef[Any, Any]] = {}


def _forget(reference: KeyedRef[Any, Any]) -> None:
    # A new node may have taken the key between the old one's death and this call.
    if _TABLE.get(reference.key) is reference:
        del _TABLE[reference.key]


class Interned(type):
    """Metaclass: calling the class gives the one object with those fields.

    The fields up to ``span`` identify a node and are passed by position. ``span`` is beside the
    node and takes no part: the first one seen stays, so an expression's span only narrows the
    span of the statement it stands in (see ``distal.ir.nodes``).
    """

    def __call__(cls, *args: Any, span: Any = None) -> Any:
        """Find or make the object."""
        key = (cls, args, cls.discriminate(args[0])) if cls.discriminate else (cls, args)
        reference: ref[Any] | None = _TABLE.get(key)
        found = reference() if reference is not None else None
        if found is None:
            found = super().__call__(*args) if span is None else super().__call__(*args, span=span)
            _TABLE[key] = KeyedRef(found, _forget, key)
        return found

    # A class whose first field is a plain number distinguishes what a dictionary would mix up.
    discriminate: Any = None


def discriminate_number(value: bool | int | float) -> tuple[type, str]:
    """A key under which 0.0, -0.0, 0 and False are four constants."""
    return type(value), repr(value)
