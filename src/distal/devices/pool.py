"""Memory for pictures, used again.

A fresh picture of 640x480 is 1,200 pages that the system clears and maps when they are first
touched, which took as long as rendering it. So memory goes back to a small pool when the last array
on it is gone.
"""

from __future__ import annotations

import errno
import mmap
import threading
import weakref

import numpy as np
from numpy.typing import NDArray

_KEPT_BYTES = 64 * 2**20  # small next to a process that renders; enough for several pictures
_SMALLEST = 2**16  # below, the allocator does as well


class _Lease:
    """What an array's memory belongs to while somebody holds the array."""

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
    try:
        return mmap.mmap(-1, size)
    except OSError as error:
        if error.errno == errno.ENOMEM:
            raise MemoryError(f"no {size / 2**20:.0f} MiB of memory for a picture") from None
        raise


class Pool:
    """Blocks of memory that nobody holds, by size."""

    def __init__(self) -> None:
        self._free: dict[int, list[mmap.mmap]] = {}
        self._bytes = 0
        # Given back from wherever an array dies, perhaps inside ``take``: the lock must allow that.
        self._lock = threading.RLock()

    def take(self, shape: tuple[int, ...]) -> NDArray[np.float32]:
        """An array whose content is not set."""
        size = int(np.prod(shape)) * 4
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
