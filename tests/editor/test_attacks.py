"""Attacks on the studio's server: headers, messages, names, files, code that does not behave."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket as sockets
import stat
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import pytest

from distal.diagnostics import LoadError
from distal.editor.local import source_file
from distal.editor.local.files import SceneFiles
from distal.editor.local.process import ChildProcess
from distal.editor.local.scratch import RENDER, ScratchFolder, sweep
from distal.editor.local.server import StudioServer
from distal.file_writer import SaveError
from tests.editor.test_local_server import asked, connected, look, secret_of, until

pytest.importorskip("websockets")

SCENE = "from distal import Scene, Sphere\nscene = Scene(Sphere(0.5))\n"
LIMIT_S = 5.0
WAIT_S = 30.0
linux = pytest.mark.skipif(sys.platform != "linux", reason="the system has no such signal")


@pytest.fixture(scope="module")
def temporary(tmp_path_factory):
    """The folder of temporary files, which is empty at the end."""
    made = tmp_path_factory.mktemp("temporary")
    before, tempfile.tempdir = tempfile.tempdir, str(made)
    yield made
    tempfile.tempdir = before


@pytest.fixture(scope="module")
def running(tmp_path_factory, temporary):
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "scene.py").write_text(SCENE)
    thrown: list[str] = []
    before = threading.excepthook
    threading.excepthook = lambda thing: thrown.append(repr(thing.exc_value))
    made = StudioServer(SceneFiles(folder / "scene.py"), limit=LIMIT_S)
    thread = threading.Thread(target=made.serve, daemon=True)
    thread.start()
    yield made
    made.close()
    thread.join(10.0)
    threading.excepthook = before
    assert thrown == []
    assert soon(lambda: not list(temporary.iterdir())), list(temporary.iterdir())


@pytest.fixture(scope="module")
def secret(running):
    return secret_of(running)


def soon(is_true, seconds=WAIT_S):
    end = time.monotonic() + seconds
    while not is_true() and time.monotonic() < end:
        time.sleep(0.05)
    return is_true()


def is_alive(process: int) -> bool:
    try:
        text = Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"


def raw(server, text: bytes, *, ends: bool = False) -> bytes:
    """What the server says to bytes that no browser sends; the end of them, if it is one."""
    host, port = server.address.split("/")[2].split(":")
    with sockets.create_connection((host, int(port)), timeout=10) as line:
        line.sendall(text)
        if ends:
            line.shutdown(sockets.SHUT_WR)
        found = b""
        with contextlib.suppress(OSError):
            while part := line.recv(65536):
                found += part
        return found


# Headers


@pytest.mark.parametrize(
    "lines",
    [
        "Host: {host}\r\nHost: {host}",
        "Host: {host}\r\nHost: evil.example",
        "Host: {host}\r\nOrigin: http://{host}\r\nOrigin: http://evil.example",
        "Host: {host}\r\nOrigin: \xe9\xff",
        "Host: {host}\r\nOrigin:",
        "Host: \xe9",
        "Accept: */*",
    ],
)
def test_odd_headers_are_refused_without_a_mistake(running, lines, capfd):
    text = lines.format(host=running.address.split("/")[2])
    for path in ("/", "/studio.js", "/?key=\xff", "/?key=%ff%00", "/results/a/b", "/socket"):
        found = raw(running, f"GET {path} HTTP/1.1\r\n{text}\r\n\r\n".encode("latin-1"))
        # A path that is not ASCII is no request at all: nothing is answered.
        assert found.startswith(b"HTTP/1.1 403") or (not found and not path.isascii()), found[:200]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "sent",
    [b"", b"\0\1\2\3", b"POST / HTTP/1.1\r\n\r\n", b"\x16\x03\x01" * 99, b"GET / HTTP/1.1\r\nX"],
)
def test_bytes_that_are_no_request_write_nothing_to_the_terminal(running, sent, capfd):
    raw(running, sent, ends=True)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "path", ["//[", "/%00", "/gallery/%00.json", "/results//", "/results/../x", "/\\..\\x"]
)
def test_odd_paths_are_not_there(running, path):
    assert asked(running, path)[0] == 404


# Messages


def test_messages_that_no_app_sends_are_answered(running, secret):
    save = {"kind": "save", "id": 1, "revision": 1, "file": "scene.py", "digest": None}
    deep = "[" * 100_000 + "]" * 100_000
    with connected(running, secret) as socket:
        until(socket, "ready")
        for sent in (deep, '{"kind":"look","id":' + deep + "}", b"\xff\xfe", b"\0" * 999):
            socket.send(sent)
            assert until(socket, "mistakes", -1).mistakes[0].severity == "error"
        for depth in range(150, 1000, 50):  # some can be read and not shown
            socket.send('{"kind":"look","id":' + "[" * depth + "]" * depth + "}")
            until(socket, "mistakes", -1)
        for name in ("a\0.py", "\ud800.py", "a\n.py", "x" * 300 + ".py", "../a.py", "\u202e.py"):
            socket.send(json.dumps({**save, "file": name, "text": "x = 1\n"}))
            assert until(socket, "mistakes", 1).mistakes[0].severity == "error"
        socket.send(json.dumps({**save, "file": "new.py", "text": "x = '\ud800'\n"}))
        text = until(socket, "mistakes", 1).mistakes[0].message
        assert text == "'new.py' has a character in line 1 that is not Unicode"
        socket.send(look(2, SCENE))
        until(socket, "scene", 2)


@pytest.mark.parametrize(
    "text",
    [
        "x = '\ud800'\n" + SCENE,
        "x = 1\0\n" + SCENE,
        "x = " + "(" * 100_000,
        "x = " + "-" * 100_000 + "1\n",
        "x = " + "[" * 90 + "]" * 90 + ".a" * 50_000 + "\n",
        "#\u202e\u2066 \ufeff\n" * 1000 + "scene = \u202e1\n",
        "class Odd(BaseException): pass\nraise Odd('\ud800')\n",
        "raise KeyboardInterrupt\n",
        "class Odd(Exception):\n    def __str__(self): raise ValueError\nraise Odd\n",
        "import sys\nsys.exit()\n",
        "x = bytearray(1 << 44)\n",
    ],
    ids=[
        "surrogate",
        "nul",
        "open",
        "minus",
        "deep",
        "bidi",
        "base",
        "interrupt",
        "str",
        "exit",
        "memory",
    ],
)
def test_texts_that_break_python_are_mistakes_of_the_scene(running, secret, text):
    with connected(running, secret) as socket:
        until(socket, "ready")
        socket.send(look(1, text))
        found = until(socket, "mistakes", 1).mistakes[0].message
        assert found and "Traceback" not in found
        socket.send(look(2, SCENE))
        until(socket, "scene", 2)


def test_what_is_printed_is_bounded(running, secret):
    with connected(running, secret) as socket:
        until(socket, "ready")
        socket.send(look(1, "for _ in range(30): print('\\ud800' * 1_000_000)\n" + SCENE))
        text = until(socket, "printed", 1).text
        assert len(text) < 21_000
        assert text.endswith("… 29,980,030 characters more")
        until(socket, "scene", 1)


# Code that does not behave

FORKS = """import os, subprocess, sys
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
open("PLACE", "w").write(str(child.pid))
"""


@linux
@pytest.mark.parametrize("end", ["os._exit(3)\n", "os.kill(os.getpid(), 9)\n", "while 1: pass\n"])
def test_what_the_code_has_started_ends_with_it(running, secret, tmp_path, end):
    place = tmp_path / "number"
    with connected(running, secret) as socket:
        until(socket, "ready")
        socket.send(look(1, FORKS.replace("PLACE", str(place)) + end))
        reason = until(socket, "restarted").reason
        assert reason.startswith("the scene's code")
        assert soon(lambda: not is_alive(int(place.read_text())))
        until(socket, "ready")
        socket.send(look(2, SCENE))
        until(socket, "scene", 2)


@linux
@pytest.mark.parametrize(
    "text",
    [
        "import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)\n",
        "import os\nos.closerange(0, 200)\nwhile True: pass\n",
        "import os\nfor i in range(3, 30):\n  try: os.write(i, b'nonsense\\n[]\\n{}\\n' * 99)\n"
        "  except OSError: pass\nos.write(1, b'x' * 9_000_000)\nos._exit(0)\n",
        "import re\nre.match('(a+)+$', 'a' * 99 + 'b')\n",
    ],
    ids=["stops itself", "closes all", "writes to all", "busy in C"],
)
def test_a_worker_in_any_state_is_replaced(running, secret, text, tmp_path):
    begun = tmp_path / "begun"
    with connected(running, secret) as socket:
        until(socket, "ready")
        socket.send(look(1, f"open({str(begun)!r}, 'w').close()\n{text}"))
        # A request that has not begun is dropped when a newer one comes.
        while not begun.exists():
            time.sleep(0.01)
        # More than a pipe holds, while nobody reads.
        for number in range(2, 5):
            socket.send(look(number, "#" * 1_000_000 + "\n"))
        until(socket, "restarted")
        until(socket, "ready")
        socket.send(look(9, SCENE))
        until(socket, "scene", 9)


@linux
def test_a_killed_server_takes_its_processes_along_and_the_next_one_its_folders(tmp_path):
    scene = tmp_path / "scene.py"
    place = tmp_path / "number"
    busy = "import re\nre.match('(a+)+$', 'a' * 99 + 'b')\n"
    scene.write_text(
        f"import os\nopen({str(place)!r}, 'w').write(str(os.getpid()) + '\\n')\n{busy}"
    )
    own = tmp_path / "temporary"
    own.mkdir()
    command = [sys.executable, "-m", "distal.cli", "studio", str(scene), "--no-browser"]
    server = subprocess.Popen(
        [*command, "--time-limit", "60"],
        env={**os.environ, "TMPDIR": str(own)},
        stdout=subprocess.DEVNULL,
    )
    try:
        assert soon(lambda: place.exists() and place.read_text().endswith("\n"))
        worker = int(place.read_text())
        assert is_alive(worker)
    finally:
        server.kill()
        server.wait()
    assert soon(lambda: not is_alive(worker))  # its own limit is 60 s
    left = list(own.iterdir())
    assert len(left) == 1


def test_folders_of_killed_studios_are_removed_and_no_others(temporary, tmp_path):
    code = (
        "import os, sys, time; from distal.editor.local.scratch import RENDER, ScratchFolder; "
        "print(ScratchFolder(RENDER).path, flush=True); time.sleep(600)"
    )
    environment = {**os.environ, "TMPDIR": str(temporary)}
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=environment
    ) as other:
        others = Path(other.stdout.readline().strip())
        own = ScratchFolder(RENDER)
        elsewhere = temporary / others.name.replace(others.name[len(RENDER) :][:8], "0123abcd")
        elsewhere.mkdir()
        link = temporary / f"{others.name}_link"
        link.symlink_to(tmp_path)
        (tmp_path / "kept").write_text("mine")
        (others / "link").symlink_to(tmp_path)
        sweep()
        assert others.exists() and own.path.exists()
        other.kill()
        other.wait()
    sweep()
    assert not others.exists()
    assert own.path.exists() and elsewhere.exists() and link.is_symlink()
    assert (tmp_path / "kept").read_text() == "mine"
    own.remove()
    elsewhere.rmdir()
    link.unlink()


@linux
def test_a_process_that_has_left_the_group_holds_nobody_up(monkeypatch):
    monkeypatch.setattr("distal.editor.local.process._REST_S", 0.5)
    code = (
        "import subprocess, sys; print(subprocess.Popen([sys.executable, '-c', "
        "'import time; time.sleep(600)'], start_new_session=True).pid)"
    )
    ended = threading.Event()
    lines: list[str] = []
    ChildProcess([sys.executable, "-c", code], lines.append, lambda *_: ended.set())
    assert ended.wait(60.0)
    os.kill(int(lines[0]), signal.SIGKILL)  # until now it held the streams


# Files


def test_a_module_that_leads_out_of_the_folder_is_not_shown(tmp_path):
    folder = tmp_path / "scenes"
    folder.mkdir()
    (tmp_path / "secret.py").write_text("x = 1\n")
    (folder / "secret.py").symlink_to(tmp_path / "secret.py")
    (folder / "near.py").symlink_to(folder / "other.py")
    (folder / "other.py").write_text("y = 1\n")
    (folder / "scene.py").write_text("import secret, near, ring, pipe\n")
    (folder / "ring.py").symlink_to(folder / "ring.py")
    os.mkfifo(folder / "pipe.py")
    files = SceneFiles(folder / "scene.py")
    assert sorted(files.all().files) == ["near.py", "scene.py"]
    for name in ("secret.py", "ring.py", "pipe.py"):
        with pytest.raises((LoadError, SaveError)):
            files.save(name, "x = 2\n", None)
    assert (tmp_path / "secret.py").read_text() == "x = 1\n"
    assert stat.S_ISFIFO((folder / "pipe.py").stat().st_mode)


def test_files_that_are_too_long_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(source_file, "LONGEST_FILE", 50)
    (tmp_path / "scene.py").write_text("# " + "x" * 40 + "\n")
    files = SceneFiles(tmp_path / "scene.py")
    with pytest.raises(LoadError, match=r"^'scene\.py' would have more than 50 bytes$"):
        files.save("scene.py", "#" * 51, files.all().digests["scene.py"])
    (tmp_path / "scene.py").write_text("#" * 51)
    changed = files.read()
    assert changed is not None
    assert changed.problems["scene.py"].text == "has more than 50 bytes"
    with pytest.raises(LoadError, match=r"has more than 50 bytes$"):
        files.save("scene.py", "x = 1\n", files.all().digests["scene.py"])


def test_a_folder_that_is_gone_is_told(tmp_path):
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "scene.py").write_text(SCENE)
    files = SceneFiles(folder / "scene.py")
    (folder / "scene.py").unlink()
    folder.rmdir()
    files.read()
    with pytest.raises(SaveError, match="there is no folder"):
        files.save("scene.py", "x = 2\n", "")
