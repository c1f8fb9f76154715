"""End a reader at its limits of time and memory, where nothing in it asks for them.

Input: a call, and what it may take. Output: its result; or it is ended by an exception in its own
thread. Needs the standard library alone.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from typing import Final, TypeVar

from distal.forking import new_lock
from distal.interrupting import raise_in

_PERIOD_S: Final = 0.05  # between two looks at a reader
_Result = TypeVar("_Result")


class _LimitError(BaseException):
    """Ends a reader, which may catch every ``Exception``."""


def limited(
    work: Callable[[], _Result],
    seconds: float,
    most: int,
    errors: tuple[Callable[[], Exception], Callable[[], Exception]],
) -> _Result:
    """Return the result of a call, which is ended at its limits.

    Not a context: where a call of C fails after its time, the thread's exception comes as the next
    function begins, which would be the end of the context.

    Args:
        work: The call.
        seconds: The processor's time that it may take.
        most: Bytes of memory that it may take, where the system tells (Linux).
        errors: Return what is raised for the time, and for the memory.

    Raises:
        Exception: One of ``errors``.
    """
    watch = _ReadWatch(seconds, most)
    try:
        try:
            return work()
        finally:
            watch.end()
    except _LimitError:
        watch.end()
        late, over = errors
        raise (over() if watch.is_memory else late()) from None


def _resident() -> int:
    """Return the bytes of memory that this process has; 0 where the system does not say."""
    try:
        with open("/proc/self/statm", "rb") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        return 0


def _take_back(thread: int) -> None:
    """Let an exception that may be on its way to this thread arrive here.

    A second one takes its place, and arrives at once. CPython 3.11 does not forget one that is
    taken back with NULL: the interpreter looks for it at each step, and hangs under a profiler.
    """
    try:
        raise_in(thread, _LimitError)
        while True:
            pass
    except _LimitError:
        pass


class _ReadWatch:
    """A thread that raises ``_LimitError`` in the thread that made it, until it is ended.

    Attributes:
        is_memory: Whether memory was spent, and not time.
    """

    def __init__(self, seconds: float, most: int) -> None:
        self._thread = threading.get_ident()
        self._lock = new_lock()
        self._ended = threading.Event()
        self._seconds, self._most, self._before = seconds, most, _resident()
        self.is_memory = self._has_raised = False
        threading.Thread(target=self._run, name="distal-read-watch", daemon=True).start()

    def _run(self) -> None:
        begin = time.monotonic(), time.process_time()
        while not self._ended.wait(_PERIOD_S):
            # Of the processor: on a busy machine a file has as much as on any other.
            passed = min(time.monotonic() - begin[0], time.process_time() - begin[1])
            self.is_memory |= _resident() - self._before > self._most
            if self.is_memory or passed > self._seconds:
                with self._lock:
                    if not self._ended.is_set():
                        self._has_raised = True
                        raise_in(self._thread, _LimitError)

    def end(self) -> None:
        """End the watch; nothing is raised afterwards."""
        while not self._ended.is_set():
            try:
                with self._lock:
                    self._ended.set()
            except _LimitError:  # on its way when the reader ended
                continue
        if self._has_raised:
            _take_back(self._thread)
