"""The studio's server: who is answered, loops that are ended, saves, two tabs."""

from __future__ import annotations

import http.client
import json
import threading
import time

import pytest

from distal.editor.local.files import SceneFiles
from distal.editor.local.guard import Guard
from distal.editor.local.server import StudioServer
from distal.editor.messages import parsed
from distal.example_files import all_examples, posters

websockets = pytest.importorskip("websockets.sync.client")

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


def asked(server, path, **headers):
    """A response to a plain request: its status, headers and body."""
    host = server.address.split("/")[2]
    connection = http.client.HTTPConnection(host, timeout=10)
    connection.request("GET", path, headers={"Host": host, **headers})
    response = connection.getresponse()
    return response.status, dict(response.getheaders()), response.read()


def cookie_of(server):
    status, headers, _ = asked(server, server.address.removeprefix(server.address.split("/?")[0]))
    assert status == 303
    assert headers["Location"] == "/"
    assert "HttpOnly" in headers["Set-Cookie"]
    assert "SameSite=Strict" in headers["Set-Cookie"]
    return headers["Set-Cookie"].split(";")[0]


def connected(server, cookie, **headers):
    host = server.address.split("/")[2]
    given = {"Cookie": cookie, **headers}
    origin = given.pop("Origin", f"http://{host}")
    return websockets.connect(
        f"ws://{host}/socket", origin=origin, additional_headers=given, max_size=None
    )


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


def test_the_address_is_good_once(server):
    address = server.address
    path = address[address.index("/?") :]
    assert asked(server, path)[0] == 303
    status, _, body = asked(server, path)
    assert status == 403
    assert body.startswith(b"This address was used already.")


@pytest.mark.parametrize("path", ["/", "/studio.js", "/gallery/melting", "/../pyproject.toml"])
def test_without_the_cookie_nothing_is_answered(server, path):
    assert asked(server, path)[0] == 403
    assert asked(server, path, Cookie="distal_1=x")[0] == 403
    assert asked(server, "/?key=")[0] == 403


def test_other_hosts_and_origins_are_refused(server):
    cookie = cookie_of(server)
    assert asked(server, "/", Cookie=cookie)[0] == 200
    for header in (
        {"Host": "evil.example"},
        {"Host": "localhost:1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
    ):
        assert asked(server, "/", Cookie=cookie, **header)[0] == 403


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
    assert asked(server, path, Cookie=cookie_of(server))[0] == 404


@pytest.mark.parametrize("name", ["melting", "coral"])
def test_examples_have_texts_and_posters(server, name):
    cookie = cookie_of(server)
    status, headers, body = asked(server, f"/gallery/{name}.webp", Cookie=cookie)
    assert (status, headers["Content-Type"]) == (200, "image/webp")
    assert body == posters()[name].read_bytes()
    status, headers, body = asked(server, f"/gallery/{name}.json", Cookie=cookie)
    assert (status, headers["Content-Type"]) == (200, "application/json; charset=utf-8")
    assert json.loads(body)["files"][f"{name}.py"] == all_examples()[name].read_text("utf-8")


def test_the_page_allows_only_its_own(server):
    status, headers, body = asked(server, "/", Cookie=cookie_of(server))
    assert status == 200
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert b"http://" not in body
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_settings_cannot_end_their_script(tmp_path):
    path = tmp_path / "a<script>.py"
    path.write_text(SCENE)
    running = StudioServer(SceneFiles(path))
    try:
        page = running._page().body.decode()
    finally:
        running.close()
    assert "a<script>" not in page
    settings = page.split('nonce="')[1].split(">", 1)[1].split("</script>")[0]
    assert json.loads(settings)["main"] == "a<script>.py"


@pytest.mark.parametrize("headers", [{"Origin": "http://evil.example"}, {"Cookie": "x=y"}])
def test_a_foreign_page_gets_no_socket(server, headers):
    cookie = cookie_of(server)
    with pytest.raises(Exception, match="403"):
        connected(server, cookie, **headers)


def test_a_socket_without_an_origin_is_refused(server):
    cookie = cookie_of(server)
    host = server.address.split("/")[2]
    with pytest.raises(Exception, match="403"):
        websockets.connect(f"ws://{host}/socket", additional_headers={"Cookie": cookie})


def test_an_endless_loop_is_ended_and_the_next_text_is_answered(server):
    with connected(server, cookie_of(server)) as socket:
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
    running = StudioServer(SceneFiles(tmp_path / "scene.py"), limit=4.0)
    threading.Thread(target=running.serve, daemon=True).start()
    try:
        with connected(running, cookie_of(running)) as socket:
            until(socket, "ready")
            socket.send(look(1, "\nwhile True:\n    pass\n"))
            assert until(socket, "printed").text == (
                "warning: scene.py is still running after 3 s\n  --> scene.py:2:1\n   |\n"
                " 2 | while True:\n   | ^^^^^^^^^^^\n"
            )
            assert until(socket, "restarted").reason == (
                "the scene's code gave no answer within 4 s; "
                "it was at line 2 of scene.py: while True:"
            )
    finally:
        running.close()


def test_code_that_ends_its_process_is_named(server):
    with connected(server, cookie_of(server)) as socket:
        until(socket, "ready")
        socket.send(look(1, "import os\nos._exit(7)\n"))
        assert until(socket, "restarted").reason.startswith(
            "the scene's code ended its process (exit status 7)"
        )
        until(socket, "ready")


def test_tabs_have_workers_of_their_own(server):
    cookie = cookie_of(server)
    with connected(server, cookie) as first, connected(server, cookie) as second:
        until(first, "ready")
        until(second, "ready")
        first.send(look(1, "while True: pass\n"))
        second.send(look(1, SCENE))
        assert until(second, "scene", 1).objects == ("scene",)


def test_a_save_is_seen_by_the_other_tab(server, tmp_path):
    cookie = cookie_of(server)
    with connected(server, cookie) as first, connected(server, cookie) as second:
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
    with connected(server, cookie_of(server)) as socket:
        until(socket, "ready")
        socket.send(sent)
        assert until(socket, "mistakes", -1).mistakes[0].severity == "error"
        socket.send(look(2, SCENE))
        until(socket, "scene", 2)


def test_a_key_is_made_anew_after_its_use():
    guard = Guard(80)
    first = guard.address()
    assert guard.address() == first
    assert guard.welcomed(first.removeprefix(guard.origin)) is not None
    assert guard.welcomed(first.removeprefix(guard.origin)) is None
    assert guard.address() != first
