"""Renders of the studio: equal to their commands, cancelled, ended, one after the other."""

from __future__ import annotations

import json
import os
import shlex
import tempfile
import threading
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from distal.cli.application import application
from distal.editor.commands import export_arguments, render_arguments, video_arguments
from distal.editor.local import render_choices
from distal.editor.local.files import SceneFiles
from distal.editor.local.renders import RenderLimits, RenderQueue, placed
from distal.editor.local.server import StudioServer
from distal.editor.messages import ExportRequest, RenderRequest, parsed
from distal.images.picture_files import read
from tests.editor.test_local_server import ANSWER_S, asked, connected, secret_of
from tests.editor.test_local_server import until as until_any

pytest.importorskip("websockets")

SCENE = '''"""A ball that grows."""

from distal import *
from distal import time
from distal.lang import color, slider

size = slider("Size", 0.4, 0.1, 1.0)
tint = color("Tint", (0.8, 0.3, 0.1))
ball = Sphere(size + time).paint(tint)

scene = Scene(ball, lights=DistantLight((1, 2, 3)), background="#123456",
              camera=Camera((1.0, 1.5, 4.0), target=(0.0, 0.0, 0.0)))
'''
# A picture that takes long, and one that never comes.
SLOW = """from distal.lang import Frame, image, vec3

@image
def picture(frame: Frame) -> vec3:
    level = 0.0
    for i in range(4_000_000):
        level = level * 0.999 + 0.001 * frame.coord.x / (1.0 + float(i))
    return vec3(level, 0.5, 0.0)
"""
ENDLESS = """from distal.lang import Frame, image, vec3

@image
def picture(frame: Frame) -> vec3:
    level = 0.0
    while level < 1.0:
        level = level * 0.5
    return vec3(level, 0.5, 0.0)
"""
SMALL = {"size": [48, 32], "format": "png"}
MOVED = {"yaw": 0.4, "pitch": 0.1, "zoom": 0.75, "pan_x": 0.05, "pan_y": -0.125}


def rendering(number, text=SCENE, kind="render", **more):
    files = {"scene.py": text}
    request = {"kind": kind, "id": number, "revision": 1, "files": files, "main": "scene.py"}
    return json.dumps({**request, **SMALL, **more})


def until(socket, kind, number=None):
    """The next message of a kind; another answer than the one that is expected fails at once."""
    if number is None:
        return until_any(socket, kind)
    while True:
        message = parsed(socket.recv(timeout=ANSWER_S))
        if getattr(message, "id", None) == number:
            if message.kind == kind:
                return message
            assert message.kind in ("progress", "printed"), message


def leftovers():
    return set(Path(tempfile.gettempdir()).glob("distal_render_*"))


@pytest.fixture
def server(tmp_path, monkeypatch, request):
    own = tmp_path / "temporary"
    own.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(own))
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "scene.py").write_text(SCENE)
    limits = getattr(request, "param", None)
    running = StudioServer(SceneFiles(folder / "scene.py"), renders=limits)
    thread = threading.Thread(target=running.serve, daemon=True)
    thread.start()
    yield running
    running.close()
    thread.join(10.0)
    assert not leftovers()


@pytest.fixture
def socket(server):
    with connected(server, secret_of(server)) as opened:
        yield opened


def fetched(server, result):
    status, _, body = asked(server, result.address)
    assert status == 200
    assert len(body) == result.bytes
    return body


def by_command(folder, command, output, monkeypatch):
    """The bytes of what a command writes, under another name."""
    words = shlex.split(command)
    assert words[0] == "distal"
    at = words.index("-o") + 1
    words[at] = output
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(application, words[1:])
    assert done.exit_code == 0, done.output
    return (folder / output).read_bytes()


def test_a_picture_is_the_one_of_its_command(server, tmp_path, monkeypatch):
    folder, secret = tmp_path / "scenes", secret_of(server)
    there = folder / "scene.png"
    there.write_bytes(b"mine")
    chosen = {"size": 0.55, "tint": [0.1, 0.5, 0.25]}
    more = {"values": chosen, "time": 0.5, "steering": MOVED, "bits": 16, "transparent": True}
    with connected(server, secret) as socket:
        socket.send(rendering(7, **more))
        first = until(socket, "progress", 7)
        result = until(socket, "answer", 7).result
        data = fetched(server, result)
        assert asked(server, result.address + "x")[0] == 404
        # Without its token the folder, whose name every user can see, is of no use.
        assert asked(server, result.address.rpartition("/")[0] + "/scene.png")[0] == 404
    assert first.label == "loading"
    assert result.name == "scene.png"
    assert there.read_bytes() == b"mine"
    assert data == by_command(folder, result.command, "other.png", monkeypatch)
    found = read(folder / "other.png").provenance
    assert found.steering == tuple(MOVED.values())
    assert found.parameters == {"size": 0.55, "tint": [0.1, 0.5, 0.25]}
    assert found.transparent and found.time == 0.5


