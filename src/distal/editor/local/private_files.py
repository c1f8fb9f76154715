"""Files that only the user may read, for what the studio keeps.

Input: a path and bytes. Output: files of mode 0600 in folders of mode 0700, each complete or not
there. Needs the standard library alone.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from distal.file_writer.state import make_private
from distal.file_writer.temporary import create, remove_leftovers, temporary_path


def write_private(path: Path, data: bytes) -> None:
    """Write a file that only the user may read, completely or not at all.

    Raises:
        OSError: It cannot be written; what was there stays.
    """
    make_private(path.parent)
    remove_leftovers(path.parent)
    temporary = temporary_path(path.parent)
    try:
        with os.fdopen(create(temporary, 0o600), "wb") as file:
            file.write(data)
            file.flush()
            with contextlib.suppress(OSError):  # a file system that cannot flush
                os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        with contextlib.suppress(OSError):  # after success it no longer exists
            temporary.unlink()
