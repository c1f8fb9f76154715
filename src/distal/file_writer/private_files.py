"""Files that only the user may read.

Input: a path and bytes. Output: files of mode 0600 in folders of mode 0700, each complete or not
there.
"""

from __future__ import annotations

import os
from pathlib import Path

from distal.file_writer.state import make_private
from distal.file_writer.temporary import flush, temporary_file


def write_private(path: Path, data: bytes) -> None:
    """Write a file that only the user may read, completely or not at all.

    Raises:
        OSError: It cannot be written; what was there stays.
    """
    make_private(path.parent)
    with temporary_file(path.parent, 0o600) as (temporary, file):
        file.write(data)
        file.flush()
        flush(file.fileno())
        file.close()  # Windows renames only what is closed
        os.replace(temporary, path)
