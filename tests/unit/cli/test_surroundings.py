"""The command in unusual surroundings: folders, terminals, names, encodings, Python's options."""

import inspect
import json
import os
import subprocess
import sys

import pytest
from PIL import Image

import distal
import distal.lang
from distal.cli.exit_codes import ExitCode
from distal.cli.terminal import forget_impossible_sizes

SCENE = "from distal import Scene, Sphere\nscene = Scene(Sphere(0.8))\n"
SMALL = ("--size", "16x12")
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
SIGNATURES = """
import inspect, json, sys, distal, distal.lang

def text(value):
    try:
        return str(inspect.signature(value))
    except (TypeError, ValueError) as error:
        return type(error).__name__

named = {f"{m.__name__}.{n}": getattr(m, n) for m in (distal, distal.lang) for n in m.__all__}
print(json.dumps({name: text(value) for name, value in named.items()}))
"""


def run(folder, *words, python=(), env=None, **options):
    """Run the command in a folder; words may be bytes."""
    return subprocess.run(
        [sys.executable, *python, "-m", "distal", *words],
        cwd=folder,
        env={**ENVIRONMENT, **(env or {})},
        capture_output=True,
        timeout=120,
        **options,
    )


COMMANDS_IN_TURN = """
import json, os, sys
from distal.cli import main

codes = []
for words in json.loads(sys.argv[1]):
    sys.argv = ["distal", *(os.fsdecode(bytes.fromhex(word)) for word in words)]
    try:
        main()
    except SystemExit as end:
        codes.append(end.code or 0)
print(*codes, file=sys.stderr)
"""


def run_all(folder, *commands, python=(), env=None):
    """Run commands one after the other in one process; each must end with 0."""
    words = [[os.fsencode(word).hex() for word in command] for command in commands]
    done = subprocess.run(
        [sys.executable, *python, "-c", COMMANDS_IN_TURN, json.dumps(words)],
        cwd=folder,
        env={**ENVIRONMENT, **(env or {})},
        capture_output=True,
        timeout=120,
    )
    assert done.stderr.split(b"\n")[-2].split() == [b"0"] * len(commands), done.stderr
    return done


def one_line(done, code):
    """Return the only line on stderr of a command that ended with a code."""
    lines = done.stderr.decode("utf-8", "surrogateescape").splitlines()
    assert done.returncode == code, lines
    assert len(lines) == 1, lines
    return lines[0]


# Python without docstrings


def test_without_docstrings_every_public_name_takes_the_same_arguments():
    plain, stripped = (
        subprocess.run(
            [sys.executable, *flags, "-c", SIGNATURES], env=ENVIRONMENT, capture_output=True
        )
        for flags in ((), ("-OO",))
    )
    assert plain.returncode == stripped.returncode == 0, stripped.stderr
    named = json.loads(plain.stdout)
    assert len(named) > 300
    assert named["distal.Sphere"] == str(inspect.signature(distal.Sphere))
    assert json.loads(stripped.stdout) == named


def test_without_docstrings_commands_do_the_same(tmp_path):
    (tmp_path / "s.py").write_text(SCENE)
    run_all(
        tmp_path,
        ("render", "s.py", "-o", "a.png", *SMALL),
        ("check", "s.py"),
        ("compile", "s.py", "--target", "wgsl"),
        python=("-OO",),
    )
    assert (tmp_path / "a.png").exists()


# Folders


