"""Who has access to the studio: other users, other programs, pages that do not read."""

from __future__ import annotations

import contextlib
import functools
import http.server
import json
import os
import re
import shutil
import signal
import socket as sockets
import stat
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from distal.editor.local import connection, serving
from distal.editor.local.files import SceneFiles
from distal.editor.local.key_file import KeyFile
from distal.editor.local.server import StudioServer
from distal.editor.messages import Changed, encoded
from tests.browser import BrowserUnavailableError, browser
from tests.editor.studio_page import IDLE, SLOW_MS
from tests.editor.test_local_server import (
    ANSWER_S,
    admitted,
    closing_code,
    connected,
    host_of,
    opened,
    secret_of,
    until,
)

servers = pytest.importorskip("websockets.sync.server")
clients = pytest.importorskip("websockets.sync.client")

SCENE = """from distal.lang import Frame, image, vec3

@image
def picture(frame: Frame) -> vec3:
    return vec3(0.5, 0.0, 0.0)
"""
STARTED = "() => window.studio"
SOON_S = 30.0
TRY_LATER = 1013
TOO_LONG = 1009
HELLO = {"nonce": re.compile("[0-9a-f]{64}"), "by": re.compile("key|secret")}
NOBODY = 65534
root = pytest.mark.skipif(
    sys.platform == "win32" or os.getuid() != 0, reason="only root can become another user"
)


@contextmanager
def running(folder, port=0):
    (folder / "scene.py").write_text(SCENE)
    made = StudioServer(SceneFiles(folder / "scene.py"), port, limit=30.0)
    thread = threading.Thread(target=made.serve, daemon=True)
    thread.start()
    try:
        yield made
    finally:
        made.close()
        thread.join(10.0)


@pytest.fixture
def server(tmp_path):
    with running(tmp_path) as made:
        yield made


def soon(is_true):
    end = time.monotonic() + SOON_S
    while not is_true() and time.monotonic() < end:
        time.sleep(0.02)
    return is_true()


@contextmanager
def unread(server, secret):
    """An admitted tab that takes no more than a message from its socket, as at a breakpoint."""
    host = host_of(server)
    own = {"max_queue": 1, "max_size": None, "close_timeout": 0.1, "ping_interval": None}
    with clients.connect(f"ws://{host}/socket", origin=f"http://{host}", **own) as socket:
        admitted(socket, secret)
        yield socket


def raw(server):
    host, port = host_of(server).split(":")
    return sockets.create_connection((host, int(port)), timeout=ANSWER_S)


# Tabs that do not read


def sent_all(server, number, size):
    """Tell all tabs of a large file, as often; fails where that waits for a tab."""
    texts = [
        encoded(Changed(files={"scene.py": f"{i}{'#' * size}"}, digests={"scene.py": str(i)}))
        for i in range(number)
    ]
    thread = threading.Thread(target=lambda: [server._send_all(t) for t in texts], daemon=True)
    thread.start()
    thread.join(SOON_S)
    assert not thread.is_alive()


def test_a_tab_that_reads_nothing_stops_no_other_and_is_dropped(server):
    secret = secret_of(server)
    with unread(server, secret), connected(server, secret) as other:
        assert soon(lambda: len(server._tabs) == 2)
        size = 8_000_000
        for turn in range(2):  # its queue is full in the second
            sent_all(server, 5, size)
            for number in range(5):
                while (changed := until(other, "changed")).files["scene.py"] == SCENE:
                    continue
                assert changed.digests["scene.py"] == str(number), turn
        assert soon(lambda: len(server._tabs) == 1)
        with connected(server, secret) as again:
            assert until(again, "changed").files == {"scene.py": SCENE}


def test_a_tab_that_reads_late_gets_everything_in_order(server):
    secret = secret_of(server)
    with connected(server, secret) as slow:
        until(slow, "ready")
        sent_all(server, 300, 100_000)
        for number in range(300):
            assert until(slow, "changed").digests["scene.py"] == str(number)


def test_the_queue_has_a_limit_of_messages_too(server, monkeypatch):
    monkeypatch.setattr(connection, "MOST_WAITING", 20)
    secret = secret_of(server)
    with unread(server, secret):
        assert soon(lambda: len(server._tabs) == 1)
        sent_all(server, 60, 300_000)
        assert soon(lambda: len(server._tabs) == 0)


