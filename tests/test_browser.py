"""The browser of the tests hears what a page says, and lets nothing out."""

from __future__ import annotations

import pytest

from tests.browser import BrowserUnavailableError, offline_page

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
