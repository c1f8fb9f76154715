"""The frame of a task on a worker: which tasks it refuses, when it stops one, how one fails.

Input: the version and the limit that the sender gives; what Dask knows of the task of this thread.
Output: the task's result, or an error whose text alone travels. Renderers ask many times a second
whether to stop.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Final, TypeVar

from distal.cluster.errors import FailedTaskError, OtherVersionError, TooLongError, words
from distal.cluster.programs import Plain
from distal.devices.base import Cancelled
from distal.diagnostics import printable
from distal.version import __version__

Result = TypeVar("Result")
# How Dask names the state of a task that runs here while nobody waits for it any more.
_UNWANTED: Final = frozenset({"cancelled", "released", "forgotten"})


def run(call: Plain, body: Callable[[Callable[[], bool]], Result]) -> Result:
    """Return the result of a task of this thread.

    Args:
        call: ``version`` of the sender, and ``limit_s``, the seconds after which the task is
            stopped, counted from the first request to stop on: without compiling.
        body: Does the work; it gets a function that says when to stop.

    Raises:
        OtherVersionError: The sender has another version; workers that join late are checked here.
        TooLongError: The task was stopped because it took too long.
        FailedTaskError: There was another error. Dask does not deliver errors that cannot be read
            on the other side, such as one with a thousand frames, so the text alone is sent.
    """
    if call["version"] != __version__:
        raise OtherVersionError(_worker().address, __version__)
    begin: list[float] = []
    wanted = _wanted()

    def is_late() -> bool:
        return bool(begin) and time.monotonic() - begin[0] > call["limit_s"]

    def stop() -> bool:
        if not begin:
            begin.append(time.monotonic())
        return is_late() or not wanted()

    failure: Exception
    try:
        return body(stop)
    except Cancelled as error:
        failure = TooLongError(f"took more than {call['limit_s']:g} s") if is_late() else error
    except Exception as error:
        failure = FailedTaskError(printable(words(error)))
    # Outside of the handlers, so that the first error is not sent as the context.
    raise failure.with_traceback(None)


def _worker() -> Any:
    from distributed import get_worker  # noqa: PLC0415 (slow to import)

    return get_worker()


def _wanted() -> Callable[[], bool]:
    """Return a function that says whether somebody waits for the task of this thread."""
    try:
        worker = _worker()
        key = worker.get_current_task()
    except (ValueError, KeyError):  # no thread of a worker
        return lambda: True
    known: Any = worker.state.tasks.get(key)
    return lambda: known is None or known.state not in _UNWANTED
