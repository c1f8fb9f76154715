"""Checks JSON values against the types of records, and writes records as JSON values.

Input: a dataclass and a JSON object, or a record. Output: a record, or JSON values; an error names
the field. Does not know the messages.
"""

from __future__ import annotations

import json
import types
import typing
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from typing import Annotated, Any, Final, Literal, Union


class MessageError(ValueError):
    """A message has the wrong form; the error says which field of it and what belongs there."""


def plain(value: Any) -> Any:
    """Return a record, or a value in it, as JSON values."""
    if is_dataclass(value):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, tuple):
        return [plain(v) for v in value]
    if isinstance(value, dict):
        return {key: plain(v) for key, v in value.items()}
    return value


def _default(made: Any) -> Any:
    if made.default_factory is not MISSING:
        return made.default_factory()
    return made.default


@cache
def field_types(record: type) -> dict[str, Any]:
    """Return the types of a record's fields by name."""
    found = typing.get_type_hints(record, include_extras=True)
    return {f.name: found[f.name] for f in fields(record)}


def record_of(record: type, found: Mapping[str, Any], path: str) -> Any:
    """Return a record from a JSON object.

    Raises:
        MessageError: As ``parsed``.
    """
    known = field_types(record)
    for name in found:
        if name not in known:
            raise MessageError(
                f"{path}: there is no field '{name[:40]}'; it has {', '.join(known)}"
            )
    for made in fields(record):
        if made.name not in found and _default(made) is MISSING:
            raise MessageError(f"{path}: the field '{made.name}' is missing")
    return record(**{n: _checked(known[n], value, f"{path}.{n}") for n, value in found.items()})


def _checked(wanted: Any, value: Any, path: str) -> Any:
    """Return a JSON value as a value of a type.

    Raises:
        MessageError: It is of another type.
    """
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return value if inner[0] is Any else _checked(inner[0], value, path)
    if origin in (Union, types.UnionType):
        return _member(inner, value, path)
    if origin is Literal:
        if value in inner:
            return value
    elif origin is tuple:
        if isinstance(value, list) and (inner[-1] is ... or len(value) == len(inner)):
            each = [inner[0]] * len(value) if inner[-1] is ... else inner
            pairs = enumerate(zip(each, value, strict=True))
            return tuple(_checked(t, v, f"{path}[{i}]") for i, (t, v) in pairs)
    elif origin is dict:
        if isinstance(value, dict):
            if inner[1] is Any:
                return value
            return {k: _checked(inner[1], v, f"{path}[{k[:40]}]") for k, v in value.items()}
    elif is_dataclass(wanted):
        if isinstance(value, dict):
            return record_of(typing.cast(type, wanted), value, path)
    elif _is_of(wanted, value):
        return float(value) if wanted is float else value
    raise MessageError(f"{path}: {_named(wanted)} belongs here, not {json.dumps(value)[:60]}")


def _is_of(wanted: Any, value: Any) -> bool:
    if wanted is float:
        numeric = isinstance(value, int | float) and not isinstance(value, bool)
        return numeric and value == value and abs(value) <= 1e300
    if wanted is int:
        return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**53
    return isinstance(value, wanted)


def _member(inner: tuple[Any, ...], value: Any, path: str) -> Any:
    """Return a JSON value as one of several types: the first that it fits.

    Raises:
        MessageError: It fits none.
    """
    first: MessageError | None = None
    for wanted in inner:
        try:
            return _checked(wanted, value, path)
        except MessageError as error:
            # The deepest error: a record with one wrong field, not a value of another type.
            if first is None or len(str(error).split(":")[0]) > len(str(first).split(":")[0]):
                first = error
    assert first is not None
    if str(first).startswith(f"{path}: "):
        names = " or ".join(map(_named, inner))
        raise MessageError(f"{path}: {names} belongs here, not {json.dumps(value)[:60]}")
    raise first


_NAMES: Final[Mapping[Any, str]] = {
    **{str: "a text", int: "a whole number", float: "a finite number", bool: "true or false"},
    types.NoneType: "null",
}


def _named(wanted: Any) -> str:
    """Return a type's name for people."""
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return f"a {inner[1]}"
    if origin is Literal:
        return " or ".join(map(repr, inner))
    if origin in (Union, types.UnionType):
        return " or ".join(map(_named, inner))
    if origin is tuple:
        return "a list" if inner[-1] is ... else f"a list of {len(inner)}"
    if origin is dict or is_dataclass(wanted):
        return "an object"
    return _NAMES[wanted]
