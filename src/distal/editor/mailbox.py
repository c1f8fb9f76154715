"""Requests that wait for the worker: the newest one of each kind is done, the others are dropped.

Input: requests in the order in which they arrive. Output: the next one to do, and those dropped.
"""

from __future__ import annotations

from distal.editor.messages import AppRequest, LookRequest


class Mailbox:
    """The requests that wait, in the order in which they are done."""

    def __init__(self) -> None:
        self._waiting: list[AppRequest] = []

    def put(self, request: AppRequest) -> list[AppRequest]:
        """Add a request; return those that it makes useless."""
        dropped = [w for w in self._waiting if _is_useless(w, request)]
        self._waiting = [w for w in self._waiting if w not in dropped]
        self._waiting.append(request)
        return dropped

    def take(self) -> AppRequest | None:
        """Remove and return the request to do next; None if none waits."""
        return self._waiting.pop(0) if self._waiting else None


def _is_useless(waiting: AppRequest, newer: AppRequest) -> bool:
    if waiting.kind in ("save", "stop"):
        return False
    if waiting.kind == newer.kind:
        return True
    return isinstance(newer, LookRequest) and waiting.revision < newer.revision
