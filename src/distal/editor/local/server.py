"""The server of ``distal studio``: the app's few files, and a socket for each tab.

Input: the files to edit. Output: an address on this machine. It never runs the author's code; each
tab has a worker in a process of its own. Uses ``websockets``.
"""

from __future__ import annotations

import json
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final
from urllib.parse import unquote

from distal.editor.local.connection import TabConnection
from distal.editor.local.drafts import Drafts
from distal.editor.local.early import EarlyWorker
from distal.editor.local.files import SceneFiles
from distal.editor.local.renders import CODE_S as RENDER_CODE_S
from distal.editor.local.renders import RenderLimits, RenderQueue
from distal.editor.local.serving import NOT_FOUND, RESULT_S, HttpReply, LocalServer
from distal.editor.local.tab import CODE_S, StudioTab
from distal.editor.messages import Changed, Restarted, encoded
from distal.example_files import all_examples, posters
from distal.version import __version__

APP: Final = Path(__file__).parent.parent / "app"
_TYPES: Final = {".js": "text/javascript", ".css": "text/css", ".html": "text/html"}
_LOOK_S: Final = 0.3  # how often files are looked at that other programs may change


class StudioServer(LocalServer):
    """Serves the app until ``close``.

    Args:
        files: The files to edit.
        port: The port; 0 for any that is free.
        limit: Seconds that the author's code has.
        early: A worker for the first tab.
        renders: The limits of time of renders; None for those of ``RenderLimits``.
        drafts: Where drafts and versions are kept; None for the user's state.

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
        renders: RenderLimits | None = None,
        drafts: Drafts | None = None,
    ) -> None:
        self._files, self._limit, self._early = files, limit, early
        self._drafts = drafts or Drafts.of_user(files.folder)
        files.keep_in(self._drafts)
        self._renders = RenderQueue(
            files.folder, renders or RenderLimits(max(limit, RENDER_CODE_S))
        )
        super().__init__(port)

    def serve(self) -> None:
        """Look at the files until ``close``; sockets are answered by threads."""
        self._look_at_files()

    def close(self) -> None:
        """End all workers, and the server."""
        with self._lock:
            tabs = list(self._tabs.values())
        for session in tabs:
            if session is not None:
                session.end()
        if self._early is not None:
            self._early.end()
        self._renders.close()
        super().close()
        self._drafts.close()

    # Sockets

    def _talk(self, connection: TabConnection) -> None:
        send = connection.send
        send(encoded(self._files.all()))
        early, self._early = self._early, None
        try:
            session = StudioTab(
                self._files,
                send,
                self._limit,
                lambda saved: self._tell(saved, connection),
                early,
                self._renders,
            )
        except OSError as error:  # the app comes again
            send(encoded(Restarted(id=None, reason=f"no worker can be started: {error}")))
            return
        with self._lock:
            self._tabs[connection] = session
        try:
            for text in connection:
                session.received(text)
        finally:
            session.end()

    def _look_at_files(self) -> None:
        """Tell all tabs what other programs have changed."""
        while not self._over.wait(_LOOK_S):
            changed = self._files.read()
            if changed is not None:
                self._tell(changed)

    def _tell(self, changed: Changed, source: Any = None) -> None:
        self._send_all(encoded(changed), source)

    # Files of the app

    def _reply(self, path: str) -> HttpReply:
        if path == "/":
            return self._page()
        if path.startswith("/gallery/"):
            return _of_gallery(unquote(path.removeprefix("/gallery/")))
        if path.startswith("/results/"):
            return self._result(path.removeprefix("/results/"))
        name = path.removeprefix("/")
        if name in ("studio.js", "studio.css"):
            return HttpReply(200, (APP / name).read_bytes(), _TYPES[Path(name).suffix])
        return HttpReply(NOT_FOUND, b"There is no such page.\n")

    def _settings(self) -> Mapping[str, object]:
        return {
            "main": self._files.main,
            "folder": str(self._files.folder),
            "isNew": self._files.is_new,
            "gallery": examples(),
            "version": __version__,
        }

    def _page(self) -> HttpReply:
        nonce = secrets.token_urlsafe(16)
        text = (APP / "studio.html").read_text(encoding="utf-8")
        body = text.replace("{nonce}", nonce).encode()
        policy = (
            f"default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; "
            f"img-src 'self' data: blob:; connect-src 'self' ws://{self._guard.authority}; "
            "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
        )
        return HttpReply(200, body, "text/html", (("Content-Security-Policy", policy),))

    def _result(self, name: str) -> HttpReply:
        folder, _, token = name.partition("/")
        data = self._renders.result(folder, token)
        if data is None:
            return HttpReply(NOT_FOUND, b"This picture is not there any more: render it again.\n")
        return HttpReply(200, data, "application/octet-stream", limit=RESULT_S)


def _of_gallery(file: str) -> HttpReply:
    """Return the texts or the poster of an example: NAME.json or NAME.webp."""
    name, _, kind = file.rpartition(".")
    path = all_examples().get(name)
    poster = posters().get(name)
    if path is not None and kind == "json":
        files = SceneFiles(path)
        body = json.dumps({"main": files.main, "files": files.all().files}).encode()
        return HttpReply(200, body, "application/json")
    if poster is not None and kind == "webp":
        return HttpReply(200, poster.read_bytes(), "image/webp")
    return HttpReply(NOT_FOUND, b"There is no such example.\n")


def examples() -> list[dict[str, str]]:
    """Return the names of all examples, and what each shows: the first line of its docstring."""
    return [{"name": n, "title": _first_line(path)} for n, path in all_examples().items()]


def _first_line(path: Path) -> str:
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith('"""'):
            return line.strip('"').strip()
    return ""
