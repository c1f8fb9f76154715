"""A lesson in the studio: its page follows the files; a mistake is told over the last page."""

from __future__ import annotations

import http.client
import threading
from contextlib import contextmanager

import pytest

from distal.editor.local.lesson_server import LessonServer
from tests.browser import BrowserUnavailableError, browser
from tests.editor.studio_page import SLOW_MS

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


def test_only_the_lesson_is_served_and_only_to_its_own_browser(tmp_path):
    (tmp_path / "lesson.md").write_text(LESSON)
    (tmp_path / "ball.py").write_text(SCENE)
    server = LessonServer(tmp_path / "lesson.md")
    host = server.address.split("/")[2]

    def asked(path, **headers):
        connection = http.client.HTTPConnection(host, timeout=10)
        connection.request("GET", path, headers={"Host": host, **headers})
        response = connection.getresponse()
        return response.status, response.headers

    try:
        assert asked("/")[0] == 403
        assert asked("/lesson")[0] == 403
        _, headers = asked("/?" + server.address.split("/?")[1])
        cookie = {"Cookie": headers["Set-Cookie"].split(";")[0]}
        status, headers = asked("/", **cookie)
        assert status == 200
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert asked("/ball.py", **cookie)[0] == 404
        assert asked("/../lesson.md", **cookie)[0] == 404
        assert asked("/", Host="example.org", **cookie)[0] == 403
        assert asked("/", Origin="http://example.org", **cookie)[0] == 403
    finally:
        server.close()
