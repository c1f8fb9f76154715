"""Tables of sweeps: names that collide with nothing, all digits, rows that a kill does not lose."""

from __future__ import annotations

import csv
import math
import os
import random
import subprocess
import sys
import textwrap
import time

import pytest

import distal
from distal import Box, Scene
from distal.file_writer import SaveError, only_writer
from distal.lang import choice, color, integer, point, slider, toggle
from distal.sweeps.solid_measures import SolidMeasures
from distal.sweeps.table import SweepTable, _whole_rows

# All words of tables, with the labels of the issue and others.
WORDS = (
    *("Number", "File", "Seconds", "Brightness", "Samples", "Noise", "Key", "Volume", "Area"),
    *("Width", "Height", "Depth", "Wall", "Remark", "Error", "Volume error", "Area_error"),
    *("Input", "Measured", "Picture", "Measured.Volume", "Input width", "Ширина", "Объём", "寬度"),
)


def _rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _fake_measures(monkeypatch, delay=0.0):
    """Measures that take no time: what is tested is the table."""

    def of(self, params, seconds, cancel):
        time.sleep(delay)
        volume = math.fsum(v for v in params.values() if isinstance(v, float)) / 3.0
        return {"key": self.key(params, seconds), "volume": volume, "width": volume / 7.0}

    monkeypatch.setattr(SolidMeasures, "of", of)


@pytest.mark.parametrize("with_pictures", [False, True])
def test_no_label_hides_a_column(with_pictures, tmp_path, monkeypatch):
    _fake_measures(monkeypatch)
    sliders = [slider(word, 0.5, 0.1, 1.0) for word in WORDS]
    side = sum(sliders, 0.0) / len(sliders)
    values = [
        {s.label: 0.1 + (i + 1) / (7.0 * (n + 3)) for n, s in enumerate(sliders)} for i in (0, 1)
    ]
    path = tmp_path / ("folder" if with_pictures else "table.csv")
    made = distal.sweep(Scene(Box((side, side, side))), values, path, size=(8, 6), measure=True)
    for given, row, cells in zip(values, made.rows, _rows(made.table), strict=True):
        assert row.inputs == {s.name: given[s.label] for s in sliders}
        assert row.measured["volume"] == math.fsum(given.values()) / 3.0
        assert float(cells["measured.volume"]) == row.measured["volume"]
        assert float(cells["measured.width"]) == row.measured["width"]
        assert {s.name: float(cells[f"input.{s.name}"]) for s in sliders} == row.inputs
        assert len(cells) == len(set(cells)) and None not in cells
    if with_pictures:
        assert made.rows[1].file == _rows(made.table)[1]["file"] == "002.png"


def _anything():
    """One parameter of each kind, whose options are hard to write in a table."""
    return {
        "slider": slider("Slider", 1.0, -1e30, 1e30),
        "integer": integer("Integer", 1, -(2**31), 2**31 - 1),
        "toggle": toggle("Toggle"),
        "choice": choice(
            "Choice", ["plain", "2", 'a "b", c', "two\nlines", " space ", "=1+1", "1"]
        ),
        "color": color("Color", "#ffffff"),
        "place": point("Place", (0.0, 0.0, 0.0), name="place"),
        "flat": point("Flat", (0.0, 0.0), name="flat"),
    }


def _anything_random(draw):
    number = lambda: draw.choice([1 / 3, 0.1, 5e-324, -0.0, 1e16 + 2, draw.uniform(-1e3, 1e3)])  # noqa: E731
    return {
        "slider": number(),
        "integer": draw.randrange(-(2**31), 2**31),
        "toggle": draw.random() < 0.5,
        "choice": draw.choice(["plain", "2", 'a "b", c', "two\nlines", " space ", "=1+1", "1"]),
        "color": tuple(draw.random() for _ in range(3)),
        "place": tuple(number() for _ in range(3)),
        "flat": tuple(number() for _ in range(2)),
        "time": draw.uniform(0.0, 1e3),
    }


