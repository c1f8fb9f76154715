"""The studio's server: who is answered, loops that are ended, saves, two tabs."""

from __future__ import annotations

import hmac
import http.client
import json
import threading
import time
from contextlib import contextmanager

import pytest

from distal.editor.local.files import SceneFiles
from distal.editor.local.server import StudioServer
from distal.editor.local.serving import REFUSED
from distal.editor.messages import parsed
from distal.example_files import all_examples, posters

websockets = pytest.importorskip("websockets.sync.client")
ConnectionClosed = pytest.importorskip("websockets.exceptions").ConnectionClosed
InvalidStatus = pytest.importorskip("websockets.exceptions").InvalidStatus

SCENE = "from distal import Scene, Sphere\nscene = Scene(Sphere(0.5))\n"
LIMIT_S = 1.0
ANSWER_S = 60.0


@pytest.fixture
def server(tmp_path):
    (tmp_path / "scene.py").write_text(SCENE)
    running = StudioServer(SceneFiles(tmp_path / "scene.py"), limit=LIMIT_S)
    thread = threading.Thread(target=running.serve, daemon=True)
    thread.start()
    yield running
    running.close()
    thread.join(10.0)
    assert not thread.is_alive()


def host_of(server):
    return server._guard.authority  # to ask for the address makes a key


def asked(server, path, **headers):
    """A response to a plain request: its status, headers and body."""
    host = host_of(server)
    connection = http.client.HTTPConnection(host, timeout=10)
    connection.request("GET", path, headers={"Host": host, **headers})
    response = connection.getresponse()
    return response.status, dict(response.getheaders()), response.read()


def opened(server, **headers):
    """A socket that has not said anything."""
    host = host_of(server)
    origin = headers.pop("Origin", f"http://{host}")
    return websockets.connect(
        f"ws://{host}/socket", origin=origin, additional_headers=headers, max_size=None
    )


def proof_of(text, *words):
    """What proves, by the written protocol, that one has a text."""
    return hmac.new(text.encode(), " ".join(words).encode(), "sha256").hexdigest()


def admitted(socket, text, by="secret"):
    """What the server says first to a page with a secret or a key; the server proves itself."""
    nonce = "5" * 64
    socket.send(json.dumps({"nonce": nonce, "by": by}))
    challenge = json.loads(socket.recv(timeout=ANSWER_S))
    theirs = challenge["nonce"]
    assert challenge == {"nonce": theirs, "proof": proof_of(text, "server", nonce, theirs)}
    socket.send(json.dumps({"proof": proof_of(text, "page", nonce, theirs)}))
    return json.loads(socket.recv(timeout=ANSWER_S))


def key_of(server):
    return server.address.split("#key=")[1]


def secret_of(server):
    """The secret that a page gets for the key."""
    with opened(server) as socket:
        return admitted(socket, key_of(server), "key")["secret"]


@contextmanager
def connected(server, secret, **headers):
    """The socket of a page that is admitted."""
    with opened(server, **headers) as socket:
        admitted(socket, secret)
        yield socket


def until(socket, kind, number=None):
    end = time.monotonic() + ANSWER_S
    while time.monotonic() < end:
        message = parsed(socket.recv(timeout=ANSWER_S))
        if message.kind == kind and (number is None or message.id == number):
            return message
    raise AssertionError(f"no '{kind}' came")


def look(number, text, **more):
    files = {"scene.py": text}
    request = {"kind": "look", "id": number, "revision": number, "files": files, "main": "scene.py"}
    return json.dumps({**request, **more})


def test_the_key_is_good_once_and_brings_the_secret_and_the_settings(server, tmp_path):
    key = key_of(server)
    with opened(server) as socket:
        welcome = admitted(socket, key, "key")
    assert set(welcome) == {"secret", "settings"}
    assert welcome["settings"]["main"] == "scene.py"
    assert welcome["settings"]["folder"] == str(tmp_path)
    with opened(server) as socket:
        socket.send(json.dumps({"nonce": "0" * 64, "by": "key"}))
        assert closing_code(socket) == REFUSED
    assert key_of(server) != key  # Enter in the terminal prints it
    with opened(server) as socket:
        assert set(admitted(socket, welcome["secret"])) == {"settings"}
    with opened(server) as socket:  # the same secret for the next browser
        assert admitted(socket, key_of(server), "key")["secret"] == welcome["secret"]


