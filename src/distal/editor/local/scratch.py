"""Temporary folders that do not outlive the studio by more than one start of it.

Input: a prefix. Output: a folder that its owner removes. A file in it is locked while the owner
lives: what a killed studio has left is found by the next one, which removes it. Needs the standard
library alone.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

if sys.platform != "win32":
    import fcntl

WORKER: Final = "distal_studio_"
RENDER: Final = "distal_render_"
LESSON: Final = "distal_lesson_"
OPENING: Final = "distal_opening_"
_LOCK: Final = ".owner"
_YOUNGEST_S: Final = 60.0  # a younger folder may not be locked yet


class ScratchFolder:
    """A temporary folder.

    Args:
        prefix: What its name begins with.

    Raises:
        OSError: It cannot be made.
    """

    def __init__(self, prefix: str) -> None:
        self.path = Path(tempfile.mkdtemp(prefix=prefix))
        self._lock = -1
        try:
            self._lock = os.open(self.path / _LOCK, os.O_CREAT | os.O_RDWR, 0o600)
            _is_taken(self._lock)
        except OSError:
            self.remove()
            raise

    def remove(self) -> None:
        """Remove it with all that is in it; links are not followed."""
        shutil.rmtree(self.path, ignore_errors=True)
        lock, self._lock = self._lock, -1
        if lock >= 0:
            os.close(lock)


def _is_taken(lock: int) -> bool:
    """Take the lock of a folder; return whether it was free."""
    if sys.platform == "win32":
        return False  # nothing is swept there
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def sweep() -> None:
    """Remove the folders of studios that were killed."""
    for prefix in (WORKER, RENDER, LESSON, OPENING):
        for folder in Path(tempfile.gettempdir()).glob(f"{prefix}*"):
            with contextlib.suppress(OSError):  # another's, without a lock, or gone in this moment
                if time.time() - folder.stat().st_mtime < _YOUNGEST_S:
                    continue
                lock = os.open(folder / _LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
                try:
                    if _is_taken(lock):
                        shutil.rmtree(folder, ignore_errors=True)
                finally:
                    os.close(lock)
