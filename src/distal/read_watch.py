"""End a reader whose time is up, where nothing in it asks for the time.

Input: seconds of the processor. Output: a context whose body is ended by an exception in its own
thread. Needs the standard library alone.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from distal.forking import new_lock
from distal.interrupting import raise_in

_PERIOD_S: Final = 0.25  # between two attempts to end a reader


class _TimeIsUp(BaseException):
    """Ends a watched reader, which may catch every ``Exception``."""


@contextmanager
def watched(seconds: float, late: Callable[[], Exception]) -> Iterator[None]:
    """End what runs in the context when its time is up.

    Args:
        seconds: The processor's time that it may take.
        late: Returns what is raised then.

    Raises:
        Exception: As ``late`` says.
    """
    watch = _ReadWatch(seconds)
    try:
        yield
    except _TimeIsUp:
        raise late() from None
    finally:
        watch.end()


class _ReadWatch:
    """A thread that raises ``_TimeIsUp`` in the thread that made it, until it is ended."""

    def __init__(self, seconds: float) -> None:
        self._thread = threading.get_ident()
        self._lock = new_lock()
        self._ended = threading.Event()
        self._seconds = seconds
        threading.Thread(target=self._run, name="distal-read-watch", daemon=True).start()

    def _run(self) -> None:
        begin = time.monotonic(), time.process_time()
        while not self._ended.wait(_PERIOD_S):
            # Of the processor: on a busy machine a file has as much as on any other.
            passed = min(time.monotonic() - begin[0], time.process_time() - begin[1])
            if passed > self._seconds:
                with self._lock:
                    if not self._ended.is_set():
                        raise_in(self._thread, _TimeIsUp)

    def end(self) -> None:
        """End the watch; nothing is raised afterwards."""
        while not self._ended.is_set():
            try:
                with self._lock:
                    self._ended.set()
                    raise_in(self._thread, None)
            except _TimeIsUp:  # on its way when the reader ended
                continue
