"""A real browser for tests: headless Chromium that draws in software, with no way to a network.

Input: files. Output: playwright's browser, and pages that remember what they said
and what they asked for; how one page serves many tests is described in ``tests.kept_page``. Where
there is no browser, a test skips aloud on the error raised here; one that is there and does not
start is a fault. Knows nothing of WebGL: that is ``tests.webgl``.
"""

from __future__ import annotations

import atexit
import contextlib
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final

from tests.kept_page import KeptPage, key_of

NAMES: Final = ("chromium", "chromium-browser", "google-chrome")
# SwiftShader is asked for by name, for the same pixels on a machine with a GPU. The resolver finds
# no host but this machine: whatever Chromium itself wants to ask, it asks nobody. Pages are put
# together without WebGL's driver, which in software needs three times as long for that. A watchdog
# that ends a slow process of the driver, with every context in it, would judge the machine's load.
FLAGS: Final = (
    "--disable-gpu-watchdog",
    "--disable-gpu-compositing",
    *("--no-sandbox", "--no-first-run", "--disable-quic", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost, EXCLUDE 127.0.0.1",
)
# WebGL on the machine's OpenGL instead: given besides, they win. Mesa's llvmpipe compiles the
# gallery's largest scene in a second and draws it several times as fast as SwiftShader: the studio
# with its first picture takes 5.5 s of the processor on SwiftShader and 3.2 s on llvmpipe.
MESA: Final = ("--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist")
SWIFTSHADER: Final = ("--use-angle=swiftshader",)
_RENDERER: Final = """() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  const name = gl?.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL;
  return name ? gl.getParameter(name) : "";
}"""
START_MS: Final = 30_000  # 1 s alone; other work on the machine may make it ten times that
VIEWPORT: Final = {"width": 1280, "height": 720}  # playwright's own, of a page without options
MOST_KEPT: Final = 3  # each has a renderer process
ACTION_MS: Final = 20_000  # playwright's own limit for one step, unless a test says otherwise


class BrowserUnavailableError(RuntimeError):
    """No browser on this machine; a test skips aloud on it."""


_running: dict[tuple[str, ...], Any] = {}
_kept: dict[tuple[str, ...], KeptPage] = {}  # that nobody has, the one that waits longest first


def browser(*flags: str) -> Any:
    """The process's one Chromium, or its one with these flags besides ``FLAGS``.

    Without flags it draws by llvmpipe, or by SwiftShader on a machine without llvmpipe: a test that
    means one of them gives ``MESA`` or ``SWIFTSHADER``. Started when first asked for and again
    after a crash, with a user data folder of its own; closed when the process ends. playwright
    refuses to run inside an asyncio loop.

    Raises:
        BrowserUnavailableError: Chromium or playwright is missing.
    """
    chosen = flags or (MESA if _has_llvmpipe() else SWIFTSHADER)
    known = _running.get(chosen)
    if known is None or not known.is_connected():
        known = _running[chosen] = _start(chosen)
    return known


@contextmanager
def kept_page(*flags: str, **options: Any) -> Iterator[KeptPage]:
    """A context and its page, which other tests have had before or will have after this one.

    Whoever had it, it is as a new one (``tests.kept_page``); after a fault it is closed.

    Args:
        flags: As for ``browser``.
        options: Those of playwright's ``new_context``: ``viewport``, ``device_scale_factor``,
            ``has_touch``, ``reduced_motion``, ``color_scheme``, …

    Raises:
        BrowserUnavailableError: Chromium or playwright is missing.
    """
    running = browser(*flags)
    key = (*flags, key_of(options))
    kept = _kept.pop(key, None)
    if kept is None or not kept.serves(running):
        kept = KeptPage(running, ACTION_MS, options)
    is_renewed = False
    try:
        kept.begin(options.get("viewport", VIEWPORT))
        yield kept
        with contextlib.suppress(Exception):  # the page or its browser is gone, or does not answer
            is_renewed = kept.is_renewed()
    finally:
        others = [_kept.pop(key)] if key in _kept else []
        if is_renewed:
            _kept[key] = kept
            others += [_kept.pop(next(iter(_kept))) for _ in range(len(_kept) - MOST_KEPT)]
        for other in others if is_renewed else [kept, *others]:
            _close(other)


@contextmanager
def offline_page(path: Path, *, flags: Sequence[str] = (), **options: Any) -> Iterator[Watched]:
    """A file opened in a page; anything it asks for over a network fails.

    ``flags`` start another Chromium with them: ``--disable-3d-apis`` is one without WebGL. Options
    as for ``kept_page``.

    Raises:
        BrowserUnavailableError: Chromium or playwright is missing.
    """
    address = path.resolve().as_uri()
    with kept_page(*flags, offline=True, **options) as kept:
        kept.page.goto(address)
        yield Watched(kept.page, kept.messages, kept.asked, address)


@dataclass
class Watched:
    """A page, what it said, and what it asked for besides itself.

    playwright tells what happened whenever it is called: after an idle page, call ``settle``.

    Attributes:
        page: playwright's page.
        messages: Lines of the console such as ``warning: …``, and ``error: …`` of what was thrown.
        asked: Addresses that it asked for, its own among them.
        address: Its own.
    """

    page: Any
    messages: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)
    address: str = ""

    @property
    def requests(self) -> list[str]:
        """Addresses besides the page's own, ``data:`` and ``blob:``."""
        own = self.address.split("#")[0]
        others = (url for url in self.asked if url.split("#")[0] != own)
        return [url for url in others if not url.startswith(("data:", "blob:"))]

    @property
    def complaints(self) -> list[str]:
        """Errors and warnings alone."""
        return [line for line in self.messages if line.startswith(("error:", "warning:"))]

    def settle(self, wait_ms: float = 50.0) -> None:
        """Let the page go on for a while, and hear what it has to say."""
        self.page.wait_for_timeout(wait_ms)


@cache
def _has_llvmpipe() -> bool:
    """Whether Chromium with ``MESA`` draws WebGL by llvmpipe, not by a GPU and not at all."""
    page = browser(*MESA).new_page()
    try:
        return "llvmpipe" in page.evaluate(_RENDERER)
    finally:
        page.close()


@cache
def _driver() -> Any:
    try:
        from playwright.sync_api import sync_playwright  # noqa: PLC0415 (optional)
    except ImportError:
        raise BrowserUnavailableError("playwright is not installed") from None
    driver = sync_playwright().start()
    atexit.register(driver.stop)
    return driver


def _start(flags: tuple[str, ...]) -> Any:
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        raise BrowserUnavailableError("chromium is not installed")
    launch = _driver().chromium.launch
    options = {"executable_path": path, "headless": True, "args": [*FLAGS, *flags]}
    try:
        running = launch(**options, timeout=START_MS)
    except Exception:  # a loaded machine; playwright makes a new user data folder each time
        running = launch(**options, timeout=2 * START_MS)
    atexit.register(_close, running)
    return running


def _close(running: Any) -> None:
    with contextlib.suppress(Exception):  # already gone: there is nothing left to close
        running.close()
