"""The browser of the tests hears what a page says, lets nothing out, and hands on clean pages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.browser import BrowserUnavailableError, kept_page, offline_page
from tests.kept_page import SPENDING

PAGE = """<!doctype html><script>
console.log("here"); console.warn("careful");
fetch("https://example.com/asked").catch(() => console.log("refused"));
setTimeout(() => { throw new Error("thrown late") }, 5);
</script>"""


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "a page.html"
    path.write_text(PAGE)
    try:
        with offline_page(path, viewport={"width": 200, "height": 100}) as watched:
            watched.settle(100)
            yield watched
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


def test_what_a_page_says_and_asks_for_is_remembered(page):
    assert {"log: here", "warning: careful", "log: refused"} <= set(page.messages)
    assert "warning: careful" in page.complaints and "log: here" not in page.complaints
    assert "error: thrown late" in page.complaints
    assert page.requests == ["https://example.com/asked"]
    assert page.page.evaluate("[innerWidth, innerHeight]") == [200, 100]


# Options of no other test: the page is nobody else's.
OWN = {"locale": "de-CH", "viewport": {"width": 320, "height": 200}}
LEFT = """async () => {
  localStorage.left = sessionStorage.left = window.name = "something";
  await new Promise((resolve) => (indexedDB.open("left").onsuccess = resolve));
}"""
FOUND = """async () => [
  localStorage.length, sessionStorage.length, window.name, (await indexedDB.databases()).length,
  matchMedia("(prefers-color-scheme: dark)").matches, innerWidth,
  (await navigator.permissions.query({ name: "clipboard-read" })).state,
  document.querySelectorAll("p:hover").length,
]"""
NEW = [0, 0, "", 0, False, 320, "prompt", 0]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "page.html"
    path.write_text("<!doctype html><link rel=icon href='data:,'><p style='height:150px'>text")
    try:
        with offline_page(path, **OWN):
            pass
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    return path


def page_after(file: Any, act: Callable[[Any], Any]) -> tuple[Any, Any, list[Any]]:
    """The pages that a test had and the next one has, and what the latter finds."""
    with offline_page(file, **OWN) as watched:
        first = watched.page
        act(first)
    with offline_page(file, **OWN) as watched:
        assert watched.messages == [] and watched.requests == []
        return first, watched.page, watched.page.evaluate(FOUND)


def leave_much(page: Any) -> None:
    page.evaluate(LEFT)
    page.evaluate("() => console.warn('careful')")
    page.emulate_media(color_scheme="dark")
    page.context.grant_permissions(["clipboard-read"])
    page.set_viewport_size({"width": 500, "height": 300})
    page.mouse.move(50, 50)
    page.mouse.down()
    page.keyboard.down("Shift")
    page.context.new_page()
    assert page.evaluate(FOUND) != NEW


def test_what_a_test_leaves_behind_does_not_reach_the_next(file):
    first, second, found = page_after(file, leave_much)
    assert second is first
    assert found == NEW
    assert second.context.pages == [second]


@pytest.mark.parametrize("name", SPENDING)
def test_a_page_that_cannot_be_made_new_is_closed(file, name):
    def ignore(*_: Any) -> None:
        """Do nothing."""

    def act(page: Any) -> None:
        arguments = {
            "add_init_script": ["window.left = 1"],
            "expose_function": ["left", ignore],
            "expose_binding": ["left", ignore],
            "route": ["**/left", ignore],
        }
        getattr(page, name)(*arguments.get(name, ["dialog", ignore]))

    first, second, _ = page_after(file, act)
    assert first.is_closed() and second is not first


def test_a_page_whose_clock_stands_is_closed(file):
    def stop(page: Any) -> None:
        page.clock.install()
        page.clock.pause_at(page.evaluate("() => Date.now()") + 1000)

    first, second, found = page_after(file, stop)
    assert first.is_closed() and second is not first
    assert found == NEW
    assert second.evaluate("() => new Promise((resolve) => setTimeout(() => resolve(5), 5))") == 5


def test_a_page_that_differs_or_in_which_a_test_failed_is_closed(file):
    zoom = {"deviceScaleFactor": 2, "width": 320, "height": 200, "mobile": False}

    def change(page: Any) -> None:
        session = page.context.new_cdp_session(page)
        session.send("Emulation.setDeviceMetricsOverride", zoom)

    first, second, _ = page_after(file, change)
    assert first.is_closed() and second is not first
    with pytest.raises(ZeroDivisionError), offline_page(file, **OWN) as watched:
        raise ZeroDivisionError
    assert watched.page.is_closed()


def test_two_pages_at_a_time_are_two(file):
    with kept_page(**OWN) as one, kept_page(**OWN) as other:
        assert one.page is not other.page


def test_each_test_has_the_size_that_it_asks_for(file):
    sizes = [{"viewport": {"width": 300, "height": 200}}, {}, {"viewport": OWN["viewport"]}]
    found = []
    for size in sizes:
        with offline_page(file, locale="it-IT", **size) as watched:
            found.append(watched.page.evaluate("() => [innerWidth, innerHeight]"))
    assert found == [[300, 200], [1280, 720], [320, 200]]
