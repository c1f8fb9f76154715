"""Parameters: definitions refuse nonsense by name, values are checked against kind and range."""

import math

import numpy as np
import pytest

from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3
from distal.lang.parameters import choice, color, integer, point, slider, toggle

SOFT = slider("Blend softness", 0.3)
STEPS = integer("Steps", 64, 16, 96)
MODE = choice("Mode", ["flat", "lit", "2"], "lit")


@pytest.mark.parametrize(
    ("label", "name"),
    [
        ("Blend softness", "blend_softness"),
        ("  Größe / mm ", "grosse_mm"),
        ("a__b--c_", "a_b_c"),
        ("3D", "p_3d"),
        ("Épaisseur", "epaisseur"),
        ("半径", "半径"),
        ("Радиус (мм)", "радиус_мм"),
        ("Ø", "ø"),
        ("µ", "μ"),
        ("x²", "x2"),
        ("①", "p_1"),
        ("٣ نقاط", "p_٣_نقاط"),
        ("Ghế", "ghe"),
    ],
)
def test_name_is_an_identifier_made_of_the_label(label, name):
    assert slider(label, 0.5).name == name


def test_chosen_name_is_kept_in_the_form_of_python():
    assert slider("°", 0.5, name="Winkel").name == "Winkel"
    assert integer("A", 1, name="ﬁn").name == "fin"


@pytest.mark.parametrize(
    ("parameter", "type", "default"),
    [
        (SOFT, FLOAT, 0.3),
        (STEPS, INT, 64),
        (toggle("On", True), BOOL, True),
        (MODE, INT, 1),
        (color("C", "#ff0000"), VEC3, (1.0, 0.0, 0.0)),
        (point("P", (1, 2)), VEC2, (1.0, 2.0)),
        (point("P"), VEC3, (0.0, 0.0, 0.0)),
    ],
)
def test_type_and_default(parameter, type, default):
    assert parameter.type is type
    assert parameter.default == default
    assert parameter.check(default) == default


def test_hex_color_is_decoded_from_srgb():
    # Middle grey: 128/255 encoded is 0.2158605 linear (IEC 61966-2-1).
    assert color("C", "#808080").default == pytest.approx((0.2158605,) * 3, abs=1e-7)
    assert color("C", "#f80").default == color("C", "#ff8800").default


@pytest.mark.parametrize(
    ("define", "error", "words"),
    [
        (lambda: slider("", 0.5), ValueError, "needs a label"),
        (lambda: slider("°", 0.5), ValueError, 'choose one: name="…"'),
        (
            lambda: slider("a", 0.5, name="a b"),
            ValueError,
            "with a letter, like radius_2, not 'a b'",
        ),
        (lambda: toggle("a", name="class"), ValueError, "Python identifier"),
        (lambda: slider("a", 0.5, name="__proto__"), ValueError, "begins with a letter"),
        (lambda: point("a", name=""), ValueError, "Python identifier"),
        (lambda: color("a", name=7), TypeError, "'a': name is a text, not int"),
        (lambda: slider("a\nb", 0.5), ValueError, "one line"),
        (lambda: slider(3, 0.5), TypeError, "label is a text"),
        (lambda: slider("A", 0.5, 1.0, 0.0), ValueError, "'A': low (1) must be below high (0)"),
        (lambda: slider("A", 2.0), ValueError, "'A' lies between 0 and 1, not 2"),
        (lambda: slider("A", math.nan), ValueError, "'A' takes a finite"),
        (lambda: slider("A", 0.5, high=math.inf), ValueError, "'A' takes a finite"),
        (lambda: slider("A", True), TypeError, "'A' takes a number"),
        (lambda: slider("A", 0.5, log=True), ValueError, "logarithmic"),
        (lambda: slider("A", 0.5, step=0), ValueError, "step"),
        (lambda: integer("A", 0.5), TypeError, "'A' takes a whole number"),
        (lambda: integer("A", 0, 0, 2**31), ValueError, "32-bit"),
        (lambda: toggle("A", 1), TypeError, "'A' takes True or False"),
        (lambda: choice("A", []), ValueError, "no options"),
        (lambda: choice("A", "ab"), TypeError, "list of options"),
        (lambda: choice("A", ["x", "x"]), ValueError, "twice"),
        (lambda: choice("A", ["x"], "y"), ValueError, "'A' takes one of x, not 'y'"),
        (lambda: choice("A", ["x"], 1), ValueError, "options 0 to 0"),
        (lambda: color("A", "rde"), ValueError, "#rrggbb"),
        (lambda: color("A", (0, 0, 2)), ValueError, "from 0 to 1"),
        (lambda: point("A", (1, 2, 3, 4)), ValueError, "2 or 3 numbers, not 4"),
        (lambda: point("A", (1, "x")), TypeError, "takes a number"),
        (lambda: point("A", 5), TypeError, "2 or 3 numbers"),
    ],
)
def test_bad_definition_names_what_is_wrong(define, error, words):
    with pytest.raises(error) as caught:
        define()
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("parameter", "text", "value"),
    [
        (SOFT, " 0.5 ", 0.5),
        (SOFT, "1e-1", 0.1),
        (STEPS, "96", 96),
        (toggle("On"), "Yes", True),
        (toggle("On"), "0", False),
        (MODE, "flat", 0),
        (MODE, "1", 1),
        (MODE, "2", 2),
        (color("C"), "#000", (0.0, 0.0, 0.0)),
        (color("C"), "0.1, 0.2, 0.3", (0.1, 0.2, 0.3)),
        (point("P", (0, 0)), "-1,2.5", (-1.0, 2.5)),
    ],
)
def test_text_is_read_by_kind(parameter, text, value):
    assert parameter.parse(text) == value


@pytest.mark.parametrize(
    ("parameter", "text"),
    [
        (SOFT, "9"),
        (SOFT, "nan"),
        (SOFT, ""),
        (SOFT, "0.5x"),
        (STEPS, "64.0"),
        (STEPS, "9" * 5000),
        (toggle("On"), "maybe"),
        (MODE, "dark"),
        (MODE, "3"),
        (MODE, "²"),
        (color("C"), "#12345"),
        (color("C"), "1,2"),
        (point("P"), "1,2"),
        (point("P"), "1,,2"),
    ],
)
def test_bad_text_is_a_short_value_error_naming_the_label(parameter, text):
    with pytest.raises(ValueError) as caught:
        parameter.parse(text)
    assert parameter.label in str(caught.value)
    assert len(str(caught.value)) < 200


def test_numpy_values_become_plain_ones():
    assert type(SOFT.check(np.float32(0.5))) is float
    assert type(STEPS.check(np.int64(32))) is int
    assert toggle("On").check(np.bool_(True)) is True
    assert point("P").check(np.arange(3)) == (0.0, 1.0, 2.0)
    assert point("P", np.zeros(2)).type is VEC2


def test_description_tells_the_range():
    assert SOFT.describe() == "a number from 0 to 1 (default 0.3)"
    assert MODE.describe() == "flat, lit, 2 (default lit)"
    assert point("P", (1, 2)).describe() == "x,y (default 1,2)"


def test_the_place_of_the_declaration_makes_no_difference():
    first = slider("Size", 0.5)
    again = slider("Size", 0.5)
    assert first.span is not None and again.span is not None
    assert again.span.line == first.span.line + 1 and first.span.file == __file__
    assert first == again and len({first, again}) == 1
