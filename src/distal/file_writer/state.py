"""The folder of what outlives a process of distal: locks, and the studio's drafts and versions.

Input: the environment. Output: a folder that nobody else may enter. Needs the standard library
alone.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
from pathlib import Path


def state_folder() -> Path:
    """Return the folder of this user's state, where the system keeps such; make it if necessary.

    Nobody else can write in it, or exchange it: what is read there becomes a text of the studio.

    Raises:
        OSError: The user has no home folder, or root has that of another user (``sudo``): root
            would make folders there that the user cannot write; or the folder cannot be made, or is
            not this user's alone.
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
    folder /= "distal"
    make_private(folder)
    _check_ours(folder)
    return folder


def _check_ours(folder: Path) -> None:
    """Check that a folder is this user's alone.

    Raises:
        PermissionError: Another user has made it (or the link to it), or can write or exchange it.
    """
    if os.name == "nt":
        return
    own = (os.geteuid(),)
    # The link itself, too: in a shared folder another user may have made it. The folder above may
    # be a group's: with some systems' umask all folders of a user are.
    for path, info, owners, bits in (
        (folder, os.lstat(folder), own, 0),
        (folder, os.stat(folder), own, stat.S_IWGRP | stat.S_IWOTH),
        (folder.parent, os.stat(folder.parent), (*own, 0), stat.S_IWOTH),
    ):
        if info.st_uid not in owners:
            raise PermissionError(errno.EPERM, f"{path} is another user's")
        is_protected = path != folder and info.st_mode & stat.S_ISVTX
        if info.st_mode & bits and not is_protected:
            raise PermissionError(errno.EPERM, f"{path} can be written by others")


def make_private(folder: Path) -> None:
    """Make a folder, and those above it that are missing, which nobody else may enter.

    Raises:
        OSError: It cannot be made.
    """
    for path in (*reversed(folder.parents), folder):
        if not path.is_dir():
            with contextlib.suppress(FileExistsError):  # made in this moment
                path.mkdir(mode=0o700)
