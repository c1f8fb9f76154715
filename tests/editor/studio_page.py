"""The studio in a browser, for tests: a server, a page, and what is asked of it."""

from __future__ import annotations

import re
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from distal.editor.local.files import SceneFiles
from distal.editor.local.server import StudioServer
from distal.loading import load
from distal.scene.viewing.viewable import viewable
from tests.browser import BrowserUnavailableError, Watched, kept_page
from tests.page.looking import Looked

SLOW_MS = 90_000  # software WebGL on a loaded machine
LIMIT_S = 60.0  # for the scene's code: nothing is ended because the machine is busy
DESK = {"viewport": {"width": 1180, "height": 640}}

SCENE = '''"""A ball and a box."""

from distal import *
from distal.lang import slider

size = slider("Size", 0.6, 0.1, 1.0)
ball = Sphere(size).paint("#d97757")
box = Box(0.50).translate(0.9, 0.0, 0.0)

scene = Scene(ball | box, lights=DistantLight((1, 2, 3)), background="#123456",
              camera=Camera((1.0, 1.5, 4.0), target=(0.3, 0.0, 0.0)))
'''
PLAYER = "() => document.querySelector('.picture .host')?.distal"
SETTLED = "() => document.querySelector('.picture .host').distal.settled()"
IDLE = "() => /\\d ms$/.test(document.querySelector('.work')?.textContent)"
TEXT = "() => studio.editor.view.state.doc.toString()"


class Shown:
    """The app in a page."""

    def __init__(self, watched: Watched, file: Path) -> None:
        self.watched, self.page, self.file = watched, watched.page, file

    def wait(self, condition: str) -> None:
        try:
            self.page.wait_for_function(condition, timeout=SLOW_MS)
        except PlaywrightTimeoutError as error:
            shown = (".state-bars", ".notice", ".work")
            says = {name: self.page.locator(name).inner_text() for name in shown}
            error.add_note(f"the app says {says}, its mistakes are {self.mistakes!r}")
            raise

    def idle(self) -> None:
        """Until the last text is answered."""
        self.page.wait_for_timeout(200)  # typing ends
        self.wait(IDLE)

    @property
    def text(self) -> str:
        return self.page.evaluate(TEXT)

    @property
    def mistakes(self) -> str:
        return self.page.locator(".mistakes").inner_text()

    def dial(self, literal: str) -> None:
        """Open the dial of the first literal with a text."""
        self.page.locator(".literal", has_text=re.compile(f"^{re.escape(literal)}$")).first.click()
        self.page.locator(".dial").wait_for()

    def turn(self, value: float, steps: int = 4) -> None:
        """Drag the dial's slider to a value, and let go."""
        self.page.locator(".dial input[type=range]").first.evaluate(
            """async (slider, [value, steps]) => {
              const from = slider.valueAsNumber;
              for (let i = 1; i <= steps; i++) {
                slider.value = from + ((value - from) * i) / steps;
                slider.dispatchEvent(new Event("input", { bubbles: true }));
                await new Promise((resolve) => setTimeout(resolve, 30));
              }
              slider.dispatchEvent(new Event("change", { bubbles: true }));
            }""",
            [value, steps],
        )

    def saved(self) -> str:
        """Save; return what the disk has."""
        self.page.evaluate("() => studio.save()")
        return self.file.read_text()

    def equals_the_cpu(self) -> bool:
        """Whether the picture is what the CPU draws of the saved file."""
        self.saved()
        self.page.evaluate(SETTLED)
        found = Looked(self.watched).beside(viewable(load(self.file)))
        return found.is_agreement


@contextmanager
def studio(folder: Path, text: str = SCENE, tabs: int = 1, limit: float = LIMIT_S, **options):
    """The app on a file, in one context of the browser; nothing else may be asked for."""
    file = folder / "scene.py"
    if not file.exists():
        file.write_text(text)
    server = StudioServer(SceneFiles(file), limit=limit)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    try:
        with kept_page(reduced_motion="reduce", **{**DESK, **options}) as kept:
            origin = server.address.split("/#")[0]
            pages = [kept.page, *(kept.context.new_page() for _ in range(1, tabs))]
            made = []
            for page in pages:
                page.goto(origin if made else server.address)
                shown = Shown(Watched(page), file)
                shown.wait(PLAYER)
                shown.wait(IDLE)
                made.append(shown)
            yield made[0] if tabs == 1 else made
            bad = [line for line in kept.messages if line.startswith(("error", "warning"))]
            elsewhere = [
                url
                for url in kept.asked
                if not url.startswith((origin, f"ws{origin[4:]}", "blob:", "data:"))
            ]
            assert not bad, bad
            assert not elsewhere, elsewhere
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    finally:
        server.close()
