"""Texts in scripts that join, combine or run from right to left; line ends and odd characters."""

from __future__ import annotations

import numpy as np
import pytest

from distal import CompileError, Text
from distal.scene.objects import lettering, shaping

pytest.importorskip("uharfbuzz")
pytest.importorskip("bidi")

HEBREW, ARABIC = "\u05e9\u05dc\u05d5\u05dd", "\u0633\u0644\u0627\u0645"


def has_font(letters: str) -> bool:
    try:
        Text(letters)
    except CompileError:
        return False
    return True


needs_hebrew = pytest.mark.skipif(not has_font("\u05e9"), reason="no font with Hebrew letters")
needs_arabic = pytest.mark.skipif(not has_font("\u0633"), reason="no font with Arabic letters")


def agreement(part: Text, whole: Text, side: int) -> float:
    """The share of places where a letter agrees with a word at its left (0) or right end (1)."""
    low, high = part.bounds()
    axes = [np.linspace(low[i], high[i], 50) for i in (0, 1)]
    grid = np.stack(np.meshgrid(*axes), -1).reshape(-1, 2)
    shift = whole.bounds()[side][0] - part.bounds()[side][0]
    return float(((part(grid) < 0) == (whole(grid + np.array([shift, 0.0])) < 0)).mean())


@needs_hebrew
def test_hebrew_runs_from_right_to_left():
    first, last, word = Text(HEBREW[0]), Text(HEBREW[-1]), Text(HEBREW)
    assert agreement(first, word, 1) > 0.99 > 0.9 > agreement(first, word, 0)
    assert agreement(last, word, 0) > 0.99


@needs_arabic
def test_arabic_letters_join():
    # The first letter has a long tail at its left, which it loses where it joins.
    widths = [Text(c).bounds()[1][0] - Text(c).bounds()[0][0] for c in ARABIC]
    low, high = Text(ARABIC[:2]).bounds()
    assert high[0] - low[0] < 0.95 * sum(widths[:2])
    # With a letter between them that does not join, both keep their forms.
    assert agreement(Text(ARABIC[0]), Text(ARABIC[:2]), 1) < 0.97
    assert agreement(Text(ARABIC[3]), Text(ARABIC), 0) > 0.97


@needs_hebrew
def test_brackets_turn_to_what_they_hold():
    assert shaping.mirrored(")321( abc") == "(321) abc"
    assert shaping.mirrored("abc (1) )2( [)x(]") == "abc (1) (2) [(x)]"
    assert shaping.mirrored("\u05d0<\u05d1 a<b") == "\u05d0>\u05d1 a<b"
    low, high = Text(f"({HEBREW})").bounds()
    # A bracket is round to the outside at both ends.
    ends = Text(f"({HEBREW})")
    middle = 0.5 * (low[1] + high[1])
    assert ends((low[0] + 0.02, middle)) < ends((low[0] + 0.02, high[1]))


def test_line_ends_are_one_line_end_and_invisible_characters_nothing():
    plain = Text("A\nB").outline().area
    for text in ("A\r\nB", "A\rB", "A\u2028B", "\ufeffA\n\u200bB", "A\nB\u00ad"):
        assert Text(text).bounds() == Text("A\nB").bounds(), repr(text)
        assert Text(text).outline().area == pytest.approx(plain)
    assert Text("A\tB").bounds() == Text("A   B").bounds()


def test_marks_of_direction_are_nothing():
    low, high = Text("abc").bounds()
    for text in ("\u200fabc\u200f", "abc \u200f", "abc\u202e"):
        found = Text(text, justify="left").bounds()
        assert found[1][1] - found[0][1] == pytest.approx(high[1] - low[1]), repr(text)
    assert Text("A\n\u200f").bounds() == Text("A\n ").bounds()


def test_decomposed_letters_are_the_composed_ones():
    assert Text("e\u0301A\u030a").bounds() == Text("\u00e9\u00c5").bounds()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a\x07b", "a text cannot show the control character '\\x07'"),
        ("a\ud800b", "a text cannot show the half of a character, '\\ud800'"),
        ("\u200b\n\ufeff", "a text needs a letter"),
        ("\u200f", "a text needs a letter"),
        ("\U0010fffd", r"no font that is known has '\U0010fffd'"),
    ],
)
def test_what_cannot_be_shown_is_refused(text, message):
    with pytest.raises(CompileError) as error:
        Text(text)
    assert message in error.value.diagnostics[0].message


@needs_hebrew
def test_without_the_packages_the_text_and_the_extra_are_named(monkeypatch):
    def missing(name):
        raise shaping.PackageError(f"no {name}", is_missing=True)

    monkeypatch.setattr(shaping, "imported", missing)
    monkeypatch.setattr(lettering.Face, "_shaper", None, raising=False)
    lettering._open_file.cache_clear()
    with pytest.raises(CompileError) as error:
        Text(HEBREW)
    assert "join, combine or run from right to left: they need the packages uharfbuzz and" in str(
        error.value
    )
    assert "pip install 'distal[text]'" in str(error.value)
    assert Text("A").outline().area > 0.0