def test_a_picture_can_be_fetched_when_it_is_told(tmp_path):
    queue, seen, is_told = RenderQueue(tmp_path, RenderLimits()), [], threading.Event()

    def tell(message):
        if message.kind == "answer":
            _, _, folder, token = message.result.address.split("/")
            seen.append(queue.result(folder, token))
            is_told.set()

    queue.add("a tab", parsed(rendering(1)), tell)
    assert is_told.wait(ANSWER_S)
    queue.close()
    assert seen[0] is not None and seen[0].startswith(b"\x89PNG")


def test_a_film_is_beside_the_scene_under_a_free_name(server, tmp_path, socket, monkeypatch):
    folder = tmp_path / "scenes"
    (folder / "scene.gif").write_bytes(b"mine")
    film = {"format": "gif", "duration": 0.2, "fps": "10", "loop": True, "steering": MOVED}
    socket.send(rendering(1, **film))
    result = until(socket, "answer", 1).result
    assert (result.name, result.address) == ("scene-2.gif", None)
    assert (folder / "scene.gif").read_bytes() == b"mine"
    assert "the loop will jump" in result.said
    assert str(tmp_path) not in result.said
    data = (folder / "scene-2.gif").read_bytes()
    assert data[:4] == b"GIF8"
    assert len(data) == result.bytes
    assert data == by_command(folder, result.command, "other.gif", monkeypatch)
    assert sorted(os.listdir(folder)) == ["other.gif", "scene-2.gif", "scene.gif", "scene.py"]


def test_a_cancelled_render_leaves_nothing_and_the_worker_answers_meanwhile(
    server, tmp_path, socket
):
    until(socket, "ready")
    socket.send(rendering(1, SLOW, size=[1600, 1200]))
    while until(socket, "progress", 1).label != "rendering":
        continue
    files = {"scene.py": SCENE}
    look = {"kind": "look", "id": 3, "revision": 1, "files": files, "main": "scene.py"}
    socket.send(json.dumps(look))
    assert until(socket, "scene", 3).objects == ("scene",)
    assert leftovers()
    cancelled = time.monotonic()
    socket.send(json.dumps({"kind": "cancel", "id": 4, "revision": 1, "job": 1}))
    until(socket, "dropped", 1)
    assert time.monotonic() - cancelled < 30.0  # the picture takes hours
    assert not leftovers()
    assert os.listdir(tmp_path / "scenes") == ["scene.py"]


@pytest.mark.parametrize("server", [RenderLimits(code=8.0, picture=6.0)], indirect=True, ids=[""])
@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            "import time\nwhile True: time.sleep(1)\n",
            "the scene's code came to no end within 8 s",
        ),
        ("import os\nos._exit(7)\n", "the scene's code ended its process (exit status 7)"),
        ("import os\nos.kill(os.getpid(), 11)\n", "the scene's code ended its process (signal 11)"),
        (ENDLESS, "there was no progress for 6 s: does a loop run for ever?"),
        ("import sys\nsys.exit(0)\n", "scene.py left with sys.exit(0) while it was loaded"),
        ("x = 1\n", "scene.py defines no scene and no @image"),
    ],
    ids=["loop", "exit", "crash", "endless", "quit", "nothing"],
)
def test_code_that_makes_no_picture_is_told(server, socket, text, reason):
    socket.send(rendering(1, text))
    assert reason in until(socket, "mistakes", 1).mistakes[0].message


def test_renders_of_two_tabs_wait_for_each_other_and_end_with_their_tab(server, tmp_path):
    secret = secret_of(server)
    with connected(server, secret) as second:
        with connected(server, secret) as first:
            first.send(rendering(1, SLOW, size=[1600, 1200]))
            while until(first, "progress", 1).label != "rendering":
                continue
            second.send(rendering(1))
            second.send(rendering(2))
            assert until(second, "progress", 1).label == "waiting"
            # One that waits is dropped at once.
            second.send(json.dumps({"kind": "cancel", "id": 3, "revision": 1, "job": 2}))
            until(second, "dropped", 2)
            child = server._renders._jobs[0]._process._process
            assert child.poll() is None
        assert until(second, "answer", 1).result.name == "scene.png"
        assert child.poll() is not None


def test_the_command_is_known_before(socket):
    socket.send(rendering(1, kind="command", samples=4, mode="path"))
    command = until(socket, "answer", 1).result.command
    assert command == ("distal render scene.py -o scene.png --size 48x32 --mode path --samples 4")
    socket.send(rendering(2, kind="command", format="bmp"))
    text = until(socket, "mistakes", 2).mistakes[0].message
    assert text == "there is no format 'bmp'; formats: png, jpg, exr, mp4, webm, gif, apng, webp"


def test_missing_packages_are_named_before(monkeypatch):
    monkeypatch.setattr("distal.packages.is_installed", lambda module: module != "OpenEXR")
    render_choices.choices.cache_clear()
    try:
        found = {f.name: f.missing for f in render_choices.choices().formats}
    finally:
        render_choices.choices.cache_clear()
    assert found["png"] is None and found["mp4"] is None
    assert found["exr"].endswith("pip install 'distal[exr]'")


