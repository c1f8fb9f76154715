"""``save`` and ``replacement``: the two ways to write a file.

Input: a path and its new content. Output: the file, replaced in one step, or an error in one line
and the old file. See ``docs/decisions/0095-one-writer.md``.
"""

from __future__ import annotations

import errno
import hashlib
import os
import shutil
import stat
import warnings
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import BinaryIO, Final, Literal

from distal.file_writer.at_rest import is_being_written, wait_until_at_rest
from distal.file_writer.destinations import (
    ChangedError,
    LinkedError,
    SaveError,
    TakenError,
    destination,
    reason,
    state,
)
from distal.file_writer.exchange import exchange
from distal.file_writer.locks import BusyError, locked
from distal.file_writer.temporary import (
    flush,
    remove_leftovers,
    temporary_file,
    temporary_path,
)

_KEPT_ATTRIBUTES: Final = ("user.", "system.posix_acl_access")
_LARGEST_COMPARED: Final = 2**28  # bytes; a file that a person edits is far smaller


class Unchecked(Enum):
    """The type of ``ANY``."""

    ANY = "any"


ANY: Final = Unchecked.ANY


@dataclass(frozen=True, slots=True)
class SavedBytes:
    """What a save has written.

    Attributes:
        digest: The digest of the new content.
        other: What another program saved in the moment before, which is no longer in the file; None
            if none did.
    """

    digest: str
    other: bytes | None = None


def digest_of(data: bytes) -> str:
    """Return a short name of some bytes."""
    return hashlib.sha256(data).hexdigest()[:16]


def save(
    path: Path,
    data: bytes,
    *,
    expected: str | Literal[Unchecked.ANY] | None = ANY,
    in_place: bool = False,
) -> SavedBytes:
    """Write a file, unless it is not what the caller expects.

    Of several processes of a user that save with the same expectation one succeeds. What another
    program saves in the same moment is returned, never lost, except as decision 95 says of file
    systems without links and without exchange.

    Args:
        path: The file. Links are followed.
        data: Its new content.
        expected: The digest of what it replaces; None or "" for a new file; ``ANY`` for no check.
        in_place: Write into the file instead of replacing it: its other names (hard links) change
            as well, but an interruption may leave a part of each text.

    Raises:
        ChangedError: The file is not what is expected.
        LinkedError: It has several names, and ``expected`` is a digest.
        SaveError: It cannot be written.
    """
    target = destination(path, in_place=in_place)
    digest = digest_of(data)
    with _one_line(path):
        if in_place and state(target) is not None:
            with locked(target):
                _checked(path, target, expected)
                _write_into(target, data)
            return SavedBytes(digest)
        with _temporary(target) as (temporary, file):
            file.write(data)
            _finish(file, target)
            with locked(target):
                other = _put(path, temporary, target, expected)
    return SavedBytes(digest, None if other == data else other)


@contextmanager
def replacement(path: Path, *, in_place: bool = False, new: bool = False) -> Iterator[BinaryIO]:
    """Open a temporary file that replaces ``path`` when the block ends without an error.

    A reader never sees part of a file, and an interrupted writer leaves nothing. A symbolic link is
    kept; its target is replaced. A file with several names (hard links) is replaced under this one,
    with a warning.

    Args:
        path: The file.
        in_place: Write into the file at the end instead of replacing it, which keeps its names.
        new: Nothing may be there.

    Raises:
        TakenError: There is a file, and ``new`` is set.
        SaveError: The file system reports an error.
    """
    target = destination(path)
    with _one_line(path):
        if new and state(target) is not None:
            raise TakenError(path)
        with _temporary(target) as (temporary, file):
            yield file
            _finish(file, target)
            with locked(target):
                if new:
                    _appear(path, temporary, target)
                elif in_place and state(target) is not None:
                    _write_into(target, temporary.read_bytes())
                else:
                    _put(path, temporary, target, ANY)


def move_into_place(temporary: Path, path: Path) -> None:
    """Replace a file by a complete temporary file, after flushing it to disk.

    Raises:
        SaveError: The file system reports an error.
    """
    target = destination(path)
    with _one_line(path):
        with open(temporary, "rb+") as file:
            _finish(file, target)
        try:
            with locked(target):
                _put(path, temporary, target, ANY)
            return
        except OSError as error:
            if error.errno != errno.EXDEV:  # a link has led to another file system
                raise
        with open(temporary, "rb") as source, replacement(path) as copy:
            shutil.copyfileobj(source, copy, 2**20)
        temporary.unlink()


@contextmanager
def _one_line(path: Path) -> Iterator[None]:
    try:
        yield
    except BusyError:
        raise SaveError(f"cannot write {path}: another process is writing it") from None
    except OSError as error:
        raise SaveError(f"cannot write {path}: {reason(error)}") from error


def _temporary(target: Path) -> AbstractContextManager[tuple[Path, BinaryIO]]:
    """Create a temporary file beside a target."""
    # Nobody else reads the new content of a private file before it has its mode.
    return temporary_file(target.parent, 0o666 if state(target) is None else 0o600)


def _finish(file: BinaryIO, target: Path) -> None:
    """Give a complete file the mode and the owner of its target, flush it and close it.

    Without the flush, a crash after the rename could leave zeros. Windows renames only what is
    closed.
    """
    file.flush()
    info = state(target)
    if info is not None and os.name != "nt":
        _keep_owner(file.fileno(), target, info)
    flush(file.fileno())
    file.close()


