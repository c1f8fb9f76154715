"""``distal mesh`` and ``distal measure``: files, texts, exit codes."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from distal.cli.application import application

PARTS = """\
from distal import Box, Circle, Plane, Scene, Sphere
from distal.lang import slider

part = Box(2.0, 1.0, 1.0).paint("#ff0000")
flat = Circle(1.0)
endless = Plane()
size = slider("size", 1.0, low=0.5, high=2.0)
ball = Sphere(size)
wire = Sphere(1.0) | Box(4.0, 0.0001, 0.0001).named("wire")
scene = Scene(part)
table = Box(2, 0.2, 2).named("top").translate(y=1) | Box(0.3, 2, 0.3).named("leg")
pair = part.named("body") | Sphere(0.3).translate(y=2.0).named("knob") | endless
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "parts.py").write_text(PARTS)
    return lambda *args: CliRunner().invoke(application, args)


def test_a_mesh_is_saved_and_described(run: Any) -> None:
    done = run("mesh", "parts.py:part", "-o", "part.stl", "--unit", "cm", "--check")
    assert done.exit_code == 0
    first, second, counts, third = done.stderr.splitlines()
    assert first.startswith("part.stl: ") and first.endswith(" triangles, 2 x 1 x 1 cm, 2 cubic cm")
    assert "cm from the surface" in second
    assert counts == "1 piece, 0 holes, 0 voids"
    assert third == "0 open edges, 0 pinched points, 0 intersections"
    data = Path("part.stl").read_bytes()[84:]
    rows = np.frombuffer(data, np.dtype([("numbers", "<f4", 12), ("rest", "<u2")]))["numbers"]
    a, b, c = rows[:, 3:].reshape(-1, 3, 3).astype(float).transpose(1, 0, 2)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    assert volume == pytest.approx(2000.0, rel=1e-6)  # cubic millimeters


def test_the_report_as_json(run: Any) -> None:
    done = run("mesh", "parts.py:scene", "-o", "part.ply", "--tolerance", "0.01", "--json")
    report = json.loads(done.stdout)
    assert report["tolerance"] == 0.01 and report["unit"] == "mm" and report["name"] == "Box"
    assert report["error"]["largest"] <= 0.01


def test_named_parts_are_saved_apart(run: Any) -> None:
    done = run("mesh", "parts.py:pair", "-o", "p.3mf", "--parts", "--tolerance", "0.02")
    assert done.exit_code == 0
    lines = done.stderr.splitlines()
    assert lines[0].startswith("p.3mf, body: ") and lines[0].endswith("2 x 1 x 1 mm, 2 cubic mm")
    assert lines[3].startswith("p.3mf, knob: ")
    assert lines[6] == "'Plane' (line 6) has no end and is left out"
    done = run("mesh", "parts.py:pair", "-o", "p.glb", "--parts", "--tolerance", "0.02", "--json")
    found = json.loads(done.stdout)
    assert [part["name"] for part in found["parts"]] == ["body", "knob"]
    assert found["endless"] == ["'Plane' (line 6)"]


def test_parameters_change_the_mesh(run: Any) -> None:
    done = run("measure", "parts.py:ball", "--set", "size=2", "--json")
    found = json.loads(done.stdout)
    volume = found["volume"]
    assert abs(volume["value"] - 33.510322) < volume["error"]
    assert found["bounds"] == [[-2.0, -2.0, -2.0], [2.0, 2.0, 2.0]]


