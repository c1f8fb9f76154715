"""Who may ask the studio's server: the browser that was given its address, and no other page.

Input: the headers of a request. Output: whether it is answered. The address has a key that is good
once; it becomes a cookie that scripts cannot read and that no other site sends. Needs the standard
library alone.
"""

from __future__ import annotations

import hmac
import secrets
import threading
from collections.abc import Mapping
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

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
        self._lock = threading.Lock()

    @property
    def origin(self) -> str:
        """The only origin that a browser's request may have."""
        return f"http://{self.authority}"

    def address(self) -> str:
        """Return an address that is good once."""
        with self._lock:
            self._key = self._key or secrets.token_urlsafe(24)
            return f"{self.origin}/?key={self._key}"

    def knows(self, headers: Mapping[str, str]) -> bool:
        """Whether a request has the cookie."""
        cookies = SimpleCookie()
        try:
            cookies.load(headers.get("Cookie", ""))
        except CookieError:
            return False
        given = cookies.get(self._cookie)
        return given is not None and hmac.compare_digest(given.value, self._secret)

    def is_ours(self, headers: Mapping[str, str], *, needs_origin: bool) -> bool:
        """Whether a request is for this host, and from one of its own pages.

        Args:
            headers: The request's headers.
            needs_origin: Whether it must say where it comes from, as those of sockets do.
        """
        origin = headers.get("Origin")
        is_from_us = origin == self.origin or (origin is None and not needs_origin)
        return headers.get("Host") == self.authority and is_from_us

    def welcomed(self, path: str) -> str | None:
        """Return the cookie for a request with the right key; the key is used up."""
        given = parse_qs(urlsplit(path).query).get("key", [""])[0]
        with self._lock:
            if self._key is None or not hmac.compare_digest(given.encode(), self._key.encode()):
                return None
            self._key = None
        return f"{self._cookie}={self._secret}; HttpOnly; SameSite=Strict; Path=/"
