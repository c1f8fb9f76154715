"""The cluster of ``--cluster local``: a scheduler in this process, workers in processes beside it.

Input: a number of workers. Output: a client, for the time of a block. All of it speaks TLS with
credentials that live as long as the block, and listens on 127.0.0.1 alone, one port for the
scheduler and one for each worker. Workers are ordinary processes, not those of Python's
``multiprocessing``, which needs semaphores; they are not in this process's group, so ctrl-C of a
terminal does not reach them, and they end when their input is closed, so also when this process is
killed.
"""

from __future__ import annotations

import json
import logging
import os
import secrets
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sized
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final, Self

from distal.cluster.errors import ClusterError, words
from distal.forking import new_lock
from distal.packages import imported, loading

LOCAL: Final = "local"
# How a scheduler or a worker listens.
LISTENING: Final[Mapping[str, Any]] = {"host": "127.0.0.1", "protocol": "tls://"}
# How long workers may take to join, in seconds: on a busy machine they import slowly.
_JOIN_S: Final = 60.0
_LOOK_S: Final = 0.02
# How long after the end of a process the next one begins, in seconds.
_AGAIN_S: Final = 0.2
# How long each part of the cluster may take to end, in seconds.
_CLOSE_S: Final = 1.0
# The scheduler is in this process, and its logs hold messages: 11 kB for each frame.
_SHORT_LOGS: Final = {
    "distributed.admin.log-length": 100,
    "distributed.admin.low-level-log-length": 50,
    "distributed.admin.system-monitor.log-length": 100,
    "distributed.diagnostics.computations.max-history": 10,
}
# -P: without the folder of the scene, whose files may have the names of modules.
_COMMAND: Final = (
    *("-P", "-c"),
    "import sys, json; settings = json.loads(sys.stdin.buffer.raw.readline()); "
    "sys.path[:] = settings['path']; from distal.cluster.local_worker import run; run(settings)",
)
_OUTSIDE_THIS_GROUP: Mapping[str, Any]
if sys.platform == "win32":
    _OUTSIDE_THIS_GROUP = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
else:
    _OUTSIDE_THIS_GROUP = {"start_new_session": True}


@contextmanager
def local_client(count: int) -> Iterator[Any]:
    """Start a cluster of processes of one thread each, for the time of a block.

    Args:
        count: How many workers.

    Raises:
        ClusterError: The workers do not start.
        PackageError: Dask, or what it makes credentials with, is not installed.
    """
    distributed: Any = imported("distributed")
    imported("cryptography")
    with loading("cryptography"):
        security = distributed.Security.temporary()
    silent = imported("distributed.utils").silence_logging_cmgr(logging.CRITICAL)
    with silent, imported("dask").config.set(_SHORT_LOGS), _Workers(security, count) as workers:
        cluster = _scheduler(security, workers.make_folder())
        client = None
        try:
            workers.start(cluster.scheduler.address)
            workers.wait(cluster.scheduler.workers)
            client = distributed.Client(cluster, set_as_default=False)
            yield client
        finally:
            # First, so that none of them does what nobody waits for.
            workers.end()
            for server in filter(None, (client, cluster)):
                with suppress(TimeoutError):
                    server.close(timeout=_CLOSE_S)


def _scheduler(security: Any, folder: str) -> Any:
    """Return a cluster of Dask that has no workers yet.

    Raises:
        ClusterError: It does not start, as on a full disk.
    """
    distributed: Any = imported("distributed")
    options = {**LISTENING, "port": 0, "security": security, "local_directory": folder}
    try:
        return distributed.SpecCluster(
            workers={},
            scheduler={"cls": without_http(distributed.Scheduler), "options": options},
            security=security,
            shutdown_on_close=False,  # at Python's end Dask would wait for what was interrupted
        )
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"the scheduler of '{LOCAL}' does not start: {words(error)}") from None


def without_http(server: Any) -> Any:
    """Return the class of a server of Dask that opens no port for web pages, which need no key."""
    return type(server.__name__, (server,), {"start_http_server": lambda *_, **__: None})


