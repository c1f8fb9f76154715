"""All combinations of values: pictures, sheets, tables; broken off, continued, refused."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import distal
from distal import Box, Scene, Sphere
from distal.cli.application import application
from distal.devices.base import Cancelled
from distal.file_writer import SaveError
from distal.images.png import quantise
from distal.lang import Frame, choice, color, image, integer, slider, toggle, vec3
from distal.mesh import measuring
from distal.sweeps.axes import axis_of

AMOUNT = slider("Amount", 0.5, 0.0, 1.0)
COUNT = integer("Count", 2, 1, 9)
LIT = toggle("Lit", True)
KIND = choice("Kind", ["plain", "odd"])
# Options whose names contain what separates values.
RATIO = choice("Ratio", ["16:9", "4,3", " wide ", "2", "4"])
TINT = color("Tint", "#ff0000")
ALL = [AMOUNT, COUNT, LIT, KIND, TINT, RATIO]


@image
def flat(frame: Frame) -> vec3:
    """One color for each combination."""
    return vec3(AMOUNT, float(COUNT) / 9.0, frame.time / 4.0)


@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("Amount", "0:1:5", (0.0, 0.25, 0.5, 0.75, 1.0)),
        ("amount", "1:0:3", (1.0, 0.5, 0.0)),
        ("amount", "0.2", (0.2,)),
        ("amount", [0.1, 0.2], (0.1, 0.2)),
        ("amount", np.linspace(0.0, 1.0, 3), (0.0, 0.5, 1.0)),
        ("count", "2:5", (2, 3, 4, 5)),
        ("count", "1:9:5", (1, 3, 5, 7, 9)),
        ("count", "1:9:4", (1, 4, 6, 9)),
        ("lit", "true,false", (True, False)),
        ("kind", "odd,plain", (1, 0)),
        ("tint", "#000000;1,1,1", ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))),
        ("time", "0:1:2", (0.0, 1.0)),
        ("ratio", "16:9", (0,)),
        ("ratio", "16:9,4,3, wide ,2", (0, 1, 2, 3)),
        ("ratio", "4,3", (1,)),
        ("ratio", "4,3,4", (1, 4)),
        ("ratio", "1, 2", (1, 3)),
    ],
)
def test_values(name, given, values):
    assert axis_of(name, given, ALL).values == values


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("size", "1", "there is no parameter 'size'; a sweep takes amount, count, lit, kind, tint"),
        ("amount", "0:1:x", "'Amount' takes FIRST:LAST:COUNT, not '0:1:x'"),
        ("amount", "0:1:0", "'Amount' takes FIRST:LAST:COUNT, not '0:1:0'"),
        ("amount", "0:2:3", "'Amount' lies between 0 and 1, not 2"),
        ("amount", "0:inf:3", "'Amount' takes FIRST:LAST:COUNT, not '0:inf:3'"),
        ("amount", "nan:1:2", "'Amount' takes FIRST:LAST:COUNT, not 'nan:1:2'"),
        ("count", "1.5:4.5:3", "'Count' takes whole numbers, not '1.5:4.5:3'"),
        ("lit", "0:1:2", "'Lit' takes true or false, not '0:1:2'"),
        ("kind", "0:1:2", "'Kind' takes one of plain, odd, not '0:1:2'"),
        ("amount", "0:1:200000", "'Amount' takes at most 100000 values, not 200000"),
        ("amount", ",", "'Amount' has no values"),
        ("time", ",", "'time' has no values"),
        ("time", "0,soon", "time is a number of seconds, not 'soon'"),
        ("time", "", "'time' has no values"),
        ("time", [], "'time' has no values"),
        ("kind", "even", "'Kind' takes one of plain, odd, not 'even'"),
    ],
)
def test_wrong_values(name, given, words):
    with pytest.raises(ValueError, match=f"^{re.escape(words)}"):
        axis_of(name, given, ALL)


def test_a_sheet_shows_each_picture_at_its_place(tmp_path):
    path = tmp_path / "grid.png"
    values = {"amount": "0:1:3", "count": "3,6", "time": [0.0, 2.0]}
    made = distal.sweep(flat, values, path, size=(40, 30))
    assert made.pictures == made.rendered == 12 and made.table == tmp_path / "grid.csv"
    with Image.open(path) as file:
        sheet, texts = np.asarray(file.convert("RGB")), file.info
    assert json.loads(texts["distal:sweep"])["axes"]["count"] == [3, 6]
    right, bottom = sheet.shape[1] - 16, sheet.shape[0] - 16
    for number in range(12):
        row, column = divmod(number, 2)
        amount, count, time = row // 2 / 2, (3, 6)[row % 2], (0.0, 2.0)[column]
        x, y = right - (2 - column) * 46 + 26, bottom - (6 - row) * 36 + 21
        pixel = quantise(np.array([[[amount, count / 9, time / 4, 1.0]]], np.float32))[0, 0, :3]
        np.testing.assert_array_equal(sheet[y, x], pixel)
    with open(made.table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["input.count"] for row in rows[:4]] == ["3", "3", "6", "6"]
    assert [row["input.time"] for row in rows[:2]] == ["0.0", "2.0"]
    light = 0.2126 * 0.5 + 0.7152 * 3 / 9
    assert float(rows[4]["picture.brightness"]) == pytest.approx(light, abs=2e-3)


def test_a_folder_keeps_what_is_there(tmp_path):
    folder = tmp_path / "pictures"
    values = {"amount": "0:1:5"}
    with pytest.raises(Cancelled):
        seen = []
        distal.sweep(
            flat,
            values,
            folder,
            size=(8, 6),
            threads=1,
            progress=lambda done, *_: seen.append(done),
            cancel=lambda: len(seen) >= 2,
        )
    left = sorted(p.name for p in folder.glob("*.png"))
    assert 0 < len(left) < 5 and (folder / "sweep.csv").exists()
    made = distal.sweep(flat, values, folder, size=(8, 6))
    assert made.rendered == 5 - len(left) and len(made.rows) == 5
    # Each has its recipe, and is what render gives.
    with Image.open(folder / "003.png") as file:
        assert json.loads(file.info["distal:parameters"])["amount"] == 0.5
        alone = quantise(flat.render((8, 6), params={"amount": 0.5}).array)[..., :3]
        np.testing.assert_array_equal(np.asarray(file.convert("RGB")), alone)
    again = distal.sweep(flat, values, folder, size=(8, 6))
    assert again.rendered == 0 and again.rows == made.rows
    assert again.rows[2].inputs == {"amount": 0.5}
    assert distal.sweep(flat, values, folder, size=(8, 6), fresh=True).rendered == 5


def test_shapes_are_swept(tmp_path):
    size = slider("Size", 0.5, 0.2, 1.0)
    made = distal.sweep(Scene(Sphere(size)), {"size": "0.2,1"}, tmp_path / "s.png", size=(24, 18))
    assert made.rows[0].picture["brightness"] != made.rows[1].picture["brightness"]
    assert str(made).startswith(f"{tmp_path / 's.png'}: 2 pictures; ")


def test_solids_are_measured(tmp_path):
    """Against closed forms; also of pictures that are there; paint is no parameter of a solid."""
    size, tint = slider("Size", 0.5, 0.2, 1.0), color("Tint", "#ff0000")
    scene, values = Scene(Sphere(size).paint(tint)), {"size": "0.4,1", "tint": "#fff;#000"}
    options = {"size": (8, 6), "threads": 1}
    distal.sweep(scene, values, tmp_path / "all", **options)
    made = distal.sweep(scene, values, tmp_path / "all", measure=True, **options)
    assert made.rendered == 0 and len(made.rows) == 4
    for full, radius in zip(made.rows, (0.4, 0.4, 1.0, 1.0), strict=True):
        row = full.measured
        volume, area = 4.0 / 3.0 * np.pi * radius**3, 4.0 * np.pi * radius**2
        assert abs(row["volume"] - volume) <= max(3.0 * row["volume_error"], 1e-4 * volume)
        assert abs(row["area"] - area) <= max(3.0 * row["area_error"], 1e-4 * area)
        assert row["width"] == pytest.approx(2.0 * radius, rel=1e-3) and row["remark"] is None
    with open(made.table, encoding="utf-8") as file:
        assert float(list(csv.DictReader(file))[3]["measured.volume"]) == row["volume"]


def test_a_table_keeps_what_an_earlier_sweep_measured(tmp_path):
    scene = Scene(Sphere(slider("Size", 0.5, 0.2, 1.0)))
    options = {"size": (8, 6), "threads": 1}
    first = distal.sweep(scene, {"size": "0.4,1"}, tmp_path, measure=True, **options)
    (tmp_path / "001.png").unlink()
    made = distal.sweep(scene, {"size": "0.4,1"}, tmp_path, **options)
    assert made.rendered == 1 and made.measured == 0
    new, kept = made.rows
    assert new.measured == {} and kept == first.rows[1]
    again = distal.sweep(scene, {"size": "0.4,1"}, tmp_path, measure=True, **options)
    assert again.rendered == 0 and again.measured == 1
    assert [row.measured for row in again.rows] == [row.measured for row in first.rows]


def test_measures_need_a_solid(tmp_path):
    with pytest.raises(
        ValueError, match=r"^measures are of solids: an @image and flat shapes have"
    ):
        distal.sweep(flat, {"amount": "0,1"}, tmp_path / "s.png", measure=True)


@pytest.mark.parametrize(
    ("values", "path", "options", "error", "words"),
    [
        ({}, "a.png", {}, ValueError, "a sweep takes values: --set NAME="),
        ({"amount": "0:1:400", "count": "1:9", "time": "0:1:40"}, "a", {}, ValueError,
         "a sweep has at most 100000 pictures, not 144000"),
        ({"amount": "0,1", "Amount": "0.5"}, "a.png", {}, ValueError, "'Amount' has values twice"),
        ({"amount": "0:1:400"}, "a.png", {}, ValueError, "a sheet of 400x1 pictures would have"),
        ({"amount": "0:1:4"}, "a.jpg", {}, SaveError,
         "a sweep is a .png, a .csv or a folder, not a.jpg"),
        ({"amount": "0:1:4"}, "a.png", {"params": {"amount": 1.0}}, ValueError,
         "'Amount' has values of the sweep, and another one"),
        ({"amount": "0:1:4"}, "a.png", {"params": {"Amount": 1.0}}, ValueError,
         "'Amount' has values of the sweep, and another one"),
    ],
)  # fmt: skip
def test_refused(values, path, options, error, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error) as caught:
        distal.sweep(flat, values, path, **options)
    assert str(caught.value).startswith(words)
    assert list(tmp_path.iterdir()) == []


def test_a_remark_says_what_the_meshes_miss(tmp_path, monkeypatch):
    """The warnings of ``measure``: the errors of such a row are large, and here is why."""
    ball = Sphere(1.0)
    missed = replace(ball.measure(), warnings=("a part is missing", "another one, too"))
    monkeypatch.setattr(measuring, "measures_of", lambda *given: missed)
    made = distal.sweep(ball, {"time": [0.0]}, tmp_path / "t.csv")
    assert made.rows[0].measured["remark"] == "a part is missing; another one, too"
    again = distal.sweep(ball, {"time": [0.0]}, tmp_path / "t.csv")
    assert again.measured == 0 and again.rows == made.rows


def test_other_parameters_have_values_by_name_or_label(tmp_path):
    size, wide = slider("Size", 0.5, 0.2, 1.0), slider("Wide base", 0.5, 0.2, 1.0)
    tall = Box((size, 1.0, wide))
    depths = []
    for number, params in enumerate(({}, {"wide_base": 0.75}, {"Wide base": np.float32(0.75)})):
        path = tmp_path / f"{number}.csv"
        (row,) = distal.sweep(tall, {"Size": [0.25]}, path, params=params).rows
        depths.append(round(row.measured["depth"], 6))
        sheet = distal.sweep(
            tall, {"Size": [0.25]}, path.with_suffix(".png"), params=params, size=(8, 6), fresh=True
        )
        assert sheet.pictures == 1
    assert depths == [0.5, 0.75, 0.75]


def test_on_a_cluster(tmp_path, monkeypatch):
    """Pictures and measures of workers are those of this process, which measures nothing then.

    A solid that has no mesh has the same remark, with the author's line, which workers do not know.
    """
    pytest.importorskip("distributed")
    from tests.cluster.conftest import local_cluster  # noqa: PLC0415 (needs the package)

    width = slider("Width", 0.5, -0.2, 1.0)
    solid = Sphere(width + 0.0) - Sphere(0.15).named("hole")
    values, files = {"width": [0.4, 0.1, 1.0]}, (tmp_path / "alone.csv", tmp_path / "all.csv")
    distal.sweep(flat, {"amount": "0:1:6"}, tmp_path / "alone.png", size=(16, 12))
    here = distal.sweep(Scene(solid), values, files[0].with_stem("solid"))
    refused = []
    measures_of = measuring.measures_of

    def noted(shape, density, request, *rest):
        refused.append(request.params)
        return measures_of(shape, density, request, *rest)

    with local_cluster(2) as client:
        distal.sweep(flat, {"amount": "0:1:6"}, tmp_path / "all.png", size=(16, 12), cluster=client)
        monkeypatch.setattr(measuring, "measures_of", noted)
        made = distal.sweep(Scene(solid), values, files[1].with_stem("solids"), cluster=client)
    assert (tmp_path / "all.png").read_bytes() == (tmp_path / "alone.png").read_bytes()
    assert made.table.read_bytes() == here.table.read_bytes()
    assert refused == [{"width": 0.1}] and made.measured == 3
    assert "has no inside" in made.rows[1].measured["remark"]


def test_the_command_takes_a_parameter_once(tmp_path):
    """Before, the last one was taken without a word."""
    words = ["sweep", "example:raymarcher", "--set", "time=0,1", "--set", "time=2"]
    made = CliRunner().invoke(application, [*words, "-o", str(tmp_path / "s.png")])
    assert made.exit_code == 2 and not list(tmp_path.iterdir())
    assert "--set gives 'time' twice: NAME=0.2,0.4 has both values" in made.output
