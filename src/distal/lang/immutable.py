"""A base class for immutable objects, such as shapes, materials and lights.

A copy is the same object. Pickling is refused: the functions and types of such an object are
compared by identity, so it would be useless in another process.
"""

from __future__ import annotations

from typing import Any, NoReturn, Self


class Immutable:
    """Base class of immutable objects; copying returns the same object."""

    __slots__ = ()

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(
            f"{self!r:.60} cannot be pickled; make it again in the other process, or load its file "
            "there: distal.load(file)"
        )
