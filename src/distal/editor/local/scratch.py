"""Temporary folders that do not outlive the studio by more than one start of it.

Input: a prefix. Output: a folder that its owner removes. Its name tells the process that owns it:
the next studio removes the folders of processes that have ended. Needs the standard library alone.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Final

from distal.file_writer.locks import is_over, process_name

WORKER: Final = "distal_studio_"
RENDER: Final = "distal_render_"
LESSON: Final = "distal_lesson_"
OPENING: Final = "distal_opening_"
_NAME: Final = re.compile(
    f"(?:{WORKER}|{RENDER}|{LESSON}|{OPENING})([0-9a-f]{{8}})-([0-9a-f]{{7}})-.+"
)


class ScratchFolder:
    """A temporary folder.

    Args:
        prefix: What its name begins with.

    Raises:
        OSError: It cannot be made.
    """

    def __init__(self, prefix: str) -> None:
        lock_file, token = process_name()
        self.path = Path(tempfile.mkdtemp(prefix=f"{prefix}{lock_file}-{token}-"))

    def remove(self) -> None:
        """Remove it with all that is in it; links are not followed."""
        shutil.rmtree(self.path, ignore_errors=True)


def sweep() -> None:
    """Remove the folders of studios that were killed; those of other users and machines stay."""
    with suppress(OSError), os.scandir(tempfile.gettempdir()) as entries:
        for entry in entries:
            name = _NAME.fullmatch(entry.name)
            if name is not None and _is_own_folder(entry) and is_over(name[1], name[2]):
                shutil.rmtree(entry.path, ignore_errors=True)


def _is_own_folder(entry: os.DirEntry[str]) -> bool:
    try:
        info = entry.stat(follow_symlinks=False)
    except OSError:  # gone in this moment
        return False
    return stat.S_ISDIR(info.st_mode) and (os.name == "nt" or info.st_uid == os.geteuid())
