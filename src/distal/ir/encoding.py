"""Write a module as bytes, and read it again in another process.

Input: a module from the front end. Output: bytes that depend on the module alone, and from them an
equal module: it prints the same text. Spans are left out, and each texture or buffer is named by
the caller, who transports its data. Reading makes nothing but nodes, types and the classes that
the caller names, so bytes from elsewhere run no code.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from typing import Any, Final

from distal.ir import nodes, types
from distal.ir.interning import Interned
from distal.ir.nodes import Module

_TUPLE: Final = 0
_PLAIN: Final = (bool, int, float, str, type(None))
# Deflate of level 6 halves the time of level 9, for 2 % more bytes.
_LEVEL: Final = 6


def _classes_of(*modules: Any) -> dict[str, type]:
    found: dict[str, type] = {}
    for module in modules:
        for name, value in vars(module).items():
            is_own = isinstance(value, type) and value.__module__ == module.__name__
            if is_own and (is_dataclass(value) or issubclass(value, Enum)):
                found[name] = value
    return found


_CLASSES: Final = _classes_of(types, nodes)


class EncodingError(ValueError):
    """Bytes are not those of a module, or a value has no form as bytes."""


def encoded(module: Module, name_of: Callable[[Any], str], others: Sequence[type] = ()) -> bytes:
    """Return a module as bytes.

    Args:
        module: The module.
        name_of: Returns the name by which ``decoded`` finds a texture or buffer again.
        others: Dataclasses and enumerations outside of the IR that the module refers to.

    Raises:
        EncodingError: A value is of none of these classes.
    """
    resources = tuple(
        r if r.source is None else replace(r, source=name_of(r.source)) for r in module.resources
    )
    writer = _Writer({**_CLASSES, **{c.__name__: c for c in others}})
    root = writer.write(replace(module, resources=resources))
    text = json.dumps([writer.names, writer.rows, root], separators=(",", ":"))
    return zlib.compress(text.encode("utf-8", "surrogatepass"), _LEVEL)


def decoded(data: bytes, named: Callable[[str], Any], others: Sequence[type] = ()) -> Module:
    """Return the module that ``encoded`` has written.

    Args:
        data: The bytes.
        named: Returns the texture or buffer of a name.
        others: As for ``encoded``.

    Raises:
        EncodingError: They are not those of a module.
    """
    known = {**_CLASSES, **{c.__name__: c for c in others}}
    try:
        names, rows, root = json.loads(zlib.decompress(data))
        classes = [known[name] for name in names]
        made: list[Any] = []
        for row in rows:
            made.append(_made(row, classes, made))
        module = made[root]
        if not isinstance(module, Module):
            raise EncodingError("the bytes are of no module")
    except (ValueError, KeyError, IndexError, TypeError, zlib.error) as error:
        raise EncodingError(f"the bytes are of no module: {error}") from None
    resources = tuple(
        r if r.source is None else replace(r, source=named(r.source)) for r in module.resources
    )
    return replace(module, resources=resources)


class _Writer:
    """Rows of values, each after the values that it refers to.

    A row has the number of a class and its fields; a field is a plain value, or a list with the
    number of another row.
    """

    def __init__(self, classes: dict[str, type]) -> None:
        self.names: list[str] = []
        self.rows: list[list[Any]] = []
        self._known = {value: name for name, value in classes.items()}
        self._numbers: dict[type, int] = {}
        self._of: dict[int, int] = {}
        self._kept: list[Any] = []  # what was written lives as long, so that no identity recurs

    def write(self, root: Any) -> int:
        """Write a value, and return the number of its row; not recursive, trees may be deep."""
        waiting = [root]
        while waiting:
            value = waiting[-1]
            if id(value) in self._of:
                waiting.pop()
                continue
            parts = list(_parts(value))
            missing = [p for p in parts if not isinstance(p, _PLAIN) and id(p) not in self._of]
            if missing:
                waiting.extend(reversed(missing))
                continue
            waiting.pop()
            self._of[id(value)] = len(self.rows)
            self._kept.append(value)
            self.rows.append([self._class_of(value), *map(self._field, parts)])
        return self._of[id(root)]

    def _field(self, value: Any) -> Any:
        return value if isinstance(value, _PLAIN) else [self._of[id(value)]]

    def _class_of(self, value: Any) -> int:
        kind = type(value)
        if kind is tuple:
            return _TUPLE
        if kind not in self._known:
            raise EncodingError(f"{value!r:.60} has no form as bytes")
        if kind not in self._numbers:
            self.names.append(self._known[kind])
            self._numbers[kind] = len(self.names)
        return self._numbers[kind]


def _parts(value: Any) -> Iterator[Any]:
    """Return the fields of a value in the order in which ``_made`` takes them."""
    if type(value) is tuple:
        return iter(value)
    if isinstance(value, Enum):
        return iter((value.value,))
    if is_dataclass(value) and not isinstance(value, type):
        return (getattr(value, name) for name in _fields(type(value)))
    raise EncodingError(f"{value!r:.60} has no form as bytes")


def _fields(kind: type) -> list[str]:
    found = _FIELDS.get(kind)
    if found is None:
        names = [f.name for f in fields(kind) if f.init and f.name != "span"]
        found = _FIELDS[kind] = names
    return found


_FIELDS: Final[dict[type, list[str]]] = {}


def _made(row: list[Any], classes: list[type], made: list[Any]) -> Any:
    values = [made[v[0]] if isinstance(v, list) else v for v in row[1:]]
    if row[0] == _TUPLE:
        return tuple(values)
    kind = classes[row[0] - 1]
    if issubclass(kind, Interned):
        return kind(*values)
    if issubclass(kind, Enum):
        return kind(values[0])
    return kind(**dict(zip(_fields(kind), values, strict=True)))
