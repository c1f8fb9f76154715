"""The server of ``distal studio lesson.md``: the lesson's page, made again whenever a file changes.

Input: a lesson. Output: an address on this machine. The lesson's scenes run in a process of their
own, which makes the page as ``distal export`` does; one that takes too long is ended.
"""

from __future__ import annotations

import contextlib
import hmac
import json
import queue
import secrets
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from distal.editor.local.connection import TabConnection
from distal.editor.local.process import ChildProcess
from distal.editor.local.scratch import LESSON, ScratchFolder
from distal.editor.local.serving import NOT_FOUND, HttpReply, LocalServer
from distal.forking import new_lock

MAKING_S: Final = 120.0
_LOOK_S: Final = 0.3
_TICK_S: Final = 0.05
_SUFFIXES: Final = (".md", ".py", ".png", ".jpg", ".hdr", ".exr", ".svg")
_SHELL: Final = Path(__file__).with_name("lesson.html")
_SCRIPT: Final = Path(__file__).parent.parent / "app" / "lesson_page.js"


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
        self._address = ""  # of the page; whoever has it may read the page
        self._text = "The page is made …"
        self._process: ChildProcess | None = None
        self._process_lock = new_lock()
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
        with contextlib.suppress(OSError):  # the folder is gone
            for path in self._lesson.parent.iterdir():
                if path.suffix in _SUFFIXES:
                    with contextlib.suppress(OSError):  # gone again
                        found[path.name] = path.stat().st_mtime_ns
        return found

    def _make(self) -> None:
        self._tell("The page is made …")
        scratch: ScratchFolder | None = None
        try:
            scratch = ScratchFolder(LESSON)
            page = scratch.path / "lesson.html"
            mistake = self._mistake_of_making(page)
            if mistake is None:
                self._page = page.read_bytes()
                self._address = f"/lesson/{secrets.token_urlsafe(24)}"
        except FileNotFoundError:
            mistake = "The page was not made: a scene's code ended the process (exit status 0)."
        except OSError as error:
            mistake = f"The page was not made: {error}"
        finally:
            if scratch is not None:
                scratch.remove()
        self._tell(mistake or "")

    def _mistake_of_making(self, page: Path) -> str | None:
        """Make the page; return what went wrong, or None."""
        command = [
            sys.executable,
            "-P",
            "-m",
            "distal.cli",
            "export",
            str(self._lesson),
            "-o",
            str(page),
        ]
        status: queue.SimpleQueue[tuple[int, str]] = queue.SimpleQueue()
        temporary = page.with_name("temporary")
        temporary.mkdir()
        with self._process_lock:
            if self._over.is_set():
                return ""
            process = self._process = ChildProcess(
                command,
                lambda _: None,
                lambda code, said: status.put((code, said)),
                temporary=temporary,
            )
        ends = time.monotonic() + self._limit
        while status.empty() and not self._over.is_set():
            if time.monotonic() > ends:
                process.kill()
                return f"The page was not made within {self._limit:g} s: does a scene run for ever?"
            time.sleep(_TICK_S)
        if self._over.is_set():
            return ""
        code, said = status.get()
        if code == 0:
            return None
        return said or f"The page was not made (exit status {code})."

    def _tell(self, text: str) -> None:
        self._text = text
        self._send_all(self._state())

    def _state(self) -> str:
        return json.dumps({"text": self._text, "address": self._address})

    def _settings(self) -> Mapping[str, object]:
        return {"name": self._lesson.name}

    def _talk(self, connection: TabConnection) -> None:
        connection.send(self._state())
        for _ in connection:
            pass

    def _reply(self, path: str) -> HttpReply:
        if self._address and hmac.compare_digest(path.encode(), self._address.encode()):
            # The page has a policy of its own, with the hashes of its scripts.
            policy = (("Content-Security-Policy", "frame-ancestors 'self'"),)
            return HttpReply(200, self._page, "text/html", policy)
        if path == f"/{_SCRIPT.name}":
            return HttpReply(200, _SCRIPT.read_bytes(), "text/javascript")
        if path != "/":
            return HttpReply(NOT_FOUND, b"There is no such page.\n")
        nonce = secrets.token_urlsafe(16)
        text = _SHELL.read_text(encoding="utf-8").replace("{nonce}", nonce)
        policy = (
            (
                "Content-Security-Policy",
                f"default-src 'none'; script-src 'self'; style-src 'nonce-{nonce}'; "
                f"frame-src 'self'; connect-src ws://{self._guard.authority}; "
                "frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
            ),
        )
        return HttpReply(200, text.encode(), "text/html", policy)
