"""Render on the workers of a Dask cluster.

Input: a ``dask.distributed.Client`` or the address of a scheduler; pictures. Output: the same
pictures, bit for bit, from processors of the same level. Dask schedules, retries and moves data;
this package sends programs as IR and numbers, never an author's objects.
"""

from __future__ import annotations

from distal.cluster.connecting import connected
from distal.cluster.errors import ClusterError
from distal.cluster.pool import WorkerPool, pool_of

__all__ = ["ClusterError", "WorkerPool", "connected", "pool_of"]
