"""A server on this machine for one browser: pages, and a socket for each tab.

Input: what a path gets, what a socket says. Output: an address that is good once. Uses
``websockets``.
"""

from __future__ import annotations

import logging
import threading
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Final
from urllib.parse import urlsplit

from distal.editor.local.guard import HOST, Guard
from distal.editor.local.scratch import sweep
from distal.editor.messages import LONGEST_MESSAGE
from distal.forking import new_lock
from distal.packages import imported

MOST_TABS: Final = 8
# A file has so long to be sent: a browser writes a large picture to a slow disk.
SENDING_S: Final = 600.0

_USED: Final = (
    "This address was used already. Open the page in the browser that has it, or start "
    "'distal studio' once more.\n"
)
_PHRASES: Final = {
    **{200: "OK", 303: "See Other", 403: "Forbidden", 404: "Not Found"},
    503: "Service Unavailable",
}
NOT_FOUND: Final = 404


# The codes of sockets that are closed: by a mistake of the server, and because it is busy.
_FAILED: Final = 1011
_TRY_LATER: Final = 1013


def _silent() -> logging.Logger:
    """Return a log that nobody sees: what a stranger sends must not fill the terminal."""
    found = logging.getLogger("distal.studio")
    found.propagate = False
    if not found.handlers:
        found.addHandler(logging.NullHandler())
    return found


@dataclass(frozen=True, slots=True)
class HttpReply:
    """What a request gets."""

    status: int
    body: bytes
    media_type: str = "text/plain"
    more: tuple[tuple[str, str], ...] = ()


class LocalServer(ABC):
    """Serves pages until ``close``.

    Args:
        port: The port; 0 for any that is free.

    Raises:
        PackageError: ``websockets`` is not installed.
        OSError: The port is taken.
    """

    def __init__(self, port: int) -> None:
        self._http11 = imported("websockets.http11")
        self._headers = imported("websockets.datastructures").Headers
        self._closed: type[Exception] = imported("websockets.exceptions").ConnectionClosed
        self._tabs: dict[Any, Any] = {}
        self._lock = new_lock()
        self._over = threading.Event()
        sweep()
        self._server = imported("websockets.sync.server").serve(
            self._talk_alone,
            HOST,
            port,
            process_request=self._answered,
            compression=None,
            max_size=LONGEST_MESSAGE,
            server_header=None,
            ping_interval=None,
            logger=_silent(),
        )
        self._guard = Guard(self._server.socket.getsockname()[1])
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """An address for one browser."""
        return self._guard.address()

    @abstractmethod
    def serve(self) -> None:
        """Do what there is to do beside the answers, until ``close``."""

    def close(self) -> None:
        """End the server."""
        self._over.set()
        self._server.shutdown()

    def _talk_alone(self, connection: Any) -> None:
        """Talk with a tab, if there are not too many; what fails ends this tab alone."""
        with self._lock:
            is_too_many = len(self._tabs) >= MOST_TABS  # several may have come at once
            if not is_too_many:
                self._tabs[connection] = None  # from now on it gets what changes
        if is_too_many:
            connection.close(_TRY_LATER, "too many tabs are open")
            return
        try:
            self._talk(connection)
        except self._closed:
            pass
        except Exception as error:
            connection.close(_FAILED, type(error).__name__)
        finally:
            with self._lock:
                self._tabs.pop(connection, None)

    @abstractmethod
    def _talk(self, connection: Any) -> None:
        """Talk with a tab until it is gone."""

    @abstractmethod
    def _reply(self, path: str) -> HttpReply:
        """Return what a path gets."""

    def _send_all(self, text: str, source: Any = None) -> None:
        """Send a text to all tabs but one."""
        with self._lock:
            tabs = [connection for connection in self._tabs if connection is not source]
        for connection in tabs:
            try:
                connection.send(text)
            except self._closed:
                continue

    def _answered(self, connection: Any, request: Any) -> Any:
        """Answer a request for a file; None lets a socket open."""
        try:
            path = urlsplit(request.path).path
        except ValueError:  # as "//[" is
            return self._response(HttpReply(NOT_FOUND, b"There is no such page.\n"))
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
            if len(self._tabs) >= MOST_TABS:
                return self._response(HttpReply(503, b"Too many tabs are open: close one.\n"))
            return None
        # Without this the rest of an answer is cut off after ten seconds.
        connection.close_timeout = SENDING_S
        return self._response(self._reply(path))

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
