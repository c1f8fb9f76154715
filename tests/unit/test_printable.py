"""Texts that others wrote are shown without what a terminal takes for a command."""

import sys
import unicodedata

import pytest

from distal.diagnostics import LONGEST_SHOWN, printable, printable_lines

UNSAFE = {"Cc", "Cf", "Cs", "Zl", "Zp"}


def test_no_control_or_format_character_of_unicode_is_left():
    every = map(chr, range(sys.maxunicode + 1))
    unsafe = "".join(c for c in every if unicodedata.category(c) in UNSAFE)
    assert len(unsafe) > 2000
    assert printable(unsafe, 10**6).isascii()
    kept = printable_lines(unsafe)
    assert set(filter(lambda c: not c.isascii() or ord(c) < 32, kept)) == {"\n", "\t"}


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("\x1b[2J", "\\x1b[2J"),
        ("a\nb\rc\td", "a\\nb\\rc\\td"),
        ("\x9b31m\x7f", "\\x9b31m\\x7f"),
        ("gro\u202exet.py", "gro\\u202exet.py"),
        ("a\u200bb\ufeff\u2066\u3164", "a\\u200bb\\ufeff\\u2066\\u3164"),
        ("\udc80", "\\x80"),  # a byte of a name that is no UTF-8
        ("\ud800", "\\ud800"),
        ("Größe 测试 🙂 हिन्दी", "Größe 测试 🙂 हिन्दी"),
        (None, "None"),
    ],
)
def test_what_is_shown(text, shown):
    assert printable(text) == shown


def test_a_long_text_is_cut():
    assert printable("x" * LONGEST_SHOWN) == "x" * LONGEST_SHOWN
    cut = printable("x" * 10**7)
    assert len(cut) == LONGEST_SHOWN
    assert cut.endswith("…")
    assert len(printable("\x1b" * 10**6, 50)) == 50
