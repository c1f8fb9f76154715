"""JupyterLab in Chromium: the last line of a cell is live, a drag turns it, a mesh turns."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

pytest.importorskip("anywidget", reason="anywidget is not installed")

import distal
from tests.browser import BrowserUnavailableError, browser
from tests.notebook.jupyter_lab import LabUnavailableError, laboratory

SCENE = """\
from distal import *
blue_egg = Scene(Sphere(0.5) | Box(1.6, 0.2, 0.2).paint("tomato"),
                 camera=Camera((0, 0, 3)), floor=False)
blue_egg"""
MESH = "(Box(1.0) - Sphere(0.6)).mesh(tolerance=0.02)"
SEEN = 3.0  # of 255: the mean difference of two pictures that a person sees as different
WAIT_MS = 120_000
OUTPUT = ".jp-OutputArea-output"
# A cell that is run before the kernel has started waits for ever.
_READY = """() => {
  const shown = window.jupyterapp?.shell?.currentWidget;
  return shown?.context?.isReady && shown.sessionContext?.session?.kernel?.status === "idle";
}"""
# Not awaited: it ends when all cells have run.
_RUN = "() => { void window.jupyterapp.commands.execute('notebook:run-all-cells'); }"
_TAKE_COPIES = """() => {
  navigator.clipboard.writeText = async (text) => { window.copied = text; };
}"""


@pytest.fixture(scope="module")
def cells(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The page of a notebook whose two cells have run."""
    folder = tmp_path_factory.mktemp("lab")
    try:
        running = browser()
        with laboratory(folder, [SCENE, MESH]) as address:
            context = running.new_context(viewport={"width": 1200, "height": 900})
            page = context.new_page()
            page.set_default_timeout(WAIT_MS)
            page.goto(address)
            page.wait_for_selector(".jp-Notebook .jp-Cell")
            page.wait_for_function(_READY)
            page.evaluate(_RUN)
            page.wait_for_selector(f"{OUTPUT} canvas")
            page.wait_for_selector(f"{OUTPUT} iframe")
            yield page
            context.close()
    except (BrowserUnavailableError, LabUnavailableError) as missing:
        pytest.skip(f"JupyterLab is not opened: {missing}")


def picture(element: Any) -> NDArray[np.float64]:
    """What is on the screen of an element."""
    return np.asarray(Image.open(io.BytesIO(element.screenshot())).convert("RGB"), float)


def until(
    page: Any, element: Any, holds: Callable[[NDArray[np.float64]], Any]
) -> NDArray[np.float64]:
    """Return the first picture of an element for which something holds."""
    for _ in range(60):
        shown = picture(element)
        if holds(shown):
            return shown
        page.wait_for_timeout(500)
    raise AssertionError("the picture did not become what is expected of it in 30 s")


def test_the_last_line_is_live_and_a_drag_turns_it(cells: Any) -> None:
    canvas = cells.locator(f"{OUTPUT} canvas").first
    canvas.scroll_into_view_if_needed()
    # The bar is tomato: it is seen once the scene is compiled and drawn.
    before = until(cells, canvas, lambda shown: (shown[..., 0] - shown[..., 2]).max() > 60.0)
    box = canvas.bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"]
    cells.mouse.move(x, y)
    cells.mouse.down()
    cells.mouse.move(x + 60, y + 10, steps=3)
    cells.mouse.up()
    until(cells, canvas, lambda shown: np.abs(shown - before).mean() > SEEN)


def test_it_has_the_title_of_its_variable_and_code_that_runs(cells: Any) -> None:
    host = cells.locator("[data-distal]").first
    shown = host.evaluate("(host) => host.shadowRoot.textContent")
    assert "blue egg" in shown
    assert not re.search(r"\d{6,}", shown), "no number of a file that the kernel made"
    cells.evaluate(_TAKE_COPIES)
    host.get_by_role("button", name="Copy as code").click()
    cells.wait_for_function("window.copied")
    code = cells.evaluate("window.copied")
    names: dict[str, Any] = {}
    exec(SCENE, names)  # as the cell above did
    assert code.startswith("import distal; blue_egg.render(")
    exec(code.replace("blue_egg.render", "made = blue_egg.render"), names)
    assert isinstance(names["made"], distal.Picture)


def test_a_mesh_turns_by_itself(cells: Any) -> None:
    frame = cells.locator(f"{OUTPUT} iframe").first
    frame.scroll_into_view_if_needed()
    before = until(cells, frame, lambda shown: shown.std() > SEEN)
    until(cells, frame, lambda shown: np.abs(shown - before).mean() > SEEN / 3.0)