def closing_code(socket):
    """The code by which the server closes a socket, which gets nothing else."""
    with pytest.raises(ConnectionClosed) as caught:
        socket.recv(timeout=ANSWER_S)
    return caught.value.rcvd.code


def test_of_two_pages_with_one_key_the_first_is_admitted(server):
    key = key_of(server)
    with opened(server) as first, opened(server) as second:
        proofs = []
        for socket in (first, second):
            socket.send(json.dumps({"nonce": "a" * 64, "by": "key"}))
            theirs = json.loads(socket.recv(timeout=ANSWER_S))["nonce"]
            proofs.append(json.dumps({"proof": proof_of(key, "page", "a" * 64, theirs)}))
        first.send(proofs[0])
        assert "secret" in json.loads(first.recv(timeout=ANSWER_S))
        second.send(proofs[1])
        assert closing_code(second) == REFUSED


@pytest.mark.parametrize(
    "hello",
    [
        '{"nonce": "' + "0" * 64 + '", "by": "nothing"}',
        '{"nonce": "' + "0" * 63 + '", "by": "secret"}',
        '{"nonce": "' + "0" * 64 + '\\n", "by": "secret"}',
        '{"nonce": 1, "by": "secret"}',
        '{"by": "secret"}',
        "[" * 900,
        "[]",
        "",
        b"\xff\xfe",
        '{"kind": "save", "id": 1, "revision": 1, "file": "scene.py", "text": "", "digest": null}',
    ],
)
def test_a_socket_that_says_something_else_is_closed(server, hello):
    with opened(server) as socket:
        socket.send(hello)
        assert closing_code(socket) == REFUSED


@pytest.mark.parametrize("wrong", ["stale", "reflected", "of the server", "none", "of another"])
def test_a_socket_without_the_right_proof_is_closed(server, wrong):
    """Also one that sends back the server's own proof, or an earlier proof of a page."""
    secret = secret_of(server)
    nonce = "1" * 64
    with opened(server) as socket:
        socket.send(json.dumps({"nonce": nonce, "by": "secret"}))
        challenge = json.loads(socket.recv(timeout=ANSWER_S))
        theirs = challenge["nonce"]
        proof = {
            "stale": proof_of(secret, "page", nonce, "2" * 64),
            "reflected": challenge["proof"],
            "of the server": proof_of(secret, "server", nonce, theirs),
            "none": "\ud800",
            "of another": proof_of(secret + "x", "page", nonce, theirs),
        }[wrong]
        socket.send(json.dumps({"proof": proof}))
        assert closing_code(socket) == REFUSED


def test_files_without_secrets_are_for_every_page_and_no_cookie_is_set(server):
    for path in ("/", "/studio.js", "/studio.css", "/gallery/melting.json", "/results/a/b", "/x"):
        status, headers, body = asked(server, path)
        assert status == (404 if path in ("/results/a/b", "/x") else 200)
        assert "Set-Cookie" not in headers
        assert b"scene.py" not in body or path.endswith(".js")
        assert str(server._files.folder).encode() not in body


def test_other_hosts_and_origins_are_refused(server):
    port = host_of(server).split(":")[1]
    for header in (
        {"Host": "evil.example"},
        {"Host": "localhost:1"},
        {"Host": f"localhost:{port}"},
        {"Origin": "http://evil.example"},
        {"Origin": "http://127.0.0.1:1"},  # another program of this machine
        {"Origin": "null"},
    ):
        status, headers, body = asked(server, "/studio.js", **header)
        assert (status, body) == (403, b"This server answers its own pages only.\n")
        assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.parametrize(
    "path",
    [
        "/../pyproject.toml",
        "/..%2f..%2fpyproject.toml",
        "/studio.html",
        "/app",
        "/gallery/../x",
        "/gallery/%2e%2e%2fmelting",
        "/gallery/none",
        "/gallery/none.webp",
        "/gallery/posters/melting.webp",
        "//etc/passwd",
        "/studio.js/",
    ],
)
def test_there_are_no_other_files(server, path):
    assert asked(server, path)[0] == 404


