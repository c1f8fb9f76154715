"""The names that the studio completes are those that there are."""

from __future__ import annotations

from tools import gen_names


def test_the_table_is_fresh():
    assert gen_names.FILE.read_text(encoding="utf-8") == gen_names.text(), (
        "run tools/gen_names.py, then build web/"
    )


def test_it_has_arguments_and_sentences():
    text = gen_names.text()
    assert '"Sphere": ["(radius=1.0)", "Ball, centred at the origin."]' in text
    assert '"smoothstep": ["(low, high, x)"' in text
    assert '"union": ["(*others, smooth=0.0, blend=\'quadratic\')"' in text
    assert text.isascii()
