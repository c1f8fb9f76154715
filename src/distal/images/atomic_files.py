"""Files that appear whole or not at all.

Input: a destination and the bytes for it. Output: the file, replaced in one step;
a failure or an interruption leaves what stood there before. Knows nothing of formats.
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
    """A file that cannot be written, and why, in one line."""


def check_destination(path: Path) -> None:
    """Refuse a destination that no file can take, before any work is spent on it.

    Raises:
        SaveError: The folder is missing or cannot be written, or the path is no plain file.
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
    """Let a whole file take the place of another, after its bytes are on disk.

    Raises:
        OSError: The file system refuses.
    """
    with open(temporary, "rb+") as file:
        os.fsync(file.fileno())  # renamed before it is on disk, a crash would leave zeros
    os.replace(temporary, path)


@contextmanager
def replacement(path: Path) -> Iterator[BinaryIO]:
    """Open a file that takes the place of ``path`` when the block ends well.

    The bytes go to a temporary file in the same folder, which is renamed: a reader never sees half
    a file, and an interrupted writer leaves nothing. A symbolic link keeps pointing where it did.

    Raises:
        SaveError: The file system refuses.
    """
    check_destination(path)
    target = Path(os.path.realpath(path))
    # Not named after the target: a name near the limit of 255 bytes has no room for an addition.
    temporary = target.parent / f".distal-{secrets.token_hex(8)}.tmp"
    try:
        try:
            # Opened by mode, not through tempfile, so that the author's umask decides who may read.
            descriptor = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
            with os.fdopen(descriptor, "w+b") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())  # renamed before it is on disk, a crash would leave zeros
            os.replace(temporary, target)
        except OSError as error:
            raise SaveError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        with suppress(OSError):  # it is gone when all went well
            temporary.unlink()
