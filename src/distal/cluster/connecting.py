"""Connect to a cluster by the text of ``--cluster``.

Input: "local", "local:N", the address of a scheduler, or its file. Output: a pool, for the time of
a block. Nothing listens beyond this machine.
"""

from __future__ import annotations

import ipaddress
import json
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from distal.cluster.errors import ClusterError, address, words
from distal.cluster.local import LOCAL, local_client
from distal.cluster.pool import TIMEOUT_S, WorkerPool
from distal.devices.threads import complete, usable_threads
from distal.packages import imported

_CONNECT_S: Final = 10.0
_OTHER_SERVER: Final = "what listens there does not answer as a scheduler does"
_PROTOCOLS: Final = ("tcp", "tls", "ucx", "ws", "wss")
_PLAIN: Final = ("tcp", "ucx", "ws")
_FORMS: Final = "local, local:4, tcp://host:8786, tls://host:8786, or the scheduler's file"
_CERTIFICATE: Final = "Dask's settings distributed.comm.tls.ca-file, client.cert and client.key"


_OPEN: Final = (
    "is not encrypted: whoever reaches it runs code as the user of its workers; "
    "tls:// admits only those who have a key"
)


@contextmanager
def connected(
    where: str, *, timeout: float = TIMEOUT_S, tell: Callable[[str], None] | None = None
) -> Iterator[WorkerPool]:
    """Connect to a cluster for the time of a block.

    Args:
        where: "local" for a process on each processor of this machine, "local:N" for N, the address
            of a scheduler, or the path of its file.
        timeout: Seconds after which a task is given to another worker.
        tell: Called with a line of text, for example of workers with another processor.

    Raises:
        ClusterError: There is no such cluster.
        PackageError: ``distal[cluster]`` is not installed.
    """
    _check_proc()
    if where == LOCAL or where.startswith(f"{LOCAL}:"):
        with local_client(_count(where)) as client:
            yield WorkerPool(client, timeout=timeout, tell=tell)
        return
    client = _client(where)
    if tell is not None and _is_open(address(client)):
        tell(f"warning: {address(client)} {_OPEN}")
    try:
        yield WorkerPool(client, timeout=timeout, tell=tell)
    finally:
        client.close(timeout=2)


def _check_proc() -> None:
    """Check that Dask can read its own process.

    Raises:
        ClusterError: It cannot: Linux's list of processes is not mounted.
    """
    if sys.platform == "linux" and not Path("/proc/self").exists():
        raise ClusterError(
            "Dask needs /proc, which is not there; without --cluster it is not needed"
        )


def _count(where: str) -> int:
    text = where.removeprefix(LOCAL).removeprefix(":")
    if not text:
        return usable_threads()
    if not text.isdigit() or not 1 <= int(text) <= 1024:
        raise ClusterError(f"'{where}': local:N has 1 to 1024 processes")
    return int(text)


def _is_open(where: str) -> bool:
    """Return whether others than this machine's users reach a scheduler, and it asks for no key."""
    protocol, _, rest = where.partition("://")
    host = rest.rpartition(":")[0].strip("[]")
    try:
        is_here = ipaddress.ip_address(host).is_loopback
    except ValueError:
        is_here = host == "localhost"
    return protocol in _PLAIN and not is_here


def _check_file(path: Path) -> None:
    """Check that a file is one that a scheduler wrote.

    Raises:
        ClusterError: It is not, or it cannot be read.
    """
    if not path.is_file():
        raise ClusterError(f"there is no file {path}; --cluster takes {_FORMS}")
    try:
        found = json.loads(path.read_text("utf-8"))["address"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        found = None
    if not isinstance(found, str):
        raise ClusterError(f"{path} is no file of a scheduler: dask scheduler --scheduler-file")
    if found.startswith("tls://"):
        _check_certificate(found)


def _check_certificate(where: str) -> None:
    """Check that Dask's settings name a certificate.

    Raises:
        ClusterError: They name none, or one that cannot be read.
    """
    security: Any = imported("distributed.security")
    try:
        found = security.Security().get_connection_args("client")["ssl_context"]
    except (OSError, ValueError) as error:  # errors of the ssl module are OSErrors
        raise ClusterError(
            f"the certificate for {where} cannot be read: {words(error)}; {_CERTIFICATE} name it"
        ) from None
    if found is None:
        raise ClusterError(f"{where} needs a certificate: {_CERTIFICATE} name the files")


def _in_time(connect: Callable[[], Any]) -> Any:
    """Return the client that a function makes.

    Dask's limit of time does not hold for a server that is no scheduler: it waits for an answer, or
    for the bytes that one seems to announce.

    Raises:
        TimeoutError: The function does not return.
    """
    ended: Future[Any] = Future()
    # No pool of threads, which Python would wait for at its end.
    threading.Thread(target=complete, args=(ended, connect), daemon=True).start()
    try:
        return ended.result(3.0 * _CONNECT_S)
    except TimeoutError:
        if ended.done():
            raise
        raise TimeoutError(_OTHER_SERVER) from None


def _client(where: str) -> Any:
    if where.startswith("tls://"):
        _check_certificate(where)
    client = imported("distributed").Client
    given: dict[str, Any] = {"timeout": _CONNECT_S, "set_as_default": False}
    protocol, separator, host = where.partition("://")
    if separator and protocol not in _PROTOCOLS:
        raise ClusterError(f"'{where}' is no cluster; --cluster takes {_FORMS}")
    if separator and not host.rpartition(":")[2].isdigit():
        raise ClusterError(f"'{where}' has no port: {protocol}://host:8786")
    try:
        if separator:
            return _in_time(lambda: client(where, **given))
        if where.endswith(".json"):
            _check_file(Path(where))
            return _in_time(lambda: client(scheduler_file=where, **given))
    except ClusterError:
        raise
    except (OSError, TimeoutError) as error:
        raise ClusterError(f"no scheduler answers at {where}: {words(error)}") from None
    except MemoryError:  # the length of a message, as Dask reads the answer of another server
        raise ClusterError(f"no scheduler answers at {where}: {_OTHER_SERVER}") from None
    except Exception as error:
        raise ClusterError(f"{where} is no scheduler: {words(error)}") from None
    raise ClusterError(f"'{where}' is no cluster; --cluster takes {_FORMS}")
