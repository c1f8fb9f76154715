"""Layout of text as outlines: chooses a font and places its glyphs.

Input: a text, a font's name or file. Output: a ``DrawnOutline``. Glyph distances are the font's
widths and kerning, without ligatures. Lines with letters that join, combine or run from right to
left are laid out by ``shaping``. The default font is the one inside Pillow, which is the same on
every machine; if it lacks a letter, the first known font of the machine that has all letters is
used.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any, Final

from distal.diagnostics import LoadError, Span
from distal.foreign_files import need, opened, reading, watched
from distal.frontend.problems import did_you_mean
from distal.lang.source_places import author_place
from distal.packages import imported
from distal.scene.objects.outlines import (
    EDGE_BYTES,
    DrawnOutline,
    Edge,
    font_tools,
    made_of,
    outline_pen,
)
from distal.scene.objects.shaping import (
    Shaper,
    lines_of,
    needs_shaping,
    shaper_of,
    shown_letters,
)
from distal.scene.tree.conversion import beside
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import FORMER_WORDS

ALIGNMENTS: Final = {"left": 0.0, "center": 0.5, "right": 1.0}
_PACKED: Final = (b"wOFF", b"wOF2")
SUFFIXES: Final = (".ttf", ".otf", ".ttc", ".otc")
# Names of common fonts with many letters.
KNOWN: Final = ("dejavusans", "notosansregular", "arialunicode", "arial", "segoeui", "helvetica")
# Height of capital letters in ems, if a font does not specify it.
CAPITALS: Final = 0.7


def text_outline(
    text: str,
    *,
    font: str | os.PathLike[str] | None = None,
    size: float = 1.0,
    justify: str = "center",
    line_spacing: float = 1.2,
    place: Span | None = None,
) -> DrawnOutline:
    r"""Return the outline of a text; the middle of its capital letters is at y = 0.

    Args:
        text: The text; "\n", "\r\n" and "\r" start a new line, a tab goes on at the next
            multiple of 4 letters.
        font: The font's file, or the name of an installed font; None for a default font.
        size: Font size; capital letters are about 0.7 times as high.
        justify: Position of x = 0 in each line: "left", "center" or "right".
        line_spacing: Distance between lines, as a multiple of ``size``.
        place: The author's line.

    Raises:
        SceneValueError: The text is blank, there is no such font, or it lacks a letter.
        SceneTypeError: ``text`` is not a string.
    """
    place = place or author_place()
    if not isinstance(text, str):
        refuse_kind(f"a text is what is written, not {text!r:.40}", None, place)
    if justify not in ALIGNMENTS:
        hint = f'justify="{FORMER_WORDS[justify]}"' if justify in FORMER_WORDS else None
        refuse(f"justify is 'left', 'center' or 'right', not {justify!r}", hint, place)
    for name, value in (("size", size), ("line_spacing", line_spacing)):
        if not 0.0 < value < math.inf:
            refuse(f"{name} must be above 0, not {value}", None, place)
    lines = lines_of(text, place)
    letters = shown_letters("".join(lines))
    if not "".join(letters).strip():
        refuse("a text needs a letter", None, place)
    face = _face(font, letters, place)
    scale = size / face.units
    middle = 0.5 * (face.capitals * scale - (len(lines) - 1) * line_spacing * size)
    edges: list[Edge] = []
    for i, line in enumerate(lines):
        glyphs, width = face.laid_out(line, place)
        origin = complex(-ALIGNMENTS[justify] * width * scale, -i * line_spacing * size - middle)
        edges += [tuple(origin + scale * p for p in edge) for edge in glyphs]
    if not edges:
        refuse("a text needs a letter that can be seen", None, place)
    return made_of(edges, "this text", place)


class Face:
    """An opened font.

    Attributes:
        units: Number of font units per em.
        capitals: Height of capital letters, in font units.

    Args:
        font: The font, of fontTools.
        name: The name of its file.
        data: The bytes of its file.
    """

    def __init__(self, font: Any, name: str, data: bytes) -> None:
        self._name, self._data = name, data
        self._shaper: Shaper | None = None
        self._order = font.getGlyphName
        self._glyphs = font.getGlyphSet()
        self._names: dict[int, str] = font.getBestCmap() or {}
        self._kerning = _Kerning(font)
        self.units = float(font["head"].unitsPerEm)
        sizes = font.get("OS/2")
        self.capitals = float(getattr(sizes, "sCapHeight", 0) or CAPITALS * self.units)

    def lacks(self, letters: set[str]) -> list[str]:
        """Return the letters that have no glyph in the font."""
        return sorted(c for c in letters if ord(c) not in self._names)

    def laid_out(self, line: str, place: Span | None) -> tuple[list[Edge], float]:
        """Return the edges of a line of text, from x = 0 on the baseline, and its width.

        Glyphs are decoded when they are drawn, so a font that is damaged may fail here.
        """
        if needs_shaping(line) and self._shaper is None:
            self._shaper = shaper_of(self._data, line, place)
        try:
            with reading("font", self._name, len(self._data)):
                return watched(lambda: self._laid_out(line, place))
        except LoadError as error:
            refuse(error.message, None, place)

    def _laid_out(self, line: str, place: Span | None) -> tuple[list[Edge], float]:
        at = 0.0
        edges: list[Edge] = []
        for name, before, offset, advance in self._placed(line):
            at += before
            pen = outline_pen(self._glyphs, place)
            self._glyphs[name].draw(pen)
            need((len(edges) + len(pen.edges)) * EDGE_BYTES, f"{len(edges):,} edges and more")
            edges += [tuple(at + offset + p for p in edge) for edge in pen.finished()]
            at += advance
        return edges, at

    def _placed(self, line: str) -> Iterator[tuple[str, float, complex, float]]:
        """Yield the glyphs of a line: name, kerning before it, offset and advance."""
        if needs_shaping(line):
            assert self._shaper is not None
            for number, advance, right, up in self._shaper.glyphs(line):
                yield self._order(number), 0.0, complex(right, up), float(advance)
            return
        before = None
        for letter in line:
            name = self._names[ord(letter)]
            kerning = self._kerning.between(before, name) if before else 0.0
            yield name, kerning, 0j, self._glyphs[name].width
            before = name


class _Kerning:
    """The kerning of pairs of glyphs, from the GPOS table, or else from the older kern table."""

    def __init__(self, font: Any) -> None:
        self._new = list(_pair_tables(font["GPOS"].table)) if "GPOS" in font else []
        self._old = font["kern"].kernTables if "kern" in font and not self._new else []

    def between(self, first: str, second: str) -> float:
        """Return the kerning in font units, from the first table that has the pair."""
        for table in self._new:
            if first in table.Coverage.glyphs:
                value = _pair_value(table, first, second)
                if value is not None:
                    return float(getattr(value, "XAdvance", 0) or 0)
        for table in self._old:
            by = getattr(table, "kernTable", {}).get((first, second))
            if by is not None:
                return float(by)
        return 0.0


def _pair_tables(table: Any) -> Iterator[Any]:
    """Yield the pair tables of the feature "kern", in order."""
    features = table.FeatureList.FeatureRecord if table.FeatureList else []
    kerning = [f.Feature.LookupListIndex for f in features if f.FeatureTag == "kern"]
    for index in sorted({index for indices in kerning for index in indices}):
        for found in table.LookupList.Lookup[index].SubTable:
            subtable = getattr(found, "ExtSubTable", found)
            if type(subtable).__name__ == "PairPos":
                yield subtable


def _pair_value(table: Any, first: str, second: str) -> Any:
    """Return a table's value for a pair if the table covers the first glyph, else None."""
    if table.Format == 1:
        pairs = table.PairSet[table.Coverage.glyphs.index(first)].PairValueRecord
        return next((pair.Value1 for pair in pairs if pair.SecondGlyph == second), None)
    before = table.ClassDef1.classDefs.get(first, 0)
    after = table.ClassDef2.classDefs.get(second, 0)
    # Class 0 contains all glyphs that the table does not name; a later table may name them.
    return table.Class1Record[before].Class2Record[after].Value1 if after else None