def test_the_end_of_the_server_waits_for_nobody(tmp_path):
    with running(tmp_path) as server, contextlib.ExitStack() as stack:
        stack.enter_context(unread(server, secret_of(server)))
        sent_all(server, 3, 9_000_000)
        silent = stack.enter_context(raw(server))
        lazy = stack.enter_context(raw(server))
        lazy.sendall(f"GET /studio.js HTTP/1.1\r\nHost: {host_of(server)}\r\n\r\n".encode())
        stack.enter_context(opened(server))
        ending = threading.Thread(target=server.close, daemon=True)
        ending.start()
        ending.join(SOON_S)
        assert not ending.is_alive()
        assert silent.recv(10) == b""


# Pages that are not admitted


def test_pages_that_are_not_admitted_have_few_places(server, monkeypatch):
    monkeypatch.setattr(serving, "ADMISSION_S", 600.0)
    secret = secret_of(server)
    with connected(server, secret) as tab, contextlib.ExitStack() as stack:
        until(tab, "ready")
        for _ in range(serving.MOST_UNADMITTED):
            stranger = stack.enter_context(opened(server))
        with opened(server) as one_more:
            assert closing_code(one_more) == TRY_LATER
        tab.send("nonsense")
        until(tab, "mistakes", -1)
        stranger.close()
        assert soon(lambda: server._waiting._value == 1)
        with connected(server, secret) as again:
            until(again, "changed")


def test_a_page_that_says_nothing_is_closed(server, monkeypatch):
    monkeypatch.setattr(serving, "ADMISSION_S", 0.2)
    with opened(server) as silent, opened(server) as half:
        half.send(json.dumps({"nonce": "0" * 64, "by": "key"}))
        assert closing_code(silent) == serving.REFUSED
        assert soon(lambda: server._waiting._value == serving.MOST_UNADMITTED)


def test_connections_are_bounded_and_those_after_them_wait(server, monkeypatch):
    monkeypatch.setattr(connection, "MOST_SOCKETS", 4)
    with contextlib.ExitStack() as stack:
        lines = [stack.enter_context(raw(server)) for _ in range(8)]
        for line in lines:
            line.sendall(f"GET / HTTP/1.1\r\nHost: {host_of(server)}\r\n".encode())
        assert soon(lambda: len(server._listener._open()) == 4)
        time.sleep(0.3)
        assert len(server._listener._open()) == 4
        for line in lines:
            line.sendall(b"\r\n")
            assert line.recv(20).startswith(b"HTTP/1.1 200")
            line.close()


def test_there_are_few_tabs_and_strangers_take_none_of_their_places(server, monkeypatch):
    monkeypatch.setattr(serving, "MOST_TABS", 1)
    secret = secret_of(server)
    assert soon(lambda: not server._tabs)
    with contextlib.ExitStack() as stack:
        for _ in range(3):
            stack.enter_context(opened(server))
        first = stack.enter_context(connected(server, secret))
        until(first, "ready")
        with opened(server) as second, pytest.raises(Exception, match="too many tabs") as caught:
            admitted(second, secret)
        assert caught.value.rcvd.code == TRY_LATER


def test_only_admitted_pages_send_long_messages(server):
    with opened(server) as socket:
        socket.send(" " * 2000)
        assert closing_code(socket) == TOO_LONG
    with connected(server, secret_of(server)) as socket:
        socket.send("x" * 3_000_000)
        assert until(socket, "mistakes", -1).mistakes[0].severity == "error"


# Other users of the machine


