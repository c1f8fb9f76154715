"""The command as a process of its own: light to start, polite when interrupted."""

import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

from distal.cli import COMMANDS

SLOW_SCENE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores it
import distal, time
from distal.cli import main

from distal import load_watch
from distal.scene import rendering

def slow(scene, options):
    print("rendering", flush=True)
    time.sleep(60)

rendering.render_scene = slow
load_watch.load_watched = lambda path, name, say: distal.Scene(distal.Sphere(1.0))
main()
"""

# Ctrl-C while the garbage collector runs a finalizer: Python ignores what is raised there.
LOST = SLOW_SCENE.replace(
    "    time.sleep(60)",
    """    import weakref
    thing = type("Thing", (), {})()
    weakref.finalize(thing, signal.raise_signal, signal.SIGINT)
    del thing
    time.sleep(60)""",
)

# The same on a busy machine: the hook that is told of it is still running after a while.
LOST_TWICE = LOST.replace(
    "main()\n",
    """from distal.cli import running
start = running.start_new_thread
running.start_new_thread = lambda *given: (start(*given), time.sleep(0.2))
main()
""",
)

SMALL = (sys.executable, "-m", "distal.cli", "render", "example:melting", "-o", "a.png", "--stats")


def environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


@pytest.mark.parametrize("script", [LOST, LOST_TWICE])
def test_ctrl_c_in_a_finalizer_is_not_lost(tmp_path, script):
    done = subprocess.run(
        [sys.executable, "-c", script, "render", "s.py", "-o", "a.png"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=50,
    )
    assert done.returncode == 130
    assert done.stdout == "rendering\n"
    assert "Traceback" not in done.stderr


def test_ctrl_c_exits_130_without_traceback_or_partial_file(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW_SCENE, "render", "s.py", "-o", "a.png"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout.readline() == "rendering\n"
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=50)
    finally:
        process.kill()
    assert process.returncode == 130
    assert time.monotonic() - begin < 50  # it would sleep for 60 s
    assert errors == ""
    assert list(tmp_path.iterdir()) == []


def test_command_line_and_compile_import_nothing_heavy():
    heavy = ("numpy", "llvmlite", "wgpu", "PIL")
    code = (
        f"import sys, distal.cli.application as a; print([m for m in {heavy} if m in sys.modules])"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    assert answer.stdout == "[]\n"


WITHOUT_NUMPY = """
import sys
sys.modules["numpy"] = None
from distal.cli import main
main()
"""


def test_a_missing_package_is_named_with_its_remedy(tmp_path):
    (tmp_path / "s.py").write_text("")
    answer = subprocess.run(
        [sys.executable, "-c", WITHOUT_NUMPY, "render", "s.py", "-o", "a.png"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert answer.returncode == 1
    assert answer.stderr == "error: numpy is missing: pip install numpy\n"


SMALL_SCENE = """
from distal.lang import Frame, image, vec3
@image
def picture(frame: Frame) -> vec3:
    return vec3(0.5)
