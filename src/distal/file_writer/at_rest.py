"""Wait until another program has finished writing a file.

Input: a path. Output: nothing; the file is at rest, or the wait took too long.
"""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Final

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

_LONGEST_WAIT_S: Final = 2.0
_PAUSE_S: Final = 0.01
_UNCHANGED_S: Final = 0.05


def wait_until_at_rest(path: Path) -> None:
    """Wait until no program has a file open for writing.

    Linux says so for most file systems. Elsewhere the file has to be unchanged for a moment.

    Raises:
        OSError: The file cannot be read.
    """
    until = time.monotonic() + _LONGEST_WAIT_S
    before, since = _state(path), time.monotonic()
    while time.monotonic() < until:
        is_written = is_being_written(path)
        if is_written is False:
            return
        time.sleep(_PAUSE_S)
        state, now = _state(path), time.monotonic()
        if state != before:
            before, since = state, now
        elif is_written is None and now - since > _UNCHANGED_S:
            return


def _state(path: Path) -> tuple[int, int]:
    info = os.stat(path)
    return info.st_mtime_ns, info.st_size


def is_being_written(path: Path) -> bool | None:
    """Return whether a program has a file open for writing; None if this cannot be known.

    The kernel grants a lease for reading only if none has. It is given back at once; a program that
    opened the file meanwhile would cause the signal, by default one that ends this process.
    """
    if not hasattr(fcntl, "F_SETLEASE"):
        return None
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        fcntl.fcntl(handle, fcntl.F_SETSIG, signal.SIGURG)
        fcntl.fcntl(handle, fcntl.F_SETLEASE, fcntl.F_RDLCK)
        fcntl.fcntl(handle, fcntl.F_SETLEASE, fcntl.F_UNLCK)
    except BlockingIOError:
        return True
    except OSError:  # another user's file, or a file system without leases
        return None
    finally:
        os.close(handle)
    return False