@pytest.fixture
def public_folder():
    """A folder that all users can enter, as those of pytest are not."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o755)
    yield folder
    shutil.rmtree(folder)


@root
def test_another_user_learns_nothing_of_a_start(public_folder):
    """The browser's command, the key's file, the port: all that another user can see or ask."""
    temporary, record = public_folder / "temporary", public_folder / "arguments"
    temporary.mkdir()
    temporary.chmod(0o1777)
    browser_command = public_folder / "browser"
    browser_command.write_text(f'#!/bin/sh\necho "$@" > {record}\n')
    browser_command.chmod(0o755)
    (public_folder / "scene.py").write_text(SCENE)
    environment = {"BROWSER": str(browser_command), "TMPDIR": str(temporary)}
    studio = subprocess.Popen(
        [sys.executable, "-m", "distal.cli", "studio", "scene.py"],
        cwd=public_folder,
        env={**os.environ, **environment, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        umask=0,
        text=True,
    )
    try:
        address = studio.stdout.readline().split()[-1]
        host, key = re.fullmatch(r"http://([\d.:]+)/#key=(\S+)", address).groups()
        assert "Enter prints an address" in studio.stdout.readline()
        assert soon(lambda: record.exists() and record.read_text().endswith("\n"))
        place = record.read_text().strip()
        assert re.fullmatch(rf"file://{temporary}/distal_opening_[\w-]+/studio\.html", place)
        file = Path(place.removeprefix("file://"))
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700
        assert f'content="0; url={address}"' in file.read_text()
        seen = as_nobody(SPY, str(file), str(studio.pid), host)
        assert seen["file"] == seen["folder"] == "PermissionError"
        assert key not in json.dumps(seen)
        assert seen["socket"] == [serving.REFUSED, serving.REFUSED]
        assert "Set-Cookie" not in seen["head"]
        # The key's owner: then the file is not needed any more.
        with clients.connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
            assert admitted(socket, key, "key")["settings"]["main"] == "scene.py"
        assert soon(lambda: not file.parent.exists())
        studio.stdin.write("\n")
        studio.stdin.flush()
        again = studio.stdout.readline().strip()
        assert again.startswith(f"http://{host}/#key=")
        assert again != address
    finally:
        studio.send_signal(signal.SIGINT)
        assert studio.wait(30.0) == 0
        studio.stdin.close()
        studio.stdout.close()


# What a second user tries, in a program of its own: plain files, and the protocol with guesses.
SPY = """
import http.client, json, os, sys
from pathlib import Path
os.setgroups([]); os.setgid(65534); os.setuid(65534)
file, process, host = sys.argv[1:]
seen = {}
for name, act in (("file", lambda: Path(file).read_text()),
                  ("folder", lambda: os.listdir(os.path.dirname(file)))):
    try:
        seen[name] = act()
    except OSError as error:
        seen[name] = type(error).__name__
seen["cmdline"] = Path(f"/proc/{process}/cmdline").read_text()
seen["temporary"] = os.listdir(os.path.dirname(os.path.dirname(file)))
line = http.client.HTTPConnection(host, timeout=10)
line.request("GET", "/", headers={"Host": host})
response = line.getresponse()
seen["head"] = list(response.headers)
seen["page"] = response.read().decode()
seen["socket"] = []
for by in ("key", "secret"):
    with connect(f"ws://{host}/socket", origin=f"http://{host}") as socket:
        socket.send(json.dumps({"nonce": "0" * 64, "by": by}))
        seen[by] = socket.recv(timeout=10)
        socket.send(json.dumps({"proof": json.loads(seen[by])["proof"]}))
        try:
            seen["more"] = socket.recv(timeout=10)
        except ConnectionClosed as error:
            seen["socket"].append(error.rcvd.code)
print(json.dumps(seen))
"""


def as_nobody(program, *words):
    """The JSON that a program of another user prints; what it needs is imported before."""
    imports = (
        "import encodings.idna\n"  # later it could not be read
        "from websockets.sync.client import connect\n"
        "from websockets.exceptions import ConnectionClosed\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", imports + program, *words],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        timeout=60.0,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_browser_is_given_a_file_and_no_key(server, monkeypatch):
    given = []
    monkeypatch.setattr("webbrowser.open", lambda address: not given.append(address))
    assert server.open_browser()
    file = Path(given[0].removeprefix("file://"))
    assert given == [file.as_uri()]
    assert server.address.split("key=")[1] not in given[0]
    assert server.address in file.read_text()
    secret_of(server)
    assert not file.parent.exists()
    server.open_browser()  # a new key, a new file
    assert Path(given[1].removeprefix("file://")).exists()
    server.close()
    assert not Path(given[1].removeprefix("file://")).parent.exists()


def test_an_address_is_text_in_its_file():
    file = KeyFile('http://x/#"><script>')
    try:
        assert "<script>" not in file.path.read_text()
    finally:
        file.remove()
    file.remove()


# In a browser


@contextmanager
def context(**options):
    try:
        made = browser().new_context(viewport={"width": 900, "height": 600}, **options)
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    try:
        yield made
    finally:
        made.close()


def page_of(context, address, condition=IDLE):
    page = context.new_page()
    page.set_default_timeout(SLOW_MS)
    page.goto(address)
    page.wait_for_function(condition)
    return page


REFUSED_NOTE = "() => document.querySelector('.no-access')?.textContent.includes('Press Enter')"
REFUSED_BAR = "() => document.querySelector('.state-bars').textContent.includes('Press Enter')"
ENDED = "() => document.querySelector('.state-bars').textContent.includes('server is away')"
CONNECTED = "() => !document.querySelector('.state-bars').children.length"


class Stranger:
    """Another program on the server's old port: it answers as well as it can without the secret."""

    def __init__(self, port):
        self.heard = []
        self._server = servers.serve(self._talk, "127.0.0.1", port)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def _talk(self, socket):
        self.heard.append(json.loads(socket.recv()))
        socket.send(json.dumps({"nonce": "0" * 64, "proof": "0" * 64}))
        socket.send(json.dumps({"settings": {"main": "scene.py"}, "secret": "mine"}))
        for text in socket:
            self.heard.append(text)

    def close(self):
        self._server.shutdown()


