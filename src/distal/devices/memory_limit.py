"""Whether this process may take only so much memory, and whether enough of it is left.

Input: how many bytes some work needs. Output: nothing, or a ``MemoryError``. Python
and NumPy raise one by themselves; LLVM ends the process, so it is asked for beforehand.
"""

from __future__ import annotations

import mmap

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]


def is_limited() -> bool:
    """Whether the address space or the data of this process has a limit, as ``ulimit -v`` sets."""
    if resource is None:
        return False
    limits = (resource.RLIMIT_AS, resource.RLIMIT_DATA)
    return any(resource.getrlimit(each)[0] != resource.RLIM_INFINITY for each in limits)


def require(size: int, purpose: str) -> None:
    """Refuse work that needs more memory than the limit leaves.

    Args:
        size: Bytes.
        purpose: What they are for, in words.

    Raises:
        MemoryError: They are not there.
    """
    if not is_limited():
        return
    try:
        mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close()
    except (OSError, MemoryError):
        needed = f"{size / 2**20:.0f} MiB"
        raise MemoryError(f"{purpose} needs {needed} more than ulimit leaves") from None
