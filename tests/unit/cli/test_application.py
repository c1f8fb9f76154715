"""The commands: what they call, what they print where, and their exit codes.

A double stands for the library here.
"""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

import distal
from distal.cli.application import application
from distal.cli.doctor import MachineFact, State
from distal.diagnostics import CompileError, LoadError, Span
from distal.error_codes import ErrorCode
from distal.images.picture import Picture
from distal.lang import func
from distal.lang.parameters import slider
from distal.lang.render_options import RenderOptions
from distal.scene.objects.shapes import Sphere
from distal.scene.scene import Scene

STATS = {"compile_s": 0.1, "render_s": 0.2, "cache_hit": True, "lanes": 32, "threads": 2}


class Double(Scene):
    """Takes what a scene takes, and remembers it."""

    __setattr__ = object.__setattr__

    def __init__(self):
        super().__init__(Sphere(1.0))
        self.options = None
        self.failure = None

    def parameters(self):
        return [slider("Blend", 0.3)]


def rendered(scene, options):
    if scene.failure:
        raise scene.failure
    scene.options = options
    width, height = options.size
    return Picture(np.ones((height, width, 4), np.float32), stats=STATS)


@pytest.fixture
def scene(monkeypatch):
    monkeypatch.setattr("distal.scene.rendering.render_scene", rendered)
    scene = Double()
    scene.loaded = []

    def load(path, name, say):
        scene.loaded.append((path, name))
        return scene

    def compile(obj, target, after=None):
        text = f"// {target} {after}\n"
        return SimpleNamespace(text=text, interface={"a": 1}, vertex="vertex\n")

    monkeypatch.setattr("distal.load_watch.load_watched", load)
    # Into the namespace itself: asking for the real names first would import the whole compiler.
    monkeypatch.setitem(vars(distal), "compile", compile)
    monkeypatch.setitem(vars(distal), "gallery", lambda: {"ball": Path("/g/ball.py")})
    return scene


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(application, words)


def test_render_writes_the_picture_and_says_how_long_it_took(scene, run):
    result = run("render", "s.py:picture", "-o", "a.png", "--size", "4x3", "--set", "blend=0.5")
    assert result.exit_code == 0, result.output
    assert scene.loaded == [("s.py", "picture")]
    assert scene.options.size == (4, 3)
    assert scene.options.params == {"blend": 0.5}
    assert scene.options.device == "cpu"
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert result.stdout == ""
    assert "a.png: 4x3; load" in result.stderr
    assert "compile 0.100 s, render 0.200 s" in result.stderr


def test_render_hands_on_time_device_and_threads(scene, run):
    words = ("--time", "1.5", "--device", "reference", "--threads", "3")
    assert run("render", "example:ball", "-o", "a.png", *words).exit_code == 0
    assert scene.loaded == [("example:ball", None)]
    assert scene.options.time == 1.5
    assert scene.options.device == "reference"
    assert scene.options.threads == 3


def test_a_function_is_no_picture(scene, run, monkeypatch):
    monkeypatch.setattr("distal.load_watch.load_watched", lambda path, name, say: hidden)
    result = run("render", "s.py:hidden", "-o", "a.png")
    assert result.exit_code == 1
    assert result.stderr == (
        "error: 'hidden' is a @func; only a scene, a shape or an @image is a picture\n"
    )


@func
def hidden(x: float) -> float:
    return x


def test_how_a_scene_is_seen_is_handed_on(scene, run):
    words = ("--view", "normal", "--samples", "4", "--transparent")
    assert run("render", "s.py", "-o", "a.png", *words).exit_code == 0
    assert (scene.options.view, scene.options.transparent) == ("normal", True)
    assert scene.options.samples == 4
    assert run("render", "s.py", "-o", "a.png", "--slice", "y=-0.5").exit_code == 0
    assert (scene.options.view, scene.options.plane) == ("slice", ((0.0, 1.0, 0.0), -0.5))
    assert run("render", "s.py", "-o", "a.png").exit_code == 0
    assert scene.options == RenderOptions(progress=scene.options.progress)


def test_stats_are_exactly_one_json_line_on_stdout(scene, run):
    result = run("render", "s.py", "-o", "a.png", "--size", "4x3", "--stats")
    assert result.stdout.count("\n") == 1
    figures = json.loads(result.stdout)
    assert {k: figures[k] for k in STATS} == STATS
    assert (figures["device"], figures["size"]) == ("cpu", [4, 3])
    assert result.stderr == ""


@pytest.mark.parametrize(
    "words",
    [
        ("--size", "0x0"),
        ("--time", "soon"),
        ("--threads", "0"),
        ("--device", "toaster"),
        ("--set", "nothing=1"),
        ("--set", "blend=9"),
        ("--nonsense",),
        ("--view", "x-ray"),
        ("--view", "local:x"),
        ("--slice", "w=1"),
        ("--slice", "y=1", "--view", "depth"),
        ("--samples", "0"),
        ("--tone-map", "sepia"),
        ("--exposure", "-1"),
        ("--exposure", "nan"),
        ("--exposure", "inf"),
    ],
)
def test_wrong_usage_is_exit_2_and_renders_nothing(scene, run, words):
    result = run("render", "s.py", "-o", "a.png", *words)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr
    assert scene.options is None
    assert not Path("a.png").exists()


