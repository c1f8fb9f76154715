"""A server on this machine for one person's browsers: pages, and a socket for each tab.

Input: what a path gets, what a socket says. Output: an address that is good once. Files are served
to every page of the server's own address, and have no secrets; what tells of the person's files
goes through a socket, after page and server have proved that they belong together (``guard``). Uses
``websockets``.
"""

from __future__ import annotations

import json
import logging
import threading
import time
import webbrowser
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final
from urllib.parse import urlsplit

from distal.editor.local.connection import BoundedListener, TabConnection
from distal.editor.local.guard import HOST, LONGEST_ADMISSION, Guard
from distal.editor.local.key_file import KeyFile
from distal.editor.local.scratch import sweep
from distal.editor.messages import LONGEST_MESSAGE
from distal.forking import new_lock
from distal.packages import imported

MOST_TABS: Final = 8
# Sockets that are not admitted yet, and the time that they have for it: four short messages.
MOST_UNADMITTED: Final = 16
ADMISSION_S: Final = 5.0
# How long an answer may take: the app's own files, and a large picture to a slow disk.
FILE_S: Final = 10.0
RESULT_S: Final = 600.0
_CLOSING_S: Final = 2.0  # for the end of a socket, and for all of them when the server ends

NOT_FOUND: Final = 404
_PHRASES: Final = {200: "OK", 403: "Forbidden", NOT_FOUND: "Not Found"}

# The codes of sockets that are closed: by a mistake of the server, because it is busy, and because
# the page has neither the key nor the secret.
_FAILED: Final = 1011
_TRY_LATER: Final = 1013
REFUSED: Final = 4403


def _silent() -> logging.Logger:
    """Return a log that nobody sees: what a stranger sends must not fill the terminal."""
    logger = logging.getLogger("distal.studio")
    logger.propagate = False
    if not logger.handlers:
        logger.addHandler(logging.NullHandler())
    return logger


@dataclass(frozen=True, slots=True)
class HttpReply:
    """What a request gets.

    Attributes:
        status: The status.
        body: The body.
        media_type: Its type.
        more: Other headers.
        limit: Seconds after which the rest of the body is not sent.
    """

    status: int
    body: bytes
    media_type: str = "text/plain"
    more: tuple[tuple[str, str], ...] = ()
    limit: float = FILE_S


