"""A lesson in the studio: its page follows the files; a mistake is told over the last page."""

from __future__ import annotations

import json
import threading
from contextlib import contextmanager

import pytest

from distal.editor.local.lesson_server import LessonServer
from tests.browser import BrowserUnavailableError, browser
from tests.editor.studio_page import SLOW_MS
from tests.editor.test_local_server import admitted, asked, opened, secret_of

pytest.importorskip("websockets")
pytest.importorskip("markdown_it")

LESSON = """+++
number = 1
title = "A ball"
summary = "One sphere."
scene = "ball.py"
+++

The ball is a function.
"""
SCENE = "from distal import *\n\nscene = Scene(Sphere(0.5))\n"
_TITLE = "() => document.querySelector('iframe').contentDocument?.querySelector('h1')?.textContent"
_TOLD = "() => document.querySelector('p[role=status]').textContent"


@contextmanager
def lesson(folder, scene=SCENE, limit=60.0):
    (folder / "lesson.md").write_text(LESSON)
    (folder / "ball.py").write_text(scene)
    server = LessonServer(folder / "lesson.md", limit=limit)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    try:
        page = browser().new_context().new_page()
    except BrowserUnavailableError as error:
        server.close()
        pytest.skip(str(error))
    page.set_default_timeout(SLOW_MS)
    thrown: list[str] = []
    page.on("pageerror", lambda error: thrown.append(str(error)))
    try:
        page.goto(server.address)
        yield server, page
        assert thrown == []
    finally:
        page.context.close()
        server.close()
        thread.join(20.0)
        assert not thread.is_alive()


def test_a_lesson_follows_its_files_and_a_mistake_leaves_the_last_page(tmp_path):
    with lesson(tmp_path) as (_, page):
        page.wait_for_function(f"() => ({_TITLE})()?.includes('A ball')")
        (tmp_path / "lesson.md").write_text(LESSON.replace("A ball", "A better ball"))
        page.wait_for_function(f"() => ({_TITLE})()?.includes('A better ball')")
        (tmp_path / "ball.py").write_text(SCENE.replace("Sphere", "Sfere"))
        page.wait_for_function(f"() => ({_TOLD})().includes('Sfere')")
        assert "A better ball" in page.evaluate(_TITLE)
        (tmp_path / "ball.py").write_text(SCENE)
        page.wait_for_function(f"() => ({_TOLD})() === ''")


def test_a_scene_that_loops_is_ended(tmp_path):
    with lesson(tmp_path, "while True:\n    pass\n", limit=3.0) as (_, page):
        page.wait_for_function(f"() => ({_TOLD})().includes('does a scene run for ever?')")


def test_only_the_lesson_is_served_and_only_to_its_own_browser(tmp_path, monkeypatch):
    def made(_, page):
        page.write_text("the page")

    monkeypatch.setattr(LessonServer, "_mistake_of_making", made)
    (tmp_path / "lesson.md").write_text(LESSON)
    (tmp_path / "ball.py").write_text(SCENE)
    server = LessonServer(tmp_path / "lesson.md")
    try:
        assert "ball" not in asked(server, "/")[2].decode()
        assert "default-src 'none'" in asked(server, "/")[1]["Content-Security-Policy"]
        assert asked(server, "/lesson_page.js")[0] == 200
        for path in ("/lesson", "/lesson/", "/ball.py", "/../lesson.md", "/lesson.md"):
            assert asked(server, path)[0] == 404
        assert asked(server, "/", Host="example.org")[0] == 403
        assert asked(server, "/", Origin="http://example.org")[0] == 403
        secret = secret_of(server)
        with opened(server) as socket:
            assert admitted(socket, secret) == {"settings": {"name": "lesson.md"}}
            assert json.loads(socket.recv(timeout=10.0))["address"] == ""
            server._make()
            addresses = [json.loads(socket.recv(timeout=60.0))["address"] for _ in range(2)]
        first = addresses[1]
        assert addresses[0] == ""
        assert asked(server, first)[::2] == (200, b"the page")
        assert asked(server, first + "x")[0] == 404
        server._make()
        assert asked(server, first)[0] == 404  # the page has another address now
    finally:
        server.close()
