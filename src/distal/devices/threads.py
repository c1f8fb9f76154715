"""Run one kernel in several threads, watched by the calling thread.

Input: a function that several threads may call at the same time and that returns when no work is
left, a counter that it advances, and a flag that stops it. Output: nothing; the work is finished or
was stopped. The calling thread only waits, so that ctrl-C and ``cancel`` take effect immediately.
"""

from __future__ import annotations

import operator
import os
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Final, TypeVar

from numpy.typing import NDArray

from distal.devices.base import Cancel, Cancelled, Progress, cancel_test
from distal.forking import new_lock

Result = TypeVar("Result")
_WATCH_S: Final = 0.02  # longest delay of a request to stop
_STACK_BYTES: Final = 16 * 2**20  # twice the LLVM backend's limit for arrays
_STARTING: Final = new_lock()  # the stack size is a setting of the whole process


def usable_threads() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Work:
    """The state that the threads of one run share.

    Attributes:
        counter: The number of the next piece; the kernel advances it.
        stop: Flags; 1 in all of them stops the work.
        pieces: The number of pieces.
    """

    def __init__(self, counter: NDArray[Any], stop: NDArray[Any], pieces: int) -> None:
        self.counter = counter
        self.stop = stop
        self.pieces = pieces

    def done(self) -> float:
        """Return the fraction of the work that is done; pieces in progress count as done."""
        return min(1.0, float(self.counter[0]) / max(1, self.pieces))


def run(
    work: Work,
    function: Callable[[], None],
    threads: int | None,
    progress: Progress | None,
    cancel: Cancel | None,
) -> int:
    """Run the work to its end, and return the number of threads used.

    Args:
        work: The state that the threads share.
        function: The kernel; each thread calls it once.
        threads: The number of threads; None uses all processors of this process.
        progress: Called regularly with the fraction of the work that is done.
        cancel: Called regularly; True stops the work.

    Raises:
        Cancelled: ``cancel`` stopped the work.
        MemoryError: The system cannot start a thread.
        TypeError: ``threads`` is not a whole number.
        ValueError: ``threads`` is below 1.
    """
    count = max(1, min(_checked(threads) or usable_threads(), work.pieces))
    failures: list[BaseException] = []

    def worker() -> None:
        try:
            function()
        except BaseException as error:
            failures.append(error)

    # Daemon threads, because an exiting interpreter must not wait for them.
    workers = [threading.Thread(target=worker, daemon=True) for _ in range(count)]
    started: list[threading.Thread] = []
    try:
        start_threads(workers, started)
        _watch(started, work, progress, cancel)
    except BaseException:
        work.stop[:] = 1
        raise
    finally:
        # Wait for the threads: they write into arrays that the caller may free.
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


def complete(future: Future[Result], work: Callable[[], Result]) -> None:
    """Do some work, and give its result or its exception to a future."""
    try:
        future.set_result(work())
    except BaseException as error:
        future.set_exception(error)


def start_threads(workers: list[threading.Thread], started: list[threading.Thread]) -> None:
    """Start threads with a large stack; those that the system starts are added to ``started``.

    Raises:
        MemoryError: The system starts none, and ``started`` is empty.
    """
    with _STARTING:
        previous = threading.stack_size(_STACK_BYTES)
        try:
            for thread in workers:
                try:
                    thread.start()
                except (
                    RuntimeError
                ):  # the system cannot start more threads; those that run do all the work
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
