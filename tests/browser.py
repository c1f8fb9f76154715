"""A real browser for tests: headless Chromium on SwiftShader, with no way out to a network.

What flows in: files. What flows out: playwright's browser, and pages that remember what they said
and what they asked for. Where there is no browser, a test skips aloud on the error raised here.
"""

from __future__ import annotations

import atexit
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

FLAGS = (
    *("--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--use-angle=swiftshader"),
    "--enable-unsafe-swiftshader",
)


class BrowserUnavailableError(RuntimeError):
    """No browser on this machine; a test skips aloud on it."""


@cache
def browser() -> Any:
    """The process's one Chromium.

    Raises:
        BrowserUnavailableError: Chromium or playwright is missing.
    """
    path = shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        raise BrowserUnavailableError("chromium is not installed")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise BrowserUnavailableError("playwright is not installed") from None
    driver = sync_playwright().start()
    running = driver.chromium.launch(executable_path=path, headless=True, args=list(FLAGS))
    atexit.register(driver.stop)
    atexit.register(running.close)
    return running


@dataclass
class Watched:
    """A page, what it wrote to the console, and what it asked for besides itself."""

    page: Any
    messages: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@contextmanager
def offline_page(path: Path, **options: Any) -> Iterator[Watched]:
    """A file opened in a page of its own; anything it asks for over a network fails."""
    context = browser().new_context(offline=True, **options)
    try:
        watched = Watched(context.new_page())
        address = path.resolve().as_uri()
        watched.page.on("console", lambda m: watched.messages.append(f"{m.type}: {m.text}"))
        watched.page.on("pageerror", lambda e: watched.messages.append(f"error: {e}"))
        watched.page.on(
            "request",
            lambda r: (
                watched.requests.append(r.url)
                if r.url.split("#")[0] != address and not r.url.startswith(("data:", "blob:"))
                else None
            ),
        )
        watched.page.goto(address)
        yield watched
    finally:
        context.close()