def test_what_a_printer_needs_in_words(run: Any) -> None:
    done = run("measure", "parts.py:table", "--proved", "--work", "100", "--width", "0.001")
    lines = {line.split()[0]: line for line in done.stdout.splitlines() if line[0] != " "}
    assert lines["wall"].startswith("wall     0.2, the least of lines ")
    assert ": 'top (Box)' (line 11), (" in lines["wall"]
    # Below the top, without the leg and without what stands on the bed.
    found = re.match(r"overhang ([\d.]+), ([\d.]+) % of the area, within 45", lines["overhang"])
    assert float(found[1]) == pytest.approx(4.0 - 0.09, rel=1e-3)
    assert "flattest at 'top (Box)' (line 11), (" in lines["overhang"]
    proved = re.match(r"proved   volume ([\d.]+) to ([\d.]+), [\d.]+ % apart", lines["proved"])
    # The top, and the leg below and above it.
    assert float(proved[1]) < 0.8 + 0.09 * 1.9 < float(proved[2])
    rest = done.stdout[done.stdout.index("proved ") :].splitlines()[1:]
    assert [line.split()[0] for line in rest[:4]] == ["mass", "center", "low", "high"]
    assert rest[4] == "         by intervals, whatever the slope"
    assert re.match(r" +[\d.]+ % of the box are undecided after [\d,]+ boxes; the shape", rest[5])
    assert rest[6] == "         --width is not reached: give a larger --work"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--width", "0.1"], "error: --width is for --proved, which is not given"),
        (
            ["--proved", "--width", "2"],
            "error: --width is a share from 0 to 2, such as 0.01, not 2",
        ),
        (["--proved", "--work", "0"], "error: --work is 1 to 1,000,000,000 boxes, not 0"),
    ],
)
def test_what_cannot_be_proved_with_is_refused(run: Any, given: list[str], message: str) -> None:
    done = run("measure", "parts.py:table", *given)
    assert done.exit_code == 2 and message in done.stderr


def test_what_a_printer_needs_as_json(run: Any) -> None:
    found = json.loads(run("measure", "parts.py:table", "--overhang", "0", "--json").stdout)
    assert found["overhang"]["area"] == 0.0 and found["overhang"]["place"] is None
    assert found["wall"]["value"] == pytest.approx(0.2, rel=1e-4) and found["wall"]["line"] == 11
    assert found.get("brackets") is None


def test_measures_in_words(run: Any) -> None:
    done = run("measure", "parts.py:part", "--density", "2")
    lines = done.stdout.splitlines()
    assert lines[0].startswith("volume   2 ± ")
    assert lines[2].startswith("mass     4 ± ")
    assert lines[4].startswith("inertia  0.666667, 0, 0; 0, 1.66667, 0; 0, 0, 1.66667 ± ")
    assert lines[6] == "bounds   (-1, -0.5, -0.5) to (1, 0.5, 0.5), which the shape never leaves"


def test_lost_parts_are_warned_of(run: Any) -> None:
    done = run("mesh", "parts.py:wire", "-o", "w.stl", "--feature", "0.4", "--tolerance", "0.1")
    assert done.exit_code == 0
    assert "warning: 'wire (Box)' (line 9) is thinner than" in done.stderr


@pytest.mark.parametrize(
    ("args", "code", "text"),
    [
        (
            ("mesh", "parts.py:part", "-o", "p.step"),
            1,
            "error: a mesh is not saved as '.step': use one of .3mf, .stl, .glb, .ply, .obj\n",
        ),
        (
            ("mesh", "parts.py:part", "-o", "p.stl", "--unit", "yard"),
            1,
            "error: a unit is one of um, mm, cm, m, inch, ft, not 'yard'\n",
        ),
        (
            ("mesh", "parts.py:part", "-o", "p.stl", "--tolerance", "0"),
            2,
            "error: --tolerance is a length above 0, not 0\n",
        ),
        (
            ("mesh", "parts.py:flat", "-o", "p.stl"),
            1,
            "error: 'Circle' is a flat shape: .extrude(height) makes a solid\n",
        ),
        (
            ("mesh", "parts.py:part", "-o", "parts.py"),
            2,
            "error: 'parts.py' is the scene itself\n",
        ),
        (
            ("measure", "parts.py:part", "--density", "-1"),
            2,
            "error: --density is a number above 0, not -1\n",
        ),
        (
            ("measure", "parts.py:part", "--overhang", "91"),
            2,
            "error: --overhang is an angle from 0 to 90 degrees, not 91\n",
        ),
    ],
)
def test_mistakes(run: Any, args: tuple[str, ...], code: int, text: str) -> None:
    done = run(*args)
    assert (done.exit_code, done.stderr) == (code, text)
    assert not list(Path().glob("p.*"))


def test_a_shape_without_end_is_refused_at_its_line(run: Any) -> None:
    done = run("mesh", "parts.py:endless", "-o", "p.stl")
    assert done.exit_code == 1
    assert "error: 'Plane' has no end along x and y and z" in done.stderr
    assert "parts.py:6:11" in done.stderr
    assert not Path("p.stl").exists()
