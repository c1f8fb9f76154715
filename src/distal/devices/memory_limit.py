"""Check before some work whether the memory that it needs is left.

Input: how many bytes some work needs. Output: nothing, or a ``MemoryError``. Python and NumPy raise
it themselves, after they have computed half of a large picture. LLVM ends the process if it gets no
memory, and so does the system.
"""

from __future__ import annotations

import mmap
from pathlib import Path
from typing import Final

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None  # type: ignore[assignment]

_MEMORY: Final = Path("/proc/meminfo")
_CONTAINER: Final = Path("/sys/fs/cgroup")  # of a process in a container


def is_limited() -> bool:
    """Return whether this process has a limit on its address space or data (``ulimit -v``)."""
    if resource is None:
        return False
    limits = (resource.RLIMIT_AS, resource.RLIMIT_DATA)
    return any(resource.getrlimit(each)[0] != resource.RLIM_INFINITY for each in limits)


def available() -> int | None:
    """Return the bytes that are left on this machine, or in this container; None: not known."""
    machine = _memory_of_machine()
    most, used = (_number(_CONTAINER / name) for name in ("memory.max", "memory.current"))
    container = None if most is None or used is None else max(most - used, 0)
    sizes = [size for size in (machine, container) if size is not None]
    return min(sizes, default=None)


def _memory_of_machine() -> int | None:
    """Return what Linux could give without harm to other processes."""
    try:
        lines = _MEMORY.read_text(encoding="ascii").splitlines()
        sizes = dict(line.split()[:2] for line in lines)
        return 1024 * (int(sizes["MemAvailable:"]) + int(sizes["SwapFree:"]))
    except (OSError, ValueError, KeyError):
        return None


def _number(path: Path) -> int | None:
    try:
        return int(path.read_text(encoding="ascii"))
    except (OSError, ValueError):  # no such file, or "max"
        return None


def require_of_machine(size: int, purpose: str) -> None:
    """Check that some work does not need more memory than the machine and the limit leave.

    For large work: it reads files of the system, which ``require`` does not.

    Args:
        size: Bytes that the work needs.
        purpose: The work, in words, for the message.

    Raises:
        MemoryError: There is not enough memory.
    """
    left = available()
    if left is not None and size > left:
        needed, has = f"{size / 2**20:,.0f} MiB", f"{left / 2**20:,.0f} MiB"
        raise MemoryError(f"{purpose} needs {needed}, and {has} are left")
    require(size, purpose)


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
