"""A page measures its driver's sine and the like once, and draws with those that are good.

Programs here paint which macros the player defined, so that its decision is seen. What is right is
measured beside it, by ``tests.webgl``, at other angles.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distal.compiler.driver import compile
from distal.lang import Frame, acos, asin, cos, image, sin, vec4
from tests import webgl
from tests.browser import MESA, SWIFTSHADER, BrowserUnavailableError, browser, offline_page
from tests.page import player_pages as pages
from tests.page.player_pages import payload, program
from tests.parity.trusting import trusting

NAMES = ("sin", "cos", "asin", "acos")
TRUST = {name: f"TRUST_{name.upper()}" for name in NAMES}
MOST = 1e-5  # what a page accepts
DRIVERS = {"swiftshader": SWIFTSHADER, "mesa": MESA}
SIZE = {"width": 160, "height": 120}
# Every text that a driver is given.
SPY = """window.texts = [];
const give = WebGL2RenderingContext.prototype.shaderSource;
WebGL2RenderingContext.prototype.shaderSource = function (shader, text) {
  texts.push(text);
  give.call(this, shader, text);
};"""
CHOSEN = "void main() { fragment_color = vec4(0.0, 1.0, 0.0, 1.0); }\n"
PLAYER = "document.querySelector('[data-distal]').distal"


@pytest.fixture(autouse=True, scope="module")
def _needs_browser() -> None:
    try:
        browser()
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


@contextmanager
def opened(path: Path, *programs: Any, driver: str = "mesa", before: str = "") -> Iterator[Any]:
    file = pages.write(path / "page.html", payload(*programs))
    script = f"<body><script>{SPY}{before}</script>"
    file.write_text(file.read_text().replace("<body>", script))
    with offline_page(file, flags=DRIVERS[driver], viewport=SIZE) as watched:
        watched.page.evaluate(f"{PLAYER}.settled()")
        yield watched.page
        assert watched.complaints == [] and watched.requests == []


def measurements(page: Any) -> int:
    return sum("floatBitsToUint" in text for text in page.evaluate("texts"))


def defined(page: Any) -> set[str]:
    """What the last scene's text has defined."""
    text = page.evaluate("texts")[-1]
    return {name for name, macro in TRUST.items() if f"#define {macro}\n" in text}


@image
def curves(frame: Frame) -> vec4:
    """Row 0: sine, cosine, 200 units wide; row 1: the arcs, from -1 to 1."""
    at = frame.coord.x / frame.resolution.x * 2.0 - 1.0
    if frame.coord.y < 1.0:
        return vec4(sin(at * 100.0), cos(at * 100.0), 0.0, 0.0)
    return vec4(asin(at), acos(at), 0.0, 0.0)


def errors(driver: str) -> dict[str, float]:
    """How far the driver's own are off."""
    width = 4096
    text = trusting(compile(curves, "glsl-es300"), NAMES)
    upper, lower = webgl.run_webgl(text, (width, 2), driver=driver)
    at = (np.arange(width) + 0.5) / width * 2.0 - 1.0  # exact in 32 bits, as is 100 times it
    wide = at * 100.0
    off = {
        "sin": lower[:, 0] - np.sin(wide),
        "cos": lower[:, 1] - np.cos(wide),
        "asin": upper[:, 0] - np.arcsin(at),
        "acos": upper[:, 1] - np.arccos(at),
    }
    return {name: float(np.max(np.abs(values))) for name, values in off.items()}


@pytest.mark.parametrize("driver", DRIVERS)
def test_what_is_good_is_trusted(tmp_path: Path, driver: str) -> None:
    found = errors(driver)
    with opened(tmp_path, program(CHOSEN, trust=TRUST), driver=driver) as page:
        trusted = defined(page)
    # Close to the limit the other angles may decide.
    clear = {name for name, error in found.items() if not MOST / 2 < error < MOST * 2}
    assert trusted & clear == {name for name in clear if found[name] < MOST}, found
    assert len(clear) >= 3, found
    assert ("sin" in trusted) == (driver == "mesa"), found


