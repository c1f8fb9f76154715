"""Threads that ask for the same result at the same time: one computes it, the others wait.

Input: a key, how to find a finished result, and how to compute it. Output: the result. Nothing is
locked while a result is computed: who asks for another one does not wait, and neither does who asks
for one that is ready.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any, Final, TypeVar
from weakref import WeakSet

from distal.forking import after_fork

Value = TypeVar("Value")

if TYPE_CHECKING:
    from functools import cached_property as cached_property
else:

    class cached_property:  # noqa: N801 (as Python's)
        """Python's, without a lock.

        That of Python 3.11 has one for all objects of a class, which it holds while it computes.
        """

        def __init__(self, compute: Callable[[Any], Any]) -> None:
            self.compute, self.__doc__ = compute, compute.__doc__

        def __set_name__(self, owner: type, name: str) -> None:
            self.name = name

        def __get__(self, instance: Any, owner: type | None = None) -> Any:
            """Return the value; of several threads that compute it, the first one's."""
            if instance is None:
                return self
            return instance.__dict__.setdefault(self.name, self.compute(instance))


class ReentranceError(RuntimeError):
    """The computation of a result asks for that result."""


class _Running:
    """A computation: the thread that it is in, and what tells of its end."""

    __slots__ = ("done", "thread")

    def __init__(self) -> None:
        self.thread = threading.get_ident()
        self.done = threading.Event()


class AtOnce:
    """Computations in progress, by key; results are kept by whoever asks.

    Who fails tells nobody: those who waited compute it themselves, so that each has an error, or an
    interruption, of its own.
    """

    def __init__(self) -> None:
        self._running: dict[Hashable, _Running] = {}
        _IN_PROGRESS.add(self)

    def result(
        self, key: Hashable, find: Callable[[], Value | None], compute: Callable[[], Value]
    ) -> Value:
        """Return what ``find`` finds, or else compute it once.

        Args:
            key: What is computed.
            find: Returns the finished result, or None.
            compute: Computes it, and keeps it where ``find`` finds it.

        Raises:
            ReentranceError: This thread is computing it already.
        """
        mine = _Running()
        while True:
            found = find()
            if found is not None:
                return found
            running = self._running.setdefault(key, mine)
            if running is mine:
                try:
                    found = find()  # another thread may have ended between the two lines above
                    return compute() if found is None else found
                finally:
                    self._running.pop(key, None)
                    mine.done.set()
            if running.thread == mine.thread:
                raise ReentranceError(f"the computation of {key!r} asks for its own result")
            if _would_wait_for_itself(running, mine.thread):
                return compute()
            _WAITING[mine.thread] = running
            try:
                running.done.wait()
            finally:
                _WAITING.pop(mine.thread, None)

    def forked(self) -> None:
        """Forget, in a forked child, what other threads of its parent were computing."""
        here = threading.get_ident()
        for key, running in list(self._running.items()):
            if running.thread != here:
                self._running.pop(key, None)


_WAITING: Final[dict[int, _Running]] = {}
_IN_PROGRESS: Final[WeakSet[AtOnce]] = WeakSet()


def _would_wait_for_itself(running: _Running, thread: int) -> bool:
    """Whether a computation waits, perhaps over others, for one of this thread's."""
    seen: set[int] = set()
    at: _Running | None = running
    while at is not None and at.thread not in seen:
        if at.thread == thread:
            return True
        seen.add(at.thread)
        at = _WAITING.get(at.thread)
    return False


def _forked() -> None:
    _WAITING.clear()
    for each in list(_IN_PROGRESS):
        each.forked()


after_fork(_forked)
