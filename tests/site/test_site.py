"""The site: links lead somewhere, blocks can be tried, the search finds, pages are accessible."""

from __future__ import annotations

import html
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest

from distal.editor.links import shared_by
from tests.accessibility import needs_axe, violations
from tests.browser import BrowserUnavailableError, offline_page
from tests.made_once import made_once

ROOT = Path(__file__).parents[2]
LINK = re.compile(r'(?:href|src)="([^"]+)"')
SCRIPT = re.compile(r"<script.*?</script>", re.DOTALL)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """The site with few scenes and lessons, and without the playground."""
    current = tmp_path_factory.mktemp("current")

    def build(folder: Path) -> None:
        few = ("--examples", "bunny,melting", "--lessons", "1,6", "--no-playground")
        words = [sys.executable, ROOT / "tools" / "build_site.py", folder / "site", *few]
        subprocess.run(words, cwd=current, check=True, timeout=600)
        left = sorted(path.name for path in current.iterdir())
        assert left == [], f"blocks of the documents were run in the current folder: {left}"

    return made_once(tmp_path_factory, "few-pages", build) / "site"


def links_of(page: Path):
    text = SCRIPT.sub("", page.read_text(encoding="utf-8"))
    return [html.unescape(found) for found in LINK.findall(text)]


def test_every_link_leads_somewhere(site):
    ids = {
        page.resolve(): set(re.findall(r'\bid="([^"]+)"', page.read_text(encoding="utf-8")))
        for page in site.rglob("*.html")
    }
    lost, count = [], 0
    for page in site.rglob("*.html"):
        for address in links_of(page):
            if re.match(r"(https?|data|blob|mailto):", address):
                continue
            path, _, anchor = address.partition("#")
            target = (page.parent / unquote(path)).resolve() if path else page.resolve()
            count += 1
            if target.is_relative_to(site.resolve() / "playground"):
                assert target.name == "index.html"
                continue
            is_lost = not target.exists() or (anchor and anchor not in ids.get(target, {anchor}))
            if is_lost or not target.is_relative_to(site.resolve()):
                lost.append((page.relative_to(site).as_posix(), address))
    assert lost == []
    assert count > 500


def test_nothing_is_asked_for_elsewhere(site):
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r'(src|<link[^>]*href)="(https?:)?//', text), page.name


def test_blocks_and_shapes_open_in_the_playground(site):
    guides = (site / "docs/guide").glob("*.html")
    tried = [address for page in guides for address in links_of(page) if "#c=" in address]
    assert len(tried) > 8
    for address in tried:
        shared = shared_by(address[address.index("#c=") :])
        assert "numpy" not in shared["files"][shared["main"]]
    shapes = [a for a in links_of(site / "docs/reference/catalogue.html") if "#c=" in a]
    assert len(shapes) > 100
    first = shared_by(shapes[0][shapes[0].index("#c=") :])
    assert re.fullmatch(r"from distal import (\w+)\n\nshape = \1\(\)\n", first["files"]["scene.py"])


def test_a_folder_that_is_no_site_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    words = [sys.executable, ROOT / "tools" / "build_site.py", tmp_path]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "holds something else" in done.stderr
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_the_search_finds_and_keys_move_through_it(site):
    try:
        with offline_page(site / "docs/guide/scenes.html") as watched:
            page = watched.page
            page.get_by_label("Search").fill("bunny")
            page.locator(".hits a").first.wait_for()
            assert page.locator(".hits a").first.inner_text().startswith("bunny")
            page.keyboard.press("ArrowDown")
            page.keyboard.press("Enter")
            page.wait_for_url("**/gallery/bunny.html")
            assert watched.complaints == []
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


@needs_axe
@pytest.mark.parametrize(
    "page", ["index.html", "docs/guide/scenes.html", "gallery/index.html", "lessons/index.html"]
)
def test_pages_are_accessible_in_light_and_dark_and_fit_a_phone(site, page):
    size = {"width": 390, "height": 800}
    try:
        with offline_page(site / page, viewport=size, bypass_csp=True) as seen:
            assert violations(seen.page) == []
            assert seen.page.evaluate("() => document.documentElement.scrollWidth") <= size["width"]
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