class LocalServer(ABC):
    """Serves pages until ``close``.

    Args:
        port: The port; 0 for any that is free.

    Raises:
        PackageError: ``websockets`` is not installed.
        OSError: The port is taken.
    """

    def __init__(self, port: int) -> None:
        serve = imported("websockets.sync.server").serve
        self._http11 = imported("websockets.http11")
        self._headers = imported("websockets.datastructures").Headers
        self._closed: type[Exception] = imported("websockets.exceptions").ConnectionClosed
        self._tabs: dict[TabConnection, Any] = {}
        self._waiting = threading.BoundedSemaphore(MOST_UNADMITTED)
        self._lock = new_lock()
        self._over = threading.Event()
        self._key_file: KeyFile | None = None
        sweep()
        self._listener = BoundedListener(HOST, port)
        self._guard = Guard(self._listener.getsockname()[1], self._remove_key_file)
        self._server = serve(
            self._talk_alone,
            sock=self._listener,
            process_request=self._answered,
            compression=None,
            max_size=LONGEST_ADMISSION,
            server_header=None,
            open_timeout=ADMISSION_S,
            close_timeout=_CLOSING_S,
            ping_interval=None,
            logger=_silent(),
        )
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """An address for one browser."""
        return self._guard.address()

    def open_browser(self) -> bool:
        """Open the browser with the address, which goes there by a file that only this user reads.

        Returns whether there is a browser.

        Raises:
            OSError: The file cannot be written.
        """
        with self._lock:
            self._key_file = self._key_file or KeyFile(self.address)
            place = self._key_file.path.as_uri()
        return webbrowser.open(place)

    @abstractmethod
    def serve(self) -> None:
        """Do what there is to do beside the answers, until ``close``."""

    def close(self) -> None:
        """End the server; who does not read, or sends nothing, is not waited for."""
        self._over.set()
        self._remove_key_file()
        ending = threading.Thread(target=self._server.shutdown, daemon=True)
        ending.start()
        ending.join(_CLOSING_S)
        self._listener.cut()
        ending.join()

    def _remove_key_file(self) -> None:
        with self._lock:
            key_file, self._key_file = self._key_file, None
        if key_file is not None:
            key_file.remove()

    # Sockets

    def _talk_alone(self, connection: Any) -> None:
        """Talk with a tab, if it is admitted; what fails ends this tab alone."""
        if not self._waiting.acquire(blocking=False):
            connection.close(_TRY_LATER, "too many pages begin at once")
            return
        try:
            welcome = self._welcome(connection)
        except (TimeoutError, self._closed):
            welcome = None
        finally:
            self._waiting.release()
        if welcome is None:
            connection.close(REFUSED, "this page has neither the key nor the secret")
            return
        tab = TabConnection(connection)
        with self._lock:
            is_too_many = len(self._tabs) >= MOST_TABS
            if not is_too_many:
                # The first message; from now on it gets what changes.
                tab.send(json.dumps({**welcome, "settings": self._settings()}))
                self._tabs[tab] = None
        if is_too_many:
            tab.close(_TRY_LATER, "too many tabs are open")
            return
        try:
            self._talk(tab)
        except self._closed:
            pass
        except Exception as error:
            tab.close(_FAILED, type(error).__name__)
        finally:
            with self._lock:
                self._tabs.pop(tab, None)
            tab.close()

    def _welcome(self, connection: Any) -> dict[str, str] | None:
        """Return what an admitted page gets first; None for a page that is not.

        Raises:
            TimeoutError: The page says nothing.
        """
        ends = time.monotonic() + ADMISSION_S
        challenge = self._guard.challenge(connection.recv(timeout=ADMISSION_S))
        if challenge is None:
            return None
        connection.send(challenge.text)
        answer = connection.recv(timeout=max(0.0, ends - time.monotonic()))
        welcome = self._guard.welcome(challenge, answer)
        if welcome is not None:
            _allow(connection, LONGEST_MESSAGE)
        return welcome

    @abstractmethod
    def _settings(self) -> Mapping[str, object]:
        """Return what a page needs to begin, which it gets when it is admitted."""

    @abstractmethod
    def _talk(self, connection: TabConnection) -> None:
        """Talk with a tab until it is gone."""

    @abstractmethod
    def _reply(self, path: str) -> HttpReply:
        """Return what a path gets; without a secret in it, nothing of the person's files."""

    def _send_all(self, text: str, source: Any = None) -> None:
        """Send a text to all tabs but one; waits for none."""
        with self._lock:
            tabs = [connection for connection in self._tabs if connection is not source]
        for connection in tabs:
            connection.send(text)

    # Files

    def _answered(self, connection: Any, request: Any) -> Any:
        """Answer a request for a file; None lets a socket open."""
        try:
            path = urlsplit(request.path).path
        except ValueError:  # as "//[" is
            return self._response(HttpReply(NOT_FOUND, b"There is no such page.\n"))
        is_socket = path == "/socket"
        if not self._guard.is_ours(request.headers, needs_origin=is_socket):
            return self._response(HttpReply(403, b"This server answers its own pages only.\n"))
        if is_socket:
            return None
        reply = self._reply(path)
        connection.close_timeout = reply.limit  # after it the rest of an answer is cut off
        return self._response(reply)

    def _response(self, reply: HttpReply) -> Any:
        charset = "" if reply.media_type.startswith("image/") else "; charset=utf-8"
        headers = self._headers(
            [
                ("Content-Type", reply.media_type + charset),
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


def _allow(connection: Any, size: int) -> None:
    """Let a connection receive longer messages; ``websockets`` takes a length at the start only."""
    protocol = connection.protocol
    name = "max_message_size" if hasattr(protocol, "max_message_size") else "max_size"
    setattr(protocol, name, size)
