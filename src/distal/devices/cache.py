"""Store compiled kernels on disk between runs.

Input: a key and a kernel's bytes. Output: the same bytes, or nothing. A kernel is machine code that
will be run, so it is read only from a folder and a file that belong to the user and that nobody
else can write. A file is written completely under another name and then renamed, and contains a
checksum of its key and its content. So concurrent writers, full disks, lost power and exchanged
files do no harm. A cache that cannot be used is not an error: everything is compiled again.
"""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import stat
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from distal.file_writer.locks import lock_file

FOLDER_VARIABLE: Final = "DISTAL_CACHE_DIR"
LIMIT_VARIABLE: Final = "DISTAL_CACHE_MIB"
OFF: Final = "off"
SIZE_LIMIT: Final = 256 * 2**20  # bytes; above it, the least recently used kernels are removed
# A process reads the sizes of all kernels at its first store, and again after it has stored this
# share of the limit. Among 3,000 kernels, reading them takes twenty times as long as storing one.
_SHARE_BETWEEN_SCANS: Final = 1 / 16
_SUFFIX: Final = ".kernel"
_TEMPORARY: Final = re.compile(r"\.new-[A-Za-z0-9_]{8,16}\Z")
# Age at which a temporary file counts as left by a killed writer. Writing takes milliseconds; a
# lock on the file shows that its writer is only paused, for example on a suspended machine.
LEFTOVER_AGE_S: Final = 3600.0
_MAGIC: Final = b"distal kernel 2\n"
_DIGEST = 32

_warned: set[Path] = set()
_stored_since_scan: dict[Path, int] = {}  # bytes, by folder


def default_folder() -> Path | None:
    """Return the folder where kernels are stored; None if they are not stored.

    ``DISTAL_CACHE_DIR`` sets it, and ``off`` disables it; the default is in the system's folder for
    caches.
    """
    chosen = os.environ.get(FOLDER_VARIABLE, "")
    if chosen.lower() == OFF:
        return None
    if chosen:
        return Path(chosen)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "distal"
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else home / ".cache") / "distal"


def size_limit() -> int:
    """Return the largest size of the user's folder in bytes; ``DISTAL_CACHE_MIB`` sets it.

    Raises:
        ValueError: It is not a whole number.
    """
    limit = os.environ.get(LIMIT_VARIABLE)
    if not limit:
        return SIZE_LIMIT
    if not limit.isdecimal():
        raise ValueError(f"{LIMIT_VARIABLE} is a whole number of MiB: '{limit}'")
    return int(limit) * 2**20


