"""Literals of all examples: found by position, and rewritten in exactly their bytes."""

from __future__ import annotations

import ast

import pytest

import distal
from distal.editor.edits import EditError, applied, edits_of
from distal.editor.links import LinkError, link_of, shared_by
from distal.editor.literals import find_literals, number_text, piece, spliced, step_of, written
from distal.editor.messages import Change, SourceLiteral


def other(found: SourceLiteral):
    match found.type, found.value:
        case "vector", tuple(values):
            return tuple(v + 1.0 for v in values)
        case "color", _:
            return "#12ab9f"
        case "switch", value:
            return not value
        case "choice", value:
            return next(word for word in found.options if word != value)
        case _, value:
            return value + (1.0 if found.whole else 0.25)


@pytest.mark.sample(3)
@pytest.mark.parametrize("name", distal.gallery())
def test_each_literal_of_an_example_changes_alone(name: str) -> None:
    text = distal.gallery()[name].read_text(encoding="utf-8")
    literals = find_literals("a.py", text)
    assert literals
    for number, found in enumerate(literals):
        assert piece(text, found.start, found.end) == found.text
        assert written(found, text, found.value) == found.text
        value = other(found)
        made = spliced(text, found.start, found.end, written(found, text, value))
        ast.parse(made)
        again = find_literals("a.py", made)
        assert len(again) == len(literals)
        assert again[number].value == pytest.approx(value) if value is not str else True
        rest = [x.text for i, x in enumerate(literals) if i != number]
        assert [x.text for i, x in enumerate(again) if i != number] == rest


@pytest.mark.parametrize(
    ("old", "value", "new"),
    [
        *((("0.42"), 0.5, "0.50"), ("0.42", 0.4237, "0.4237"), (".5", 0.25, ".25")),
        *(("1.", 2.0, "2."), ("1_000", 2500.0, "2_500"), ("1e-3", 0.002, "2e-3")),
        *(("1.5E2", 160.0, "1.6E2"), ("0x1F", 32.0, "0x20"), ("-0.5", 0.5, "0.5")),
        *(("0.5", -0.01, "-0.01"), ("1_000.5", 12000.5, "12_000.5"), ("3", -4.0, "-4")),
    ],
)
def test_the_notation_is_kept(old: str, value: float, new: str) -> None:
    assert number_text(old, value) == new


@pytest.mark.parametrize(
    ("text", "step"), [("0.42", 0.01), ("12", 1.0), ("1e-3", 1e-3), (".5", 0.1), ("1.50e2", 1.0)]
)
def test_the_step_is_that_of_the_last_digit(text: str, step: float) -> None:
    assert step_of(text) == pytest.approx(step)


def test_offsets_are_those_of_browsers() -> None:
    text = 'name = "\U0001f407é"; radius = 0.5  # \U0001f407\n'
    (found,) = find_literals("a.py", text)
    units = text.encode("utf-16-le")
    assert units[2 * found.start : 2 * found.end].decode("utf-16-le") == "0.5"
    assert spliced(text, found.start, found.end, "0.6") == text.replace("0.5", "0.6")


def test_a_negative_base_of_a_power_gets_parentheses() -> None:
    text = "x = 2.0 ** 2.0\n"
    found = find_literals("a.py", text)[0]
    assert written(found, text, -2.0) == "(-2.0)"


def test_the_argument_is_named() -> None:
    text = "from distal import Sphere\nball = Sphere(0.5).translate(y=1.0)\n"
    assert [(x.call, x.slot) for x in find_literals("a.py", text)] == [
        ("Sphere", "radius"),
        ("translate", "y"),
    ]


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        ("Sphere(0.50)", 0.01, None),
        ("Sphere(radius=2)", 1.0, None),
        ("Box((1.0, 2.0, 3.0))", 0.1, None),
        ("Box(1.0).rounded(rounding=0.1)", 0.1, None),
        ("Material('#123456', specular=0.2)", None, None),  # the first is the color
        ("matte('red', roughness=0.5)", 0.0, 1.0),
        ("DistantLight((1, 2, 3), angle=2.0)", None, None),
        ("Sphere(0.06 * weight)", None, None),
        ("mine(radius=0.5)", None, None),
        ("Sphere(0.5).translate(0.1, 0.2, 0.3)", 0.1, None),
    ],
)
def test_limits_of_arguments_are_those_of_the_library(text, low, high) -> None:
    found = find_literals("a.py", text)[0]
    assert (found.low, found.high) == (low, high), found