@pytest.mark.parametrize("name", ["melting", "coral"])
def test_examples_have_texts_and_posters(server, name):
    status, headers, body = asked(server, f"/gallery/{name}.webp")
    assert (status, headers["Content-Type"]) == (200, "image/webp")
    assert body == posters()[name].read_bytes()
    status, headers, body = asked(server, f"/gallery/{name}.json")
    assert (status, headers["Content-Type"]) == (200, "application/json; charset=utf-8")
    assert json.loads(body)["files"][f"{name}.py"] == all_examples()[name].read_text("utf-8")


def test_the_page_allows_only_its_own(server):
    status, headers, body = asked(server, "/")
    assert status == 200
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert b"http://" not in body
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1:1", None])
def test_a_foreign_page_gets_no_socket(server, origin):
    with pytest.raises(InvalidStatus, match="403"):
        opened(server, Origin=origin)


def test_an_endless_loop_is_ended_and_the_next_text_is_answered(server):
    with connected(server, secret_of(server)) as socket:
        assert until(socket, "changed").files == {"scene.py": SCENE}
        until(socket, "ready")
        socket.send(look(1, "while True: pass\n"))
        socket.send(json.dumps({"kind": "text", "id": 2, "revision": 1, "files": {}, "main": "x"}))
        restarted = until(socket, "restarted")
        assert restarted.id == 1
        assert restarted.reason == "the scene's code gave no answer within 1 s"
        assert until(socket, "dropped").id == 2
        until(socket, "ready")
        socket.send(look(3, SCENE))
        assert until(socket, "scene", 3).objects == ("scene",)


def test_the_line_of_an_endless_loop_is_told(tmp_path):
    (tmp_path / "scene.py").write_text(SCENE)
    running = StudioServer(SceneFiles(tmp_path / "scene.py"), limit=7.0)
    threading.Thread(target=running.serve, daemon=True).start()
    try:
        with connected(running, secret_of(running)) as socket:
            until(socket, "ready")
            socket.send(look(1, "\nwhile True:\n    pass\n"))
            assert until(socket, "printed").text == (
                "warning: scene.py is still running after 3 s\n  --> scene.py:2:1\n   |\n"
                " 2 | while True:\n   | ^^^^^^^^^^^\n"
            )
            assert until(socket, "restarted").reason == (
                "the scene's code gave no answer within 7 s; "
                "it was at line 2 of scene.py: while True:"
            )
    finally:
        running.close()


def test_code_that_ends_its_process_is_named(server):
    with connected(server, secret_of(server)) as socket:
        until(socket, "ready")
        socket.send(look(1, "import os\nos._exit(7)\n"))
        assert until(socket, "restarted").reason.startswith(
            "the scene's code ended its process (exit status 7)"
        )
        until(socket, "ready")


def test_tabs_have_workers_of_their_own(server):
    secret = secret_of(server)
    with connected(server, secret) as first, connected(server, secret) as second:
        until(first, "ready")
        until(second, "ready")
        first.send(look(1, "while True: pass\n"))
        second.send(look(1, SCENE))
        assert until(second, "scene", 1).objects == ("scene",)


def test_a_save_is_seen_by_the_other_tab(server, tmp_path):
    secret = secret_of(server)
    with connected(server, secret) as first, connected(server, secret) as second:
        digest = until(first, "changed").digests["scene.py"]
        until(second, "changed")
        text = f"# mine\n{SCENE}"
        save = {"kind": "save", "id": 1, "revision": 1, "file": "scene.py", "text": text}
        first.send(json.dumps({**save, "digest": digest}))
        assert until(first, "answer", 1).result.conflict is None
        assert (tmp_path / "scene.py").read_text() == text
        assert until(second, "changed").files == {"scene.py": text}
        second.send(json.dumps({**save, "digest": digest, "text": "other\n"}))
        assert until(second, "answer", 1).result.conflict == text


@pytest.mark.parametrize(
    "sent", ["{", "[]", '{"kind":"nothing"}', '{"kind":"stop","id":1}', "x" * 99]
)
def test_messages_of_the_wrong_form_are_answered(server, sent):
    with connected(server, secret_of(server)) as socket:
        until(socket, "ready")
        socket.send(sent)
        assert until(socket, "mistakes", -1).mistakes[0].severity == "error"
        socket.send(look(2, SCENE))
        until(socket, "scene", 2)
