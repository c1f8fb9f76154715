"""Make the names in emitted text: the author's names if possible, else changed to be valid.

Input: names of the IR. Output: unique identifiers that are valid in GLSL and WGSL: ASCII, without
double underscores, of limited length, not reserved by the target. Equal input gives equal names.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

_GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)")
# WebGL 1 rejects identifiers of more than 256 characters; this leaves room for numbers.
_LONGEST: Final = 200


@dataclass(frozen=True, slots=True)
class Reserved:
    """The names that a text must not declare.

    Attributes:
        words: Keywords, built-ins, and the names that the text or its host declares.
        prefixes: No name may begin with these.
        parts: No name may contain these, because a host replaces them anywhere. Each contains an
            underscore; without it, the part is harmless.
    """

    words: frozenset[str]
    prefixes: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()

    def __contains__(self, name: str) -> bool:
        return (
            name in self.words
            or name.startswith(self.prefixes)
            or any(part in name for part in self.parts)
        )

    def __or__(self, words: Iterable[str]) -> Reserved:
        """Return a copy with more words."""
        return replace(self, words=self.words.union(words))


def _letter(char: str) -> str:
    """Return a non-ASCII letter as ASCII letters; a Greek letter becomes its name."""
    if char.isascii():
        return char
    plain = "".join(c for c in unicodedata.normalize("NFKD", char) if c.isascii())
    if plain:
        return plain
    greek = _GREEK.match(unicodedata.name(char, ""))
    return greek[1].lower() if greek else f"u{ord(char):x}"


def safe_name(wanted: str, reserved: Reserved) -> str:
    """Return ``wanted`` if it is a valid name, else a similar valid name."""
    name = "".join(map(_letter, wanted))
    # Double underscores are reserved for the implementation (GLSL) or invalid (WGSL).
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", name))[:_LONGEST]
    if name in ("", "_"):
        name = "unused"
    for part in reserved.parts:
        name = name.replace(part, part.replace("_", ""))
    # Also "gl" itself: with a number it would become gl_2.
    if f"{name}_".startswith(reserved.prefixes):
        name = f"own_{name.lstrip('_')}"
    if name[0].isdigit():
        name = f"n{name}"
    return name.removesuffix("_") + "_" if name in reserved else name


class Namer:
    """Makes unique names for one scope."""

    def __init__(self, reserved: Reserved, taken: Iterable[str] = ()) -> None:
        self._reserved = reserved
        self._taken = set(taken)

    def inner(self, visible: Iterable[str] | None = None) -> Namer:
        """Return a namer for an inner scope; its names do not shadow those in ``visible``.

        None for ``visible`` means all names made so far.
        """
        return Namer(self._reserved, self._taken if visible is None else visible)

    def name(self, wanted: str) -> str:
        """Return an unused name: ``wanted`` if possible."""
        safe = safe_name(wanted, self._reserved)
        stem = safe.rstrip("_")
        name, count = safe, 2
        while name in self._taken or name in self._reserved:
            name, count = f"{stem}_{count}", count + 1
        self._taken.add(name)
        return name
