"""Work in a thread beside the calls that its result will make faster.

Input: what to do. Output: nothing; the work hands its result on. An exiting interpreter does not
wait for it.
"""

from __future__ import annotations

import atexit
import threading
import warnings
from collections.abc import Callable
from typing import Final

from distal.devices.threads import start_threads
from distal.forking import new_lock

# For what takes long: others keep their processors.
ONE_AT_A_TIME: Final = new_lock()
# Held by what an exit must not interrupt, for milliseconds: LLVM's loader. An exit keeps it.
UNINTERRUPTED: Final = new_lock()
atexit.register(UNINTERRUPTED.acquire)


class BackgroundWork:
    """Work that has been started.

    Args:
        work: What to do.
        purpose: The work in words, for the message if it fails.
    """

    def __init__(self, work: Callable[[], None], purpose: str) -> None:
        self._work = work
        self._purpose = purpose
        self._ended = False
        self._failure: BaseException | None = None
        self._start()

    def check(self) -> None:
        """Warn once if the work failed; start it again in a forked child, which has no thread."""
        failure, self._failure = self._failure, None
        if failure is not None:
            text = f"{self._purpose} failed: {str(failure) or type(failure).__name__}"
            warnings.warn(text, RuntimeWarning, stacklevel=2)
        elif not self._ended and not self._thread.is_alive():
            self._start()

    def wait(self, seconds: float | None = None) -> None:
        """Wait for the end of the work."""
        self._thread.join(seconds)

    def _start(self) -> None:
        self._thread = threading.Thread(target=self._run, daemon=True)
        try:
            start_threads([self._thread], [])
        except MemoryError as error:
            self._failure, self._ended = error, True

    def _run(self) -> None:
        try:
            self._work()
        except BaseException as error:
            self._failure = error
        self._ended = True
