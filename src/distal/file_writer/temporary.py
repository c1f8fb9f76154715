"""Temporary files beside the files that they become, and the removal of those left by others.

Input: a folder. Output: files whose names tell their process, and none of a process that has ended.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

from distal.file_writer.locks import is_over, process_name

# Names do not contain the name of the target, because one near the limit of 255 bytes could not be
# extended: the file of locks, the number and the token of the process, and a random number.
_NAME: Final = re.compile(r"\.distal-([0-9a-f]{8})-[0-9]+-([0-9a-f]{7})-[0-9a-f]{8}\.tmp\Z")
# A process of another machine or container cannot be looked up: its file is removed when nothing
# has happened to it for so long.
_LEFTOVER_AGE_S: Final = 7 * 24 * 3600.0
# A folder is searched once in this time by a process, and only so many of its entries: to search
# one of 50,000 takes 25 ms.
_PERIOD_S: Final = 60.0
_MOST_ENTRIES: Final = 50_000
# A file system that cannot flush says so by one of these; SQLite and git ignore them as well.
_CANNOT_FLUSH: Final = (errno.EINVAL, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS)

_searched: dict[str, float] = {}


def temporary_path(folder: Path) -> Path:
    """Return the path of a new temporary file of this process."""
    lock_file, token = process_name()
    return folder / f".distal-{lock_file}-{os.getpid()}-{token}-{secrets.token_hex(4)}.tmp"


@contextmanager
def temporary_file(folder: Path, mode: int) -> Iterator[tuple[Path, BinaryIO]]:
    """Create a temporary file in a folder; remove it at the end if it is still there.

    Args:
        folder: The folder, from which the files of ended processes are removed first.
        mode: The permissions, of which the umask takes some.

    Raises:
        OSError: The file system reports an error.
    """
    remove_leftovers(folder)
    path = temporary_path(folder)
    try:
        with os.fdopen(create(path, mode), "w+b") as file:
            yield path, file
    finally:
        with suppress(OSError):  # after success it no longer exists
            path.unlink()


def flush(handle: int) -> None:
    """Flush an open file to the disk, if its file system can.

    Raises:
        OSError: The file system reports an error.
    """
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in _CANNOT_FLUSH:
            raise


def create(path: Path, mode: int) -> int:
    """Create a temporary file and return its descriptor.

    ``os.open`` and not ``tempfile``, so that a new file has the permissions of the author's umask.

    Raises:
        OSError: The file system reports an error.
    """
    flags = os.O_CREAT | os.O_EXCL | os.O_RDWR
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0), mode)


def remove_leftovers(folder: Path, *, at_once: bool = False) -> None:
    """Remove the temporary files that processes of this user have left when they were killed.

    Files of processes that live and those of other users stay. Errors are ignored.

    Args:
        folder: The folder.
        at_once: Search it even if it was searched a short time ago.
    """
    now = time.monotonic()
    key = str(folder)
    if not at_once and now - _searched.get(key, -_PERIOD_S) < _PERIOD_S:
        return
    if len(_searched) >= 1000:
        _searched.clear()
    _searched[key] = now
    with suppress(OSError), os.scandir(folder) as entries:
        for _, entry in zip(range(_MOST_ENTRIES), entries, strict=False):
            match = _NAME.match(entry.name)
            if match is not None:
                with suppress(OSError):
                    if _is_leftover(entry, match):
                        os.unlink(entry.path)


def _is_leftover(entry: os.DirEntry[str], name: re.Match[str]) -> bool:
    info = entry.stat(follow_symlinks=False)
    if not stat.S_ISREG(info.st_mode):
        return False
    if os.name != "nt" and info.st_uid != os.geteuid():
        return False
    over = is_over(name[1], name[2])
    if over is None:
        # A rename changes the second time alone.
        return time.time() - max(info.st_mtime, info.st_ctime) > _LEFTOVER_AGE_S
    return over
