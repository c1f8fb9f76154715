"""Who may ask the studio's server: the browser that was given its address, and no other page.

Input: the headers of a request, as ``websockets`` has them. Output: whether it is answered. The
address has a key that is good once; it becomes a cookie that scripts cannot read and that no other
site sends. Needs the standard library alone.
"""

from __future__ import annotations

import hmac
import secrets
from typing import Any
from urllib.parse import parse_qs, urlsplit

from distal.forking import new_lock

HOST = "127.0.0.1"


class Guard:
    """The secrets of one server.

    Args:
        port: The server's port.
    """

    def __init__(self, port: int) -> None:
        self.authority = f"{HOST}:{port}"
        self._cookie = f"distal_{port}"  # cookies of one host are shared by its ports
        self._key: str | None = secrets.token_urlsafe(24)
        self._secret = secrets.token_urlsafe(32)
        self._lock = new_lock()

    @property
    def origin(self) -> str:
        """The only origin that a browser's request may have."""
        return f"http://{self.authority}"

    def address(self) -> str:
        """Return an address that is good once."""
        with self._lock:
            self._key = self._key or secrets.token_urlsafe(24)
            return f"{self.origin}/?key={self._key}"

    def knows(self, headers: Any) -> bool:
        """Whether a request has the cookie."""
        # Other programs of this host have cookies of any form, which a parser may stop at.
        pairs = (pair.strip().partition("=") for pair in _one(headers, "Cookie").split(";"))
        given = [value for name, _, value in pairs if name == self._cookie]
        return len(given) == 1 and _is_same(given[0], self._secret)

    def is_ours(self, headers: Any, *, needs_origin: bool) -> bool:
        """Whether a request is for this host, and from one of its own pages.

        Args:
            headers: The request's headers.
            needs_origin: Whether it must say where it comes from, as those of sockets do.
        """
        origin = _one(headers, "Origin")
        is_from_us = origin == self.origin or ("Origin" not in headers and not needs_origin)
        return _one(headers, "Host") == self.authority and is_from_us

    def welcomed(self, path: str) -> str | None:
        """Return the cookie for a request with the right key; the key is used up."""
        given = parse_qs(urlsplit(path).query).get("key", [""])[0]
        with self._lock:
            if self._key is None or not _is_same(given, self._key):
                return None
            self._key = None
        return f"{self._cookie}={self._secret}; HttpOnly; SameSite=Strict; Path=/"


def _one(headers: Any, name: str) -> str:
    """Return a header's value; "" where it is missing or there several times."""
    values: list[str] = headers.get_all(name)
    return values[0] if len(values) == 1 else ""


def _is_same(given: str, secret: str) -> bool:
    return hmac.compare_digest(given.encode("utf-8", "surrogatepass"), secret.encode())
