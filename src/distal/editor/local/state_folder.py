"""Files that outlive the studio, in a private folder of its user.

Input: nothing, or a path and bytes. Output: the folder; files of mode 0600 in folders of mode 0700,
each complete or not there. Uses ``platformdirs``.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from distal.file_writer.temporary import create, remove_leftovers, temporary_path
from distal.packages import imported


def state_folder() -> Path:
    """Return the folder of the user's state; it need not exist.

    Raises:
        PackageError: ``platformdirs`` is not installed.
    """
    folder: Path = imported("platformdirs").user_state_path("distal", appauthor=False)
    return folder


def make_private(folder: Path) -> None:
    """Make a folder, and those above it that are missing, which nobody else may enter.

    Raises:
        OSError: It cannot be made.
    """
    for path in (*reversed(folder.parents), folder):
        if not path.is_dir():
            with contextlib.suppress(FileExistsError):  # made in this moment
                path.mkdir(mode=0o700)


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
