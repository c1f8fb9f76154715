"""``render``, ``check`` and ``probe`` of real scenes: exact texts, exit codes, pictures."""

import json
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from distal.cli.application import application

LYING = """\
from distal import Plane, Scene, Shape, Sphere
from distal.lang import func, length, vec3

@func
def steep(p: vec3) -> float:
    return 2.0 * (length(p) - 1.0)

ball = Shape.from_function(steep, bounds=((-1, -1, -1), (1, 1, 1)))
"""

TWISTED = """\
from distal import Box, Camera, Scene
scene = Scene(Box(1.0, 2.0, 1.0).twist(2.0).paint("#ff0000"), camera=Camera((0, 0, 4)))
"""

FLOORLESS = TWISTED.replace("))\n", "), floor=False)\n")

PICTURE = """\
from distal.lang import Frame, func, image, vec3

@func
def half(x: float) -> float:
    return 0.5 * x

@image
def picture(frame: Frame) -> vec3:
    height = half(frame.coord.y)
    return vec3(height)
"""

SHAPES = """\
from distal import Box, Sphere
one = Sphere(0.5)
shape = (Box(1.0) - one).named("die")
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = {
        "lying": LYING,
        "twisted": TWISTED,
        "floorless": FLOORLESS,
        "picture": PICTURE,
        "shapes": SHAPES,
    }
    for name, text in files.items():
        Path(f"{name}.py").write_text(text)
    return lambda *words: CliRunner().invoke(application, words)


def test_a_lie_is_told_at_its_line_and_is_exit_1(run):
    result = run("check", "lying.py")
    assert result.exit_code == 1
    assert result.stderr == ""
    head, error = result.stdout.split("\n\n")[:2], result.stdout.split("\n\n")[2]
    assert head[0] == "steep  slope 1  -  box (-1, -1, -1) to (1, 1, 1)  lying.py:8"
    assert head[1].startswith("slope of 'steep': 1\nmeasured at 6144 points: |gradient| median 2, ")
    lines = error.rstrip("\n").split("\n")
    assert lines[0].startswith(
        "error: 'steep' declares the slope 1, but its value changes by 2 per unit "
    )
    assert lines[1:] == [
        "  --> lying.py:8:8",
        "   |",
        " 8 | ball = Shape.from_function(steep, bounds=((-1, -1, -1), (1, 1, 1)))",
        "   |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^",
        "   = hint: slope=2.1",
    ]


def test_where_slope_comes_from(run):
    result = run("check", "twisted.py")
    assert result.exit_code == 0
    assert result.stdout.startswith(
        "twist  slope 1.93  -      box (-0.707, -1, -0.707) to (0.707, 1, 0.707)  twisted.py:2\n"
        "  Box  slope 1     exact  box (-0.5, -1, -0.5) to (0.5, 1, 0.5)  twisted.py:2\n"
        "\n"
        "slope of 'twist': 1.93\n"
        "  twist(rate=2) raises the slope from 1 to 1.93 at twisted.py:2\n"
        "measured at "
    )
    assert "note: twist(rate=2) is no longer exact outside" in result.stdout


def test_check_for_editors_is_one_line_of_json(run):
    result = run("check", "lying.py:ball", "--json")
    assert result.exit_code == 1
    assert result.stdout.count("\n") == 1
    made = json.loads(result.stdout)
    assert (made["version"], made["holds"], made["name"]) == (1, False, "steep")
    (error,) = [f for f in made["findings"] if f["severity"] == "error"]
    assert error["code"] == "slope-exceeded"
    place = {"file": "lying.py", "line": 8, "column": 8, "end_line": 8, "end_column": 68}
    assert error["place"] == place
    assert json.loads(run("check", "twisted.py", "--json").stdout)["holds"]


@pytest.mark.parametrize("command", ["check", "probe", "measure"])
def test_an_error_for_editors_is_json_too(run, command):
    Path("wrong.py").write_text("from distal import Sphere\n\nball = Spher(1.0)\n")
    words = ("--at", "1,1") if command == "probe" else ()
    result = run(command, "wrong.py", "--json", *words)
    assert result.exit_code == 1
    (error,) = json.loads(result.stdout)["errors"]
    assert error == {
        "code": "file",
        "message": "NameError: name 'Spher' is not defined",
        "hint": "did you mean 'Sphere'?",
        **{"file": "wrong.py", "line": 3, "column": 8, "end_line": 3, "end_column": 13},
        "excerpt": "ball = Spher(1.0)",
        "labels": [],
    }
    assert "error: NameError" in result.stderr and not run(command, "wrong.py", *words).stdout


def test_probe_tells_what_a_pixel_saw(run):
    result = run("probe", "floorless.py", "--at", "32,24", "--size", "64x48")
    assert result.exit_code == 0
    lines = result.stdout.rstrip("\n").split("\n")
    assert lines[0] == "pixel     32,24 of 64x48 at 0 s"
    assert lines[1].startswith("ray       from (0, 0, 4) along (")
    assert lines[2].startswith("steps     ")
    assert lines[3].startswith("hit       at (")
    assert lines[6:8] == [
        "shape     Box(size=(1, 2, 1)): exact outside, exact inside, lower bound",
        "part of   twist",
    ]
    assert lines[8:12] == [
        "  --> floorless.py:2:15",
        "   |",
        f" 2 | {FLOORLESS.splitlines()[1]}",
        "   |               ^^^^^^^^^^^^^^^^^^",
    ]
    assert lines[12] == "material  matte: color (1, 0, 0) #ff0000, diffuse 1"


def test_probe_of_nothing_and_for_editors(run):
    result = run("probe", "floorless.py", "--at", "0,0", "--size", "64x48")
    assert result.stdout.endswith("\nnothing   the ray passed the box\n")
    words = ("--at", "32,24", "--size", "64x48", "--json", "--time", "2")
    made = json.loads(run("probe", "floorless.py", *words).stdout)
    assert made["hit"]
    assert made["time"] == 2.0
    assert made["material"]["color"] == [1.0, 0.0, 0.0]


def test_probe_of_an_image_lists_its_locals(run):
    lines = run("probe", "picture.py", "--at", "1,1", "--size", "4x4").stdout.splitlines()
    assert lines[0] == "pixel     1,1 of 4x4 at 0 s"
    assert lines[2].startswith("height  float  ")
    assert "line " in lines[2]
    made = json.loads(run("probe", "picture.py", "--at", "1,1", "--json").stdout)
    assert [each["name"] for each in made["locals"]] == ["height"]
    assert made["time"] == 0.0


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (
            ("check", "picture.py"),
            1,
            "error: 'picture' is no scene and no shape; guarantees are checked of these\n",
        ),
        (
            ("probe", "twisted.py", "--at", "640,0"),
            2,
            "error: a picture of 640x480 ends at 639,479\n",
        ),
        (
            ("render", "picture.py", "-o", "a.png", "--transparent"),
            2,
            "error: --transparent is for scenes and shapes; 'picture' is an @image\n",
        ),
        (
            ("render", "picture.py", "-o", "a.png", "--no-caustics"),
            2,
            "error: --no-caustics is for scenes and shapes; 'picture' is an @image\n",
        ),
        (
            ("render", "picture.py", "-o", "a.png", "--time-limit", "3"),
            2,
            "error: --time-limit is for scenes and shapes; 'picture' is an @image\n",
        ),
        (
            ("render", "picture.py", "-o", "a.png", "--view", "local:depth"),
            2,
            "error: 'picture' has no local 'depth' that can be shown\n"
            "what it can show:\n  local:height  float\n",
        ),
        (
            ("render", "twisted.py", "-o", "a.png", "--view", "local:t"),
            2,
            "error: there is no view 'local:t'; views: color, coordinate, signal, distance, "
            "normal, depth, steps, material, slope, slice; locals are shown of an @image\n",
        ),
        (
            ("check", "twisted.py", "--set", "a=1"),
            2,
            "error: there is no parameter 'a'\nthis scene has no parameters\n",
        ),
        (("check", "nowhere.py"), 1, "error: there is no file nowhere.py\n"),
    ],
)
def test_mistakes_are_one_clear_message(run, words, code, message):
    result = run(*words)
    assert (result.exit_code, result.stdout, result.stderr) == (code, "", message)
    assert not Path("a.png").exists()


def test_a_lone_shape_is_rendered_in_its_own_scene(run):
    result = run("render", "shapes.py", "-o", "a.png", "--size", "32x24")
    assert result.exit_code == 0, result.output
    assert Image.open("a.png").getextrema()[0][1] > 150
    assert run("probe", "shapes.py", "--at", "16,12", "--size", "32x24").exit_code == 0
    assert run("render", "shapes.py:one", "-o", "b.png", "--size", "32x24").exit_code == 0
    assert Path("a.png").read_bytes() != Path("b.png").read_bytes()


def test_views_of_scenes_and_images(run):
    pictures = set()
    for words in (
        ("--view", "normal"),
        ("--view", "steps"),
        ("--slice", "z=0"),
        ("--slice", "y=0.9"),
        ("--exposure", "0.5"),
        ("--tone-map", "agx"),
        ("--transparent",),
    ):
        result = run("render", "twisted.py", "-o", "a.png", "--size", "32x24", *words)
        assert result.exit_code == 0, result.output
        pictures.add(Path("a.png").read_bytes())
    assert len(pictures) == 7
    for view in ("signal", "coordinate", "local:height"):
        result = run("render", "picture.py", "-o", "a.png", "--size", "8x4", "--view", view)
        assert result.exit_code == 0, result.output
