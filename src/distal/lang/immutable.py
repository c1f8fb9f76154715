"""A base class for immutable objects, such as shapes, materials and lights.

A copy is the same object. What an author makes can be pickled (``_pickled``); views of it and
other parts of a compilation cannot.
"""

from __future__ import annotations

from typing import Any, Self


class Immutable:
    """Base class of immutable objects; copying returns the same object."""

    __slots__ = ()

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __reduce_ex__(self, protocol: object) -> Any:
        return self._pickled()

    def _pickled(self) -> Any:
        """Return what ``__reduce__`` gives.

        Raises:
            TypeError: Objects of this class stay in their process.
        """
        raise TypeError(
            f"{self!r:.60} cannot be pickled; make it again in the other process, or load its file "
            "there: distal.load(file)"
        )
