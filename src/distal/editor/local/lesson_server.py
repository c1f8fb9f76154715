"""The server of ``distal studio lesson.md``: the lesson's page, made again whenever a file changes.

Input: a lesson. Output: an address on this machine. The lesson's scenes run in a process of their
own, which makes the page as ``distal export`` does; one that takes too long is ended.
"""

from __future__ import annotations

import contextlib
import json
import secrets
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any, Final

from distal.editor.local.serving import NOT_FOUND, HttpReply, LocalServer

MAKING_S: Final = 120.0
_LOOK_S: Final = 0.3
_SUFFIXES: Final = (".md", ".py", ".png", ".jpg", ".hdr", ".exr", ".svg")
_SHELL: Final = Path(__file__).with_name("lesson.html")


class LessonServer(LocalServer):
    """Serves a lesson's page until ``close``.

    Args:
        lesson: The lesson's file.
        port: The port; 0 for any that is free.
        limit: Seconds in which the page is to be made.

    Raises:
        PackageError: ``websockets`` is not installed.
        OSError: The port is taken.
    """

    def __init__(self, lesson: Path, port: int = 0, limit: float = MAKING_S) -> None:
        self._lesson, self._limit = lesson.resolve(), limit
        self._page = b""
        self._count = 0
        self._text = "The page is made …"
        self._process: subprocess.Popen[str] | None = None
        self._process_lock = threading.Lock()
        super().__init__(port)

    def serve(self) -> None:
        """Make the page at first and after each change, until ``close``."""
        known: dict[str, int] = {}
        while not self._over.is_set():
            found = self._times()
            if found != known:
                known = found
                self._make()
            self._over.wait(_LOOK_S)

    def close(self) -> None:
        """End the server, and the process that makes the page."""
        self._over.set()
        with self._process_lock:
            if self._process is not None:
                self._process.kill()
        super().close()

    def _times(self) -> dict[str, int]:
        """Return when the files of the lesson's folder were written, by name."""
        found: dict[str, int] = {}
        for path in self._lesson.parent.iterdir():
            if path.suffix in _SUFFIXES:
                with contextlib.suppress(OSError):  # gone again
                    found[path.name] = path.stat().st_mtime_ns
        return found

    def _make(self) -> None:
        self._tell("The page is made …")
        with tempfile.TemporaryDirectory(prefix="distal_lesson_") as folder:
            page = Path(folder) / "lesson.html"
            mistake = self._mistake_of_making(page)
            if mistake is None:
                self._page = page.read_bytes()
                self._count += 1
        self._tell(mistake or "")

    def _mistake_of_making(self, page: Path) -> str | None:
        """Make the page; return what went wrong, or None."""
        command = [sys.executable, "-m", "distal.cli", "export", str(self._lesson), "-o", str(page)]
        with self._process_lock:
            if self._over.is_set():
                return ""
            process = self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                encoding="utf-8",
                errors="replace",
                start_new_session=True,
            )
        try:
            _, said = process.communicate(timeout=self._limit)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return f"The page was not made within {self._limit:g} s: does a scene run for ever?"
        if process.returncode == 0:
            return None
        return said.strip() or f"The page was not made (exit status {process.returncode})."

    def _tell(self, text: str) -> None:
        self._text = text
        self._send_all(self._state())

    def _state(self) -> str:
        return json.dumps({"text": self._text, "count": self._count})

    def _talk(self, connection: Any) -> None:
        with self._lock:
            self._tabs[connection] = None
        try:
            connection.send(self._state())
            for _ in connection:
                pass
        except self._closed:
            pass
        finally:
            with self._lock:
                del self._tabs[connection]

    def _reply(self, path: str) -> HttpReply:
        if path == "/lesson" and self._page:
            # The page has a policy of its own, with the hashes of its scripts.
            policy = (("Content-Security-Policy", "frame-ancestors 'self'"),)
            return HttpReply(200, self._page, "text/html", policy)
        if path != "/":
            return HttpReply(NOT_FOUND, b"There is no such page.\n")
        nonce = secrets.token_urlsafe(16)
        text = _SHELL.read_text(encoding="utf-8").replace("{nonce}", nonce)
        name = self._lesson.name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
        policy = (
            (
                "Content-Security-Policy",
                f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; "
                f"frame-src 'self'; connect-src ws://{self._guard.authority}; "
                "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
            ),
        )
        return HttpReply(200, text.replace("{name}", name).encode(), "text/html", policy)
