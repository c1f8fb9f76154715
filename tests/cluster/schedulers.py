"""Schedulers and workers as processes of their own, as the command ``dask`` starts them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def dask(*arguments: str, environment: Mapping[str, str] | None = None) -> subprocess.Popen[bytes]:
    """Start ``dask`` with arguments; its messages are dropped."""
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **(environment or {})},
    )


def end(*processes: subprocess.Popen[bytes]) -> None:
    """End processes."""
    for process in processes:
        process.kill()
        process.wait()


def worker(file: Path, *more: str, environment: Mapping[str, str] | None = None) -> Any:
    """Start a worker of one thread for the scheduler of a file."""
    return dask(
        *("worker", "--no-nanny", "--nthreads", "1", "--host", "127.0.0.1"),
        *("--dashboard-address", "127.0.0.1:0"),
        *("--scheduler-file", str(file), *more),
        environment=environment,
    )


@contextmanager
def scheduler(
    file: Path, *more: str, environment: Mapping[str, str] | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """A scheduler that listens on this machine alone, and writes its file."""
    process = dask(
        *("scheduler", "--host", "127.0.0.1", "--port", "0"),
        *("--dashboard-address", "127.0.0.1:0"),
        *("--scheduler-file", str(file), *more),
        environment=environment,
    )
    try:
        wait(file.exists)
        time.sleep(0.3)
        yield process
    finally:
        end(process)


def wait(condition: Any, seconds: float = 60.0) -> None:
    """Wait until a condition is true."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it took too long"
        time.sleep(0.05)
