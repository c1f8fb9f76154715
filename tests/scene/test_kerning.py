"""How far apart letters stand, in fonts made here: square letters, so that boxes tell."""

from __future__ import annotations

import pytest

from distal.scene.objects.lettering import text_outline

pytest.importorskip("fontTools")

from fontTools.feaLib.builder import addOpenTypeFeaturesFromString
from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import newTable
from fontTools.ttLib.tables._k_e_r_n import KernTable_format_0

WIDTH, LEFT, RIGHT = 500, 100, 400  # of 1000 units: a letter's advance, and its square's sides
PAIRS = """
feature kern {
    pos a b -80;
    pos b a <20 0 0 0>;
    pos [a c] [c d] 60;
} kern;
feature dist { pos c b 300; } dist;
"""
NEW = {"ab": -80, "ba": 0, "ac": 60, "cd": 60, "bc": 0, "cb": 0, "bb": 0}


def font(features: str = "", old: dict[tuple[str, str], int] | None = None) -> FontBuilder:
    """Letters a to d, each a square."""
    names = [".notdef", *"abcd"]
    pen = TTGlyphPen(None)
    pen.moveTo((LEFT, 0))
    for corner in ((LEFT, 700), (RIGHT, 700), (RIGHT, 0)):
        pen.lineTo(corner)
    pen.closePath()
    made, square = FontBuilder(1000, isTTF=True), pen.glyph()
    made.setupGlyphOrder(names)
    made.setupCharacterMap({ord(name): name for name in "abcd"})
    made.setupGlyf(dict.fromkeys(names, square))
    made.setupHorizontalMetrics(dict.fromkeys(names, (WIDTH, LEFT)))
    made.setupHorizontalHeader(ascent=800, descent=-200)
    made.setupPost()
    if features:
        addOpenTypeFeaturesFromString(made.font, features)
    if old is not None:
        table = KernTable_format_0()
        table.coverage, table.format, table.kernTable = 1, 0, old
        made.font["kern"] = newTable("kern")
        made.font["kern"].version, made.font["kern"].kernTables = 0, [table]
    return made


def kerning(made: FontBuilder, folder, text: str) -> int:
    """By how many units the second letter stands farther than the first one's width."""
    path = folder / "made.ttf"
    made.save(path)
    outline = text_outline(text, font=path, justify="left")
    across = outline.high[0] - outline.low[0]
    return round(1000 * across - (WIDTH + RIGHT - LEFT))


@pytest.mark.parametrize("text", NEW)
@pytest.mark.parametrize("extension", [False, True], ids=["plain", "extension"])
def test_pairs_and_classes_of_the_new_table(tmp_path, text, extension):
    lookup = "lookup k useExtension {{ {} }} k;"
    inner = PAIRS.partition("{")[2].partition("}")[0]
    features = PAIRS.replace(inner, lookup.format(inner), 1) if extension else PAIRS
    assert kerning(font(features), tmp_path, text) == NEW[text]


@pytest.mark.parametrize(("text", "units"), [("ab", -50), ("ba", 0), ("ac", 70)])
def test_pairs_of_the_old_table(tmp_path, text, units):
    old = {("a", "b"): -50, ("a", "c"): 70}
    assert kerning(font(old=old), tmp_path, text) == units


def test_the_new_table_counts_where_there_are_both(tmp_path):
    both = font(PAIRS, {("a", "b"): 10, ("b", "b"): 10})
    assert kerning(both, tmp_path, "ab") == -80
    assert kerning(both, tmp_path, "bb") == 0


def test_nothing_is_moved_without_tables(tmp_path):
    assert kerning(font(), tmp_path, "ab") == 0
