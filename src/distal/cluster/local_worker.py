"""The process of a worker of ``--cluster local``.

Input: its settings, a line of JSON on stdin that ``local`` writes, with the credentials. The end of
stdin is the end of the other process, and of this one. Output: what Dask's worker does.
"""

from __future__ import annotations

import asyncio
import logging
import os
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Mapping
from typing import Any, Final

from distal.cluster.local import LISTENING, without_http
from distal.packages import imported

_LOOK_S: Final = 0.1


def run(settings: Mapping[str, Any]) -> None:
    """Work until stdin ends.

    Args:
        settings: ``scheduler``, its address; ``security``, arguments of Dask's ``Security``;
            ``folder``, for temporary files; ``memory``, the share of this machine's memory.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where the group of processes is the same
    threading.Thread(target=_end_with_stdin, args=(settings["folder"],), daemon=True).start()
    # Dask writes the key to a file for as long as OpenSSL reads it.
    tempfile.tempdir = settings["folder"]
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    asyncio.run(_work(settings))


async def _work(settings: Mapping[str, Any]) -> None:
    distributed: Any = imported("distributed")
    worker = without_http(distributed.Worker)(
        settings["scheduler"],
        nthreads=1,
        memory_limit=settings["memory"],
        local_directory=settings["folder"],
        security=distributed.Security(**settings["security"]),
        **LISTENING,
    )
    async with worker:
        limit = worker.memory_manager.memory_limit
        threading.Thread(target=_end_when_full, args=(limit,), daemon=True).start()
        await worker.finished()


def _end_with_stdin(folder: str) -> None:
    while os.read(0, 4096):
        pass
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)


def _end_when_full(limit: float | None) -> None:
    """End the process before it takes the memory of others, as Dask's nannies do."""
    share = imported("dask").config.get("distributed.worker.memory.terminate")
    if not share or not limit:
        return
    process = imported("psutil").Process()
    while process.memory_info().rss < share * limit:
        time.sleep(_LOOK_S)
    os._exit(1)
