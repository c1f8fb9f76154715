"""Where the studio keeps what outlives it: a private folder of the user, and locks of processes.

Input: nothing, or the folder that ``DISTAL_STATE_DIR`` names. Output: paths, files of mode 0600 in
folders of mode 0700. A file in it is complete or not there. Uses ``platformdirs``.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import sys
import time
from pathlib import Path
from typing import Final

from distal.packages import imported

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

FOLDER_VARIABLE: Final = "DISTAL_STATE_DIR"
TEMPORARY: Final = ".tmp"  # what the name of an unfinished file ends in
_PATIENCE_S: Final = 1.0  # so long another process may look whether a lock is free
_TICK_S: Final = 0.01


def state_folder() -> Path:
    """Return the folder of the user's state; it need not exist.

    Raises:
        PackageError: ``platformdirs`` is not installed.
    """
    chosen = os.environ.get(FOLDER_VARIABLE, "")
    if chosen:
        return Path(chosen)
    found: Path = imported("platformdirs").user_state_path("distal", appauthor=False)
    return found


def make_private(folder: Path) -> None:
    """Make a folder, and those above it, which nobody else may enter.

    Raises:
        OSError: It cannot be made.
    """
    for path in (*reversed(folder.parents), folder):
        with contextlib.suppress(FileExistsError):
            if not path.is_dir():
                path.mkdir(mode=0o700)


def write_private(path: Path, data: bytes) -> None:
    """Write a file that only the user may read, completely or not at all.

    Raises:
        OSError: It cannot be written.
    """
    make_private(path.parent)
    temporary = path.with_name(f".{secrets.token_hex(8)}{TEMPORARY}")
    try:
        flags = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(temporary, flags, 0o600), "wb") as file:
            file.write(data)
            file.flush()
            with contextlib.suppress(OSError):  # some file systems have no fsync
                os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise


class LifeLock:
    """A lock that is taken while its process lives.

    Args:
        path: The file; it is made.

    Raises:
        OSError: It cannot be made.
    """

    def __init__(self, path: Path) -> None:
        make_private(path.parent)
        self.path = path
        self._file = os.open(path, os.O_CREAT | os.O_RDWR, 0o600)
        end = time.monotonic() + _PATIENCE_S
        while not _is_taken_by_us(self._file) and time.monotonic() < end:
            time.sleep(_TICK_S)

    def release(self) -> None:
        """Give it back; the file goes."""
        with contextlib.suppress(OSError):
            os.close(self._file)
        with contextlib.suppress(OSError):
            self.path.unlink()


def is_alive(path: Path) -> bool:
    """Whether a process has the lock of a file."""
    try:
        file = os.open(path, os.O_RDWR)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    try:
        return not _is_taken_by_us(file)
    finally:
        os.close(file)


def _is_taken_by_us(file: int) -> bool:
    """Take the lock of an open file; return whether it was free."""
    try:
        if sys.platform == "win32":
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
