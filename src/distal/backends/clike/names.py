"""Names in emitted text: the author's own where the target allows, made safe and unique.

Input: names of the IR. Output: identifiers that GLSL and WGSL both take as identifiers: ASCII, no
double underscore, of bounded length, none that the target reserves. Equal input gives equal names.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

_GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)")
# WebGL 1 refuses identifiers of more than 256 characters; numbers may be appended to this.
_LONGEST: Final = 200


@dataclass(frozen=True, slots=True)
class Reserved:
    """What no name of the author's may be in a text.

    Attributes:
        words: Keywords, built-ins, and what the text or its host declares.
        prefixes: What no name may begin with.
        parts: What no name may contain: a host replaces it wherever it stands. Each has an
            underscore, and is harmless without.
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
        """The same with more words."""
        return replace(self, words=self.words.union(words))


def _letter(char: str) -> str:
    """A letter that no target takes, in letters that each takes: a Greek one by its name."""
    if char.isascii():
        return char
    plain = "".join(c for c in unicodedata.normalize("NFKD", char) if c.isascii())
    if plain:
        return plain
    greek = _GREEK.match(unicodedata.name(char, ""))
    return greek[1].lower() if greek else f"u{ord(char):x}"


def safe_name(wanted: str, reserved: Reserved) -> str:
    """``wanted`` if the target takes it as a name, else something close to it."""
    name = "".join(map(_letter, wanted))
    # Names with two underscores in a row belong to the implementation (GLSL) or are refused (WGSL).
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", name))[:_LONGEST]
    if name in ("", "_"):
        name = "unused"
    for part in reserved.parts:
        name = name.replace(part, part.replace("_", ""))
    # Also "gl" itself: with a number it is gl_2.
    if f"{name}_".startswith(reserved.prefixes):
        name = f"own_{name.lstrip('_')}"
    if name[0].isdigit():
        name = f"n{name}"
    return name.removesuffix("_") + "_" if name in reserved else name


class Namer:
    """Hands out names of one scope, no name twice."""

    def __init__(self, reserved: Reserved, taken: Iterable[str] = ()) -> None:
        self._reserved = reserved
        self._taken = set(taken)

    def inner(self, visible: Iterable[str] | None = None) -> Namer:
        """A namer of a scope inside, whose names hide none of ``visible``; None: of all so far."""
        return Namer(self._reserved, self._taken if visible is None else visible)

    def name(self, wanted: str) -> str:
        """A free name, ``wanted`` itself if it can be."""
        safe = safe_name(wanted, self._reserved)
        stem = safe.rstrip("_")
        name, count = safe, 2
        while name in self._taken or name in self._reserved:
            name, count = f"{stem}_{count}", count + 1
        self._taken.add(name)
        return name
