"""Where a file is written: links followed, and reasons why it cannot be, before work is done.

Input: a path. Output: the path without links, or an error in one line. Does not write.
"""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path
from typing import Final

_MOST_LINKS: Final = 40  # as many as Linux follows
_LONGEST_NAME: Final = 255  # bytes, where the system does not say


class SaveError(Exception):
    """A file cannot be written; the message says why, in one line."""


class ChangedError(SaveError):
    """The file is not what the caller expects; nothing was written.

    Attributes:
        digest: The digest of what is there now; "" for nothing.
        data: What is there now; None for nothing.
    """

    def __init__(self, path: Path, digest: str, data: bytes | None, *, was_there: bool) -> None:
        what = "another program has changed it" if was_there else "it is there already"
        super().__init__(f"cannot write {path}: {'it is gone' if data is None else what}")
        self.digest, self.data = digest, data


class TakenError(SaveError):
    """There is a file already where a new one was to be made; nothing was written."""

    def __init__(self, path: Path) -> None:
        super().__init__(f"cannot write {path}: it is there already")


class LinkedError(SaveError):
    """The file has several names (hard links), of which replacing it would change only one.

    ``save(..., in_place=True)`` changes them all.

    Attributes:
        names: The number of names.
    """

    def __init__(self, path: Path, names: int) -> None:
        super().__init__(
            f"cannot write {path}: the file has {names} names (hard links), of which only this one "
            "would change: write in place to change all, or delete this name first"
        )
        self.names = names


def check_destination(path: Path) -> None:
    """Check that a file can be written at a destination, before time is spent on its content.

    Raises:
        SaveError: The folder is missing or not writable, or the path is not an ordinary file, is
            read-only, or leads through another user's link in a folder shared by all.
    """
    destination(path)


def check_ours(path: Path) -> None:
    """Check that a file or folder beside an output was not put there by another user.

    Raises:
        SaveError: It was, in a folder where all can do that.
    """
    try:
        info = state(path)
        is_foreign = info is not None and _is_foreign(info, path.parent, stat.S_IWOTH)
    except OSError as error:
        raise SaveError(f"cannot write {path}: {reason(error)}") from None
    if is_foreign:
        raise SaveError(
            f"cannot write {path}: it belongs to another user, in a folder that is shared by all"
        )


def destination(path: Path, *, in_place: bool = False) -> Path:
    """Return the file that is written for a path: absolute, without links.

    A link that leads to nothing is followed too: the file is created where it points.

    Args:
        path: The path.
        in_place: Whether no other file is made in the folder.

    Raises:
        SaveError: As for ``check_destination``.
    """
    try:
        target = _followed(path)
        info = state(target)
        folder = target.parent
        if info is None and not folder.is_dir():
            raise SaveError(f"cannot write {path}: there is no folder {folder}")
        if info is not None:
            _check_file(path, target, info)
        may_write_folder = os.access(folder, os.W_OK | os.X_OK)
    except NotADirectoryError as error:
        above = os.path.dirname(error.filename)
        raise SaveError(f"cannot write {path}: {above} is a file, no folder") from None
    except (OSError, ValueError) as error:  # ValueError: a zero in the name
        raise SaveError(f"cannot write {path}: {reason(error)}") from None
    if not may_write_folder and not (in_place and info is not None):
        raise SaveError(f"cannot write {path}: the folder {folder} is not writable")
    return target


def reason(error: Exception) -> str:
    """Return the reason of an error of the file system."""
    return getattr(error, "strerror", None) or str(error)


def state(path: Path) -> os.stat_result | None:
    """Return the state of a file, of a link itself; None if there is nothing.

    Raises:
        OSError: The file system reports an error.
    """
    try:
        return os.lstat(path)
    except FileNotFoundError:
        return None


def name_beside(path: Path, suffix: str, prefix: str = "") -> Path:
    """Return the path of a companion of a file: its name with a prefix and a suffix.

    A name that would be too long is cut, and gets a digest of the whole name.
    """
    try:
        limit = os.pathconf(path.parent, "PC_NAME_MAX")
    except (AttributeError, OSError, ValueError):
        limit = _LONGEST_NAME
    name = os.fsencode(path.name)
    longest = limit - len(os.fsencode(prefix + suffix))
    if len(name) <= longest:
        return path.with_name(prefix + path.name + suffix)
    mark = "~" + hashlib.sha256(name).hexdigest()[:16]
    stem = path.name
    while len(os.fsencode(stem)) > longest - len(mark):
        stem = stem[:-1]
    return path.with_name(prefix + stem + mark + suffix)


def _check_file(path: Path, target: Path, info: os.stat_result) -> None:
    # Replacing a device or a socket would destroy it.
    if not stat.S_ISREG(info.st_mode):
        kind = "a folder" if stat.S_ISDIR(info.st_mode) else "no ordinary file"
        raise SaveError(f"cannot write {path}: it is {kind}")
    if _is_foreign(info, target.parent, stat.S_IWOTH | stat.S_ISVTX):
        raise SaveError(
            f"cannot write {path}: it belongs to another user, in a folder that is shared by all"
        )
    # Root could write it nevertheless; the mode says that nobody should.
    if not info.st_mode & 0o222 or not os.access(target, os.W_OK):
        raise SaveError(f"cannot write {path}: it is read-only")


def _followed(path: Path) -> Path:
    """Return a path without links.

    The kernel's protection of links in shared folders (``fs.protected_symlinks``) is applied here
    too, because it holds for opening a file, and not for reading a link. The
    sticky bit makes no difference here: all can put links there.

    Raises:
        SaveError: There are too many links, or one is another user's in a shared folder.
        OSError: The file system reports an error.
    """
    if os.name == "nt":
        return Path(os.path.realpath(path))
    here, links = "/", 0
    rest = _whole(path).split("/")[::-1]
    while rest:
        part = rest.pop()
        if part in ("", "."):
            continue
        if part == "..":
            here = os.path.dirname(here)
            continue
        there = os.path.join(here, part)
        info = state(Path(there))
        if info is None or not stat.S_ISLNK(info.st_mode):
            here = there
            continue
        links += 1
        if links > _MOST_LINKS:
            raise SaveError(f"cannot write {path}: its links lead in a circle")
        if _is_foreign(info, Path(here), stat.S_IWOTH):
            raise SaveError(
                f"cannot write {path}: {there} is a link of another user, in a folder that is "
                "shared by all"
            )
        text = os.readlink(there)
        rest += text.split("/")[::-1]
        here = "/" if text.startswith("/") else here
    return Path(here)


def _whole(path: Path) -> str:
    """Return an absolute path; ".." stays, because a link may be before it."""
    try:
        return str(path if path.is_absolute() else os.path.join(os.getcwd(), path))
    except FileNotFoundError:
        raise SaveError(f"cannot write {path}: the working folder is gone") from None


def _is_foreign(info: os.stat_result, folder: Path, bits: int) -> bool:
    """Return whether a file or link is neither ours nor the owner's of a folder shared by all.

    Args:
        info: The file or link.
        folder: Where it is.
        bits: The bits in the mode of a shared folder.
    """
    if os.name == "nt":
        return False
    shared = os.stat(folder)
    return shared.st_mode & bits == bits and info.st_uid not in (os.geteuid(), shared.st_uid)
