"""Check whether this process has a memory limit, and whether enough memory is left.

Input: how many bytes some work needs. Output: nothing, or a ``MemoryError``. Python and NumPy raise
it themselves. LLVM ends the process if it gets no memory, so the memory is checked before.
"""

from __future__ import annotations

import mmap

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]


def is_limited() -> bool:
    """Return whether this process has a limit on its address space or data (``ulimit -v``)."""
    if resource is None:
        return False
    limits = (resource.RLIMIT_AS, resource.RLIMIT_DATA)
    return any(resource.getrlimit(each)[0] != resource.RLIM_INFINITY for each in limits)


def require(size: int, purpose: str) -> None:
    """Check that some work does not need more memory than the limit leaves.

    Args:
        size: Bytes that the work needs.
        purpose: The work, in words, for the message.

    Raises:
        MemoryError: There is not enough memory.
    """
    if not is_limited():
        return
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close()
    except (OSError, MemoryError):
        needed = f"{size / 2**20:.0f} MiB"
        raise MemoryError(f"{purpose} needs {needed} more than ulimit leaves") from None
