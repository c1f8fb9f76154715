"""Lists of sets of values: from Python, from CSV files, drawn; a mistake names its place."""

from __future__ import annotations

import re
from collections import namedtuple
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from distal import packages
from distal.cli.application import application
from distal.lang import choice, color, integer, point, slider, toggle
from distal.sweeps import drawing, inputs, parameter_sets
from distal.sweeps.columns import TIME
from distal.sweeps.inputs import inputs_of, read_inputs

WIDTH = slider("Width", 0.5, 0.1, 2.0)
SCALE = slider("Scale", 1.0, 0.01, 100.0, log=True)
COUNT = integer("Count", 2, 1, 9)
LIT = toggle("Lit", True)
KIND = choice("Kind", ["plain", "odd", "a, b"])
TINT = color("Tint", "#ff0000")
PLACE = point("Place", (0.0, 0.0, 0.0))
CYRILLIC = slider("Ширина", 0.5)
ALL = [WIDTH, SCALE, COUNT, LIT, KIND, TINT, PLACE, CYRILLIC]


@pytest.mark.parametrize(
    ("text", "sets"),
    [
        ("width\n0.5\n1\n", [{"width": 0.5}, {"width": 1.0}]),
        ("Width,COUNT\n0.5,3", None),
        ("Width,count\n0.5,3", [{"width": 0.5, "count": 3}]),
        ("\ufeffwidth,kind\r\n1e-1,odd\r\n\r\n0.2,2\r\n", [
            {"width": 0.1, "kind": "odd"}, {"width": 0.2, "kind": "a, b"}]),
        ('\n width , kind \n 0.1 ,"a, b"\n', [{"width": 0.1, "kind": "a, b"}]),
        ("lit,time\ntrue,0.25\nNo,1", [{"lit": True, "time": 0.25}, {"lit": False, "time": 1.0}]),
        ('tint\n#ffffff\n"0.1,0.2,1"', [{"tint": (1.0, 1.0, 1.0)}, {"tint": (0.1, 0.2, 1.0)}]),
        ("tint.b,tint.r,tint.g\n0.3,0.1,0.2", [{"tint": (0.1, 0.2, 0.3)}]),
        ("place.x,place.y,place.z\n-1,2e3,.5", [{"place": (-1.0, 2000.0, 0.5)}]),
        ("Ширина\n0.3", [{"ширина": 0.3}]),
        ("number,input.width,measured.width,kind\n1,0.3,x,y", [{"width": 0.3}]),
    ],
)  # fmt: skip
def test_files(text, sets, tmp_path):
    path = tmp_path / "sets.csv"
    path.write_bytes(text.encode())
    if sets is None:
        with pytest.raises(ValueError, match="there is no parameter 'COUNT'"):
            read_inputs(path, ALL)
        return
    found = read_inputs(path, ALL)
    assert [found.named(i) for i in range(len(found.sets))] == sets


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "it is empty"),
        (b"\xef\xbb\xbf\n\n", "it is empty: its first line has the names of parameters"),
        (b"width\n", "it has names of parameters, and no values below them"),
        (b"width,wide\n1,1", "there is no parameter 'wide'; a sweep takes width, scale, count, "
         "lit, kind, tint, place, \u0448\u0438\u0440\u0438\u043d\u0430, time"),
        (b"width,Width\n1,1", "'Width' has two columns: 'width' and 'Width'"),
        (b"tint,tint.r\n#fff,1", "'Tint' has two columns: 'tint' and 'tint.r'"),
        (b"tint.r,tint.g\n1,1", "'Tint' has no column 'tint.b'"),
        (b"width,,count\n1,1,1", "column 2 has no name"),
        (b"width;count\n0,5;3", "its columns are separated by commas, not semicolons or tabs"),
        (b"width,count\n0.5,3\n0,5,3", "line 3 has 3 values for 2 columns; the decimal sign is a "
         "point, and a value with commas stands in \"\u2026\""),
        (b'width\n"0,5"', "line 2, column 'width': 'Width' takes a number, not '0,5'"),
        (b"width,count\n1,2\n1", "line 3 has 1 values for 2 columns"),
        (b"width,count\n1,2\n1,", "line 3, column 'count': there is no value"),
        (b"Width\n1\n\n3", "line 4, column 'Width': 'Width' lies between 0.1 and 2, not 3"),
        (b"width\nnan", "line 2, column 'width': 'Width' takes a finite 32-bit number, not nan"),
        (b"width\n-inf", "line 2, column 'width': 'Width' takes a finite 32-bit number, not -inf"),
        (b"count\n2.5", "line 2, column 'count': 'Count' takes a whole number, not '2.5'"),
        (b"kind\neven", "line 2, column 'kind': 'Kind' takes one of plain, odd, a, b, not 'even'"),
        (b"time\nsoon", "line 2, column 'time': time is a number of seconds, not 'soon'"),
        (b"tint.r,tint.g,tint.b\n1,1,2", "line 2, column 'tint.r', 'tint.g', 'tint.b': 'Tint' "
         "takes numbers from 0 to 1, not 1,1,2"),
        (b"\xff\xfew\x00", "it is text in UTF-16; save it as UTF-8"),
        (b"width\n\xff", "it is not text in UTF-8"),
        (b"width\n1\x00", "it is no text"),
        (b'width\n"1', "line 2: unexpected end of data"),
        (b"width\n" + b"1\n" * 100_001,
         "a sweep has at most 100000 pictures, and the list has more"),
    ],
)  # fmt: skip
def test_wrong_files(data, words, tmp_path):
    path = tmp_path / "sets.csv"
    path.write_bytes(data)
    with pytest.raises(ValueError) as caught:
        read_inputs(path, ALL)
    assert str(caught.value) == f"{path}: {words}"