def test_outputs_are_where_the_command_was_started(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    (here / "beside.py").write_text("radius = 0.8\n")
    text = f"import os, beside\nos.chdir({str(there)!r})\n" + SCENE.replace("0.8", "beside.radius")
    (here / "s.py").write_text(text)
    run_all(
        here,
        ("render", "s.py", "-o", "a.png", *SMALL),
        ("compile", "s.py", "--target", "wgsl", "-o", "a.wgsl"),
        ("video", "s.py", "-o", "f/%02d.png", "--duration", "0.1", "--fps", "10", *SMALL),
    )
    assert not list(there.iterdir())
    names = {path.name for path in here.iterdir()}
    assert names >= {"a.png", "a.wgsl", "a.json", "f"}


def test_a_deleted_working_folder_is_one_line(tmp_path):
    (tmp_path / "s.py").write_text(SCENE)
    gone = tmp_path / "gone"
    gone.mkdir()
    command = f"rmdir ../gone; {sys.executable} -m distal render ../s.py -o a.png"
    done = subprocess.run(["sh", "-c", command], cwd=gone, env=ENVIRONMENT, capture_output=True)
    assert one_line(done, 1) == "error: the working folder was deleted; change to another one"


# Names


@pytest.mark.parametrize(
    ("name", "locale", "shown"),
    [
        (b"bad\xff.py", {}, "bad\\xff.py"),
        ("ü.py".encode(), {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}, "ü.py"),
    ],
)
def test_names_that_are_no_text_for_python_are_written_as_text(tmp_path, name, locale, shown):
    folder = os.fsencode(tmp_path)
    try:
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(SCENE)
    except OSError:
        pytest.skip("this file system takes only names that are text")
    run_all(
        folder,
        *((b"render", name, b"-o", out, b"--size", b"16x12") for out in (b"a.png", b"a.exr")),
        (b"rerender", b"a.png", b"-o", b"b.png", b"--source", name),
        env=locale,
    )
    assert Image.open(tmp_path / "a.png").text["distal:source"] == shown
    assert shown.encode() in (tmp_path / "a.exr").read_bytes()
    with open(os.path.join(folder, b"err" + name), "w", encoding="utf-8") as file:
        file.write("from distal import *\nscene = Scene(sphere)\n")
    done = run(folder, b"check", b"err" + name, b"--json", env=locale)
    assert json.loads(done.stdout)["errors"][0]["file"] == f"err{shown}"


# Terminals


def test_a_terminal_of_no_width_is_one_of_the_usual_width(tmp_path):
    sizes = {"COLUMNS": "0", "LINES": "0", "TERMINAL_WIDTH": "wide"}
    for words in (("render", "--help"), ("render", "--sise")):
        narrow, usual = run(tmp_path, *words, env=sizes), run(tmp_path, *words)
        assert narrow.stdout + narrow.stderr == usual.stdout + usual.stderr
        assert b"--size" in narrow.stdout + narrow.stderr


@pytest.mark.parametrize("size", ["0", "-80", "", "wide", "8.5", "²"])
def test_impossible_sizes_are_forgotten(monkeypatch, size):
    monkeypatch.setenv("COLUMNS", size)
    monkeypatch.setenv("LINES", "50")
    forget_impossible_sizes()
    assert "COLUMNS" not in os.environ
    assert os.environ["LINES"] == "50"


# Python


def test_warnings_that_are_errors_are_located(tmp_path):
    text = "import warnings\nwarnings.simplefilter('error')\nfrom distal import *\n"
    (tmp_path / "w.py").write_text(
        f"{text}scene = Scene(Sphere(0.8), camera=Camera((0, 0, 0.1)))\n"
    )
    done = run(tmp_path, "render", "w.py", "-o", "a.png", *SMALL)
    lines = done.stderr.decode().splitlines()
    assert done.returncode == 1
    assert lines[0].startswith("error: the camera is inside 'Sphere'")
    assert lines[1] == "  --> w.py:4:9"


# Streams and exit codes


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
def test_a_full_disk_below_the_streams(tmp_path):
    (tmp_path / "s.py").write_text(SCENE)
    said = "error: cannot write to stdout: No space left on device"
    for words in (("--help",), ("--version",), ("examples",)):
        with open("/dev/full", "wb") as full:
            done = subprocess.run(
                [sys.executable, "-m", "distal", *words],
                env=ENVIRONMENT,
                stdout=full,
                stderr=subprocess.PIPE,
            )
        assert one_line(done, 1) == said
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "distal", "render", "s.py", "-o", "a.png", *SMALL],
            cwd=tmp_path,
            env=ENVIRONMENT,
            stdout=subprocess.PIPE,
            stderr=full,
        )
    assert done.returncode == 0
    assert (tmp_path / "a.png").exists()


STEEP = """
from distal import Shape
from distal.lang import func, length, vec3

@func
def ball(p: vec3) -> float:
    return 3.0 * length(p) - 1.0

shape = Shape.from_function(ball, slope=1.0, bounds=((-1, -1, -1), (1, 1, 1)))
"""
# How each cause comes about: the files, and the words of the command.
ENDS = {
    "the work is done": ({}, ("--version",)),
    "there is a mistake in the scene": ({"s.py": "x = (\n"}, ("compile", "s.py", "--target", "ir")),
    "a file cannot be read or written, or is none of its kind": (
        {"s.py": SCENE},
        ("compile", "s.py", "--target", "ir", "-o", "none/a.txt"),
    ),
    "a package or a device is missing, or memory": (
        {"s.py": SCENE, "OpenEXR.py": "raise ModuleNotFoundError(name='OpenEXR')\n"},
        ("render", "s.py", "-o", "a.exr"),
    ),
    "`check`, `--check` or `doctor` found something": (
        {"s.py": STEEP},
        ("check", "s.py"),
    ),
    "the command line is invalid": ({}, ("compile", "s.py", "--target", "none")),
    "it was interrupted, as by ctrl-C": (
        {"s.py": "raise KeyboardInterrupt\n"},
        ("compile", "s.py", "--target", "ir"),
    ),
    "what reads its output has ended, as `head` does": ({}, ("examples",)),
}


@pytest.mark.parametrize(("code", "cause"), [(code, c) for code in ExitCode for c in code.causes])
def test_each_exit_code_has_its_causes(tmp_path, code, cause):
    files, words = ENDS[cause]
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    process = subprocess.Popen(
        [sys.executable, "-m", "distal", *words],
        cwd=tmp_path,
        env={**ENVIRONMENT, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    if code is ExitCode.PIPE_CLOSED:
        process.stdout.close()
        process.stdout = None
    out, errors = process.communicate(timeout=120)
    assert process.returncode == code, errors
    assert b"Traceback" not in errors
    if words[0] == "check":
        assert b"'ball' declares the slope 1" in out
