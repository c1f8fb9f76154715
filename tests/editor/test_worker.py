"""The worker as its supervisor sees it: a child process, lines of JSON, authors' mistakes."""

from __future__ import annotations

import base64
import io
import json
import os
import queue
import re
import subprocess
import sys
import threading
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import distal
from distal.editor.literals import spliced

ROOT = Path(__file__).parents[2]
SPHERE = """\
from distal import Box, Scene, Sphere
from distal.lang import slider

print("hello from the author")
size = slider("Size", 0.5, low=0.1, high=2.0)
scene = Scene(Sphere(size).translate(0.25, 0.0, 0.0) | Box(0.5))
"""
LOOP = "while True:\n    pass\n"


class Child:
    """A worker in a process of its own."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "distal.editor.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "DISTAL_VERIFY": ""},
            text=True,
            encoding="utf-8",
        )
        self.lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._read, daemon=True).start()
        self._next = 0
        self.ready = self.message()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.put(line)

    def post(self, kind: str, text: str = SPHERE, **fields: Any) -> int:
        self._next += 1
        made = {"kind": kind, "id": self._next, "revision": self._next, "main": "scene.py"}
        made |= {"files": {"scene.py": text}, **fields}
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(made) + "\n")
        self.process.stdin.flush()
        return self._next

    def message(self, timeout: float = 120.0) -> dict[str, Any]:
        """The next message but ``progress``."""
        while True:
            found = json.loads(self.lines.get(timeout=timeout))
            if found["kind"] != "progress":
                return found

    def ask(self, kind: str, text: str = SPHERE, **fields: Any) -> dict[str, Any]:
        number = self.post(kind, text, **fields)
        while True:
            found = self.message()
            if found["kind"] != "printed":
                assert found["id"] == number, found
                return found


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    made = Child()
    yield made
    made.process.kill()
    made.process.wait()


def literal(text: str, answer: dict[str, Any], written: str) -> dict[str, Any]:
    found = [x for x in answer["literals"] if x["text"] == written]
    assert len(found) == 1, (written, [x["text"] for x in answer["literals"]])
    assert text[found[0]["start"] : found[0]["end"]] == written
    return found[0]


def change(found: dict[str, Any], value: Any) -> dict[str, Any]:
    where = {key: found[key] for key in ("file", "start", "end")}
    return {"what": "literal", "value": value, **where}


def test_it_says_what_it_can_do(child: Child) -> None:
    assert child.ready["kind"] == "ready"
    assert {"look", "hold", "write", "text", "export"} <= set(child.ready["abilities"])
    assert child.ready["versions"]["distal"] == distal.__version__


def test_a_scene_comes_with_its_payload_literals_and_shapes(child: Child) -> None:
    number = child.post("look")
    printed, found = child.message(), child.message()
    assert printed == {
        **{"kind": "printed", "id": number, "revision": number},
        **{"text": "hello from the author\n", "hangs": ""},
    }
    assert found["kind"] == "scene"
    content = found["payload"]
    assert content["programs"]["encoding"] == "plain" and len(content["programs"]["data"]) == 2
    views = {view["name"]: view["program"] for view in content["views"]}
    assert views.pop("color") >= 0 and set(views.values()) == {-1}
    assert [p["label"] for p in content["parameters"]] == ["Size"]
    assert {s["name"]: s["line"] for s in found["shapes"]}.items() >= {"Box": 6}.items()
    assert literal(SPHERE, found, "0.25")["way"] == "numbers"
    assert found["objects"] == ["scene"]


def test_a_drag_sends_numbers_and_an_edit_and_ends_as_the_new_text_does(child: Child) -> None:
    first = child.ask("look")
    drag = change(literal(SPHERE, first, "0.25"), 0.75)
    moved = child.ask("look", changes=[drag], known=first["key"], lean=True)
    assert moved["kind"] == "numbers" and moved["key"] == first["key"]
    (edit,) = moved["edits"]
    text = spliced(SPHERE, edit["start"], edit["end"], edit["text"])
    assert text == SPHERE.replace("0.25", "0.75")
    whole = child.ask("look", text)
    assert whole["key"] == first["key"]
    programs = [made["payload"]["programs"]["data"][0] for made in (first, whole)]
    assert programs[0]["fragment"] == programs[1]["fragment"]
    numbers = {u["name"]: u["default"] for u in programs[1]["uniforms"] if u["origin"] == "number"}
    assert {n: v for n, v in moved["numbers"].items() if n in numbers} == numbers
    assert [0.75, 0.0, 0.0] in [numbers[n] for n in numbers] or 0.75 in numbers.values()


def test_the_default_of_a_slider_is_a_number_too(child: Child) -> None:
    first = child.ask("look")
    keep = {"what": "parameter", "name": "Size", "value": 0.8}
    moved = child.ask("look", changes=[keep], known=first["key"], lean=True)
    assert moved["kind"] == "numbers" and moved["parameters"][0]["default"] == 0.8
    assert moved["edits"][0]["text"] == "0.8"


def test_a_number_of_a_function_is_held_as_an_input(child: Child) -> None:
    text = distal.gallery()["melting"].read_text()
    first = child.ask("look", text)
    found = literal(text, first, "0.85")
    assert found["way"] == "hold"
    held = child.ask("hold", text, file="scene.py", start=found["start"], end=found["end"])
    program = held["payload"]["programs"]["data"][0]
    (uniform,) = [u for u in program["uniforms"] if u["name"] == held["held"]]
    assert uniform["default"] == 0.85 and uniform["origin"] == "number"
    assert held["held"] not in {p["name"] for p in held["payload"]["parameters"]}
    assert uniform["uniform"] in program["fragment"]


FRAMES = """
from distal.lang import Frame, buffer, image, ivec2, key_held, sample, slider, texel, vec3, vec4