def request_of(cls, **more):
    return cls(id=1, revision=1, files={}, main="scene.py", **more)


def test_words_of_commands():
    request = request_of(
        RenderRequest,
        format="mp4",
        object="moon",
        values={"On": True, "Count": 3.0, "Third": 1 / 3, "P": (1.0, -0.5, 1e-9)},
        time=2.0,
        quality="high",
        view="normal",
    )
    assert video_arguments(request, "a b.mp4") == [
        *("video", "scene.py:moon", "-o", "a b.mp4", "--duration", "2", "--fps", "30"),
        *("--size", "640x480", "--start", "2", "--view", "normal", "--quality", "high"),
        *("--set", "On=true", "--set", "Count=3", "--set", "Third=0.3333333333333333"),
        *("--set", "P=1,-0.5,1e-09"),
    ]
    path = request_of(RenderRequest, format="exr", mode="path", time_limit=1.5, look="night")
    assert render_arguments(path, "-x.exr")[4:] == [
        *("--size", "640x480", "--mode", "path", "--time-limit", "1.5", "--look", "night"),
    ]
    page = request_of(ExportRequest, format="page", embed=True, time=1.5)
    assert export_arguments(page, "a.html") == [
        *("export", "scene.py", "-o", "a.html", "--time", "1.5", "--embed"),
    ]
    page = request_of(ExportRequest, format="page", size=(800, 600), look="night", mode="path")
    assert export_arguments(page, "a.html")[4:] == [
        *("--size", "800x600", "--look", "night", "--mode", "path"),
    ]
    text = request_of(ExportRequest, format="isf", size=(800, 600), look="night", mode="path")
    assert export_arguments(text, "a.fs")[4:] == ["--target", "isf", "--look", "night"]


def test_a_name_is_taken_once(tmp_path):
    source = tmp_path / "made.gif"
    source.write_bytes(b"film")
    folder = tmp_path / "scenes"
    folder.mkdir()
    assert [placed(source, folder).name for _ in range(3)] == [
        "made.gif",
        "made-2.gif",
        "made-3.gif",
    ]
    assert {file.read_bytes() for file in folder.iterdir()} == {b"film"}


FORGED = """import os, sys, atexit
line = '{"stage": "rendering", "done": 0.987, "text": "forged"}\\n'
atexit.register(lambda: os.write(1, line.encode()))
print(line, flush=True)
sys.__stdout__.write(line)
sys.__stdout__.flush()
os.write(1, line.encode())
print("x" * 3_000_000)
"""


def test_printed_lines_are_no_progress(socket):
    socket.send(rendering(1, FORGED + SCENE))
    told = []
    while (message := parsed(socket.recv(timeout=ANSWER_S))).kind != "answer":
        told.append((getattr(message, "text", None), getattr(message, "done", None)))
    assert message.result.name == "scene.png"
    assert told
    assert not [one for one in told if "forged" in str(one) or one[1] == 0.987]


def test_requests_that_cannot_be_rendered_do_not_stop_the_queue(server, socket, tmp_path):
    attempts = [
        (rendering(1, "x = '\ud800'\n"), "'scene.py' has a character in line 1 that is not"),
        (rendering(1, object="../../x"), "'../../x' is not the name of a scene"),
        (rendering(1, object="x\0"), "is not the name of a scene"),
        (rendering(1, main="../scene.py"), "there is no file '../scene.py' among the texts"),
        (rendering(1, files={"scene.py": SCENE, "a\0.py": ""}), "'a\\x00.py' is not the name"),
        (rendering(1, files={"scene.py": SCENE, "../a.py": ""}), "'../a.py' is not the name"),
        (rendering(1, look="x\0y"), "cannot be rendered (ValueError"),
    ]
    for sent, reason in attempts:
        socket.send(sent)
        assert reason in until(socket, "mistakes", 1).mistakes[0].message
    assert os.listdir(tmp_path / "scenes") == ["scene.py"]
    socket.send(rendering(2))
    until(socket, "answer", 2)


def test_a_full_disk_is_told_and_the_next_render_works(socket, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("distal.editor.local.renders.ScratchFolder", full)
        socket.send(rendering(1))
        text = until(socket, "mistakes", 1).mistakes[0].message
        assert text == "[Errno 28] No space left on device"
    socket.send(rendering(2))
    until(socket, "answer", 2)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_a_render_that_leaves_a_process_behind_ends(socket, tmp_path):
    place = tmp_path / "number"
    fork = (
        "import os, time\nnumber = os.fork()\nif number == 0:\n    time.sleep(600)\n"
        f"open({str(place)!r}, 'w').write(str(number))\n"
    )
    socket.send(rendering(1, fork + SCENE))
    assert until(socket, "answer", 1).result.name == "scene.png"
    with pytest.raises(OSError, match="No such process"):
        for _ in range(100):
            os.kill(int(place.read_text()), 0)
            time.sleep(0.05)