def test_a_table_reads_back_to_the_bit(tmp_path, monkeypatch):
    """As the inputs of the next sweep; by Python's csv, whatever is in an option."""
    draw = random.Random(4)
    parameters = list(_anything().values())
    sets = [_anything_random(draw) for _ in range(60)]
    from distal.sweeps.inputs import inputs_of, read_inputs  # noqa: PLC0415 (not the whole sweep)

    inputs = inputs_of(sets, parameters)
    assert [inputs.named(i) for i in range(len(sets))] == sets
    table = SweepTable(tmp_path / "t.csv", inputs, ("brightness",), (), files=False)
    from distal.sweeps.table import SweepRow  # noqa: PLC0415

    with table.open({}):
        for i in reversed(range(len(sets))):
            table.add(SweepRow(i + 1, inputs.named(i), {}, {"brightness": sets[i]["slider"] / 3.0}))
    again = read_inputs(tmp_path / "t.csv", parameters)
    assert again.sets == inputs.sets
    assert [repr(again.named(i)) for i in range(len(sets))] == [repr(s) for s in sets]
    table = SweepTable(tmp_path / "t.csv", again, ("brightness",), (), files=False)
    rows = table.earlier(fresh=False)
    assert [repr(rows[i + 1].picture["brightness"]) for i in range(len(sets))] == [
        repr(s["slider"] / 3.0) for s in sets
    ]


_PROGRAM = """
import sys, time
import distal
from distal import Box, Scene
from distal.lang import slider
from distal.sweeps.solid_measures import SolidMeasures

def of(self, params, seconds, cancel):
    time.sleep(0.03)
    return {"key": self.key(params, seconds), "volume": params["width"] / 3.0}

SolidMeasures.of = of
width = slider("Width", 0.5, 0.1, 1.0)
made = distal.sweep(
    Scene(Box((width, 0.5, 0.5))), {"Width": "0.1:1:200"}, sys.argv[1], size=(4, 3), measure=True,
)
print(made.measured)
"""


@pytest.mark.parametrize("name", ["table.csv", "folder"])
def test_a_killed_sweep_loses_no_row(name, tmp_path, monkeypatch):
    program, output = tmp_path / "program.py", tmp_path / name
    program.write_text(textwrap.dedent(_PROGRAM))
    table = output if output.suffix else output / "sweep.csv"
    process = subprocess.Popen([sys.executable, program, output], stdout=subprocess.DEVNULL)
    try:
        until = time.monotonic() + 60.0
        while not table.exists() or table.read_bytes().count(b"\n") < 6:
            assert process.poll() is None and time.monotonic() < until
            time.sleep(0.01)
    finally:
        process.kill()
        process.wait()
    left = _rows(table)
    assert 5 <= len(left) < 200
    for row in left:
        assert float(row["measured.volume"]) == float(row["input.width"]) / 3.0
    done = {int(row["number"]) for row in left}
    measured = []

    def of(self, params, seconds, cancel):
        measured.append(params["width"])
        return {"key": self.key(params, seconds), "volume": params["width"] / 3.0}

    monkeypatch.setattr(SolidMeasures, "of", of)
    width = slider("Width", 0.5, 0.1, 1.0)
    scene = Scene(Box((width, 0.5, 0.5)))
    made = distal.sweep(scene, {"Width": "0.1:1:200"}, output, size=(4, 3), measure=True)
    assert made.measured == len(measured) == 200 - len(done)
    assert [row.number for row in made.rows] == list(range(1, 201))
    assert [int(row["number"]) for row in _rows(table)] == list(range(1, 201))
    if name == "folder":
        assert made.rendered == 200 - len(done)


def _small(monkeypatch):
    _fake_measures(monkeypatch)
    return Scene(Box((slider("Width", 0.5, 0.1, 1.0), 0.5, slider("Depth", 0.5, 0.1, 1.0))))


def test_a_row_that_was_cut_off_is_measured_again(tmp_path, monkeypatch):
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    distal.sweep(scene, {"width": "0.1:1:4"}, path)
    whole = path.read_bytes()
    first = whole.index(b"\n") + 1
    for length in range(first, len(whole)):
        path.write_bytes(whole[:length])
        made = distal.sweep(scene, {"width": "0.1:1:4"}, path)
        assert made.measured == 4 - whole[:length].count(b"\n") + 1
        assert path.read_bytes() == whole