# Finding fonts


def _face(font: str | os.PathLike[str] | None, letters: set[str], place: Span | None) -> Face:
    """Return the requested font, or one that has all the letters."""
    face = _pillows_face() if font is None else _opened(_file_of(font, place), place)
    missing = face.lacks(letters) if face else sorted(letters)
    if face is not None and not missing:
        return face
    if font is None:
        installed = _installed()
        for name in KNOWN:
            if name in installed:
                other = _opened(installed[name], place)
                if not other.lacks(letters):
                    return other
    shown = ", ".join(repr(c) for c in missing[:8])
    has = "the font has no" if font is not None else "no font that is known has"
    refuse(f"{has} {shown}", "name another with font=", place)


def _file_of(font: str | os.PathLike[str], place: Span | None) -> str:
    if not isinstance(font, str | os.PathLike):
        refuse_kind(f"font is a file or a name, not {font!r:.40}", None, place)
    wanted = os.fspath(font)
    if wanted.lower().endswith(SUFFIXES):
        found = os.fspath(beside(wanted, place))
        if not os.path.isfile(found):
            refuse(f"there is no font file '{wanted}'", None, place)
        return found
    installed = _installed()
    plain = _plain(wanted)
    for name in (plain, plain + "regular"):
        if name in installed:
            return installed[name]
    hint = did_you_mean(plain, installed) or "give the font's file"
    refuse(f"there is no font '{wanted}' on this machine", hint, place)