class _Workers:
    """The processes of the workers, and a folder for them; one that ends is started again.

    Args:
        security: The credentials; they reach a process by its input, never as a file, argument or
            variable.
        count: How many.
    """

    def __init__(self, security: Any, count: int) -> None:
        values = {name: getattr(security, name) for name in security.__slots__}
        self._settings: dict[str, Any] = {
            "path": [entry for entry in sys.path if isinstance(entry, str)],
            "security": {n: v for n, v in values.items() if isinstance(v, str | bool)},
            "memory": 1.0 / count,
        }
        self._count = count
        self._processes: dict[int, subprocess.Popen[bytes]] = {}
        self._threads: list[threading.Thread] = []
        self._lock = new_lock()
        self._is_ending = threading.Event()
        self._ends = 0  # how many processes have ended by themselves
        self._error = ""  # why one could not be started
        # Python's libraries of arithmetic would have a thread for each processor in each worker.
        single = imported("dask").config.get("distributed.nanny.pre-spawn-environ")
        self._environment = {**{name: str(value) for name, value in single.items()}, **os.environ}
        self._name = f"distal-cluster-{secrets.token_hex(8)}"
        self._folder: Path | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def make_folder(self) -> str:
        """Make the folder in which Dask writes, and not into one that all users share.

        Raises:
            ClusterError: There is no place for it.
        """
        try:
            self._folder = Path(tempfile.gettempdir()) / self._name
            os.mkdir(self._folder, 0o700)
        except OSError as error:
            raise ClusterError(f"'{LOCAL}' needs a folder for temporary files: {error}") from None
        self._settings["folder"] = str(self._folder)
        return str(self._folder)

    def start(self, scheduler: str) -> None:
        """Start the processes for the scheduler of an address.

        Raises:
            ClusterError: The system has no threads for them.
        """
        self._settings["scheduler"] = scheduler
        for number in range(self._count):
            thread = threading.Thread(target=self._keep, args=(number,), daemon=True)
            try:
                thread.start()
            except RuntimeError as error:
                raise ClusterError(f"'{LOCAL}:{self._count}' is too much: {error}") from None
            self._threads.append(thread)

    def wait(self, joined: Sized) -> None:
        """Wait until all have joined the scheduler, or some and time is up.

        Args:
            joined: Those that the scheduler knows.

        Raises:
            ClusterError: They end as they start, or none has joined in time.
        """
        deadline = time.monotonic() + _JOIN_S
        while len(joined) < self._count:
            is_late = time.monotonic() > deadline
            if is_late and joined:
                return
            if is_late or self._ends > self._count:
                what = f"have not joined in {_JOIN_S:g} s" if is_late else "end as they start"
                raise ClusterError(f"the workers of '{LOCAL}' {what}: {self._last_line()}")
            time.sleep(_LOOK_S)  # not in Dask, where ctrl-C prints a traceback

    def end(self) -> None:
        """End the processes."""
        self._is_ending.set()
        with self._lock:
            for process in self._processes.values():
                process.kill()
        for thread in self._threads:
            thread.join(_CLOSE_S)

    def _keep(self, number: int) -> None:
        """Start a process, again whenever it ends, until all are to end."""
        while True:
            with self._lock:
                if self._is_ending.is_set():
                    return
                process = self._begun(number)
            if process is not None:
                stdin: Any = process.stdin
                with suppress(OSError), process:  # it may have ended already
                    stdin.write(json.dumps(self._settings).encode() + b"\n")
                    stdin.flush()
                    process.wait()
            self._ends += 1
            self._is_ending.wait(_AGAIN_S)

    def _begun(self, number: int) -> subprocess.Popen[bytes] | None:
        """Start a process, which then waits for its settings; None if the system does not."""
        try:
            with open(self._messages(number), "wb") as messages:
                process = self._processes[number] = subprocess.Popen(
                    [sys.executable, *_COMMAND],
                    stdin=subprocess.PIPE,
                    stdout=messages,
                    stderr=messages,
                    env=self._environment,
                    **_OUTSIDE_THIS_GROUP,
                )
        except OSError as error:
            self._error = words(error)
            return None
        return process

    def _messages(self, number: int) -> Path:
        return Path(self._settings["folder"]) / f"{number}.txt"

    def _last_line(self) -> str:
        """Return the last line that one of them has written, or why there is none."""
        if self._error:
            return self._error
        for number in range(self._count):
            with suppress(OSError):
                lines = self._messages(number).read_text("utf-8", "replace").strip().splitlines()
                if lines:
                    return lines[-1]
        return "they say nothing"
