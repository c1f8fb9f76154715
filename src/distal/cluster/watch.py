"""Look after the tasks of a cluster: workers that hang, and whether the scheduler is there.

Input: a client, tasks. Output: workers that hang are dropped; Dask gives their tasks to others, and
computes again what only they knew. A task on which two workers hang is given up. A worker stops a
task that takes too long by itself (``limits``), so a worker hangs if it does not even do that.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Final

from distal.cluster.errors import ClusterError, TaskError, address, explained, lost
from distal.forking import new_lock

# The longest time between two looks, in seconds.
_EVERY_S: Final = 5.0
# What a worker needs besides the time of a task: imports and compiling.
GRACE_S: Final = 30.0
# How the keys of constants begin, on which the tasks wait.
CONSTANT: Final = "distal-"


class Watch:
    """Looks after the tasks of a pool.

    Args:
        client: The client.
        timeout: Seconds that a task may take.
        tell: Called with a line of text for each worker that is dropped.
    """

    def __init__(self, client: Any, timeout: float, tell: Callable[[str], None]) -> None:
        self._client, self._timeout, self._tell = client, timeout, tell
        self._limit = timeout + GRACE_S
        self._lock = new_lock()
        self._tasks: dict[str, str] = {}
        self._tried: dict[str, list[str]] = {}
        self._given_up: dict[str, str] = {}
        # What each worker has, and since when it has finished none of it.
        self._held: dict[str, tuple[set[str], float]] = {}
        self._without: float | None = None
        self._next = 0.0

    @contextmanager
    def on(self, futures: Sequence[Any], what: str) -> Iterator[None]:
        """Look after tasks during the block.

        Args:
            futures: The tasks.
            what: What they make, for messages.
        """
        keys = [future.key for future in futures]
        with self._lock:
            if not self._tasks:
                self._next = time.monotonic() + min(self._timeout, _EVERY_S)
            self._tasks |= dict.fromkeys(keys, what)
        try:
            yield
        finally:
            with self._lock:
                for key in keys:
                    for known in (self._tasks, self._tried, self._given_up):
                        known.pop(key, None)

    def look(self, future: Any = None) -> None:
        """Look after the tasks, if the last look was long ago.

        Args:
            future: The task that the calling thread waits for.

        Raises:
            TaskError: Two workers hung on this task.
            ClusterError: The scheduler is lost, or no workers are left.
        """
        if self._client.status not in ("running", "connecting"):
            raise ClusterError(lost(self._client))
        now = time.monotonic()
        with self._lock:
            is_due = now >= self._next
            if is_due:
                self._next = now + min(self._timeout, _EVERY_S)
            tasks = dict(self._tasks)
        if is_due:
            self._look(now, tasks)
        reason = None if future is None else self._given_up.get(future.key)
        if reason is not None:
            raise TaskError(tasks[future.key], reason, shared=True)

    def _look(self, now: float, tasks: Mapping[str, str]) -> None:
        with explained(self._client):
            processing = self._client.processing()
            # Not Client.scheduler_info: what it returns may be that of its timer, without workers.
            identity = self._client.sync(self._client.scheduler.identity, n_workers=-1)
        workers = identity["workers"]
        self._check_workers(now, bool(workers))
        held = {worker: set(keys) for worker, keys in processing.items() if keys}
        since = {}
        for worker, keys in held.items():
            known, begin = self._held.get(worker, (keys, now))
            # A worker that has finished one of them, also one of another client, goes on.
            since[worker] = begin if known <= keys else now
        self._held = {worker: (keys, since[worker]) for worker, keys in held.items()}
        own = {w: [k for k in processing[w] if k in tasks or _is_constant(k)] for w in held}
        late = {w: keys for w, keys in own.items() if keys and now - since[w] >= self._limit}
        if late:
            self._drop(late, workers, tasks)

    def _check_workers(self, now: float, are_there: bool) -> None:
        """Wait for workers if there are none, but not without end."""
        if are_there:
            self._without = None
        elif self._without is None:
            self._without = now
            self._tell(f"the scheduler {address(self._client)} has no workers left: waiting")
        elif now - self._without >= self._limit:
            raise ClusterError(
                f"the scheduler {address(self._client)} has had no workers for {self._limit:g} s; "
                "what is finished is kept"
            )

    def _drop(
        self, late: Mapping[str, list[str]], workers: Mapping[str, Any], tasks: Mapping[str, str]
    ) -> None:
        """Drop the workers that hang.

        Args:
            late: Workers that have finished nothing for long, and the keys of their tasks, in the
                order in which they got them.
            workers: What the scheduler knows of each worker.
            tasks: What each task makes.
        """
        # A worker that is silent is the reason also where another one waits for its data.
        newest = max((w["last_seen"] for w in workers.values()), default=0.0)
        silent = {a for a, w in workers.items() if newest - w["last_seen"] > self._limit}
        for worker in sorted(silent or late):
            if len(workers) < 2:
                raise ClusterError(f"{self._hangs(worker)}, and there is no other")
            key = next((key for key in late.get(worker, ()) if key in tasks), None)
            self._tell(f"{self._hangs(worker)}: it is dropped, others go on")
            if key is not None:
                tried = self._tried.setdefault(key, [])
                tried.append(worker)
                if len(tried) > 1:
                    self._given_up[key] = f"made the workers {' and '.join(tried)} hang"
            self.drop(worker)
            self._held.pop(worker, None)

    def _hangs(self, worker: str) -> str:
        return f"the worker {worker} has finished nothing for more than {self._limit:g} s"

    def drop(self, worker: str) -> None:
        """Take a worker from the scheduler; Dask gives its tasks to others."""
        with explained(self._client):
            self._client.sync(
                self._client.scheduler.unregister, address=worker, stimulus_id="distal-dropped"
            )


def _is_constant(key: Any) -> bool:
    return str(key).startswith(CONSTANT)