def test_a_missing_file(tmp_path):
    with pytest.raises(ValueError, match=r"sets.csv: (No such file|there is no such file)"):
        inputs_of(tmp_path / "sets.csv", ALL)


def test_lists():
    Row = namedtuple("Row", "width kind")
    found = inputs_of([{"Width": 0.5, "kind": 1}, Row(np.float32(0.1), "plain")], ALL)
    assert found.named(0) == {"width": 0.5, "kind": "odd"}
    assert found.named(1) == {"width": float(np.float32(0.1)), "kind": "plain"}
    assert inputs_of(({"width": w} for w in (0.2, 0.3)), ALL).sets == [(0.2,), (0.3,)]


@pytest.mark.parametrize(
    ("sets", "words"),
    [
        ([], "the list of a sweep has no sets of values"),
        ([{}], "set 1 has no values"),
        ([{"width": 1.0}, 3.0], "set 2: values by parameter, as {'width': 0.5}, not float"),
        ([{"width": 1.0}, {"wide": 1.0}], "set 2: there is no parameter 'wide'; a sweep takes"),
        ([{"width": 1.0}, {}], "set 2 has no value of 'Width', which set 1 has"),
        ([{"width": 1.0}, {"width": 1.0, "lit": True}],
         "set 2 has a value of 'lit', which set 1 has not"),
        ([{"width": 1.0, "Width": 1.0}], "set 1 has 'Width' twice: 'width' and 'Width'"),
        ([{"width": 1.0}, {"width": "much"}], "set 2: 'Width' takes a number, not 'much'"),
        ([{"width": 1.0}, {"width": float("nan")}],
         "set 2: 'Width' takes a finite 32-bit number, not nan"),
        ([{"width": None}], "set 1: 'Width' takes a number, not None"),
        ([{3: 1.0}], "set 1: there is no parameter '3'"),
        (3.0, "a sweep takes values by parameter, or a list of them, not float"),
    ],
)  # fmt: skip
def test_wrong_lists(sets, words):
    with pytest.raises(ValueError, match=f"^{re.escape(words)}"):
        inputs_of(sets, ALL)


@pytest.fixture
def shown(monkeypatch):
    """A picture with all of the parameters."""
    monkeypatch.setattr(drawing, "viewable", lambda *_: SimpleNamespace(parameters=ALL))


@pytest.mark.parametrize("count", [1, 7, 64])
def test_a_latin_hypercube_has_one_value_in_each_part(count, shown):
    sets = parameter_sets(None, count, {"width": None, "scale": None, "time": (1, 3)}, seed=5)
    units = np.array([
        [(s["width"] - 0.1) / 1.9, np.log(s["scale"] / 0.01) / np.log(1e4), (s["time"] - 1) / 2]
        for s in sets
    ])  # fmt: skip
    parts = np.sort(np.floor(units * count).astype(int), axis=0)
    np.testing.assert_array_equal(parts, np.arange(count)[:, None].repeat(3, axis=1))
    again = parameter_sets(None, count, {"width": None, "scale": None, "time": (1, 3)}, seed=5)
    assert again == sets
    other = parameter_sets(None, count, {"width": None, "scale": None, "time": (1, 3)}, seed=6)
    assert other != sets


