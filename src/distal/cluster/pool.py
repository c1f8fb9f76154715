"""Send work to the workers of a Dask scheduler, and take what they return.

Input: a client; tasks. Output: what tasks return; programs and data at the workers. Dask decides
who does what, repeats the work of workers that ended, and moves data. What is added here: the check
of versions, a limit of time, and messages of one line.
"""

from __future__ import annotations

import socket
import threading
import time
import warnings
from collections.abc import Callable, Hashable, Mapping, MutableMapping, Sequence
from contextlib import suppress
from queue import SimpleQueue
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from distal.cluster import work
from distal.cluster.errors import ClusterError, OtherVersionError, address, explained, words
from distal.cluster.programs import Plain, Sent, digest_of, sent
from distal.cluster.sizes import PartSizes
from distal.cluster.watch import CONSTANT, Watch
from distal.devices.base import Cancelled, cancel_test
from distal.devices.features import chosen_level
from distal.forking import new_lock
from distal.lang.composed import Composed
from distal.lang.functions import Image
from distal.lang.render_options import Cancel
from distal.lang.runtime_access import executor
from distal.packages import imported
from distal.version import __version__

# The longest time until a request to stop is noticed, in seconds.
_LOOK_S: Final = 0.1
# How long workers are waited for that have not joined yet, in seconds.
_JOIN_S: Final = 10.0
# How long a worker of this network may take to accept a connection, in seconds.
_REACH_S: Final = 1.0
# For how long an answer of the scheduler on its workers is good, in seconds.
_SLOTS_S: Final = 1.0
# A task that takes longer is given to another worker, once.
TIMEOUT_S: Final = 600.0
# One pool for each client: it checks the workers once, and sends each program once.
_POOLS: Final[MutableMapping[Any, WorkerPool]] = WeakKeyDictionary()
# How tasks are submitted: Dask repeats one that raised an error once, on any worker.
SUBMITTED: Final[Mapping[str, Any]] = {"pure": False, "retries": 1}
# Programs, and programs and data at the workers, that are kept for the next picture.
_MOST_PROGRAMS: Final = 16
_MOST_SENT: Final = 128
_LARGE_GRAPH: Final = "Sending large graph"


