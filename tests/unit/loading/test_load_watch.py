"""A scene's file that never ends: what is said, and that a save or ctrl-C ends it."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from distal import load_watch
from distal.diagnostics import Diagnostic
from distal.load_watch import LoadWatch, SavedAgain
from distal.loading import load

SCENE = """from distal.lang import Frame, image, vec3

@image
def grey(frame: Frame) -> vec3:
    return vec3(0.5)
"""
# What never ends, and the line that is shown.
ENDLESS = {
    "a loop": ("while True: pass\n", 1),
    "a loop that calls": (
        "def turn():\n    return 1\n\n\nfor _ in iter(int, 1):\n    turn()\n",
        5,
    ),
    "a wait": ("import time\n\ntime.sleep(1e6)\n", 3),
    "a loop that catches all": (
        "while True:\n    try:\n        len(str(1))\n    except BaseException:\n        pass\n",
        1,
    ),
}
# Loads a file with a patience of 0.2 s, and says what it is.
PROGRAM = """
import sys
from distal import lang, load_watch
load_watch.PATIENCE_S = 0.2
say = lambda found: print(found.text("warning"), file=sys.stderr, flush=True)
print(load_watch.load_watched(sys.argv[1], None, say))
"""


def started(file: Path) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, file.name],
        cwd=file.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    said = "".join(process.stderr.readline() for _ in range(6))
    assert said.startswith(f"warning: {file.name} is still running after 0.2 s\n"), said
    return process


@pytest.mark.parametrize("name", ENDLESS)
def test_the_line_is_said_and_a_save_loads_the_file_again(name: str, tmp_path: Path) -> None:
    text, line = ENDLESS[name]
    file = tmp_path / "scene.py"
    file.write_text(text)
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, file.name],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stderr is not None
        said = "".join(process.stderr.readline() for _ in range(6))
        shown = text.splitlines()[line - 1]
        assert said == (
            "warning: scene.py is still running after 0.2 s\n"
            f"  --> scene.py:{line}:1\n   |\n{line:>2} | {shown}\n   | {'^' * len(shown)}\n"
            "   = hint: save the file to load it again, or end it by ctrl-C\n"
        )
        file.write_text(SCENE)
        out, rest = process.communicate(timeout=30)
    finally:
        process.kill()
    assert (process.returncode, rest) == (0, "")
    assert "grey" in out


@pytest.mark.parametrize("name", ENDLESS)
def test_ctrl_c_ends_it(name: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.py"
    file.write_text(ENDLESS[name][0])
    process = started(file)
    try:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
    finally:
        process.kill()
    # By KeyboardInterrupt, or by the watch if the author's code catches that.
    assert process.returncode in (-signal.SIGINT, 130)


def test_a_loop_in_a_module_beside_it_is_shown(tmp_path: Path) -> None:
    (tmp_path / "parts.py").write_text(
        "def endless():\n    while 1:\n        pass\n\n\nendless()\n"
    )
    file = tmp_path / "scene.py"
    file.write_text("import parts\n")
    said: list[Diagnostic] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(load_watch, "PATIENCE_S", 1.0)  # a busy machine reads slowly
        thread, watch, _ = in_thread(file, said)
        while not said:
            time.sleep(0.01)
        watch.interrupt()
        thread.join(20)
    assert f"--> {tmp_path / 'parts.py'}:2:5" in said[0].text("warning")
    assert "parts" not in sys.modules


def in_thread(
    file: Path, said: list[Diagnostic]
) -> tuple[threading.Thread, LoadWatch, list[object]]:
    """Load a file in a thread, as a window does."""
    found: list[object] = []
    watch = LoadWatch(file, said.append)

    def run() -> None:
        try:
            with watch:
                found.append(load(str(file)))
        except BaseException as error:
            found.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread, watch, found


@pytest.mark.parametrize("name", ["a loop", "a loop that catches all"])
def test_a_thread_ends_when_it_is_interrupted(name: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.py"
    file.write_text(ENDLESS[name][0])
    said: list[Diagnostic] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(load_watch, "PATIENCE_S", 0.1)
        thread, watch, found = in_thread(file, said)
        while not watch.is_overdue:
            time.sleep(0.01)
        watch.interrupt()
        thread.join(20)
    assert not thread.is_alive()
    assert isinstance(found[0], SavedAgain)
    assert len(said) == 1
    assert not watch.is_overdue


def test_a_file_that_ends_says_nothing(tmp_path: Path) -> None:
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    said: list[Diagnostic] = []
    before = signal.getsignal(signal.SIGINT)
    assert load_watch.load_watched(str(file), None, said.append).name == "grey"
    assert said == []
    assert signal.getsignal(signal.SIGINT) is before