"""


def render_small(tmp_path, *, before="", size="4x4", cache="off"):
    (tmp_path / "s.py").write_text(SMALL_SCENE)
    code = f"{before}\nfrom distal.cli import main\nmain()"
    return subprocess.run(
        [sys.executable, "-c", code, "render", "s.py", "-o", "a.png", "--size", size],
        cwd=tmp_path,
        env={**environment(), "DISTAL_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_too_little_memory_is_one_line(tmp_path):
    limit = "import resource; resource.setrlimit(resource.RLIMIT_AS, (3 * 2**30, 3 * 2**30))"
    answer = render_small(tmp_path, before=limit, size="16384x16384")
    assert (answer.returncode, answer.stderr.count("\n")) == (1, 1)
    assert answer.stderr.startswith("error: not enough memory: a picture of 16384x16384 ")


def test_a_warning_is_one_line(tmp_path):
    cache = tmp_path / "cache"
    cache.mkdir()
    cache.chmod(0o777)
    answer = render_small(tmp_path, cache=cache)
    assert answer.returncode == 0
    first, last = answer.stderr.splitlines()
    assert first.startswith("warning: the kernel cache")
    assert last.startswith("a.png: 4x4")


def test_a_scene_alone_is_rendered(tmp_path):
    (tmp_path / "ball.py").write_text("from distal import *\nball = Sphere(1.0)\n")
    command = (sys.executable, "-m", "distal.cli")
    for scene, file in (("ball.py", "ball.png"), ("ball.py:ball", "ball_ball.png")):
        words = (*command, scene, "--size", "4x3")
        subprocess.run(words, cwd=tmp_path, env=environment(), check=True, capture_output=True)
        with Image.open(tmp_path / file) as image:
            assert image.size == (4, 3)
    wrong = subprocess.run(
        (*command, "bal.py"), cwd=tmp_path, env=environment(), capture_output=True, text=True
    )
    assert (wrong.returncode, wrong.stderr) == (1, "error: there is no file bal.py\n")


def test_the_scene_is_not_overwritten_by_its_text(tmp_path):
    (tmp_path / "s.py").write_text(SMALL_SCENE)
    answer = subprocess.run(
        [sys.executable, "-m", "distal.cli", "compile", "s.py", "--target=wgsl", "-o", "./s.py"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (answer.returncode, answer.stderr) == (2, "error: 's.py' is the scene itself\n")
    assert (tmp_path / "s.py").read_text() == SMALL_SCENE


def test_a_name_that_is_too_long_is_one_line(tmp_path):
    answer = subprocess.run(
        [sys.executable, "-m", "distal.cli", "compile", "s" * 300, "--target=wgsl"],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (answer.returncode, answer.stderr.count("\n")) == (1, 1)
    assert answer.stderr.startswith("error: cannot read sss")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_stdout_on_a_full_disk_is_one_line(tmp_path):
    with open("/dev/full", "w") as full:
        process = subprocess.run(
            [*SMALL, "--size", "4x4"],
            cwd=tmp_path,
            env=environment(),
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert process.returncode == 1
    assert process.stderr == "error: cannot write to stdout: No space left on device\n"


def test_closed_streams_disturb_nothing(tmp_path):
    script = 'exec "$@" 0<&- 1>&- 2>&-'
    words = ["sh", "-c", script, "sh", *SMALL, "--size", "4x4"]
    process = subprocess.run(words, cwd=tmp_path, env=environment())
    assert process.returncode == 0
    # Nothing that was meant for a stream is in the picture.
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (4, 4)


def test_help_begins_with_what_a_newcomer_asks_for():
    words = [sys.executable, "-m", "distal.cli", "--help"]
    told = subprocess.run(words, env=environment(), capture_output=True, text=True, check=True)
    commands = re.findall(r"^\W*(\w+)  +[A-Z]", told.stdout.partition("Commands")[2], re.MULTILINE)
    assert commands[:4] == ["render", "view", "studio", "new"]
    assert commands[-1] == "doctor"
    assert commands == list(COMMANDS)


def test_a_new_scene_is_rendered_and_never_written_over(tmp_path):
    def run(*words):
        command = (sys.executable, "-m", "distal.cli", *words)
        given = {"cwd": tmp_path, "env": environment(), "capture_output": True, "text": True}
        return subprocess.run(command, **given)

    made = run("new", "first")
    assert (made.returncode, made.stdout) == (0, "")
    assert made.stderr.startswith("first.py: a first scene. Go on with\n")
    assert run("first.py", "--size", "16x12").returncode == 0
    with Image.open(tmp_path / "first.png") as picture:
        assert np.asarray(picture).std() > 20.0
    text = (tmp_path / "first.py").read_text()
    again = run("new", "first.py")
    assert (again.returncode, again.stderr) == (
        1,
        "error: first.py is there already; give another name\n",
    )
    assert (tmp_path / "first.py").read_text() == text
    assert run("new").returncode == 0 and (tmp_path / "scene.py").exists()
    wrong = run("new", "a.txt")
    assert (wrong.returncode, wrong.stderr) == (2, "error: a scene is a Python file: a.py\n")
    missing = run("new", "nowhere/a.py")
    assert missing.returncode == 1 and missing.stderr.startswith("error: cannot write nowhere/a.py")