class WorkerPool:
    """The workers of a client.

    Attributes:
        client: The ``dask.distributed.Client``.
        watch: Looks after its tasks.

    Args:
        client: The client.
        timeout: Seconds after which a task is given to another worker.
        tell: Called with a line of text, for example of workers with another processor.
    """

    def __init__(
        self,
        client: Any,
        *,
        timeout: float = TIMEOUT_S,
        tell: Callable[[str], None] | None = None,
    ) -> None:
        self.client = client
        self._timeout = timeout
        self._tell = tell or (lambda words: warnings.warn(words, stacklevel=3))
        self.watch = Watch(client, timeout, self._tell)
        self._lock = new_lock()
        self._sent: dict[str, Any] = {}  # futures of constants, by their names
        self._programs: dict[int, tuple[Any, Sent, Any]] = {}
        self._sizes: dict[Hashable, PartSizes] = {}
        self._levels: set[str] = set()
        self._own_level = chosen_level(None).name
        self._refused: set[str] = set()
        self._is_direct = False
        self._checked = False
        self._slots, self._slots_until = 1, 0.0

    @property
    def slots(self) -> int:
        """How many tasks the workers do at the same time, a second ago; 1 while there are none."""
        now = time.monotonic()
        if now >= self._slots_until:
            self._slots = _aside(self._asked_slots)
            self._slots_until = now + _SLOTS_S
        return self._slots

    def _asked_slots(self) -> int:
        try:
            return max(1, int(sum(self.client.nthreads().values())))
        except Exception:
            return 1

    def check(self) -> None:
        """Check that there are workers, and that they have this version.

        Raises:
            ClusterError: There are none, or one of them has another version.
        """
        if self._checked:
            return
        with explained(self.client):
            with suppress(TimeoutError):  # workers that were started with this command come late
                self.client.wait_for_workers(1, timeout=_JOIN_S)
            answers = self.client.run(work.about, on_error="return")
        # Workers that end meanwhile are replaced by others, as during the work.
        answers = {w: answer for w, answer in answers.items() if not isinstance(answer, OSError)}
        if not answers:
            raise ClusterError(
                f"the scheduler {address(self.client)} has no workers: start some with "
                f"'dask worker {address(self.client)}'"
            )
        for worker, answer in answers.items():
            if isinstance(answer, ModuleNotFoundError):
                raise ClusterError(
                    f"the worker {worker} has no distal: pip install distal=={__version__} there"
                )
            if isinstance(answer, BaseException):
                raise ClusterError(f"the worker {worker} fails: {words(answer)}")
            if answer["version"] != __version__:
                refused = _other_version(worker, answer["version"])
                raise ClusterError(f"{refused}: install the same version there")
            self.saw_level(answer["level"])
        # Else each result goes through the scheduler, which copies it.
        self._is_direct = all(map(_is_reachable, answers))
        self._checked = True

    # Programs

    def program_of(self, image: Image | Composed) -> Sent:
        """Return what is sent of a picture; kept as long as it is unchanged."""
        parts = executor().parts(image)
        with self._lock:
            known = self._programs.pop(id(image), None)
            if known is None or known[0] is not parts:
                known = parts, sent(image), image
            # The entry holds the picture, so that its identity does not recur.
            _keep(self._programs, id(image), known, _MOST_PROGRAMS)
            return known[1]

    # Work

    def call(self, **given: Any) -> Plain:
        """Return the argument of a task that is its own."""
        return {**given, "version": __version__, "limit_s": self._timeout}

    def constant(self, name: str, content: Any) -> Any:
        """Return the future of plain data, which workers take from each other.

        It is a task, not data at a worker: if the worker ends, another one gets it again.
        """
        with self._lock:
            future = self._sent.pop(name, None)
            if future is None or future.status in ("cancelled", "lost", "error"):
                future = self._submitted(name, content)
            _keep(self._sent, name, future, _MOST_SENT)
            return future

    def data_of(self, program: Sent) -> dict[str, Any]:
        """Return the futures of a program's data."""
        return {name: self.constant(name, content) for name, content in program.data.items()}

    def sizes(self, key: Hashable, least: int, unit: int) -> PartSizes:
        """Return what is known of the parts of a program, to choose the size of the next ones."""
        with self._lock:
            found = self._sizes.pop(key, None) or PartSizes(least, unit)
            _keep(self._sizes, key, found, _MOST_SENT)
            return found

    def array(self, array: NDArray[np.generic]) -> Any:
        """Return an array of one pass for the arguments of a task: its future if it is large."""
        if array.nbytes < 2**16:
            return array
        content = np.ascontiguousarray(array)
        with self._lock:
            return self._submitted(digest_of(content), content)

    def _submitted(self, name: str, content: Any) -> Any:
        """Return the future of plain data; call it with the lock, as filters are not safe."""
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", _LARGE_GRAPH)
            key = f"{CONSTANT}{name}"
            return self.client.submit(work.constant, content, key=key, priority=10)

    def result(self, submit: Callable[[], Any], cancel: Cancel | None, what: str) -> Any:
        """Return the result of a task; one that takes too long is given to another worker.

        Args:
            submit: Submits the task, and returns its future.
            cancel: Stops waiting for it.
            what: What it makes, for messages.

        Raises:
            Cancelled: ``cancel`` stopped it.
            TaskError: It failed on the workers that tried it, or took too long there.
            ClusterError: The scheduler is lost.
        """
        wanted = cancel_test(cancel)
        while True:
            future, ended = _begun(submit())
            try:
                with self.watch.on([future], what):
                    while not ended.wait(_LOOK_S):
                        if wanted():
                            raise Cancelled
                        self.watch.look(future)
                return self.taken(future, what)
            except OtherVersionError as error:
                self.refuse(error)
            except BaseException:
                self.give_up([future])
                raise

    def give_up(self, futures: list[Any]) -> None:
        """Cancel tasks; a scheduler that is lost has none any more."""
        with suppress(Exception):
            self.client.cancel(futures, force=True)

    def wait(self, futures: Sequence[Any]) -> None:
        """Wait until one of some tasks is finished, or it is time to look for other things.

        Raises:
            ClusterError: The scheduler is lost.
        """
        wait = imported("distributed").wait
        with suppress(TimeoutError), explained(self.client), self.client.as_current():
            wait(futures, timeout=_LOOK_S, return_when="FIRST_COMPLETED")

    def taken(self, future: Any, what: str) -> Any:
        """Return the result of a finished task.

        Raises:
            TaskError: It failed.
            OtherVersionError: The worker has another version.
            ClusterError: The scheduler is lost.
        """
        status = future.status
        with explained(self.client, what, is_of_task=status == "error"):
            if status != "finished":
                return future.result()
            return self.client.gather(future, direct=self._is_direct)

    def refuse(self, error: OtherVersionError) -> None:
        """Drop a worker with another version, which joined after the check."""
        worker, version = error.args
        with self._lock:
            if worker in self._refused:
                return
            self._refused.add(worker)
        self._tell(f"{_other_version(worker, version)}: it is dropped, others go on")
        self.watch.drop(worker)

    def saw_level(self, level: str) -> None:
        """Tell once of workers whose processors have another level."""
        if level == self._own_level or level in self._levels:
            return
        self._levels.add(level)
        self._tell(
            f"a worker computes with {level}, this machine with {self._own_level}: the last bits "
            "of pixels may differ"
        )


def pool_of(cluster: Any) -> WorkerPool:
    """Return the pool of a client; a pool is returned unchanged.

    Raises:
        TypeError: It is neither.
    """
    if isinstance(cluster, WorkerPool):
        return cluster
    if not isinstance(cluster, imported("distributed").Client):
        raise TypeError(f"cluster is a dask.distributed.Client, not {type(cluster).__name__}")
    known = _POOLS.get(cluster)
    if known is None:
        known = _POOLS[cluster] = WorkerPool(cluster)
    return known


def _keep(kept: dict[Any, Any], key: Any, value: Any, most: int) -> None:
    """Add an entry as the newest one, and drop the oldest ones if there are too many."""
    kept[key] = value
    while len(kept) > most:
        kept.pop(next(iter(kept)))


def _begun(future: Any) -> tuple[Any, threading.Event]:
    """Return a future, and an event that is set when it is finished."""
    ended = threading.Event()
    future.add_done_callback(lambda _: ended.set())
    return future, ended


def _aside(ask: Callable[[], int]) -> int:
    """Return an answer of another thread: ctrl-C while Dask itself waits prints a traceback."""
    answers: SimpleQueue[int] = SimpleQueue()
    threading.Thread(target=lambda: answers.put(ask()), daemon=True).start()
    return answers.get()


def _other_version(worker: str, version: str) -> str:
    return f"the worker {worker} has distal {version}, this process {__version__}"


def _is_reachable(worker: str) -> bool:
    """Return whether this machine can connect to a worker, which may be in a network of its own."""
    host, _, port = worker.rpartition("://")[2].rpartition(":")
    try:
        with socket.create_connection((host.strip("[]"), int(port)), _REACH_S):
            return True
    except (OSError, ValueError):
        return False
