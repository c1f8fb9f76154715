"""A thread that loads, compiles and renders, so that the window never waits.

Input: jobs, and callbacks for their results. Output: calls of the callbacks in the window's thread,
in the order of the jobs. Does not depend on what jobs do.
"""

from __future__ import annotations

import contextlib
import functools
import queue
import threading
from collections.abc import Callable
from typing import Any, Final, TypeAlias

# Called in the window's thread with a result, or with the exception that was raised.
Done: TypeAlias = "Callable[[Any], None]"
Job: TypeAlias = "Callable[[threading.Event], Any]"
Jobs: TypeAlias = "queue.SimpleQueue[tuple[Job, Done, threading.Event] | None]"

_END: Final = None


class Worker:
    """Runs jobs one after the other.

    Attributes:
        waiting: Number of jobs that are not finished.
    """

    def __init__(self, post: Callable[[Callable[[], None]], None]) -> None:
        """Start the thread; ``post`` runs a function in the window's thread, from any thread."""
        self.waiting = 0
        self._post = post
        self._ended = False
        self._abandoned: list[threading.Thread] = []
        self._begin()

    def _begin(self) -> None:
        self._jobs: Jobs = queue.SimpleQueue()
        self._cancel = threading.Event()  # of all jobs that are submitted until it is set
        # A daemon thread, because a compiler cannot be interrupted.
        self._thread = threading.Thread(
            target=self._run, args=(self._jobs,), name="distal-window", daemon=True
        )
        self._thread.start()

    def submit(self, job: Job, done: Done) -> None:
        """Run a job after all earlier jobs. Its argument is the event that asks it to end early."""
        self.waiting += 1
        self._jobs.put((job, done, self._cancel))

    def cancel(self) -> None:
        """Ask the jobs that run or wait to end early; they may also finish."""
        self._cancel.set()
        self._cancel = threading.Event()

    def abandon(self) -> None:
        """Run the jobs that wait in another thread: the one that runs may never end.

        Nothing is done with its result.
        """
        left, self.waiting = self._jobs, self.waiting - 1
        self._cancel.set()
        self._abandoned.append(self._thread)
        self._begin()
        with contextlib.suppress(queue.Empty):
            while True:
                work = left.get_nowait()
                self._jobs.put(work and (*work[:2], self._cancel))
        left.put(_END)

    def stop(self, patience_s: float) -> bool:
        """End the threads; return whether they ended within ``patience_s`` seconds."""
        self._ended = True
        self._cancel.set()
        self._jobs.put(_END)
        self._thread.join(patience_s)
        return not any(thread.is_alive() for thread in (self._thread, *self._abandoned))

    def _run(self, jobs: Jobs) -> None:
        while (work := jobs.get()) is not _END:
            job, done, cancel = work
            if self._ended:
                return
            try:
                result = job(cancel)
            except BaseException as error:  # the window reports every exception
                result = error
            if jobs is not self._jobs:  # abandoned
                return
            if not self._ended:
                self._post(functools.partial(self._finish, jobs, done, result))

    def _finish(self, jobs: Jobs, done: Done, result: Any) -> None:
        if jobs is self._jobs:  # else it was abandoned after it had ended
            self.waiting -= 1
            done(result)