def test_a_longer_list_goes_on(tmp_path, monkeypatch):
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    sets = [{"width": w} for w in (0.5, 0.3, 0.8, 0.2)]
    distal.sweep(scene, sets[:2], path)
    made = distal.sweep(scene, sets, path)
    assert made.measured == 2 and len(made.rows) == 4


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"width": "0.1:1:4"}, "it has 'width' 0.4 in row 2, and not 0.4000000000000001"),
        ({"width": "0.1,0.4"}, "it has row '3' of 2"),
        ({"depth": "0.1:1:4"}, "it has no column of 'depth'"),
        ({"width": "0.1:1:4", "depth": 1.0}, "it has no column of 'depth'"),
    ],
)
def test_a_table_of_other_inputs_is_kept(values, words, tmp_path, monkeypatch):
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    if "0.4000000000000001" in words:
        values = {"width": [0.1, 0.4000000000000001, 0.7, 1.0]}
    distal.sweep(scene, {"width": "0.1:1:4"}, path)
    whole = path.read_bytes()
    with pytest.raises(SaveError) as caught:
        distal.sweep(scene, values, path)
    assert str(caught.value) == (
        f"{path} is of other inputs: {words}; --fresh (fresh=True) replaces it, or name another "
        "output"
    )
    assert path.read_bytes() == whole
    made = distal.sweep(scene, values, path, fresh=True)
    assert len(_rows(path)) == len(made.rows) == made.measured


def test_a_file_that_is_no_table_is_kept(tmp_path, monkeypatch):
    """Also with ``fresh``: it may be the list of the values."""
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    path.write_text("width,depth\n0.5,0.5\n")
    for fresh in (False, True):
        with pytest.raises(SaveError, match="is no table of a sweep of this version: move it"):
            distal.sweep(scene, path, path, fresh=fresh)
    assert path.read_text() == "width,depth\n0.5,0.5\n"


def test_a_changed_solid_is_measured_again(tmp_path, monkeypatch):
    _fake_measures(monkeypatch)
    width, path = slider("Width", 0.5, 0.1, 1.0), tmp_path / "t.csv"
    values = {"width": "0.1,1"}
    distal.sweep(Scene(Box((width, 0.5, 0.5))), values, path)
    assert distal.sweep(Scene(Box((width, 0.5, 0.5))), values, path).measured == 0
    assert distal.sweep(Scene(Box((width, 0.5, 0.6))), values, path).measured == 2


def test_two_sweeps_do_not_share_a_table(tmp_path, monkeypatch):
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    distal.sweep(scene, {"width": "0.1,1"}, path)
    with (
        only_writer(path),
        pytest.raises(SaveError, match=r"cannot write .*: another process is writing it"),
    ):
        distal.sweep(scene, {"width": "0.1,1"}, path)
    distal.sweep(scene, {"width": "0.1,1"}, path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="limits of files are those of POSIX")
def test_a_full_disk_leaves_whole_rows(tmp_path, monkeypatch):
    """One line says so; what is there is whole rows."""
    scene, path = _small(monkeypatch), tmp_path / "t.csv"
    written, write = [], os.write

    def full(handle, data):
        if bytes(data[:2]) == b"3,":
            written.append(write(handle, bytes(data[:5])))
            monkeypatch.setattr(os, "write", refuse)
            return 5
        return write(handle, data)

    def refuse(handle, data):
        monkeypatch.setattr(os, "write", write)
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(SaveError, match=r"cannot write .*: No space left on device"):
        distal.sweep(scene, {"width": "0.1:1:4"}, path)
    assert written == [5]
    assert [row["number"] for row in _rows(path)] == ["1", "2"]


def test_whole_rows():
    assert _whole_rows("a,b\n1,2\n3") == [["a", "b"], ["1", "2"]]
    assert _whole_rows('a,b\n1,"x\ny"\n3,"x\n') == [["a", "b"], ["1", "x\ny"]]
    with pytest.raises(SaveError, match="row 2 has 1 values for 2 columns"):
        _whole_rows("a,b\n1\n1,2\n")
