"""One kernel run by several threads, watched by the caller's.

Input: a function that several threads may call at once and that returns when nothing is
left to do, a counter it advances, a flag it obeys. Output: nothing; it is done, or it was
ended. The caller's own thread only waits, so that ctrl-C and ``cancel`` act at once.
"""

from __future__ import annotations

import operator
import os
import threading
import time
from collections.abc import Callable
from typing import Any, Final

from numpy.typing import NDArray

from distal.devices.base import Cancel, Cancelled, Progress, cancel_test

_WATCH_S: Final = 0.02  # how long a request to end may wait
_STACK_BYTES: Final = 16 * 2**20  # twice what the LLVM backend gives to arrays
_STARTING: Final = threading.Lock()  # the size of stacks is the whole process's


def usable_threads() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Work:
    """What the threads of one run share."""

    def __init__(self, counter: NDArray[Any], stop: NDArray[Any], pieces: int) -> None:
        self.counter = counter
        self.stop = stop
        self.pieces = pieces

    def done(self) -> float:
        """The finished share; pieces being worked on count as done."""
        return min(1.0, float(self.counter[0]) / max(1, self.pieces))


def run(
    work: Work,
    function: Callable[[], None],
    threads: int | None,
    progress: Progress | None,
    cancel: Cancel | None,
) -> int:
    """Run to the end; the number of threads used.

    Raises:
        Cancelled: ``cancel`` said so.
    """
    count = max(1, min(_checked(threads) or usable_threads(), work.pieces))
    failures: list[BaseException] = []

    def worker() -> None:
        try:
            function()
        except BaseException as error:
            failures.append(error)

    # Daemon threads: a cancelled run ends soon, but an interpreter that exits does not wait for it.
    workers = [threading.Thread(target=worker, daemon=True) for _ in range(count)]
    started: list[threading.Thread] = []
    try:
        _start(workers, started)
        _watch(started, work, progress, cancel)
    except BaseException:
        work.stop[0] = 1
        raise
    finally:
        # The kernel writes into arrays that the caller is about to drop.
        for thread in started:
            thread.join()
    if failures:
        raise failures[0]
    if progress is not None:
        progress(1.0)
    return len(started)


def _checked(threads: int | None) -> int | None:
    if threads is None:
        return None
    try:
        number = operator.index(threads)
    except TypeError:
        raise TypeError(f"threads is a whole number, not {threads!r}") from None
    if number < 1:
        raise ValueError(f"threads must be at least 1, not {number}")
    return number


def _start(workers: list[threading.Thread], started: list[threading.Thread]) -> None:
    with _STARTING:
        previous = threading.stack_size(_STACK_BYTES)
        try:
            for thread in workers:
                try:
                    thread.start()
                except (
                    RuntimeError
                ):  # the system starts no more threads; the running ones do all the work
                    if not started:
                        raise MemoryError("the system starts no thread") from None
                    break
                started.append(thread)
        finally:
            threading.stack_size(previous)


def _watch(
    workers: list[threading.Thread], work: Work, progress: Progress | None, cancel: Cancel | None
) -> None:
    reported = time.monotonic()
    wanted = cancel_test(cancel)
    for thread in workers:
        while True:
            if wanted():
                raise Cancelled
            thread.join(_WATCH_S)
            if not thread.is_alive():
                break
            now = time.monotonic()
            if progress is not None and now - reported >= 0.1:
                reported = now
                progress(work.done())
