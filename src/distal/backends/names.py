"""Names in emitted text: the author's own where the target allows, made safe and unique.

In: names of the IR. Out: identifiers that GLSL and WGSL both take as identifiers: ASCII, no double
underscore, none of the words that the target keeps. Equal input gives equal names.
"""

from __future__ import annotations

import re
import unicodedata

_GREEK = re.compile(r"GREEK (?:SMALL|CAPITAL) LETTER (?:FINAL )?(\w+)")


def _letter(char: str) -> str:
    """A letter that no target takes, in letters that each takes: a Greek one by its name."""
    if char.isascii():
        return char
    plain = "".join(c for c in unicodedata.normalize("NFKD", char) if c.isascii())
    if plain:
        return plain
    greek = _GREEK.match(unicodedata.name(char, ""))
    return greek[1].lower() if greek else f"u{ord(char):x}"


def safe_name(wanted: str, reserved: frozenset[str]) -> str:
    """``wanted`` if the target takes it as a name, else something close to it."""
    name = "".join(map(_letter, wanted))
    # Names with two underscores in a row belong to the implementation (GLSL) or are refused (WGSL).
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", name))
    if name in ("", "_"):
        name = "unused"
    if name.startswith("gl_"):
        name = f"own_{name}"
    if name[0].isdigit():
        name = f"n{name}"
    return name.removesuffix("_") + "_" if name in reserved else name


class Namer:
    """Hands out names of one scope, no name twice."""

    def __init__(self, reserved: frozenset[str], taken: frozenset[str] = frozenset()) -> None:
        self._reserved = reserved
        self._taken = set(taken)

    def name(self, wanted: str) -> str:
        """A free name, ``wanted`` itself if it can be."""
        safe = safe_name(wanted, self._reserved)
        stem = safe.rstrip("_")
        name, count = safe, 2
        while name in self._taken or name in self._reserved:
            name, count = f"{stem}_{count}", count + 1
        self._taken.add(name)
        return name
