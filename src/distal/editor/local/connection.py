"""The socket of a tab, and the socket that all tabs come to: nobody waits for one that is slow.

Input: texts to send. Output: texts that were received. Each tab has a queue and a thread that sends
it. A tab that does not read (its page is at a breakpoint) is cut off when its queue is full, and
comes back by itself. Uses ``websockets`` through its objects only.
"""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections import deque
from collections.abc import Iterator
from typing import Any, Final
from weakref import WeakSet

from distal.editor.messages import LONGEST_MESSAGE

MOST_WAITING: Final = 2000  # messages that wait for a tab; a render reports up to 20 times a second
MOST_WAITING_BYTES: Final = LONGEST_MESSAGE
MOST_SOCKETS: Final = 48  # each has four file descriptors, and some systems allow 256
_TICK_S: Final = 0.05


class TabConnection:
    """A tab's socket; sending takes no time, and what cannot be sent is left out.

    Args:
        connection: The connection of ``websockets``.
    """

    def __init__(self, connection: Any) -> None:
        self._connection = connection
        self._lock = threading.Condition()
        self._texts: deque[str] = deque()  # the first one is being sent
        self._size = 0
        self._is_over = False
        threading.Thread(target=self._write, daemon=True).start()

    def __iter__(self) -> Iterator[str | bytes]:
        """Iterate over what the tab sends, until it is gone."""
        yield from self._connection

    def send(self, text: str) -> None:
        """Send a text when those before it are sent; a tab whose queue is full is cut off."""
        with self._lock:
            if self._is_over:
                return
            # JSON is ASCII: a character is a byte. A single message always fits.
            size = self._size + len(text)
            if self._texts and (len(self._texts) >= MOST_WAITING or size > MOST_WAITING_BYTES):
                self._cut()
                return
            self._texts.append(text)
            self._size = size
            self._lock.notify_all()

    def close(self, code: int = 1000, reason: str = "") -> None:
        """Close it, what waits is left out; one that does not read is cut off."""
        with self._lock:
            is_sending = bool(self._texts)
            if is_sending:
                self._cut()
            self._end()
        if not is_sending:
            self._connection.close(code, reason)

    def _cut(self) -> None:
        # ``close`` would wait for the message that is being sent.
        with contextlib.suppress(OSError):
            self._connection.socket.shutdown(socket.SHUT_RDWR)
        self._end()

    def _end(self) -> None:
        self._is_over = True
        self._texts.clear()
        self._size = 0
        self._lock.notify_all()

    def _write(self) -> None:
        """Send what waits, until it is over."""
        while True:
            with self._lock:
                self._lock.wait_for(lambda: self._texts or self._is_over)
                if self._is_over:
                    return
                text = self._texts[0]
            try:
                self._connection.send(text)
            except Exception:  # it is closed, in one of several ways
                with self._lock:
                    self._end()
                return
            with self._lock:
                if self._is_over:
                    return
                self._texts.popleft()
                self._size -= len(text)


class BoundedListener(socket.socket):
    """A listening socket that takes a limited number of connections; others wait until one ends.

    Args:
        host: The address.
        port: The port; 0 for any that is free.

    Raises:
        OSError: The port is taken.
    """

    def __init__(self, host: str, port: int) -> None:
        with socket.create_server((host, port)) as server:
            super().__init__(server.family, server.type, server.proto, fileno=server.detach())
        self._lock = threading.Lock()
        self._accepted: WeakSet[socket.socket] = WeakSet()

    def accept(self) -> tuple[socket.socket, Any]:
        """Wait for a connection.

        Raises:
            OSError: This socket is closed.
        """
        while self.fileno() >= 0 and len(self._open()) >= MOST_SOCKETS:
            time.sleep(_TICK_S)
        accepted, address = super().accept()
        with self._lock:
            self._accepted.add(accepted)
        return accepted, address

    def cut(self) -> None:
        """End all connections at once, also of those who do not read."""
        for accepted in self._open():
            with contextlib.suppress(OSError):
                accepted.shutdown(socket.SHUT_RDWR)

    def _open(self) -> list[socket.socket]:
        with self._lock:
            return [accepted for accepted in self._accepted if accepted.fileno() >= 0]
