"""Write files atomically: completely or not at all.

Input: a destination and its bytes. Output: the file, replaced in one step. After a failure or an
interruption the old file is unchanged. Does not depend on file formats.
"""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


class SaveError(Exception):
    """A file cannot be written; the message says why, in one line."""


def check_destination(path: Path) -> None:
    """Check that a file can be written at a destination, before time is spent on its content.

    Raises:
        SaveError: The folder is missing or not writable, or the path is not an ordinary file.
    """
    target = Path(os.path.realpath(path))
    folder = target.parent
    try:
        if not folder.is_dir():
            raise SaveError(f"cannot write {path}: there is no folder {folder}")
        # Replacing a device or a socket would destroy it.
        if target.exists() and not stat.S_ISREG(target.stat().st_mode):
            kind = "a folder" if target.is_dir() else "no ordinary file"
            raise SaveError(f"cannot write {path}: it is {kind}")
    except OSError as error:
        raise SaveError(f"cannot write {path}: {error.strerror or error}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise SaveError(f"cannot write {path}: the folder {folder} is not writable")


def move_into_place(temporary: Path, path: Path) -> None:
    """Replace a file by a complete temporary file, after flushing it to disk.

    Raises:
        OSError: The file system reports an error.
    """
    with open(temporary, "rb+") as file:
        os.fsync(file.fileno())  # otherwise a crash after the rename could leave zeros
    os.replace(temporary, path)


@contextmanager
def replacement(path: Path) -> Iterator[BinaryIO]:
    """Open a temporary file that replaces ``path`` when the block ends without an error.

    The temporary file is in the same folder and is renamed at the end: a reader never sees part of
    a file, and an interrupted writer leaves nothing. A symbolic link is kept; its target is
    replaced.

    Raises:
        SaveError: The file system reports an error.
    """
    check_destination(path)
    target = Path(os.path.realpath(path))
    # Not named after the target, because a name near the limit of 255 bytes cannot be extended.
    temporary = target.parent / f".distal-{secrets.token_hex(8)}.tmp"
    try:
        try:
            # os.open, not tempfile, so that the file has the permissions of the author's umask.
            descriptor = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
            with os.fdopen(descriptor, "w+b") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())  # otherwise a crash after the rename could leave zeros
            os.replace(temporary, target)
        except OSError as error:
            raise SaveError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        with suppress(OSError):  # after success the temporary file no longer exists
            temporary.unlink()
