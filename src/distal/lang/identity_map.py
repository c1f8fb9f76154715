"""A map whose keys are objects by identity, kept as long as these live.

Input: objects that can be referred to weakly. Output: values. For objects that are equal by value,
where each has something of its own: its source file, its places in messages.
"""

from __future__ import annotations

from typing import Any, Generic, TypeVar, overload
from weakref import ref

Value = TypeVar("Value")
Default = TypeVar("Default")


class IdentityMap(Generic[Value]):
    """Values of objects, forgotten with the objects."""

    __slots__ = ("__weakref__", "_rows")

    def __init__(self) -> None:
        self._rows: dict[int, tuple[ref[Any], Value]] = {}

    @overload
    def get(self, key: object) -> Value | None: ...
    @overload
    def get(self, key: object, default: Default) -> Value | Default: ...
    def get(self, key: object, default: Any = None) -> Any:
        """Return the value of an object, or the default."""
        row = self._rows.get(id(key))
        return default if row is None else row[1]

    def __setitem__(self, key: object, value: Value) -> None:
        self._rows[id(key)] = self._row(key, value)

    def setdefault(self, key: object, value: Value) -> Value:
        """Return the value of an object, which it gets if it has none."""
        return self._rows.setdefault(id(key), self._row(key, value))[1]

    def __contains__(self, key: object) -> bool:
        return id(key) in self._rows

    def __len__(self) -> int:
        return len(self._rows)

    def _row(self, key: object, value: Value) -> tuple[ref[Any], Value]:
        number, rows = id(key), self._rows

        def forget(dead: ref[Any]) -> None:
            row = rows.get(number)
            if row is not None and row[0] is dead:  # not that of a later object at its address
                del rows[number]

        return ref(key, forget), value