def test_a_processor_that_cannot_is_one_line(scene, run, monkeypatch):
    monkeypatch.setenv("DISTAL_CPU", "mmx")
    result = run("render", "s.py", "-o", "a.png")
    assert result.exit_code == 2
    assert "there is no CPU feature level 'mmx'" in result.stderr


@pytest.mark.parametrize(
    "words",
    [("render", "s.py", "-o", "a.png"), ("compile", "example:planet", "--target", "glsl-es300")],
    ids=["render", "compile"],
)
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("DISTAL_CACHE_MIB", "DISTAL_CACHE_MIB is a whole number of MiB: 'much'"),
        ("DISTAL_LLVM_LEVEL", "DISTAL_LLVM_LEVEL is a level of LLVM's code generation, 0 to 3"),
    ],
)
def test_a_variable_with_another_value_is_one_line(scene, run, monkeypatch, words, name, message):
    monkeypatch.setenv(name, "much")
    result = run(*words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("source", "file"),
    [("a/s.py", "s.png"), ("s.py:picture", "s_picture.png"), ("example:sea", "sea.png")],
)
def test_without_an_output_the_picture_is_named_like_the_scene(scene, run, source, file):
    result = run("render", source, "--size", "4x3")
    assert result.exit_code == 0, result.output
    assert Path(file).read_bytes().startswith(b"\x89PNG")


def test_output_is_checked_before_any_work(scene, run):
    result = run("render", "s.py", "-o", "a.jpg", "--transparent")
    assert (result.exit_code, result.stderr) == (
        2,
        "error: a JPEG has no transparency: -o FILE.png\n",
    )
    for name in ("a.bmp", "nowhere/a.png"):
        result = run("render", "s.py", "-o", name)
        assert result.exit_code == 1
        assert result.stderr.startswith(f"error: cannot write {name}")
    assert scene.loaded == []


@pytest.mark.parametrize(
    ("failure", "code", "message"),
    [
        (
            CompileError.at(ErrorCode.NAME, "'x' is not defined", Span("s.py", 1, 4, 5, "y = x")),
            1,
            "error: 'x' is not defined\n  --> s.py:1:5\n   |\n 1 | y = x\n   |     ^\n",
        ),
        (LoadError("there is no file s.py"), 1, "error: there is no file s.py\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_failures_have_their_text_and_code_and_leave_no_file(scene, run, failure, code, message):
    scene.failure = failure
    result = run("render", "s.py", "-o", "a.png")
    assert result.exit_code == code
    assert result.stderr == message
    assert list(Path().iterdir()) == []


def test_a_fault_of_ours_is_not_dressed_up(scene, run):
    scene.failure = ZeroDivisionError("ours")
    assert isinstance(run("render", "s.py", "-o", "a.png").exception, ZeroDivisionError)


def test_compile_prints_the_text_alone(scene, run):
    result = run("compile", "s.py", "--target", "wgsl")
    assert result.exit_code == 0
    # Under a comment that says whose it is, and how it is used.
    assert result.stdout.startswith("/*\n * s.py, written by distal ")
    assert result.stdout.endswith(" */\n\n// wgsl None\n")
    assert run("compile", "s.py", "--target", "ir", "--after", "lower").stdout == "// ir lower\n"


def test_compile_to_a_file_writes_interface_and_vertex_stage_beside_it(scene, run):
    result = run("compile", "s.py", "--target", "glsl-es300", "-o", "a.frag")
    assert (result.exit_code, result.stdout) == (0, "")
    assert Path("a.frag").read_text().endswith(" */\n\n// glsl-es300 None\n")
    assert json.loads(Path("a.json").read_text()) == {"a": 1}
    assert Path("a.vert").read_text() == "vertex\n"
    assert len(list(Path().iterdir())) == 3


@pytest.mark.parametrize(
    "words",
    [
        (),
        ("--target", "basic"),
        ("--target", "wgsl", "--after", "lower"),
        ("--target", "ir", "--after", "nothing"),
        ("--target", "wgsl", "-o", "a.json"),
    ],
)
def test_compile_refuses_wrong_usage(scene, run, words):
    assert run("compile", "s.py", *words).exit_code == 2
    assert list(Path().iterdir()) == []


def test_examples_are_listed(scene, run, monkeypatch):
    found = {"coral": Path("/g/frames/coral.py"), "ball": Path("/g/ball.py")}
    monkeypatch.setattr("distal.cli.application.all_examples", lambda: found)
    assert run("examples").stdout == "example:ball\t/g/ball.py\nexample:coral\t/g/frames/coral.py\n"


@pytest.mark.parametrize(("state", "code"), [(State.OPTIONAL, 0), (State.BROKEN, 1)])
def test_doctor_shows_each_finding_and_its_remedy(run, monkeypatch, state, code):
    missing = MachineFact("packages [gpu]", "wgpu", state, "missing", "pip install 'distal[gpu]'")
    monkeypatch.setattr("distal.cli.doctor.examine", lambda: [missing])
    result = run("doctor")
    assert result.exit_code == code
    for word in ("packages [gpu]", "wgpu", "missing", "fix: pip install 'distal[gpu]'"):
        assert word in result.stdout
