"""Detect that files were saved.

Input: paths. Output: whether one of them has changed and is completely written. Needs the standard
library alone.

The times of files are read four times a second. That costs a few microseconds per file and works
on every file system. Notifications of the operating system do not work on shared folders, and for
an editor that saves by renaming they would also need a watch on the folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Final, TypeAlias

PERIOD_S: Final = 0.25

Signature: TypeAlias = "tuple[tuple[int, ...] | None, ...]"


class FileWatcher:
    """Watches a set of files, and of folders whose entries may change."""

    def __init__(self, files: Iterable[Path], since_ns: int | None = None) -> None:
        """Watch these files from now on, or from an earlier time on (``time.time_ns``)."""
        self._paths: tuple[Path, ...] = ()
        self._known: Signature = ()
        self._last: Signature = ()
        self.watch(files)
        if since_ns is not None:
            self._expect_saved(since_ns)

    def _expect_saved(self, since_ns: int) -> None:
        """Forget the states of what was saved since then: what it was before is not known."""
        self._known = tuple(s if s is None or s[0] <= since_ns else () for s in self._known)

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these files from now on.

        A file that was already watched keeps its last known state, so that a save during loading is
        detected.
        """
        known = dict(zip(self._paths, self._known, strict=True))
        self._paths = tuple(dict.fromkeys(files))
        self._known = tuple(known[p] if p in known else _state(p) for p in self._paths)
        self._last = self._known

    def has_changed(self) -> bool:
        """Return whether something was saved since this last returned True, and is now unchanged.

        A file that is still being written changes between two calls; then the result is False.
        """
        state = tuple(map(_state, self._paths))
        at_rest, self._last = state == self._last, state
        if not at_rest or state == self._known:
            return False
        self._known = state
        return True


def _state(path: Path) -> tuple[int, ...] | None:
    """Return values that change when a file is saved or replaced, or a folder's entries change."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
