"""The QR code of a link: a decoder that is not the studio's reads it from the page's picture."""

from __future__ import annotations

import io
import random
import shutil
import string
import subprocess
from pathlib import Path

import pytest
from PIL import Image

from tests.editor.studio_page import studio

pytest.importorskip("websockets")

WEB = Path(__file__).parents[2] / "web"
DECODE = """
const { readFileSync } = require("node:fs");
const found = require("jsqr")(new Uint8ClampedArray(readFileSync(process.argv[1])), %d, %d);
process.stdout.write(found ? found.data : "nothing is read");
"""
LONGEST = 2000  # as LONGEST_CODE in share_sheet.ts


@pytest.fixture(scope="module", autouse=True)
def _decoder():
    if shutil.which("node") is None or not (WEB / "node_modules" / "jsqr").exists():
        pytest.skip("jsqr is not installed: run `npm ci` in web/")


def decoded(page, folder: Path) -> str:
    """Return the text of the QR code in a picture of the whole page."""
    with Image.open(io.BytesIO(page.screenshot())) as shot:
        pixels = shot.convert("RGBA")
    file = folder / "pixels"
    file.write_bytes(pixels.tobytes())
    command = ["node", "-e", DECODE % pixels.size, str(file)]
    return subprocess.run(command, cwd=WEB, check=True, capture_output=True, text=True).stdout


def link_of(page) -> str:
    return page.locator("dialog input[type=text]").input_value()


def open_sheet(page) -> None:
    page.evaluate("() => studio.sharing.share()")
    page.locator("dialog .code").wait_for()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_its_code_is_the_link(tmp_path, scheme):
    with studio(tmp_path, color_scheme=scheme) as app:
        open_sheet(app.page)
        plain = link_of(app.page)
        assert "#c=" in plain
        assert decoded(app.page, tmp_path) == plain
        app.page.get_by_label("With the sliders' values").check()
        full = link_of(app.page)
        assert len(full) > len(plain)
        assert decoded(app.page, tmp_path) == full
        app.page.get_by_label("As a frame").check()
        assert decoded(app.page, tmp_path) == full


def test_a_link_that_is_too_long_has_a_sentence(tmp_path):
    letters = random.Random(7).choices(string.ascii_letters + string.digits, k=1850)
    with studio(tmp_path, viewport={"width": 1180, "height": 800}) as app:
        page = app.page
        page.evaluate("(t) => studio.texts.set('scene.py', '# ' + t)", "".join(letters))
        open_sheet(page)
        assert 0.85 * LONGEST < len(link_of(page)) <= LONGEST
        assert decoded(page, tmp_path) == link_of(page)
        page.keyboard.press("Escape")
        page.evaluate(
            "(t) => studio.texts.set('scene.py', '# ' + t)",
            "".join(random.Random(8).choices(string.ascii_letters, k=3000)),
        )
        open_sheet(page)
        assert len(link_of(page)) > LONGEST
        assert not page.locator("dialog .code svg").count()
        assert page.locator("dialog .code").inner_text() == (
            "No QR code: a phone's camera reads at most 2,000 characters. Copy the link."
        )
