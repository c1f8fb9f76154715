"""Errors of a cluster, in one line each. Input: errors of Dask and of tasks. Output: a text."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from distal.devices.base import Cancelled, PartError
from distal.diagnostics import LONGEST_MESSAGE, DeviceError, printable


class TooLongError(Exception):
    """A worker stopped a task that took longer than its limit."""


class FailedTaskError(Exception):
    """A task failed; the text says why."""


class OtherVersionError(Exception):
    """A worker has another version of distal; its address and its version are the arguments."""


class ClusterError(DeviceError):
    """The cluster cannot do the work; the message is one line."""

    def __init__(self, message: str) -> None:
        super().__init__(printable(message, LONGEST_MESSAGE))


class TaskError(ClusterError, PartError):
    """A task failed on each worker that tried it, or took too long there; others are not concerned.

    Attributes:
        what: What the task makes, for messages.
        reason: Why it failed, as the rest of a sentence that begins with ``what``.
        shared: Whether another task of the same worker may be the reason.
    """

    def __init__(self, what: str, reason: str, *, shared: bool = False) -> None:
        super().__init__(f"{what} {reason}")
        self.what, self.reason, self.shared = what, printable(reason, LONGEST_MESSAGE), shared


@contextmanager
def explained(client: Any, what: str = "the work", *, is_of_task: bool = False) -> Iterator[None]:
    """Report errors of Dask and of tasks in one line.

    Args:
        client: The client.
        what: What is made, for messages.
        is_of_task: Whether the block raises the error of a task, and never one of Dask.

    Raises:
        ClusterError: There was one; a ``TaskError`` if it concerns this task alone.
    """
    from distributed import KilledWorker  # noqa: PLC0415 (an optional package, slow to import)
    from distributed.client import FutureCancelledError  # noqa: PLC0415
    from distributed.comm.core import CommClosedError  # noqa: PLC0415

    try:
        yield
    except (KeyboardInterrupt, ClusterError):
        raise
    except KilledWorker as error:
        raise TaskError(what, _of_killed(error), shared=True) from None
    except TooLongError as error:
        raise TaskError(what, str(error)) from None
    except OtherVersionError:
        raise
    except Exception as error:
        if not is_of_task and isinstance(error, TimeoutError | Cancelled):
            raise
        if not is_of_task and isinstance(error, CommClosedError | FutureCancelledError | OSError):
            raise ClusterError(f"{lost(client)} ({words(error)})") from None
        raise TaskError(what, f"failed on a worker: {words(error)}") from error


def _of_killed(error: Any) -> str:
    """Return the reason of a task whose workers ended."""
    last = getattr(getattr(error, "last_worker", None), "address", "")
    where = f", at last {last}" if last else ""
    return f"ended each of the {error.allowed_failures + 1} workers that tried it{where}"


def words(error: BaseException) -> str:
    """Return the first line of an error's message, with the error's class if that says more."""
    lines = str(error).strip().splitlines()
    if not lines:
        return type(error).__name__
    return f"KeyError: {lines[0]}" if isinstance(error, KeyError) else lines[0]


def address(client: Any) -> str:
    """Return the address of a client's scheduler."""
    scheduler = getattr(client, "scheduler", None)
    return str(getattr(scheduler, "address", "") or "of the cluster")


def lost(client: Any) -> str:
    """Return the message for a scheduler that does not answer."""
    return f"the scheduler {address(client)} is lost; what is finished is kept"
