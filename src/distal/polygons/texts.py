"""Texts of meshes: their encoding, and numbers with the line in which they are.

Input: bytes. Output: the same without a byte order mark; numbers. Errors name the line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from distal.diagnostics import LoadError, printable

_MARK: Final = b"\xef\xbb\xbf"
_WIDE: Final = (b"\xff\xfe", b"\xfe\xff")
_LINE_END: Final = re.compile(rb"\r\n?|\n")
_COMMA: Final = re.compile(rb"[+-]?\d+,\d+")
_LONGEST: Final = 40


def text_of(data: bytes) -> bytes:
    """Return a text without its byte order mark.

    Raises:
        LoadError: It is in UTF-16.
    """
    if data.startswith(_WIDE):
        raise LoadError("it is text in UTF-16: save it in UTF-8")
    return data.removeprefix(_MARK)


def line_of(data: bytes, at: int) -> int:
    """Return the number of the line of a byte; the first one is 1."""
    return 1 + sum(1 for _ in _LINE_END.finditer(data, 0, at))


def numbers(words: Sequence[bytes]) -> list[float]:
    """Return what words say, each of them a number that is finite.

    Raises:
        LoadError: One of them is no such number; the message names it, without a line.
    """
    try:
        found = [float(word) for word in words]
    except ValueError:
        found = []
    # Python's own numbers may have underscores, those of files never.
    if (
        len(found) == len(words)
        and b"_" not in b"".join(words)
        and all(-1e300 < value < 1e300 for value in found)
    ):
        return found
    raise LoadError(next(filter(None, map(_wrong, words)), "a number is missing"))


def _wrong(word: bytes) -> str:
    """Return what is wrong with a word as a number; empty for nothing."""
    shown = printable(word[:_LONGEST].decode("utf-8", "replace"))
    try:
        value = float(word)
    except ValueError:
        if _COMMA.fullmatch(word):
            return f"'{shown}' has a decimal comma: write a point"
        return f"'{shown}' is no number"
    if b"_" in word:
        return f"'{shown}' is no number"
    return "" if -1e300 < value < 1e300 else f"'{shown}' is no finite number"
