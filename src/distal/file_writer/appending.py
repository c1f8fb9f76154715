"""``appending``: add whole lines to a file as they come, so that a killed process loses none.

Input: a file that there is, and lines. Output: the file with these lines at its end. The file is
not replaced: a reader sees the lines that are finished, and so does the next run. The content that
lines are added to is written by ``replacement`` first.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from distal.file_writer.destinations import SaveError, destination, reason
from distal.file_writer.locks import BusyError, claimed
from distal.file_writer.temporary import flush

# A process that is killed loses no line. A machine that loses its power loses those of this time:
# to flush each line of a quick program to the disk would take longer than the program.
_FLUSH_S: Final = 1.0


class LineAppender:
    """Adds lines to an open file.

    Args:
        path: The file, for messages.
        handle: Its descriptor, at its end.
    """

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle
        self._flushed = time.monotonic()

    def add(self, data: bytes) -> None:
        """Add lines, all of them or none.

        Raises:
            SaveError: They cannot be written, as on a full disk.
        """
        length = os.fstat(self._handle).st_size
        try:
            rest = memoryview(data)
            while rest:
                rest = rest[os.write(self._handle, rest) :]
            if time.monotonic() - self._flushed >= _FLUSH_S:
                self.flush()
        except OSError as error:
            os.ftruncate(self._handle, length)
            raise SaveError(f"cannot write {self._path}: {reason(error)}") from error

    def flush(self) -> None:
        """Flush the file to the disk."""
        flush(self._handle)
        self._flushed = time.monotonic()


@contextmanager
def only_writer(path: Path) -> Iterator[None]:
    """Keep other processes of this user from adding to the same file during the block.

    Raises:
        SaveError: One does already.
    """
    try:
        with claimed(destination(path)):
            yield
    except BusyError:
        raise SaveError(f"cannot write {path}: another process is writing it") from None


@contextmanager
def appending(path: Path) -> Iterator[LineAppender]:
    """Open a file that there is to add lines to it; what is added stays, however the block ends.

    Raises:
        SaveError: The file cannot be opened or flushed.
    """
    flags = os.O_WRONLY | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    try:
        handle = os.open(destination(path), flags)
        try:
            appender = LineAppender(path, handle)
            yield appender
            appender.flush()
        finally:
            os.close(handle)
    except OSError as error:
        raise SaveError(f"cannot write {path}: {reason(error)}") from error
