"""The messages of the studio: what is written is read, and what does not belong is refused."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import pytest

from distal.editor import messages
from distal.editor.messages import MessageError, encoded, parsed

ROOT = Path(__file__).parents[2]

LOOK = {
    "kind": "look",
    "id": 4,
    "revision": 2,
    "files": {"scene.py": "x = 1\n"},
    "main": "scene.py",
    "values": {"Blend": 0.5, "On": True, "Color": [1, 0.5, 0]},
    "changes": [{"what": "literal", "file": "scene.py", "start": 4, "end": 5, "value": 2}],
}
SAMPLES = [
    messages.LookRequest(id=1, revision=1, files={"a.py": ""}, main="a.py", size=(8, 4)),
    messages.HoldRequest(
        id=1, revision=1, files={"a.py": ""}, main="a.py", file="a.py", start=0, end=2
    ),
    messages.Ready(abilities=("look",), versions={"distal": "1"}),
    messages.SceneFound(
        id=1,
        revision=1,
        payload={"format": 1},
        key="k",
        literals=(
            messages.SourceLiteral(
                **dict(file="a.py", line=1, start=0, end=4, text="#fff", type="color"),
                **dict(value="#fff", parts=((0, 1),), way="numbers"),
            ),
        ),
        shapes=(messages.ShapePlace(name="a", label=True, file="a.py", line=1, start=0, end=1),),
        edits=(messages.Edit(file="a.py", start=0, end=1, text="2"),),
        ms={"all": 1.5},
    ),
    messages.NumbersFound(id=1, revision=1, key="k", numbers={"r": [1.0, 2.0]}, parameters=({},)),
    messages.Mistakes(
        id=1, revision=1, mistakes=(messages.Mistake(severity="error", message="m"),)
    ),
    messages.Answer(id=1, revision=1, request="check", result=messages.Checked(mistakes=())),
    messages.Answer(id=1, revision=1, request="write", result=messages.Written(edits=())),
    messages.Dropped(id=1, revision=1),
    messages.Changed(files={"a.py": "x"}, digests={"a.py": "d"}),
]


@pytest.mark.parametrize("message", SAMPLES, ids=lambda m: type(m).__name__)
def test_what_is_written_is_read(message: messages.Message) -> None:
    text = encoded(message)
    assert "\n" not in text
    assert parsed(text) == message


def test_a_request_may_leave_out_what_has_a_default() -> None:
    look = parsed(json.dumps(LOOK))
    assert isinstance(look, messages.LookRequest)
    assert look.view == "color" and look.size == (640, 480) and not look.lean
    assert look.values["Color"] == (1.0, 0.5, 0.0) and look.values["On"] is True
    assert look.changes[0].value == 2.0


WRONG = {
    "no JSON": ("{", "a message is a JSON object"),
    "a list": ("[]", "a message is a JSON object"),
    "no kind": ({"kind": "leap"}, "there is no message 'leap'; kinds: look, hold"),
    "missing": ({"files": ...}, "look: the field 'files' is missing"),
    "unknown": ({"fils": {}}, "look: there is no field 'fils'; it has id, revision, files"),
    "a number": ({"id": "4"}, 'look.id: a whole number belongs here, not "4"'),
    "a truth": ({"time": True}, "look.time: a finite number belongs here, not true"),
    "infinite": ({"time": 1e999}, "look.time: a finite number belongs here, not Infinity"),
    "a text in a list": ({"files": {"a.py": 1}}, "look.files[a.py]: a text belongs here, not 1"),
    "a size": ({"size": [1, 2, 3]}, "look.size: a list of 2 belongs here, not [1, 2, 3]"),
    "a word": ({"mode": "fast"}, "look.mode: 'direct' or 'path' or null belongs here"),
    "within": (
        {"changes": [{"what": "litteral"}]},
        "look.changes[0].what: 'literal' or 'parameter' or 'camera' belongs here",
    ),
    "a value": (
        {"values": {"a": None}},
        "look.values[a]: true or false or a finite number or a list belongs here, not null",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_belong_is_named(case: str) -> None:
    change, expected = WRONG[case]
    if isinstance(change, dict):
        whole = {**LOOK, **change}
        change = json.dumps({k: v for k, v in whole.items() if v is not ...})
    with pytest.raises(MessageError) as caught:
        parsed(change)
    assert str(caught.value).startswith(expected)


def test_an_answer_has_the_result_of_its_request() -> None:
    message = json.loads(encoded(SAMPLES[6]))
    assert message["request"] == "check"
    message["request"] = "text"
    with pytest.raises(MessageError, match=r"answer\.result: not the result of a 'text'"):
        parsed(json.dumps(message))


@pytest.mark.parametrize("tool", ["gen_messages", "gen_forms"])
def test_the_types_and_forms_of_typescript_are_fresh(tool: str) -> None:
    spec = importlib.util.spec_from_file_location(tool, ROOT / f"tools/{tool}.py")
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    assert made.FILE.read_text(encoding="utf-8") == made.text(), f"run tools/{tool}.py"
