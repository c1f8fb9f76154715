"""The folder with the finished parts of a video, so that an interrupted run can continue.

Input: the path of the output, and everything that its frames depend on. Output: a folder in the
folder of the output, with a manifest and complete parts only. Does not depend on how parts are
made.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Final

from distal.diagnostics import printable
from distal.file_writer import (
    SaveError,
    check_destination,
    check_ours,
    move_into_place,
    name_beside,
    replacement,
)
from distal.file_writer.locks import lock_file

MANIFEST: Final = "manifest.json"
LOCK: Final = "lock"
# A process that was forked from this one holds its files until its program begins.
_FREED_S: Final = 0.5

Tell = Callable[[str], Any]


class Store:
    """The folder ``.out.mp4.distal`` beside ``out.mp4``; used by one process at a time."""

    def __init__(self, output: Path) -> None:
        self.output = output
        self.folder = name_beside(output, ".distal", ".")
        self._lock: IO[Any] | None = None

    def open(self, manifest: Mapping[str, Any], fresh: bool, tell: Tell) -> None:
        """Create the folder, or continue with it if it belongs to the same video.

        Args:
            manifest: Everything that the frames depend on, as JSON values.
            fresh: Start again in any case.
            tell: Called with the reason if the work starts again.

        Raises:
            SaveError: The folder cannot be made, is another user's in a folder shared by all, or
            another process uses it.
        """
        check_destination(self.output)
        try:
            if self.folder.is_symlink():
                raise SaveError(f"cannot write {self.folder}: it is a link")
            self.folder.mkdir(mode=0o700, exist_ok=True)
            # Another user could put links there, through which FFmpeg would write.
            check_ours(self.folder)
            # distal creates no links here; writing or deleting through one would change files
            # elsewhere.
            for path in self.folder.iterdir():
                if path.is_symlink():
                    path.unlink()
            self._lock = open(self.folder / LOCK, "a")  # noqa: SIM115 (held until close)
            self._hold()
            known = self._known()
            changed = [] if known is None else _changed(known, manifest)
            if known is None or fresh or changed:
                if changed and not fresh and self.items():
                    tell(f"starts again: {'; '.join(changed)}")
                self._empty()
            for pattern in ("*.partial*", ".distal-*.tmp"):
                for path in self.folder.glob(pattern):
                    path.unlink()
            with replacement(self.folder / MANIFEST) as file:
                file.write(json.dumps(manifest, indent=1, sort_keys=True).encode())
        except OSError as error:
            self.close()
            raise SaveError(f"cannot write {self.folder}: {error.strerror or error}") from error
        except SaveError:
            self.close()
            raise

    def path(self, name: str) -> Path:
        """Return the file of a part."""
        return self.folder / name

    def items(self) -> list[Path]:
        """Return the complete segments and frames in the folder."""
        names = (MANIFEST, LOCK)
        return [p for p in self.folder.iterdir() if p.name not in names and p.name[0] != "."]

    def appear(self, made: Path) -> None:
        """Move the finished video to its path and delete the folder.

        Raises:
            SaveError: The video cannot be moved.
        """
        move_into_place(made, self.output)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.close()

    def close(self) -> None:
        """Release the folder for other processes; delete it if it is empty."""
        if self._lock is None:
            return
        with suppress(OSError):
            if not self.items():
                shutil.rmtree(self.folder)
        self._lock.close()
        self._lock = None

    def _hold(self) -> None:
        if self._lock is None:
            return
        until = time.monotonic() + _FREED_S
        while not lock_file(self._lock.fileno()):
            if time.monotonic() > until:
                self._lock.close()
                self._lock = None
                raise SaveError(f"another process is writing {self.output}")
            time.sleep(0.01)

    def _known(self) -> dict[str, Any] | None:
        try:
            found = json.loads((self.folder / MANIFEST).read_text("utf-8"))
        except (OSError, ValueError, RecursionError):
            return None
        return found if isinstance(found, dict) else None

    def _empty(self) -> None:
        for path in self.folder.iterdir():
            if path.name == LOCK:
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()


def _changed(known: Mapping[str, Any], wanted: Mapping[str, Any]) -> list[str]:
    """Describe the differences of two manifests."""
    changes = []
    for name, value in wanted.items():
        if known.get(name) == value:
            continue
        if name == "program":
            changes.append("the scene has changed")
        elif name == "parameters":
            changes.append("parameters have changed")
        else:
            was = printable(known.get(name), 80)
            changes.append(f"{name.replace('_', ' ')} was {was}, is {value}")
    return changes
