"""Labels in any script: each target, page and command takes the names that are made of them."""

import json
import re

import pytest

import distal
from distal import Box, Scene, Sphere, choose
from distal.cli.arguments import read_assignments
from distal.compiler.driver import COMPILE_TARGETS
from distal.editor.edits import EditError, applied, edits_of
from distal.editor.messages import Change
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.lang import choice, color, integer, point, slider, toggle
from distal.notebook.widget import LiveView
from distal.scene.viewing.viewable import viewable

RADIUS = slider("半径", 0.5, 0.1, 2.0)
KIND = choice("Вид", ["球", "箱"], "球")
SHAPE = (
    choose(KIND, {"球": Sphere(RADIUS), "箱": Box(RADIUS)})
    .translate(point("موقع", (0.0, 0.1, 0.0)))
    .shown(toggle("Показать", True))
    .paint(color("Ø", "tomato"))
)
MANY = SHAPE | Sphere(integer("संख्या", 3, 1, 9) / 10).translate(x=slider("°", 0.5, name="angle"))
SCENE = Scene(MANY)
NAMES = {"半径", "вид", "موقع", "показать", "ø", "संख्या", "angle"}


@pytest.mark.parametrize("target", [t for t in COMPILE_TARGETS if t != "ir"])
def test_texts_for_targets_have_no_other_letters_than_ascii(target):
    text = distal.compile(SCENE, target=target).text
    code = re.sub(r"//.*|/\*.*?\*/|^;.*", "", text, flags=re.DOTALL if "isf" in target else 0)
    assert code.isascii()
    assert target == "llvm" or "angle" in code  # a parameter is in the text by its name


def test_a_value_by_any_name_changes_the_picture():
    plain = SCENE.render(size=(24, 18))
    for values in (
        {"半径": 0.9},
        {"вид": "箱"},
        {"показать": False},
        {"ø": "blue"},
        {"angle": 0.1},
    ):
        assert (SCENE.render(size=(24, 18), params=values).levels != plain.levels).any(), values
    by_label = SCENE.render(size=(24, 18), params={"半径": 0.9, "°": 0.1})
    by_name = SCENE.render(size=(24, 18), params={"半径": 0.9, "angle": 0.1})
    assert (by_label.levels == by_name.levels).all()


def test_set_takes_letters_that_a_keyboard_decomposes():
    parameters = [slider("x", 0.5, name="ö"), slider("が", 0.5)]
    assert read_assignments(["o\u0308=1", "か\u3099=0"], parameters) == {"ö": 1.0, "が": 0.0}


def test_a_default_is_written_where_its_name_says():
    text = "from distal.lang import slider\na = slider('°', 1.0, name='angle')\n"
    text += "b = slider('半径', 1.0)\n"
    text += "c = slider('%', 1)\n"  # Python refuses it, and nothing reads its default
    for name, line in (("angle", 2), ("半径", 3)):
        change = Change(what="parameter", name=name, value=0.25)
        (edit,) = edits_of({"s.py": text}, "s.py", [change])
        lines = applied({"s.py": text}, [edit])["s.py"].split("\n")
        assert "0.25" in lines[line - 1]
    with pytest.raises(EditError, match="no declaration"):
        edits_of({"s.py": text}, "s.py", [Change(what="parameter", name="°C", value=1.0)])


def test_page_and_notebook_list_the_names():
    made = json.loads(json.dumps(payload(viewable(SCENE, None, 0.0), PageOptions(), variable=None)))
    assert {row["name"] for row in made["parameters"]} == NAMES
    assert {row["label"] for row in made["parameters"]} >= {"半径", "Ø", "°"}
    widget = LiveView(SCENE)
    widget.set(半径=0.9)
    assert widget.params["半径"] == 0.9