def test_it_is_measured_once_and_only_where_it_matters(tmp_path: Path) -> None:
    plain = program(CHOSEN)
    some = program(CHOSEN, trust={"cos": "TRUST_COS"})
    whole = program(CHOSEN + "// another\n", trust=TRUST)
    with opened(tmp_path, plain, some, whole) as page:
        assert measurements(page) == 0 and "#define" not in page.evaluate("texts")[-1]
        page.evaluate(f"{PLAYER}.setView('normal')")
        page.evaluate(f"{PLAYER}.settled()")
        assert measurements(page) == 1 and defined(page) == {"cos"}
        page.evaluate(f"{PLAYER}.setView('depth')")
        page.evaluate(f"{PLAYER}.settled()")
        assert measurements(page) == 1 and {"sin", "cos"} <= defined(page)


def test_each_function_is_judged_by_itself(tmp_path: Path) -> None:
    # For the page the cosine is another at a single angle, and an arc no number at one.
    before = """const { cos, asin } = Math;
Math.cos = (x) => cos(x) + (x === 0.390625 ? 2e-5 : 0);
Math.asin = (x) => (x === 0.390625 ? NaN : asin(x));"""
    with opened(tmp_path, program(CHOSEN, trust=TRUST), before=before) as page:
        assert "sin" in defined(page) and not {"cos", "asin"} & defined(page)


def test_after_a_lost_context_the_driver_is_measured_anew(tmp_path: Path) -> None:
    with opened(tmp_path, program(CHOSEN, trust=TRUST)) as page:
        page.evaluate(
            "() => { const c = document.querySelector('[data-distal]').shadowRoot"
            ".querySelector('canvas'); window.lose = c.getContext('webgl2')"
            ".getExtension('WEBGL_lose_context'); window.lose.loseContext() }"
        )
        page.get_by_role("alert").wait_for()
        page.evaluate("window.lose.restoreContext()")
        page.get_by_role("alert").wait_for(state="detached")
        page.evaluate(f"{PLAYER}.settled()")
        assert measurements(page) == 2 and "sin" in defined(page)


def test_a_driver_that_cannot_be_measured_is_not_trusted(tmp_path: Path) -> None:
    before = """const link = WebGL2RenderingContext.prototype.getProgramParameter;
WebGL2RenderingContext.prototype.getProgramParameter = function (program, what) {
  const isMeasure = texts.at(-1).includes("floatBitsToUint");
  return isMeasure && what === this.LINK_STATUS ? false : link.call(this, program, what);
};"""
    with opened(tmp_path, program(CHOSEN, trust=TRUST), before=before) as page:
        assert measurements(page) == 1 and defined(page) == set()


def test_an_error_is_on_the_same_line_with_and_without_macros(tmp_path: Path) -> None:
    bad = program("void main() { fragment_color = vec4(nothing); }\n", trust=TRUST)
    bad["lines"] = [[5, 5, 0, 42], *([n, n, 0, n] for n in (4, 6, 7, 8, 9, 10))]
    file = pages.write(tmp_path / "page.html", payload(bad))
    for flags in DRIVERS.values():
        with offline_page(file, flags=flags, viewport={"width": 700, "height": 400}) as watched:
            notice = watched.page.get_by_role("alert")
            notice.wait_for()
            assert "scene.py:42" in notice.locator("p").inner_text()


def test_the_picture_is_drawn_by_the_text_that_was_chosen(tmp_path: Path) -> None:
    body = (
        "void main() {\n#ifdef TRUST_SIN\nfragment_color = vec4(0.0, 1.0, 0.0, 1.0);\n"
        "#else\nfragment_color = vec4(1.0, 0.0, 0.0, 1.0);\n#endif\n}\n"
    )
    for driver, color in (("mesa", (0, 255, 0)), ("swiftshader", (255, 0, 0))):
        with opened(tmp_path, program(body, trust=TRUST), driver=driver) as page:
            read = """async (player) => {
              const blob = await player.screenshot();
              const bitmap = await createImageBitmap(blob);
              const board = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
              board.drawImage(bitmap, 0, 0);
              return [...board.getImageData(5, 5, 1, 1).data].slice(0, 3);
            }"""
            shown = page.evaluate(f"() => ({read})({PLAYER})")
            assert tuple(shown) == color, driver