def test_sobol_points_are_those_of_a_net(shown):
    """Each box of the elementary partitions of 64 boxes has one of 64 points."""
    pytest.importorskip("scipy")
    sets = parameter_sets(None, 64, {"width": None, "ширина": "0:1"}, method="sobol", seed=3)
    units = np.array([[(s["width"] - 0.1) / 1.9, s["ширина"]] for s in sets])
    for across in (1, 2, 4, 8, 16, 32, 64):
        boxes = np.floor(units * (across, 64 // across)) @ (1000, 1)
        assert len(set(boxes)) == 64
    with pytest.warns(UserWarning, match="100 Sobol points are not balanced: 64 or 128 are"):
        assert len(parameter_sets(None, 100, method="sobol")) == 100


def test_all_kinds_are_drawn_evenly(shown):
    sets = parameter_sets(None, 90, {"count": None, "lit": None, "kind": None, "tint": "#fff;#000"})
    counts = {name: {} for name in sets[0]}
    for each in sets:
        for name, value in each.items():
            counts[name][value] = counts[name].get(value, 0) + 1
    assert counts["count"] == dict.fromkeys(range(1, 10), 10)
    assert counts["lit"] == dict.fromkeys((False, True), 45)
    assert counts["kind"] == dict.fromkeys(KIND.options, 30)
    assert counts["tint"] == dict.fromkeys(((0.0,) * 3, (1.0,) * 3), 45)
    assert inputs_of(sets, ALL).named(3) == sets[3]
    assert set(parameter_sets(None, 1)[0]) == {"width", "scale", "count", "lit", "kind", "ширина"}


@pytest.mark.parametrize(
    ("count", "values", "options", "words"),
    [
        (0, None, {}, "count is a whole number from 1 to 100000, not 0"),
        (2.0, None, {}, "count is a whole number from 1 to 100000, not 2.0"),
        (2, None, {"seed": -1}, "seed is a whole number from 0 to"),
        (2, None, {"seed": True}, "seed is a whole number from 0 to"),
        (2, None, {"method": "halton"}, "method is one of latin, sobol, not 'halton'"),
        (2, {}, {}, "there is no parameter to vary"),
        (2, {"wide": None}, {}, "there is no parameter 'wide'"),
        (2, {"width": (0.0, 1.0)}, {}, "'Width' lies between 0.1 and 2, not 0"),
        (2, {"width": "1:0.5"}, {}, "'Width' takes LOW:HIGH, not 1.0:0.5"),
        (2, {"width": None, "Width": None}, {}, "'Width' has values twice"),
        (2, {"tint": None}, {}, "'Tint' has no range of its own: give values of it"),
        (2, {"time": None}, {}, "'time' has no range of its own: give values of it"),
    ],
)
def test_wrong_draws(count, values, options, words, shown):
    with pytest.raises(ValueError, match=f"^{re.escape(words)}"):
        parameter_sets(None, count, values, **options)


def test_sobol_without_scipy(shown, monkeypatch):
    def missing(module):
        raise ModuleNotFoundError(f"No module named '{module}'", name="scipy")

    monkeypatch.setattr(packages.importlib, "import_module", missing)
    with pytest.raises(packages.PackageError, match=r"pip install 'distal\[design\]'"):
        parameter_sets(None, 4, method="sobol")


def test_time_is_a_column_of_its_own():
    """Unless a parameter has the name."""
    found = inputs_of([{TIME: 2.0}], ALL)
    assert found.params(0) == {} and found.time(0, 0.0) == 2.0
    found = inputs_of([{TIME: 0.25}], [slider("Time", 0.5)])
    assert found.params(0) == {"time": 0.25} and found.time(0, 7.0) == 7.0


_SCENE = """
from distal import Box, Scene
from distal.lang import slider
scene = Scene(Box((slider("Width", 0.5, 0.1, 2.0), 0.5, slider("File", 0.5, 0.1, 1.0))))
"""


def _run(*words):
    made = CliRunner().invoke(application, ["sweep", *map(str, words)])
    return made.exit_code, made.output


def test_the_command_takes_lists(tmp_path, monkeypatch):
    """Sheets of lists have the pictures at their places; files, draws, mistakes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.py").write_text(_SCENE)
    (tmp_path / "sets.csv").write_text("width,file\n0.3333333333333333,0.2\n1,1\n2,0.5\n")
    code, text = _run("scene.py", "--values", "sets.csv", "-o", "all.png", "--size", "8x6")
    assert code == 0 and "all.png: 3 pictures; all.csv" in text
    rows = inputs.read_inputs(tmp_path / "all.csv", [WIDTH, slider("File", 0.5, 0.1, 1.0)])
    assert rows.sets == [(0.3333333333333333, 0.2), (1.0, 1.0), (2.0, 0.5)]
    draw = ("scene.py", "--draw", "latin:4", "--set", "width=0.5:1", "--size", "8x6")
    assert _run(*draw, "-o", "drawn", "--seed", 3)[0] == 0
    code, text = _run(*draw, "-o", "drawn", "--seed", 4)
    assert code == 1 and "sweep.csv is of other inputs: it has 'width'" in text
    for words, message in (
        (("--values", "sets.csv", "--set", "width=1"), "--values has all values: leave out"),
        (("--seed", "1", "--set", "width=1"), "--seed is for --draw"),
        (("--draw", "latin"), "--draw takes METHOD:COUNT, like latin:100, not 'latin'"),
        (("--draw", "halton:3"), "method is one of latin, sobol, not 'halton'"),
        ((), "a sweep takes values: --set NAME=FIRST:LAST:COUNT or NAME=A,B,C"),
        (("--values", "scene.py"), "scene.py: "),
    ):
        code, text = _run("scene.py", "-o", "no.png", *words)
        assert code == 2 and message in " ".join(text.split()), text
    assert not (tmp_path / "no.png").exists()
