"""The folder of what outlives a process of distal: locks, and the studio's drafts and versions.

Input: the environment. Output: a folder that nobody else may enter. Needs the standard library
alone.
"""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from pathlib import Path


def state_folder() -> Path:
    """Return the folder of this user's state, where the system keeps such; it need not exist.

    Raises:
        OSError: The user has no home folder, or root has that of another user (``sudo``): root
            would make folders there that the user cannot write.
    """
    try:
        home = Path.home()
    except RuntimeError:
        raise FileNotFoundError(errno.ENOENT, "this user has no home folder") from None
    chosen = os.environ.get("XDG_STATE_HOME", "")
    if os.path.isabs(chosen):
        folder = Path(chosen)
    elif sys.platform == "darwin":
        folder = home / "Library" / "Application Support"
    elif os.name == "nt":
        folder = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    else:
        folder = home / ".local" / "state"
    if os.name != "nt" and os.geteuid() == 0:
        there = next(f for f in (folder, *folder.parents) if f.is_dir())
        if there.stat().st_uid != 0:
            raise PermissionError(errno.EPERM, f"{there} is another user's")
    return folder / "distal"


def make_private(folder: Path) -> None:
    """Make a folder, and those above it that are missing, which nobody else may enter.

    Raises:
        OSError: It cannot be made.
    """
    for path in (*reversed(folder.parents), folder):
        if not path.is_dir():
            with contextlib.suppress(FileExistsError):  # made in this moment
                path.mkdir(mode=0o700)
