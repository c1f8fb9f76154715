"""Objects that stay as they were made: copies are themselves, and they stay in their process.

Input: nothing. Output: a base class for shapes, materials, lights and their like.
Their functions and types are known by identity, so another process could do nothing with them.
"""

from __future__ import annotations

from typing import Any, NoReturn, Self


class Immutable:
    """What does not change, and so need not be copied."""

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
