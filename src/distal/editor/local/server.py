"""The server of ``distal studio``: the app's few files, and a socket for each tab.

Input: the files to edit. Output: an address on this machine. It never runs the author's code; each
tab has a worker in a process of its own. Uses ``websockets``.
"""

from __future__ import annotations

import contextlib
import json
import secrets
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from urllib.parse import unquote, urlsplit

from distal.diagnostics import LoadError
from distal.editor.local.early import EarlyWorker
from distal.editor.local.files import SceneFiles
from distal.editor.local.guard import HOST, Guard
from distal.editor.local.tab import CODE_S, StudioTab
from distal.editor.messages import LONGEST_MESSAGE, Changed, encoded
from distal.loading import gallery
from distal.packages import imported
from distal.version import __version__

APP: Final = Path(__file__).parent.parent / "app"
_TYPES: Final = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}
_MOST_TABS: Final = 8
_LOOK_S: Final = 0.3  # how often files are looked at that other programs may change

_USED: Final = (
    "This address was used already. Open the page in the browser that has it, or start "
    "'distal studio' once more.\n"
)


@dataclass(frozen=True, slots=True)
class HttpReply:
    """What a request gets."""

    status: int
    body: bytes
    media_type: str = "text/plain"
    more: tuple[tuple[str, str], ...] = ()


class StudioServer:
    """Serves the app until ``close``.

    Args:
        files: The files to edit.
        port: The port; 0 for any that is free.
        limit: Seconds that the author's code has.
        early: A worker for the first tab.

    Raises:
        PackageError: ``websockets`` is not installed.
        OSError: The port is taken.
    """

    def __init__(
        self,
        files: SceneFiles,
        port: int = 0,
        limit: float = CODE_S,
        early: EarlyWorker | None = None,
    ) -> None:
        self._files, self._limit, self._early = files, limit, early
        self._http11 = imported("websockets.http11")
        self._headers = imported("websockets.datastructures").Headers
        self._closed: type[Exception] = imported("websockets.exceptions").ConnectionClosed
        self._tabs: dict[Any, StudioTab | None] = {}
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._server = imported("websockets.sync.server").serve(
            self._talk,
            HOST,
            port,
            process_request=self._answered,
            compression=None,
            max_size=LONGEST_MESSAGE,
            server_header=None,
            ping_interval=None,
        )
        self._guard = Guard(self._server.socket.getsockname()[1])
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """An address for one browser."""
        return self._guard.address()

    def serve(self) -> None:
        """Look at the files until ``close``; sockets are answered by threads."""
        self._look_at_files()

    def close(self) -> None:
        """End all workers, and the server."""
        self._over.set()
        with self._lock:
            tabs = list(self._tabs.values())
        for session in tabs:
            if session is not None:
                session.end()
        if self._early is not None:
            self._early.end()
        self._server.shutdown()

    # Sockets

    def _talk(self, connection: Any) -> None:
        def send(text: str) -> None:
            with contextlib.suppress(self._closed):  # the tab is gone: the loop below ends
                connection.send(text)

        with self._lock:
            self._tabs[connection] = None  # from now on it gets what changes
        send(encoded(self._files.all()))
        early, self._early = self._early, None
        session = StudioTab(
            self._files, send, self._limit, lambda saved: self._tell(saved, connection), early
        )
        with self._lock:
            self._tabs[connection] = session
        try:
            for text in connection:
                session.received(text)
        except self._closed:
            pass
        finally:
            with self._lock:
                del self._tabs[connection]
            session.end()

    def _look_at_files(self) -> None:
        """Tell all tabs what other programs have changed."""
        while not self._over.wait(_LOOK_S):
            try:
                changed = self._files.read()
            except LoadError:
                continue  # while it is written; or gone: the app still has the text
            if changed is not None:
                self._tell(changed)

    def _tell(self, changed: Changed, source: Any = None) -> None:
        with self._lock:
            tabs = [connection for connection in self._tabs if connection is not source]
        for connection in tabs:
            try:
                connection.send(encoded(changed))
            except self._closed:
                continue

    # Files of the app

    def _answered(self, connection: Any, request: Any) -> Any:
        """Answer a request for a file; None lets a socket open."""
        path = urlsplit(request.path).path
        is_socket = path == "/socket"
        if not self._guard.is_ours(request.headers, needs_origin=is_socket):
            return self._response(HttpReply(403, b"This server answers its own pages only.\n"))
        if not self._guard.knows(request.headers):
            cookie = self._guard.welcomed(request.path) if path == "/" else None
            if cookie is None:
                return self._response(HttpReply(403, _USED.encode()))
            more = (("Set-Cookie", cookie), ("Location", "/"))
            return self._response(HttpReply(303, b"", more=more))
        if is_socket:
            if len(self._tabs) >= _MOST_TABS:
                return self._response(HttpReply(503, b"Too many tabs are open: close one.\n"))
            return None
        return self._response(self._file(path))

    def _file(self, path: str) -> HttpReply:
        if path == "/":
            return self._page()
        if path.startswith("/gallery/"):
            return self._example(unquote(path.removeprefix("/gallery/")).removesuffix(".json"))
        name = path.removeprefix("/")
        if name in ("studio.js", "studio.css"):
            return HttpReply(200, (APP / name).read_bytes(), _TYPES[Path(name).suffix])
        return HttpReply(404, b"There is no such page.\n")

    def _page(self) -> HttpReply:
        nonce = secrets.token_urlsafe(16)
        settings = {
            "main": self._files.main,
            "folder": str(self._files.folder),
            "isNew": self._files.is_new,
            "gallery": examples(),
            "nonce": nonce,
            "version": __version__,
        }
        text = (APP / "studio.html").read_text(encoding="utf-8")
        # Inside of a script, only "<" could end it.
        filled = json.dumps(settings).replace("<", "\\u003c")
        body = text.replace("{nonce}", nonce).replace("{settings}", filled).encode()
        sources = f"'self' ws://{self._guard.authority}"
        policy = (
            f"default-src 'none'; script-src 'self' 'nonce-{nonce}'; style-src 'self' "
            f"'nonce-{nonce}'; img-src 'self' data: blob:; connect-src {sources}; "
            "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
        )
        return HttpReply(200, body, "text/html", (("Content-Security-Policy", policy),))

    def _example(self, name: str) -> HttpReply:
        path = gallery().get(name)
        if path is None:
            return HttpReply(404, b"There is no such example.\n")
        files = SceneFiles(path)
        body = json.dumps({"main": files.main, "files": files.all().files}).encode()
        return HttpReply(200, body, "application/json")

    def _response(self, reply: HttpReply) -> Any:
        headers = self._headers(
            [
                ("Content-Type", f"{reply.media_type}; charset=utf-8"),
                ("Content-Length", str(len(reply.body))),
                ("Cache-Control", "no-store"),
                ("X-Content-Type-Options", "nosniff"),
                ("Referrer-Policy", "no-referrer"),
                ("Cross-Origin-Resource-Policy", "same-origin"),
                ("Connection", "close"),
                *reply.more,
            ]
        )
        return self._http11.Response(reply.status, _PHRASES[reply.status], headers, reply.body)


_PHRASES: Final = {
    **{200: "OK", 303: "See Other", 403: "Forbidden", 404: "Not Found"},
    503: "Service Unavailable",
}


def examples() -> list[dict[str, str]]:
    """Return the names of the gallery, and what each shows: the first line of its docstring."""
    return [{"name": n, "title": _first_line(path)} for n, path in gallery().items()]


def _first_line(path: Path) -> str:
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith('"""'):
            return line.strip('"').strip()
    return ""
