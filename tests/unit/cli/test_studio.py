"""``distal studio``: what it refuses, and that it ends with its workers."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys

import pytest

pytest.importorskip("websockets")

ENDS_S = 30.0


def started(folder, *words, browser=("--no-browser",)):
    """The command as a process of its own group, as a terminal starts it."""
    return subprocess.Popen(
        [sys.executable, "-m", "distal.cli", "studio", *browser, *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["lesson.md"], "there is no file 'lesson.md'"),
        (["picture.png"], "'picture.png' is not a Python file"),
        (["none/scene.py"], "there is no folder 'none'"),
        (["example:none"], "there is no example 'none'; 'distal examples' lists them"),
        (["binary.py"], "binary.py' is not UTF-8 text"),
        (["--port", "99999"], "65535"),
        (["--time-limit", "0"], "0"),
    ],
)
def test_what_it_cannot_open_is_one_line(tmp_path, words, told):
    (tmp_path / "binary.py").write_bytes(b"\xff\xfe\x00")
    done = started(tmp_path, *words)
    _, text = done.communicate(timeout=ENDS_S)
    assert done.returncode != 0
    assert told in " ".join(text.split())
    assert "Traceback" not in text


def test_a_port_that_is_taken_is_named(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = started(tmp_path, "--port", str(port))
        _, text = done.communicate(timeout=ENDS_S)
    assert done.returncode != 0
    assert f"port {port} cannot be used" in " ".join(text.split())


def test_ctrl_c_ends_it(tmp_path):
    running = started(tmp_path, "new.py")
    line = running.stdout.readline()
    assert re.match(r"new\.py at http://127\.0\.0\.1:\d+/#key=\S+$", line)
    running.send_signal(signal.SIGINT)
    _, text = running.communicate(timeout=ENDS_S)
    assert running.returncode == 0
    assert text == ""
    assert not (tmp_path / "new.py").exists()  # nobody has saved it


def test_without_a_browser_one_is_asked_to_open_the_address(monkeypatch, tmp_path):
    monkeypatch.setenv("BROWSER", str(tmp_path / "none"))
    running = started(tmp_path, "new.py", browser=())
    assert running.stderr.readline() == (
        "warning: the browser is not opened (there is none): open the address above yourself\n"
    )
    running.send_signal(signal.SIGINT)
    running.communicate(timeout=ENDS_S)
    assert running.returncode == 0
