"""Notices that a scene's files were saved.

What flows in: paths. What flows out, whenever it is asked: whether they are other than they were,
and have come to rest. Loads nothing.

Files are asked for their times four times a second, which costs a few microseconds for each and
works on every file system; notices of the operating system do not reach shared folders, and an
editor that saves by renaming needs the folder watched as well.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Final, TypeAlias

PERIOD_S: Final = 0.25

Signature: TypeAlias = "tuple[tuple[int, ...] | None, ...]"


class Watch:
    """Watches a set of files, and folders whose lists of names may change."""

    def __init__(self, files: Iterable[Path]) -> None:
        self._paths: tuple[Path, ...] = ()
        self._known: Signature = ()
        self._last: Signature = ()
        self.watch(files)

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these from now on.

        A file that was watched before keeps its last known state: what was saved while the scene
        was being loaded is not missed.
        """
        known = dict(zip(self._paths, self._known, strict=True))
        self._paths = tuple(dict.fromkeys(files))
        self._known = tuple(known[p] if p in known else _state(p) for p in self._paths)
        self._last = self._known

    def has_changed(self) -> bool:
        """Whether something was saved since this was last true, and nothing in the last period.

        A file that is still being written changes from one question to the next: it is waited for.
        """
        state = tuple(map(_state, self._paths))
        at_rest, self._last = state == self._last, state
        if not at_rest or state == self._known:
            return False
        self._known = state
        return True


def _state(path: Path) -> tuple[int, ...] | None:
    """What changes when a file is saved, or replaced, or a folder gets another name; None: gone."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