class Cache:
    """A folder of kernels.

    Attributes:
        folder: The folder; None stores nothing.
        limit: The maximum size, in bytes; each process may pass it by ``_SHARE_BETWEEN_SCANS``.
    """

    def __init__(self, folder: Path | None, limit: int | None = None) -> None:
        self.folder = folder
        self.limit = size_limit() if limit is None else limit

    def load(self, key: str) -> bytes | None:
        """Return the bytes stored under a key; None if they are missing or damaged."""
        with self._opened() as folder:
            if folder is None:
                return None
            try:
                # Non-blocking: opening a pipe with this name would otherwise wait forever.
                flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
                handle = os.open(key + _SUFFIX, flags, dir_fd=folder)
            except OSError:
                return None
            with suppress(OSError), os.fdopen(handle, "rb") as file:
                info = os.fstat(handle)
                if not stat.S_ISREG(info.st_mode) or info.st_size > self.limit:
                    return None
                if not _only_ours(info):
                    self._warn("holds a file that others can write; not used")
                    return None
                data = file.read()
                with suppress(OSError):
                    os.utime(handle)  # for the removal of the least recently used
                return _checked(key, data)
        return None

    def store(self, key: str, payload: bytes) -> bool:
        """Store bytes under a key; return whether they were stored."""
        data = _MAGIC + _digest(key, payload) + payload
        if self.folder is None or len(data) > self.limit:
            return False
        with suppress(OSError):
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with self._opened() as folder:
            if folder is None:
                return False
            is_due = self._scan_is_due(len(data))
            if is_due:
                self._drop_leftovers(folder)
            try:
                _replace(folder, key + _SUFFIX, data)
            except OSError:
                return False
            if is_due:
                self._shrink(folder)
        return True

    def _scan_is_due(self, size: int) -> bool:
        """Return whether to read the whole folder at a store of so many bytes, and count them."""
        assert self.folder is not None
        total = _stored_since_scan.get(self.folder, self.limit) + size
        is_due = total > self.limit * _SHARE_BETWEEN_SCANS
        _stored_since_scan[self.folder] = 0 if is_due else total
        return is_due

    def discard(self, key: str) -> None:
        """Remove the bytes stored under a key."""
        with self._opened() as folder, suppress(OSError):
            if folder is not None:
                os.unlink(key + _SUFFIX, dir_fd=folder)

    def size(self) -> tuple[int, int]:
        """Return the number of kernels and their total size in bytes."""
        with self._opened() as folder:
            files = [] if folder is None else list(_kernels(folder))
        return len(files), sum(size for _, size, _ in files)

    @contextmanager
    def _opened(self) -> Iterator[int | None]:
        """Open the folder, so that the checked folder is the one used; None if it is not ours."""
        if self.folder is None or not hasattr(os, "O_NOFOLLOW"):
            yield None
            return
        try:
            # Another user's link could point to a folder of this user that is not a cache.
            link = os.lstat(self.folder)
            handle = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        except OSError:
            yield None
            return
        try:
            if link.st_uid == os.geteuid() and _only_ours(os.fstat(handle)):
                yield handle
            else:
                self._warn("can be written by others; not used")
                yield None
        finally:
            os.close(handle)

    def _warn(self, what: str) -> None:
        assert self.folder is not None
        if self.folder not in _warned:
            _warned.add(self.folder)
            warnings.warn(f"the kernel cache {self.folder} {what}", RuntimeWarning, stacklevel=4)

    def _drop_leftovers(self, folder: int) -> None:
        """Remove the temporary files of killed writers, but never those of running ones."""
        with suppress(OSError), os.scandir(folder) as entries:
            for entry in entries:
                if _TEMPORARY.match(entry.name):
                    with suppress(OSError):
                        _drop_leftover(folder, entry.name)

    def _shrink(self, folder: int) -> None:
        """Remove the least recently used kernels, down to four fifths of the limit."""
        files = sorted(_kernels(folder))
        total = sum(size for _, size, _ in files)
        if total <= self.limit:
            return
        for _, size, name in files:
            if total <= self.limit * 4 // 5:
                break
            with suppress(OSError):
                os.unlink(name, dir_fd=folder)
                total -= size


def _only_ours(info: os.stat_result) -> bool:
    others_write = info.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return info.st_uid == os.geteuid() and not others_write


def _kernels(folder: int) -> Iterator[tuple[float, int, str]]:
    """Yield the time of last use, the size and the name of every kernel."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(_SUFFIX):
                with suppress(OSError):
                    info = entry.stat(follow_symlinks=False)
                    yield info.st_mtime, info.st_size, entry.name


def _drop_leftover(folder: int, name: str) -> None:
    info = os.stat(name, dir_fd=folder, follow_symlinks=False)
    if not stat.S_ISREG(info.st_mode) or not time.time() - info.st_mtime > LEFTOVER_AGE_S:
        return
    handle = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
    try:
        if lock_file(handle):
            os.unlink(name, dir_fd=folder)
    finally:
        os.close(handle)


def _replace(folder: int, name: str, data: bytes) -> None:
    temporary = f".new-{secrets.token_hex(8)}"
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    handle = os.open(temporary, flags, 0o600, dir_fd=folder)
    try:
        with os.fdopen(handle, "wb") as file:
            lock_file(handle)
            file.write(data)
            file.flush()
            _rename(folder, temporary, name)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary, dir_fd=folder)
        raise


def _rename(folder: int, temporary: str, name: str) -> None:
    try:
        os.replace(temporary, name, src_dir_fd=folder, dst_dir_fd=folder)
    except IsADirectoryError:
        os.rmdir(name, dir_fd=folder)  # removes only an empty folder
        os.replace(temporary, name, src_dir_fd=folder, dst_dir_fd=folder)


def _digest(key: str, payload: bytes) -> bytes:
    """Return a checksum of the content and of its key."""
    named = key.encode()
    return hashlib.sha256(len(named).to_bytes(8, "little") + named + payload).digest()


def _checked(key: str, data: bytes) -> bytes | None:
    """Return the payload of a file; None if it is damaged or belongs to another key."""
    start = len(_MAGIC) + _DIGEST
    if len(data) < start or not data.startswith(_MAGIC):
        return None
    payload = data[start:]
    return payload if _digest(key, payload) == data[len(_MAGIC) : start] else None