def _plain(name: str) -> str:
    """Return a font's name without the differences between spellings of it."""
    return "".join(c for c in name.lower() if c.isalnum())


def _opened(file: str, place: Span | None) -> Face:
    try:
        return _open_file(file, os.stat(file).st_mtime_ns)
    except LoadError as error:
        refuse(error.message, None, place)
    except OSError as error:
        name = os.path.basename(file)
        refuse(f"the font '{name}' cannot be read: {error.strerror or error}", None, place)


@lru_cache(maxsize=8)
def _open_file(file: str, changed: int) -> Face:
    name = os.path.basename(file)
    fonts = font_tools("ttLib", None)
    with opened("font", file, name=name) as data:
        if data.startswith(_PACKED):  # each table may unpack to any length, in one call
            raise LoadError("it is a packed font of web pages (WOFF): convert it to .ttf or .otf")
        return watched(lambda: Face(fonts.TTFont(BytesIO(data), fontNumber=0), name, data))


@lru_cache(maxsize=1)
def _pillows_face() -> Face | None:
    """Return the font inside Pillow, or None if Pillow was built without FreeType."""
    images: Any = imported("PIL.ImageFont")
    data = getattr(images.load_default(10), "font_bytes", None)
    if not data:
        return None
    return Face(font_tools("ttLib", None).TTFont(BytesIO(data)), "of Pillow", data)


@lru_cache(maxsize=1)
def _installed() -> dict[str, str]:
    """Return the installed fonts: files by normalised name, the first found of each."""
    found: dict[str, str] = {}
    for folder in _folders():
        for file in sorted(folder.rglob("*")):
            if file.suffix.lower() in SUFFIXES:
                found.setdefault(_plain(file.stem), str(file))
    return found


def _folders() -> list[Path]:
    home = Path.home()
    if sys.platform == "win32":
        windows = Path(os.environ.get("WINDIR", "C:/Windows"))
        own = Path(os.environ.get("LOCALAPPDATA", home)) / "Microsoft" / "Windows"
        places = [own / "Fonts", windows / "Fonts"]
    elif sys.platform == "darwin":
        places = [home / "Library/Fonts", Path("/Library/Fonts"), Path("/System/Library/Fonts")]
    else:
        data = os.environ.get("XDG_DATA_HOME") or home / ".local/share"
        shared = os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share"
        roots = [Path(data), *map(Path, shared.split(":"))]
        places = [*(root / "fonts" for root in roots), home / ".fonts"]
    return [place for place in places if place.is_dir()]