@pytest.mark.parametrize(
    ("text", "value", "some"),
    [
        ('Scene(ball, tone_map="agx")', "agx", {"none", "aces"}),
        ("Scene(ball, look='night')", "night", {"studio", "outdoor"}),
        ('Scene(ball, mode="path")', "path", {"direct"}),
        ('Texture2D("wood.png", wrap="clamp")', "clamp", {"repeat"}),
        ('choice("soft", ["soft", "hard"], "hard")', "hard", {"soft"}),
        ('lang.choice("Kind", options=("a", "b"), default="b")', "b", {"a"}),
    ],
)
def test_a_word_of_a_few_is_a_choice(text: str, value: str, some: set[str]) -> None:
    (found,) = find_literals("a.py", text)
    assert (found.type, found.value, found.way) == ("choice", value, "compile")
    assert {value, *some} <= set(found.options)
    word = min(some)
    made = spliced(text, found.start, found.end, written(found, text, word))
    assert find_literals("a.py", made)[0].value == word
    assert made[: found.start] == text[: found.start]
    assert made[found.start + len(word) + 2 :] == text[found.end :]


@pytest.mark.parametrize(
    "text",
    [
        'Scene(ball, name="aces")',
        'Scene(ball, tone_map="acse")',
        'Scene(ball, tone_map=r"aces")',
        'Scene(ball, tone_map="""aces""")',
        'choice("soft", ["soft", "hard"])',
        'choice("Kind", kinds, "hard")',
        'open("repeat")',
        'paint(u"#fff")',
    ],
)
def test_other_texts_are_no_choice(text: str) -> None:
    assert find_literals("a.py", text) == ()


def test_limits_by_name_are_those_of_the_kind_of_object() -> None:
    text = "Material('red', specular=0.2)\nSphere(0.5).translate(x=0.1)\nCamera((0, 0, 4), fov=0.9)"
    by_slot = {found.slot: found for found in find_literals("a.py", text)}
    assert (by_slot["specular"].low, by_slot["specular"].high) == (0.0, 1.0)
    assert (by_slot["x"].low, by_slot["x"].high) == (None, None)
    assert (by_slot["fov"].low, by_slot["fov"].high) == (0.1, None)


def test_edits_are_refused_where_they_cannot_be_written() -> None:
    files = {"a.py": "from distal.lang import slider\ns = slider('Size', 0.5 * 2.0)\n"}
    with pytest.raises(EditError, match="the default of 'size' in line 2 is computed"):
        edits_of(files, "a.py", [Change(what="parameter", name="size", value=1.0)])
    with pytest.raises(EditError, match="there is no literal from 0 to 4"):
        edits_of(files, "a.py", [Change(what="literal", start=0, end=4, value=1.0)])
    twice = [
        Change(
            what="literal",
            start=files["a.py"].index("0.5"),
            end=files["a.py"].index("0.5") + 3,
            value=float(v),
        )
        for v in (1, 2)
    ]
    with pytest.raises(EditError, match="two changes are at the same place"):
        edits_of(files, "a.py", twice)
    (edit,) = edits_of(files, "a.py", twice[:1])
    assert applied(files, [edit])["a.py"].endswith("1.0 * 2.0)\n")


def test_links_come_back_and_broken_ones_are_refused() -> None:
    shared = {"files": {"a.py": "x = '\U0001f407'\n"}, "main": "a.py", "time": 1.5}
    link = link_of(shared)
    assert link.startswith("#c=") and shared_by("https://a.b/c" + link) == shared
    text = distal.gallery()["bunny"].read_text(encoding="utf-8")
    assert len(link_of({"files": {"bunny.py": text}, "main": "bunny.py"})) < 2500
    for broken in (link[:-6], "#c=!!!!", "#d=abc", "#c="):
        with pytest.raises(LinkError):
            shared_by(broken)