def test_reload_second_tab_second_browser_and_a_stranger_on_the_port(tmp_path):
    with context() as first, context() as second, contextlib.ExitStack() as stack:
        server = stack.enter_context(running(tmp_path))
        origin, port = f"http://{host_of(server)}", int(host_of(server).split(":")[1])
        page = page_of(first, server.address)
        assert page.url == f"{origin}/"
        assert page.evaluate("() => document.cookie") == ""
        page.reload()
        page.wait_for_function(IDLE)
        tab = page_of(first, origin, STARTED)
        # Another browser has no access until it gets a key, in the same page.
        other = page_of(second, origin, REFUSED_NOTE)
        other.evaluate("(address) => { location.href = address; }", server.address)
        other.wait_for_function(STARTED)
        assert other.url == f"{origin}/"
        assert first.cookies() == second.cookies() == []
        tab.close()
        other.close()
        # The server ends, and another program has its port.
        server.close()
        page.wait_for_function(ENDED)
        page.evaluate("() => studio.files.replace('scene.py', '# my secret text\\n')")
        stranger = Stranger(port)
        stack.callback(stranger.close)
        page.wait_for_function(REFUSED_BAR)
        page.evaluate("() => studio.save()")
        assert "not saved: nobody answers" in page.locator(".notice").inner_text()
        page.wait_for_function(REFUSED_BAR)
        page.evaluate("() => studio.looking.run()")
        page.evaluate("() => studio.opening.open('melting')")
        page.evaluate("(key) => { location.hash = 'key=' + key; }", "another-key")
        assert soon(lambda: len(stranger.heard) >= 3)  # by the key, and by the secret again
        page.wait_for_timeout(300)
        for heard in stranger.heard:
            assert set(heard) == set(HELLO)
            assert all(HELLO[name].fullmatch(value) for name, value in heard.items())
        assert "another-key" not in page.url
        assert page.evaluate("() => studio.texts.files['scene.py']") == "# my secret text\n"
        # The studio again, at the same port: a new key in one tab is enough for all.
        stranger.close()
        server = stack.enter_context(running(tmp_path, port))
        page_of(first, server.address, STARTED)
        page.wait_for_function(CONNECTED)
        page.evaluate("() => studio.save()")
        assert (tmp_path / "scene.py").read_text() == "# my secret text\n"


def test_without_storage_it_works_until_a_reload(tmp_path):
    with running(tmp_path) as server, context() as made:
        made.add_init_script(
            "Object.defineProperty(window, 'localStorage', "
            "{ get() { throw new DOMException('blocked', 'SecurityError'); } })"
        )
        page = page_of(made, server.address)
        notice = page.locator(".notice").inner_text()
        assert notice.startswith("This browser stores nothing for this page. After a reload, press")
        page.reload()
        page.wait_for_function(REFUSED_NOTE)
        page.evaluate("(address) => { location.href = address; }", server.address)
        page.wait_for_function(STARTED)


def test_a_page_of_another_port_gets_nothing(tmp_path):
    folder = tmp_path / "other"
    folder.mkdir()
    (folder / "index.html").write_text("<!doctype html><title>other</title>")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    handler.func.log_message = lambda *_: None
    with running(tmp_path) as server, context() as made:
        other = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=other.serve_forever, daemon=True).start()
        try:
            page_of(made, server.address, STARTED)  # this browser has access
            page = page_of(made, f"http://127.0.0.1:{other.server_port}/", "() => true")
            got = page.evaluate(FOREIGN, host_of(server))
        finally:
            other.shutdown()
            other.server_close()
    assert got == {"fetch": "TypeError", "blind": "TypeError", "script": "error", "socket": "close"}


FOREIGN = """async (host) => {
  const name = (promise) => promise.then(() => "answered", (error) => error.name);
  const script = document.createElement("script");
  script.src = `http://${host}/studio.js`;
  const loaded = new Promise((resolve) => {
    script.onload = () => resolve("load");
    script.onerror = () => resolve("error");
  });
  document.head.append(script);
  const socket = new WebSocket(`ws://${host}/socket`);
  const ended = new Promise((resolve) => {
    socket.onopen = () => resolve("open");
    socket.onclose = () => resolve("close");
  });
  return {
    fetch: await name(fetch(`http://${host}/studio.js`)),
    blind: await name(fetch(`http://${host}/studio.js`, { mode: "no-cors" })),
    script: await loaded,
    socket: await ended,
  };
}"""
