"""Scripts whose letters join, combine or run from right to left: by HarfBuzz and python-bidi.

Input: a line of text and an opened font. Output: its glyphs from left to right, with their places.
Lines that need none of this are laid out by ``lettering`` alone, without these packages.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator
from itertools import groupby
from typing import Any, Final

from distal.diagnostics import Span
from distal.packages import PackageError, imported
from distal.scene.tree.errors import refuse

# Blocks of scripts whose letters change with their neighbors: Hangul's parts, those of India and
# South-East Asia, Mongolian, and their extensions.
_COMPLEX: Final = (
    (0x0900, 0x0DFF),
    (0x0F00, 0x109F),
    (0x1100, 0x11FF),
    (0x1700, 0x18AF),
    (0x1900, 0x1CFF),
    (0xA800, 0xABFF),
    (0x11000, 0x11FFF),
)
_MARKS: Final = ("Mn", "Mc", "Me")
_BACKWARDS: Final = ("R", "AL")
# Characters that say how others join, which a font need not have.
JOINERS: Final = "\u200c\u200d"
# Without a glyph and without a width: where a line may be broken, and a mark of the byte order.
_INVISIBLE: Final = dict.fromkeys(map(ord, "\u200b\u2060\ufeff\u00ad"))
_LINE_ENDS: Final = ("\r\n", "\r", "\u2028", "\u2029", "\x85")
_PAIRS: Final = {
    begin: close for begin, close in ("()", "[]", "{}", "<>", "\u00ab\u00bb", "\u2039\u203a")
}
_MIRRORED: Final = {**_PAIRS, **{close: begin for begin, close in _PAIRS.items()}}
_TAB: Final = 4  # letters


def lines_of(text: str, place: Span | None) -> list[str]:
    """Return the lines of a text, in composed letters.

    Raises:
        SceneValueError: The text holds control characters or halves of characters.
    """
    for end in _LINE_ENDS:
        text = text.replace(end, "\n")
    lines = text.translate(_INVISIBLE).expandtabs(_TAB).split("\n")
    for line in lines:
        for letter in line:
            if unicodedata.category(letter) in ("Cc", "Cs"):
                kind = "control character" if ord(letter) < 256 else "half of a character,"
                refuse(f"a text cannot show the {kind} {letter!r}", "leave it out", place)
    return [unicodedata.normalize("NFC", line) for line in lines]


def needs_shaping(line: str) -> bool:
    """Return whether letters of a line join, combine, or run from right to left."""
    return any(
        unicodedata.category(c) in (*_MARKS, "Cf")
        or unicodedata.bidirectional(c) in (*_BACKWARDS, "AN")
        or any(low <= ord(c) <= high for low, high in _COMPLEX)
        for c in line
        if not c.isascii()
    )


def shown_letters(line: str) -> set[str]:
    """Return the letters of a line for which a font needs glyphs."""
    return {c for c in line if unicodedata.category(c) != "Cf"}


class Shaper:
    """A font of HarfBuzz.

    Args:
        data: The bytes of the font's file.
    """

    def __init__(self, data: bytes) -> None:
        self._harfbuzz: Any = imported("uharfbuzz")
        self._font = self._harfbuzz.Font(self._harfbuzz.Face(data))

    def glyphs(self, line: str) -> Iterator[tuple[int, int, int, int]]:
        """Yield the glyphs of a line from left to right: number, advance, and offsets in x and y.

        The direction of the line is that of its first letter that has one.
        """
        for backwards, letters in _runs(mirrored(imported("bidi").get_display(line))):
            buffer = self._harfbuzz.Buffer()
            buffer.add_str(letters[::-1] if backwards else letters)
            buffer.guess_segment_properties()
            buffer.direction = "rtl" if backwards else "ltr"
            self._harfbuzz.shape(self._font, buffer)
            # A run of marks of direction alone has no glyphs, and then there is None.
            positions = buffer.glyph_positions or ()
            for info, at in zip(buffer.glyph_infos, positions, strict=True):
                yield info.codepoint, at.x_advance, at.x_offset, at.y_offset


def shaper_of(data: bytes, line: str, place: Span | None) -> Shaper:
    """Return the shaper of a font.

    Raises:
        SceneValueError: A package is missing or broken.
    """
    try:
        imported("bidi")
        return Shaper(data)
    except PackageError as error:
        why = "" if error.is_missing else f" ({error})"
        refuse(
            f"the letters of {line!r:.40} join, combine or run from right to left: they need the "
            f"packages uharfbuzz and python-bidi{why}",
            "pip install 'distal[text]'",
            place,
        )


def mirrored(shown: str) -> str:
    """Return a line in the order in which it is shown, with its brackets turned to what they hold.

    A pair stands in a part from right to left if its second bracket is shown first; a bracket
    without the other if both letters beside it do.
    """
    letters, waiting = list(shown), list[int]()
    for i, letter in enumerate(shown):
        if letter not in _MIRRORED:
            continue
        other = next((j for j in reversed(waiting) if shown[j] == _MIRRORED[letter]), None)
        if other is None:
            waiting.append(i)
            continue
        del waiting[waiting.index(other) :]
        if letter in _PAIRS:
            letters[i], letters[other] = shown[other], letter
    for i in waiting:
        beside = [*_strong(shown[i::-1]), *_strong(shown[i:])]
        if beside and all(kind in _BACKWARDS for kind in beside):
            letters[i] = _MIRRORED[shown[i]]
    return "".join(letters)


def _strong(letters: str) -> list[str]:
    """Return the direction of the first letter that has one, if there is such a letter."""
    kinds = (unicodedata.bidirectional(c) for c in letters)
    return [k for k in kinds if k in ("L", *_BACKWARDS)][:1]


def _runs(shown: str) -> list[tuple[bool, str]]:
    """Return the runs of one direction of a line that is in the order in which it is shown.

    Marks stand before their letter in a run from right to left. Spaces and signs between two runs
    are in the order, and have the form, in which they are shown.
    """
    backwards = [unicodedata.bidirectional(c) in _BACKWARDS for c in shown]
    for i, c in enumerate(shown):
        if unicodedata.category(c) in _MARKS or c in JOINERS:
            follows = next(
                (
                    backwards[j]
                    for j in range(i + 1, len(shown))
                    if unicodedata.category(shown[j]) not in _MARKS and shown[j] not in JOINERS
                ),
                False,
            )
            belongs = (
                i > 0 and not backwards[i - 1] and unicodedata.category(shown[i - 1])[0] in "LM"
            )
            backwards[i] = (follows or (i > 0 and backwards[i - 1])) and not belongs
    pairs = zip(backwards, shown, strict=True)
    return [
        (
            is_backwards,
            "".join(c for _, c in run if c in JOINERS or unicodedata.category(c) != "Cf"),
        )
        for is_backwards, run in groupby(pairs, key=lambda pair: pair[0])
    ]
