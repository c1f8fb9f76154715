"""Who may ask the studio's server: a browser that has its key or its secret, and no other page.

Input: the headers of a request, as ``websockets`` has them; the first messages of a socket. Output:
whether they are answered. The address has a key that is good once; the page gets a secret for it,
which it keeps. Page and server prove to each other that they have the same text, and send a proof
only (decision 97), so that whoever else has the port later learns nothing. Needs the standard
library alone.

A socket begins with four messages, all JSON objects; nonces and proofs are 64 hexadecimal digits:

1. page: ``{"nonce": N, "by": "key" | "secret"}``
2. server: ``{"nonce": M, "proof": HMAC(text, "server N M")}``
3. page: ``{"proof": HMAC(text, "page N M")}``
4. server: ``{"settings": ..., "secret": ...}``, the secret for a key only.
"""

from __future__ import annotations

import hmac
import json
import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from distal.forking import new_lock

HOST: Final = "127.0.0.1"
LONGEST_ADMISSION: Final = 1000  # bytes of a message before the page is admitted

_NONCE: Final = re.compile("[0-9a-f]{64}")


@dataclass(frozen=True, slots=True)
class Challenge:
    """What the server asks of a page.

    Attributes:
        text: The message to the page.
        proof: The proof that the page has to answer with.
        key: The key that the page says it has; None for one with the secret.
    """

    text: str
    proof: str
    key: str | None


class Guard:
    """The secrets of one server.

    Args:
        port: The server's port.
        key_used: Called when the key has been used.
    """

    def __init__(self, port: int, key_used: Callable[[], None] = lambda: None) -> None:
        self.authority = f"{HOST}:{port}"
        self._key_used = key_used
        self._key: str | None = secrets.token_urlsafe(24)
        self._secret = secrets.token_urlsafe(32)
        self._lock = new_lock()

    @property
    def origin(self) -> str:
        """The only origin that a browser's request may have."""
        return f"http://{self.authority}"

    def address(self) -> str:
        """Return an address that is good once.

        Browsers send no fragment: the key is in no log and in no ``Referer``.
        """
        with self._lock:
            self._key = self._key or secrets.token_urlsafe(24)
            return f"{self.origin}/#key={self._key}"

    def is_ours(self, headers: Any, *, needs_origin: bool) -> bool:
        """Whether a request is for this host, and from one of its own pages.

        Args:
            headers: The request's headers.
            needs_origin: Whether it must say where it comes from, as those of sockets do.
        """
        origin = _one(headers, "Origin")
        is_from_us = origin == self.origin or ("Origin" not in headers and not needs_origin)
        return _one(headers, "Host") == self.authority and is_from_us

    def challenge(self, hello: str | bytes) -> Challenge | None:
        """Return the answer to a page's first message; None for one that cannot be admitted."""
        message = _object(hello)
        nonce, by = message.get("nonce"), message.get("by")
        if not isinstance(nonce, str) or not _NONCE.fullmatch(nonce):
            return None
        with self._lock:
            key = self._key if by == "key" else None
        shared = self._secret if by == "secret" else key
        if shared is None:
            return None
        own = secrets.token_hex(32)
        text = json.dumps({"nonce": own, "proof": _proof(shared, "server", nonce, own)})
        return Challenge(text, _proof(shared, "page", nonce, own), key)

    def welcome(self, challenge: Challenge, answer: str | bytes) -> dict[str, str] | None:
        """Return what a page with the right proof gets, None for another; a key is used up."""
        proof = _object(answer).get("proof")
        if not isinstance(proof, str) or not _is_same(proof, challenge.proof):
            return None
        if challenge.key is None:
            return {}
        with self._lock:
            if self._key != challenge.key:
                return None  # another page was first
            self._key = None
        self._key_used()
        return {"secret": self._secret}


def _one(headers: Any, name: str) -> str:
    """Return a header's value; "" where it is missing or there several times."""
    values: list[str] = headers.get_all(name)
    return values[0] if len(values) == 1 else ""


def _object(text: str | bytes) -> dict[str, Any]:
    """Return the JSON object of a text; an empty one for anything else."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return value if isinstance(value, dict) else {}


def _proof(shared: str, side: str, page: str, server: str) -> str:
    """Return what only somebody with the text can compute; it differs by side and by nonces."""
    return hmac.new(shared.encode(), f"{side} {page} {server}".encode(), "sha256").hexdigest()


def _is_same(proof: str, expected: str) -> bool:
    return hmac.compare_digest(proof.encode("utf-8", "surrogatepass"), expected.encode())