def _keep_owner(handle: int, target: Path, info: os.stat_result) -> None:
    """Give a file the owner, the group, the mode and the attributes of another, where allowed."""
    for owner in (info.st_uid, -1):
        with suppress(OSError):
            os.fchown(handle, owner, info.st_gid)
            break
    mode = info.st_mode & 0o777  # as after writing into a file: no program runs as another user
    is_group_kept = os.fstat(handle).st_gid == info.st_gid
    if not is_group_kept:
        mode &= 0o707 | (mode & 0o7) << 3  # another group may do no more than everybody
    with suppress(OSError):  # a file system without modes
        os.fchmod(handle, mode)
    if not is_group_kept or not hasattr(os, "listxattr"):
        return
    with suppress(OSError):
        for name in os.listxattr(target):
            if name.startswith(_KEPT_ATTRIBUTES):
                os.setxattr(handle, name, os.getxattr(target, name))


def _check_names(path: Path, target: Path) -> None:
    """Check that a file has one name.

    Raises:
        LinkedError: It has several.
    """
    info = state(target)
    if info is not None and info.st_nlink > 1:
        # A killed writer may have left a second name.
        remove_leftovers(target.parent, at_once=True)
        info = state(target)
    if info is not None and info.st_nlink > 1:
        raise LinkedError(path, info.st_nlink)


def _read(target: Path) -> bytes | None:
    """Return the content of an ordinary file; None if there is nothing.

    Raises:
        SaveError: It is none, or larger than what is compared.
        OSError: It cannot be read.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0)
    try:
        handle = os.open(target, flags | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        return None
    with os.fdopen(handle, "rb") as file:
        info = os.fstat(handle)
        if not stat.S_ISREG(info.st_mode):
            raise SaveError(f"cannot write {target}: it is no ordinary file")
        if info.st_size > _LARGEST_COMPARED:
            raise SaveError(f"cannot write {target}: there is a file of {info.st_size:,} bytes")
        return file.read()


def _checked(path: Path, target: Path, expected: str | Literal[Unchecked.ANY] | None) -> None:
    """Check that a file is what is expected.

    Raises:
        ChangedError: It is not.
    """
    if expected is ANY:
        return
    data = _read(target)
    digest = "" if data is None else digest_of(data)
    if digest != (expected or ""):
        raise ChangedError(path, digest, data, was_there=bool(expected))


def _put(
    path: Path, temporary: Path, target: Path, expected: str | Literal[Unchecked.ANY] | None
) -> bytes | None:
    """Rename a complete temporary file to its target; return what another program saved meanwhile.

    Raises:
        ChangedError: The target, which is locked, is not what is expected.
        LinkedError: It has several names, and ``expected`` is a digest.
        OSError: The file system reports an error.
    """
    if expected is ANY:
        info = state(target)
        os.replace(temporary, target)
        if info is not None and info.st_nlink > 1:
            warnings.warn(
                f"{path} had {info.st_nlink} names (hard links): the others keep the old file",
                stacklevel=3,
            )
        return None
    _checked(path, target, expected)
    if not expected:
        try:
            _appear(path, temporary, target)
        except TakenError:
            _checked(path, target, expected)
            raise
        return None
    _check_names(path, target)
    if exchange(temporary, target):
        return _other(path, temporary, target, expected)
    backup = _kept_link(target)
    try:
        os.replace(temporary, target)
        return None if backup is None else _other(path, backup, target, expected)
    finally:
        if backup is not None:
            backup.unlink(missing_ok=True)


def _appear(path: Path, temporary: Path, target: Path) -> None:
    """Rename a temporary file to a target where nothing may be.

    Raises:
        TakenError: There is something.
    """
    try:
        if os.name == "nt":
            os.rename(temporary, target)  # never replaces there
        else:
            os.link(temporary, target)
            os.unlink(temporary)
    except FileExistsError:
        raise TakenError(path) from None
    except OSError:  # no links in this file system
        if state(target) is not None:
            raise TakenError(path) from None
        os.replace(temporary, target)


def _kept_link(target: Path) -> Path | None:
    """Give a file a second name, so that it outlives its replacement; None if it cannot."""
    backup = temporary_path(target.parent)
    try:
        os.link(target, backup)
    except OSError:
        return None
    return backup


def _other(path: Path, replaced: Path, target: Path, expected: str) -> bytes | None:
    """Return the content of a replaced file, if it is not the expected one.

    If it cannot be read, or this is interrupted, it is put back: nobody has seen it.
    """
    try:
        data = _read(replaced)
        if data is None:
            return None
        if digest_of(data) != expected or is_being_written(replaced):
            wait_until_at_rest(replaced)
            data = _read(replaced)
    except BaseException as error:
        if not exchange(replaced, target):
            os.replace(replaced, target)
        if isinstance(error, OSError | SaveError):
            raise SaveError(f"cannot write {path}: another program is writing it") from None
        raise
    return None if data is None or digest_of(data) == expected else data


def _write_into(target: Path, data: bytes) -> None:
    """Write into a file that exists, which keeps its names, mode and owner.

    What extends the file is written first: a full disk leaves the old text.

    Raises:
        OSError: The file system reports an error.
    """
    flags = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    handle = os.open(target, flags)
    try:
        length = os.fstat(handle).st_size
        try:
            _write_at(handle, length, data[length:])
        except OSError:
            os.ftruncate(handle, length)
            raise
        _write_at(handle, 0, data[:length])
        os.ftruncate(handle, len(data))
        flush(handle)
    finally:
        os.close(handle)


def _write_at(handle: int, place: int, data: bytes) -> None:
    os.lseek(handle, place, os.SEEK_SET)
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(handle, rest) :]
