"""Locks of paths, and of processes, between all processes of a user.

Input: a path, or the token of a process. Output: a lock for the time of a block; whether a process
lives. One file of the user's state folder is locked byte by byte, so no lock leaves a file behind,
and a process that ends frees its locks. Where there is no such folder, or its file system has no
locks, only the threads of a process wait for each other.
"""

from __future__ import annotations

import hashlib
import os
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from distal.file_writer.state import state_folder
from distal.forking import new_lock

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]

LONGEST_WAIT_S: Final = 10.0  # a lock is held for the time of a rename
_FIRST_PAUSE_S: Final = 0.001
_LONGEST_PAUSE_S: Final = 0.02
# Places in the file: first those of paths, then those of processes.
_PLACES: Final = 2**28
_TOKEN_DIGITS: Final = 7

# Other threads wait for one of these; two paths rarely share one.
_THREADS: Final = [new_lock() for _ in range(64)]
_OPENING: Final = new_lock()
_claims: set[int] = set()


class BusyError(Exception):
    """Another process holds a lock for too long."""


class _LockFile:
    """The open file of locks.

    Attributes:
        name: Names the file and the machine: only its processes see each other's locks.
    """

    def __init__(self, handle: int) -> None:
        self._handle = handle
        info = os.fstat(handle)
        parts = (_machine(), info.st_dev, info.st_ino)
        self.name = hashlib.sha256(repr(parts).encode()).hexdigest()[:8]

    def take(self, place: int) -> bool:
        """Lock a byte if it is free.

        Raises:
            OSError: The file system has no locks.
        """
        try:
            if fcntl is not None:
                fcntl.lockf(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, place)
            else:
                _windows(self._handle, place, is_taken=True)
        except (BlockingIOError, PermissionError):
            return False
        return True

    def free(self, place: int) -> None:
        """Free a byte."""
        with suppress(OSError):
            if fcntl is not None:
                fcntl.lockf(self._handle, fcntl.LOCK_UN, 1, place)
            else:
                _windows(self._handle, place, is_taken=False)


@dataclass(slots=True)
class _Process:
    """This process: its number, which a fork changes, its token and its file of locks."""

    number: int
    token: str
    file: _LockFile | None


_processes: list[_Process] = []  # of this process and the ones that it was forked from


def process_name() -> tuple[str, str]:
    """Return the names of the file of locks and of this process; zeros if there are no locks."""
    process = _this_process()
    return ("0" * 8 if process.file is None else process.file.name), process.token


def is_over(lock_file: str, token: str) -> bool | None:
    """Return whether a process has ended; None if this cannot be known.

    Args:
        lock_file: The name of its file of locks.
        token: The name of the process.
    """
    this = _this_process()
    if this.file is None or lock_file != this.file.name:
        return None
    if token == this.token:
        return False
    place = _PLACES + int(token, 16)
    try:
        if not this.file.take(place):
            return False
    except OSError:
        return None
    this.file.free(place)
    return True


def lock_file(handle: int) -> bool:
    """Lock an open file until it is closed; return False if another process has locked it.

    Where there are no such locks, as on Windows, nobody has.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other threads and processes of this user from the block of the same path.

    Args:
        path: A path without links. Letters of both cases are one, as in some file systems.

    Raises:
        BusyError: Another one has not left its block for ``LONGEST_WAIT_S``.
    """
    digest = hashlib.sha256(str(path).casefold().encode("utf-8", "surrogatepass")).digest()
    place = int.from_bytes(digest[:8], "little") % _PLACES
    until = time.monotonic() + LONGEST_WAIT_S
    threads = _THREADS[place % len(_THREADS)]
    if not threads.acquire(timeout=LONGEST_WAIT_S):
        raise BusyError
    try:
        file = _taken(place, until)
        try:
            yield
        finally:
            if file is not None:
                file.free(place)
    finally:
        threads.release()


@contextmanager
def claimed(path: Path) -> Iterator[None]:
    """Keep other threads and processes of this user from claiming the same path during the block.

    It may last long: nobody waits for it, and ``locked`` of the path is free.

    Args:
        path: A path without links.

    Raises:
        BusyError: Another one has claimed it.
    """
    digest = hashlib.sha256(b"claim\0" + str(path).casefold().encode("utf-8", "surrogatepass"))
    place = int.from_bytes(digest.digest()[:8], "little") % _PLACES
    with _OPENING:  # the system keeps other processes out, not the threads of this one
        if place in _claims:
            raise BusyError
        _claims.add(place)
    try:
        file = _taken(place, time.monotonic())
        try:
            yield
        finally:
            if file is not None:
                file.free(place)
    finally:
        _claims.discard(place)


def _taken(place: int, until: float) -> _LockFile | None:
    file = _this_process().file
    pause = _FIRST_PAUSE_S
    try:
        while file is not None and not file.take(place):
            if time.monotonic() > until:
                raise BusyError
            time.sleep(pause)
            pause = min(2.0 * pause, _LONGEST_PAUSE_S)
    except OSError:  # a file system without locks
        return None
    return file


def _this_process() -> _Process:
    with _OPENING:
        if not _processes or _processes[-1].number != os.getpid():
            _processes.append(_new_process())
        return _processes[-1]


def _new_process() -> _Process:
    """Open the file of locks and lock the byte of this process, as long as it lives.

    A forked child uses the open file of its parent: to close it would free locks of its own.
    """
    file = _processes[-1].file if _processes else _opened()
    for _ in range(8):
        token = secrets.token_hex(4)[:_TOKEN_DIGITS]
        try:
            if file is None or file.take(_PLACES + int(token, 16)):
                return _Process(os.getpid(), token, file)
        except OSError:
            break
    return _Process(os.getpid(), "0" * _TOKEN_DIGITS, None)


def _opened() -> _LockFile | None:
    try:
        folder = state_folder()
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        handle = os.open(folder / "locks", flags, 0o600)
    except OSError:
        return None
    info = os.fstat(handle)
    if not stat.S_ISREG(info.st_mode) or (os.name != "nt" and info.st_uid != os.geteuid()):
        os.close(handle)
        return None
    return _LockFile(handle)


def _machine() -> str:
    return os.uname().nodename if hasattr(os, "uname") else os.environ.get("COMPUTERNAME", "")


def _windows(handle: int, place: int, *, is_taken: bool) -> None:
    import msvcrt  # noqa: PLC0415 (Windows alone has it)

    system: Any = msvcrt
    with _OPENING:  # the place in the file is shared by all threads
        os.lseek(handle, place, os.SEEK_SET)
        system.locking(handle, system.LK_NBLCK if is_taken else system.LK_UNLCK, 1)
