"""The one thread that loads, compiles and renders, so that the window never waits.

Input: jobs, and what to do with their results. Output: results, handed to the
window's own thread in the order of their jobs. Knows nothing of what jobs do.
"""

from __future__ import annotations

import functools
import queue
import threading
from collections.abc import Callable
from typing import Any, Final, TypeAlias

# Called in the window's thread with a result, or with what was raised.
Done: TypeAlias = "Callable[[Any], None]"
Job: TypeAlias = "Callable[[threading.Event], Any]"

_END: Final = None


class Worker:
    """Runs one job after the other.

    Attributes:
        waiting: How many jobs are not done.
    """

    def __init__(self, post: Callable[[Callable[[], None]], None]) -> None:
        """``post`` calls a function soon in the window's thread, from any thread."""
        self.waiting = 0
        self._post = post
        self._jobs: queue.SimpleQueue[tuple[Job, Done] | None] = queue.SimpleQueue()
        self._cancel = threading.Event()
        self._ended = False
        # A daemon: a compiler cannot be interrupted.
        self._thread = threading.Thread(target=self._run, name="distal-window", daemon=True)
        self._thread.start()

    def submit(self, job: Job, done: Done) -> None:
        """Run a job when those before it are done. It is given the sign to end early."""
        self.waiting += 1
        self._jobs.put((job, done))

    def cancel(self) -> None:
        """Request that the running job ends early; it is free to finish."""
        self._cancel.set()

    def stop(self, patience_s: float) -> bool:
        """End the thread; whether it ended in time."""
        self._ended = True
        self._cancel.set()
        self._jobs.put(_END)
        self._thread.join(patience_s)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while (work := self._jobs.get()) is not _END:
            job, done = work
            self._cancel.clear()
            if self._ended:  # set between the two: the sign must not be lost
                return
            try:
                result = job(self._cancel)
            except BaseException as error:  # whatever it is: the window reports it
                result = error
            if not self._ended:
                self._post(functools.partial(self._finish, done, result))

    def _finish(self, done: Done, result: Any) -> None:
        self.waiting -= 1
        done(result)
