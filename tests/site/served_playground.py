"""The playground's pages on a server of this machine, and contexts that watch them."""

from __future__ import annotations

import functools
import http.server
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pytest

from tests.browser import BrowserUnavailableError, browser
from tests.kept_page import is_of_the_driver

SLOW_MS: Final = 120_000
NAMES: Final = ["melting", "raymarcher", "sdfray_row"]
KEEP_FRAMES: Final = ["coral", "spectrum"]
DESK: Final = {"viewport": {"width": 1180, "height": 640}}


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A server of files that writes no log."""

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder; gives its address."""
    handler = functools.partial(Quiet, directory=str(folder.parent))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/{folder.name}/"
    server.shutdown()
    server.server_close()


@contextmanager
def context(origin: str, **options: Any) -> Iterator[Any]:
    """A browser's context; what it asks for elsewhere, and what it complains of, is a fault."""
    try:
        made = browser().new_context(reduced_motion="reduce", **{**DESK, **options})
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
    messages: list[str] = []
    asked: list[str] = []
    made.on("console", lambda said: messages.append(f"{said.type}: {said.text}"))
    made.on("weberror", lambda thrown: messages.append(f"error: {thrown.error}"))
    made.on("request", lambda request: asked.append(request.url))
    try:
        yield made
        complaints = [m for m in messages if m.startswith(("error", "warning"))]
        assert [m for m in complaints if not is_of_the_driver(m)] == []
        assert [u for u in asked if not u.startswith((origin, "blob:", "data:"))] == []
    finally:
        made.close()
