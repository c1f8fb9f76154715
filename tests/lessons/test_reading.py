"""The format of lessons: what is read, and the exact texts of mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest

from distal.diagnostics import CompileError
from distal.lessons.document import Goal, Layers, Phrases, Prose, Try
from distal.lessons.reading import parse
from distal.lessons.scenes import folded, staged

HEAD = """+++
number = 1
title = "A ball"
summary = "One ball."
scene = "ball.py"
+++
"""
SCENE = """from distal.lang import Frame, image, length, slider, vec3

radius = slider("Radius", 0.3, low=0.1, high=0.9)


@image
def ball(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution - 0.5
    d = length(uv) - radius
    return vec3(1.0) if d < 0.0 else vec3(0.0)
"""


def lesson(body: str, head: str = HEAD):
    return parse(head + body, Path("lesson.md"))


def mistake(body: str, head: str = HEAD) -> str:
    with pytest.raises(CompileError) as raised:
        lesson(body, head)
    return str(raised.value)


def test_all_parts_are_read():
    made = lesson(
        "Text.\n\n```\n:::try is code here\n```\n"
        ':::try title="Large" values="radius=0.8, b=1,2,3" least=0.02\nDo it.\n:::\n'
        ":::watch\nIt grows.\n:::\n"
        ":::phrases\nbigger | radius=0.6 | more\nflat | | no slider\n:::\n"
        ":::layers signal=local:d\nsignal | The number.\n:::\n"
        ':::goal file="goal.py" values="radius=0.5"\nReach it.\n:::\n'
    )
    text, attempt, phrases, layers, goal = made.parts
    assert isinstance(text, Prose) and ":::try is code here" in text.text
    values = {"radius": "0.8", "b": "1,2,3"}
    assert attempt == Try(12, "Large", values, "Do it.", "It grows.", "", 0.02)
    assert isinstance(phrases, Phrases)
    assert [row.values for row in phrases.rows] == [{"radius": "0.6"}, {}]
    assert isinstance(layers, Layers)
    assert layers.views == {"coordinate": "coordinate", "signal": "local:d", "color": "color"}
    assert isinstance(goal, Goal) and goal.values == {"radius": "0.5"}


MISTAKES = {
    "Text": (
        "Text.",
        "error: a lesson begins with its settings\n"
        "  --> lesson.md:1:1\n   |\n 1 | Text.\n   | ^^^^^\n"
        "   = hint: write +++, settings in TOML, and +++",
        "",
    ),
    "fence": (
        'Text.\n:::tri title="A"\n:::\n',
        "error: there is no fence ':::tri'\n"
        '  --> lesson.md:8:1\n   |\n 8 | :::tri title="A"\n   | ^^^^^^^^^^^^^^^^\n'
        "   = hint: did you mean 'try'?",
        HEAD,
    ),
    "open": (
        'Text.\n:::try title="A" values="a=1"\nText.\n',
        "error: ':::try' is not closed\n"
        '  --> lesson.md:8:1\n   |\n 8 | :::try title="A" values="a=1"\n'
        "   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "   = hint: write ::: alone on the line after its text",
        HEAD,
    ),
    "attribute": (
        'Text.\n:::try title="A" value="a=1"\n:::\n',
        "error: ':::try' has no attribute 'value'\n"
        '  --> lesson.md:8:1\n   |\n 8 | :::try title="A" value="a=1"\n'
        "   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "   = hint: did you mean 'values'?",
        HEAD,
    ),
    "watch": (
        "Text.\n:::watch\nIt grows.\n:::\n",
        "error: ':::watch' has no experiment\n"
        "  --> lesson.md:8:1\n   |\n 8 | :::watch\n   | ^^^^^^^^\n"
        "   = hint: put :::watch directly below the ::: of the experiment that it belongs to",
        HEAD,
    ),
    "phrase": (
        "Text.\n:::phrases\nbigger | radius=1\n:::\n",
        "error: a phrase has three parts\n"
        "  --> lesson.md:9:1\n   |\n 9 | bigger | radius=1\n   | ^^^^^^^^^^^^^^^^^\n"
        "   = hint: write PHRASE | NAME=VALUE | WHAT HAPPENS; the second may be empty",
        HEAD,
    ),
    "nothing": (
        'Text.\n:::try title="A"\n:::\n',
        "error: this experiment changes nothing\n"
        '  --> lesson.md:8:1\n   |\n 8 | :::try title="A"\n   | ^^^^^^^^^^^^^^^^\n'
        '   = hint: write values="max_steps=16" or view="steps"',
        HEAD,
    ),
    "setting": (
        "Text.\n",
        "error: there is no setting 'titel'\n"
        '  --> lesson.md:3:1\n   |\n 3 | titel = "A ball"\n   | ^^^^^^^^^^^^^^^^\n'
        "   = hint: did you mean 'title'?",
        HEAD.replace("title", "titel"),
    ),
    "type": (
        "Text.\n",
        "error: 'number' is a whole number from 1, not 'one'\n"
        '  --> lesson.md:2:1\n   |\n 2 | number = "one"\n   | ^^^^^^^^^^^^^^\n'
        "   = hint: write number = 6",
        HEAD.replace("number = 1", 'number = "one"'),
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_names_its_line_and_a_fix(name):
    body, expected, head = MISTAKES[name]
    assert mistake(body, head) == expected


def test_invalid_toml_is_at_its_line():
    text = mistake("Text.", HEAD.replace('title = "A ball"', "title = A ball"))
    assert "error: this is not TOML: Invalid value" in text
    assert "--> lesson.md:3:1" in text


STAGED = {
    'Text.\n:::try title="A" values="radios=0.5"\n:::\n:::watch\nX.\n:::\n': (
        8,
        "there is no parameter 'radios'",
        "did you mean 'radius'?",
    ),
    'Text.\n:::try title="A" values="radius=5"\n:::\n:::watch\nX.\n:::\n': (
        8,
        "'radius': 'Radius' lies between 0.1 and 0.9, not 5",
        "write a value in range",
    ),
    'Text.\n:::try title="A" values="radius=0.5"\n:::\n': (
        8,
        "this experiment does not say its effect",
        "write :::watch below it, and what the reader will see",
    ),
    "Text.\n:::layers signal=local:e\n:::\n": (
        8,
        "there is no view 'local:e'",
        "did you mean 'local:d'?",
    ),
    'Text.\n:::goal file="../goal.py" values="radius=0.5"\n:::\n': (
        8,
        "'../goal.py' is not in the lesson's folder",
        "keep a lesson and its scenes in one folder, or use example:NAME",
    ),
}


@pytest.mark.parametrize("body", STAGED)
def test_a_mistake_about_the_scene_names_its_line_and_a_fix(body, tmp_path):
    (tmp_path / "ball.py").write_text(SCENE)
    with pytest.raises(CompileError) as raised:
        staged(parse(HEAD + body, tmp_path / "lesson.md"))
    (found,) = raised.value.diagnostics
    assert (found.span.line, found.message, found.hint) == STAGED[body]


def test_a_scene_that_is_missing_is_reported_at_its_setting(tmp_path):
    with pytest.raises(CompileError) as raised:
        staged(parse(HEAD + "Text.", tmp_path / "lesson.md"))
    (found,) = raised.value.diagnostics
    assert found.span.line == 5
    assert found.message.startswith("there is no file")


def test_code_is_folded_around_what_is_shown():
    parts = folded(SCENE, ("ball", "radius"))
    assert [(first, shown) for _, first, shown in parts] == [(1, False), (3, True), (6, True)]
    assert parts[2][0].startswith("@image\ndef ball")


FRAMES = """
from distal.lang import Frame, buffer, image, ivec2, texel, vec4


@buffer
def trail(frame: Frame) -> vec4:
    return 0.5 * texel(trail, ivec2(frame.coord))


@image
def picture(frame: Frame) -> vec4:
    return texel(trail, ivec2(frame.coord))
"""


def test_a_picture_that_keeps_frames_is_not_for_a_lesson(tmp_path):
    (tmp_path / "ball.py").write_text(FRAMES)
    with pytest.raises(CompileError) as raised:
        staged(parse(HEAD + "Text.", tmp_path / "lesson.md"))
    assert "reads earlier frames or keys, which a lesson's picture has not" in str(raised.value)
    assert "show it on a page: distal export FILE -o page.html" in str(raised.value)
