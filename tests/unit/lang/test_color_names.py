"""Names of colors: all of CSS, in any case; near misses get a hint."""

from __future__ import annotations

import pytest
from PIL import ImageColor

from distal.lang import color
from distal.lang.color_names import CODES, code_of_name, hint_for
from distal.lang.parameter_values import ColorNameError, as_color


def test_the_names_are_those_of_css():
    assert len(CODES) == 148
    for name, code in CODES.items():
        assert ImageColor.getrgb(name) == ImageColor.getrgb(code), name
    # Read from the specification by hand.
    assert CODES["tomato"] == "#ff6347"
    assert CODES["rebeccapurple"] == "#663399"
    assert CODES["lightgoldenrodyellow"] == "#fafad2"
    assert CODES["grey"] == CODES["gray"] == "#808080"


def test_case_and_outer_spaces_do_not_matter():
    assert code_of_name(" Tomato ") == code_of_name("TOMATO") == "#ff6347"
    assert as_color("c", "White") == (1.0, 1.0, 1.0)
    assert as_color("c", "tomato") == as_color("c", "#ff6347")


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("tomatto", "did you mean 'tomato'?"),
        ("dark-slate gray", "did you mean 'darkslategray'?"),
        ("transparent", "a color is opaque: write glass(), or render(transparent=True) for the"),
        ("#12345", None),
        ("xyzzy", None),
        ("", None),
        ("\u043a\u0440\u0430\u0441\u043d\u044b\u0439", None),
    ],
)
def test_a_text_that_is_no_color_gets_a_hint(text, hint):
    with pytest.raises(ColorNameError, match="takes a color like #rrggbb or tomato") as raised:
        as_color("c", text)
    assert (raised.value.hint or "").startswith(hint or "")
    assert (raised.value.hint is None) is (hint is None)
    assert hint_for(text) == raised.value.hint


def test_parameters_take_names():
    tint = color("Tint", "gold")
    assert tint.default == as_color("", "#ffd700")
    assert tint.parse("RebeccaPurple") == as_color("", "#663399")
    with pytest.raises(ValueError, match="did you mean 'gold'"):
        tint.parse("golld")
