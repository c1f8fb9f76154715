"""Compiled kernels kept between runs.

What flows in: a key and a kernel's bytes. What flows out: the same bytes, or nothing. A kernel is
machine code that will be run, so it is read only from a folder and a file that belong to the user
and that nobody else can write. Files are written whole under another name and then renamed, and
carry a checksum, so that writers side by side, full disks and lost power do no harm. A cache that
cannot be used is no error: everything is compiled again.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

FOLDER_VARIABLE: Final = "DISTAL_CACHE_DIR"
OFF: Final = "off"
SIZE_LIMIT: Final = 256 * 2**20  # bytes; then the longest unused go
_SUFFIX: Final = ".kernel"
_MAGIC: Final = b"distal kernel 1\n"
_DIGEST = 32

_warned: set[Path] = set()


def default_folder() -> Path | None:
    """Where kernels are kept; None when that is nowhere.

    ``DISTAL_CACHE_DIR`` decides, ``off`` meaning nowhere; else the system's folder for caches.
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


class Cache:
    """A folder of kernels."""

    def __init__(self, folder: Path | None, limit: int = SIZE_LIMIT) -> None:
        self.folder = folder
        self.limit = limit

    def load(self, key: str) -> bytes | None:
        """The bytes stored under a key, if they are there and sound."""
        with self._opened() as folder:
            if folder is None:
                return None
            try:
                handle = os.open(key + _SUFFIX, os.O_RDONLY | os.O_NOFOLLOW, dir_fd=folder)
            except OSError:
                return None
            with os.fdopen(handle, "rb") as file:
                if not _only_ours(os.fstat(handle), stat.S_ISREG):
                    self._warn("holds a file that others can write; not used")
                    return None
                data = file.read()
                with suppress(OSError):
                    os.utime(handle)  # used last: dropped last
        return _checked(data)

    def store(self, key: str, payload: bytes) -> bool:
        """Keep bytes under a key; whether that worked."""
        if self.folder is None:
            return False
        with suppress(OSError):
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with self._opened() as folder:
            if folder is None:
                return False
            data = _MAGIC + hashlib.sha256(payload).digest() + payload
            try:
                _replace(self.folder, key + _SUFFIX, data)
            except OSError:
                return False
            self._shrink()
        return True

    def size(self) -> tuple[int, int]:
        """How many kernels there are, and their bytes."""
        files = list(self._files())
        return len(files), sum(size for _, size, _ in files)

    @contextmanager
    def _opened(self) -> Iterator[int | None]:
        """The folder held open, so that what was checked is what is read; None if not ours."""
        if self.folder is None or not hasattr(os, "O_NOFOLLOW"):
            yield None
            return
        try:
            handle = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        except OSError:
            yield None
            return
        try:
            if _only_ours(os.fstat(handle), stat.S_ISDIR):
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

    def _files(self) -> Iterator[tuple[float, int, str]]:
        """Time of last use, size and path of every kernel."""
        if self.folder is None:
            return
        with suppress(OSError), os.scandir(self.folder) as entries:
            for entry in entries:
                if entry.name.endswith(_SUFFIX):
                    with suppress(OSError):
                        info = entry.stat(follow_symlinks=False)
                        yield info.st_mtime, info.st_size, entry.path

    def _shrink(self) -> None:
        """Drop what was not used for longest, down to four fifths of the limit."""
        files = sorted(self._files())
        total = sum(size for _, size, _ in files)
        if total <= self.limit:
            return
        for _, size, path in files:
            if total <= self.limit * 4 // 5:
                break
            with suppress(OSError):
                os.unlink(path)
                total -= size


def _only_ours(info: os.stat_result, right_sort: object) -> bool:
    assert callable(right_sort)
    others_write = info.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return bool(right_sort(info.st_mode)) and info.st_uid == os.geteuid() and not others_write


def _replace(folder: Path, name: str, data: bytes) -> None:
    handle, temporary = tempfile.mkstemp(prefix=".new-", dir=folder)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.replace(temporary, folder / name)
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)
        raise


def _checked(data: bytes) -> bytes | None:
    """The payload of a file, or None when it is broken."""
    start = len(_MAGIC) + _DIGEST
    if len(data) < start or not data.startswith(_MAGIC):
        return None
    payload = data[start:]
    if hashlib.sha256(payload).digest() != data[len(_MAGIC) : start]:
        return None
    return payload
