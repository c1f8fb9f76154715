"""The kinds of messages: ``@message("look")`` makes a class the record of a kind.

Input: classes with annotated fields. Output: frozen records, and ``KINDS``, which has them all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final, TypeVar, dataclass_transform


@dataclass(frozen=True, slots=True)
class Message:
    """What all messages have: their kind."""

    kind: ClassVar[str]


KINDS: Final[dict[str, type[Message]]] = {}
_Made = TypeVar("_Made", bound=Message)


@dataclass_transform(frozen_default=True, kw_only_default=True)
def message(kind: str, result: type | None = None) -> Callable[[type[_Made]], type[_Made]]:
    """Return a decorator that makes a class the record of a kind of messages.

    Args:
        kind: The name of the kind in the JSON text.
        result: For a request that is answered by ``answer``: the type of its result.
    """

    def record(made: type[_Made]) -> type[_Made]:
        made.kind = kind
        if result is not None:
            made.result = result  # type: ignore[attr-defined]  # only requests have one
        complete = dataclass(frozen=True, slots=True, kw_only=True)(made)
        KINDS[kind] = complete
        return complete

    return record
