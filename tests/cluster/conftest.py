"""Processes of this machine as a cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

pytest.importorskip("distributed")

import dask
from distributed import Client, LocalCluster


@contextmanager
def local_cluster(count: int = 2, **given: Any) -> Iterator[Any]:
    """A client of some processes of one thread each; nothing listens beyond this machine.

    A process that died starts again, however long that takes: on a busy machine longer than the 15
    seconds after which Dask would do without it.
    """
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "600s"}),
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=50,
            **given,
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield client


@pytest.fixture(scope="package")
def client() -> Iterator[Any]:
    """Two processes for all tests here that do not harm them; idle ones take processor time."""
    with local_cluster() as found:
        yield found
