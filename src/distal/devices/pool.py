"""A pool that reuses the memory of pictures.

A new picture of 640x480 has 1,200 pages that the system clears and maps at their first access,
which took as long as rendering. So memory returns to a small pool when the last array that uses it
is deleted.
"""

from __future__ import annotations

import errno
import math
import mmap
import os
import weakref

import numpy as np
from numpy.typing import NDArray

from distal.forking import new_lock

_KEPT_BYTES = 64 * 2**20  # small compared with a rendering process; enough for several pictures
_SMALLEST = 2**16  # bytes; for smaller arrays the allocator is as fast


class _Lease:
    """The owner of an array's memory, as long as the array is in use."""

    def __init__(self, memory: mmap.mmap, shape: tuple[int, ...]) -> None:
        self.memory = memory
        address = np.frombuffer(memory, np.uint8).ctypes.data
        self.__array_interface__ = {
            "version": 3,
            "shape": shape,
            "typestr": np.dtype(np.float32).str,
            "data": (address, False),
        }


def _mapped(size: int) -> mmap.mmap:
    # Shared memory, the default, gets no huge pages: 132 MB took 115 ms to fill instead of 22.
    private = {} if os.name == "nt" else {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS}
    try:
        return mmap.mmap(-1, size, **private)
    except OSError as error:
        if error.errno == errno.ENOMEM:
            raise MemoryError(f"no {size / 2**20:.0f} MiB of memory for a picture") from None
        raise


class Pool:
    """Unused blocks of memory, by size."""

    def __init__(self) -> None:
        self._free: dict[int, list[mmap.mmap]] = {}
        self._bytes = 0
        # An array can be deleted anywhere, even inside ``take``, so the lock must be reentrant.
        self._lock = new_lock()

    def take(self, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """Return an array with undefined content."""
        size = math.prod(shape) * 4
        if size < _SMALLEST:
            return np.empty(shape, np.float32)
        memory = self._reused(size)
        if memory is None:
            memory = _mapped(size)
            if hasattr(mmap, "MADV_HUGEPAGE"):
                memory.madvise(mmap.MADV_HUGEPAGE)
        lease = _Lease(memory, shape)
        weakref.finalize(lease, self._give_back, memory, size).atexit = False
        return np.asarray(lease)

    def _reused(self, size: int) -> mmap.mmap | None:
        with self._lock:
            blocks = self._free.get(size)
            if not blocks:
                return None
            self._bytes -= size
            return blocks.pop()

    def _give_back(self, memory: mmap.mmap, size: int) -> None:
        with self._lock:
            if self._bytes + size <= _KEPT_BYTES:
                self._free.setdefault(size, []).append(memory)
                self._bytes += size


PICTURES = Pool()