fading = slider("Fading", 0.9)


@buffer
def trail(frame: Frame) -> vec4:
    old = texel(trail, ivec2(frame.coord))
    return old * fading + vec4(0.1 if key_held(32) else 0.0)


@image
def picture(frame: Frame) -> vec3:
    return sample(trail, frame.coord / frame.resolution).rgb
"""


def test_a_picture_that_keeps_frames_comes_with_its_buffers(child: Child) -> None:
    found = child.ask("look", FRAMES)
    content = found["payload"]
    frames = content["frames"]
    assert [each["name"] for each in frames["passes"]] == ["trail"]
    assert frames["itself"] is None and frames["keyboard"] == "keyboard"
    assert content["time"]["animated"]
    assert [p["name"] for p in content["parameters"]] == ["fading"]
    drawn = content["programs"]["data"][frames["passes"][0]["program"]]
    assert {t["name"] for t in drawn["textures"]} == {"trail", "keyboard"}


def test_a_mistake_is_at_its_line(child: Child) -> None:
    broken = SPHERE.replace("Box(0.5)", "Box(0.5).paint(")
    wrong = child.ask("look", broken)
    assert wrong["kind"] == "mistakes" and wrong["mistakes"][0]["line"] == 6
    missing = child.ask("look", SPHERE.replace("Box(0.5)", "Boxx(0.5)"))
    (mistake,) = missing["mistakes"]
    assert mistake["message"] == "NameError: name 'Boxx' is not defined"
    assert mistake["hint"] == "did you mean 'Box'?"
    assert mistake["line"] == 6
    (own,) = child.ask("look", "raise NameError('of the author')\n")["mistakes"]
    assert own["message"] == "NameError: of the author"
    line = SPHERE.replace("Box(0.5)", "Boxx(0.5)").splitlines()[5]
    assert line[mistake["column"] - 1 : mistake["end_column"] - 1] == "Boxx"
    assert (mistake["excerpt"], mistake["code"], mistake["labels"]) == (line, "file", [])
    text = distal.gallery()["melting"].read_text().replace("blend)", "blend + vec3(1.0))")
    (mistake,) = child.ask("look", text)["mistakes"]
    assert text.splitlines()[mistake["line"] - 1].strip().startswith("return smooth_union")


def test_a_mistake_has_the_labels_that_explain_it(child: Child) -> None:
    text = SPHERE.replace("Box(0.5)", 'Box(slider("size", 2.0, low=0.0, high=4.0))')
    (mistake,) = child.ask("look", text)["mistakes"]
    assert (mistake["severity"], mistake["code"]) == ("error", "parameter-name")
    assert mistake["excerpt"][mistake["column"] - 1 :].startswith('slider("size", 2.0')
    columns = {"column": 8, "end_column": 46}
    assert mistake["labels"] == [
        {
            "text": "the first is here",
            **{"file": "scene.py", "line": 5, "end_line": 5, **columns},
            "excerpt": SPHERE.splitlines()[4],
        }
    ]


def test_an_unknown_view_and_a_wrong_message_are_answered(child: Child) -> None:
    assert "there is no view 'x'" in child.ask("look", view="x")["mistakes"][0]["message"]
    child.post("look", main=4)
    assert "look.main: a text belongs here" in child.message()["mistakes"][0]["message"]
    folder = child.ask("look", files={"scene.py": SPHERE, "../x.py": ""})
    assert "is not the name of a Python file" in folder["mistakes"][0]["message"]


def test_neighbors_are_imported_and_follow_their_text(child: Child) -> None:
    main = "from parts import ball\nfrom distal import Scene\nscene = Scene(ball)\n"
    parts = "from distal import Sphere\nball = Sphere({})\n"
    for radius in (0.5, 0.75):
        files = {"scene.py": main, "parts.py": parts.format(radius)}
        found = child.ask("look", files=files)
        program = found["payload"]["programs"]["data"][0]
        assert radius in [u["default"] for u in program["uniforms"]]
        assert ("parts.py", 2) in [(s["file"], s["line"]) for s in found["shapes"]]


def test_texts_exports_and_writes_are_answered(child: Child) -> None:
    text = child.ask("text", target="wgsl")["result"]
    assert text["language"] == "wgsl" and "fn " in text["text"]
    assert {place[3] for place in text["places"]} == {6}
    page = child.ask("export", format="page")["result"]
    assert page["name"] == "scene.html" and page["text"].startswith("<!doctype html>")
    toy = child.ask("export", format="shadertoy")["result"]
    assert "mainImage" in toy["text"] and toy["command"].startswith("distal export scene.py")
    camera = {"what": "camera", "text": "Camera((1.0, 2.0, 3.0))"}
    edits = child.ask("write", changes=[camera])["result"]["edits"]
    made = SPHERE
    for edit in sorted(edits, key=lambda e: -e["start"]):
        made = spliced(made, edit["start"], edit["end"], edit["text"])
    assert "from distal import Camera, Box" in made
    assert "Box(0.5), camera=Camera((1.0, 2.0, 3.0)))" in made


def test_a_picture_with_frames_is_exported_to_all_tabs(child: Child) -> None:
    text = (ROOT / "examples/frames/coral.py").read_text(encoding="utf-8")
    made = child.ask("export", text, format="shadertoy")["result"]
    assert made["name"] == "scene.shadertoy.zip"
    files = unpacked(made)
    texts = [files[name] for name in files if name.endswith(".glsl")]
    tabs = [re.findall(r"The tab (.*) of a shader on shadertoy", text) for text in texts]
    assert tabs == [["Buffer A"], ["Buffer B"], ["Buffer C"], ["Buffer D"], ["Image"]]
    assert all(text.count("void mainImage(") == 1 for text in texts)
    assert [each["code"].strip() for each in json.loads(files["scene.json"])["renderpass"]] == [
        text.strip() for text in texts
    ]


def test_a_text_is_exported_with_the_files_that_it_needs(child: Child) -> None:
    made = child.ask("export", format="glsl-330")["result"]
    assert made["name"] == "scene.glsl-330.zip" and made["media_type"] == "application/zip"
    files = unpacked(made)
    assert list(files) == ["scene.txt", "scene.json", "scene.vert"]
    assert json.loads(files["scene.json"])["target"] == "glsl-330"


def unpacked(made: dict[str, Any]) -> dict[str, str]:
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(made["base64"]))) as archive:
        return {name: archive.read(name).decode() for name in archive.namelist()}


def test_pixels_and_checks_are_answered(child: Child) -> None:
    scene = SPHERE + "scene = Scene(Sphere(1.0).named('ball'), floor=False)\n"
    found = child.ask("probe", scene, x=320, y=240)["result"]
    assert found["shape"] == "ball" and found["line"] == 7 and found["numbers"]["steps"] > 0
    assert "mistakes" in child.ask("check", scene)["result"]


def test_the_newest_look_wins() -> None:
    made = Child()
    try:
        ids = [made.post("look") for _ in range(6)]
        kinds = {}
        while len(kinds) < len(ids):
            message = made.message()
            if message["kind"] != "printed":
                kinds[message["id"]] = message["kind"]
        assert kinds[ids[-1]] == "scene"
        assert [kinds[i] for i in ids[1:-1]].count("dropped") >= 3
    finally:
        made.process.kill()
        made.process.wait()


def test_a_loop_without_end_is_killed_from_outside() -> None:
    made = Child()
    made.post("look", LOOP)
    with pytest.raises(queue.Empty):
        made.message(timeout=2.0)
    assert made.process.poll() is None
    begin = time.monotonic()
    made.process.kill()
    made.process.wait(timeout=60.0)
    again = Child()
    assert again.ready["kind"] == "ready"
    assert again.process.stdin is not None
    again.process.stdin.write('{"kind":"stop","id":1,"revision":1}\n')
    again.process.stdin.flush()
    assert again.process.wait(timeout=60.0) == 0
    assert time.monotonic() - begin < 60.0
