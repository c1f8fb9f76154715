"""Files that keep the samples of a picture while it is rendered.

Input: a film and the fingerprint of its picture. Output: a file, replaced in one step, so that a
process that is killed loses only the passes since the last one. Does not depend on how samples are
made.
"""

from __future__ import annotations

import time
import zipfile
from pathlib import Path
from typing import Any, Final

import numpy as np

from distal.file_writer import SaveError, check_destination, replacement
from distal.runtime.accumulation import Film

# Seconds between two writes; a slow disk is written to less often.
_INTERVAL_S: Final = 10.0
_INTERVAL_WRITES: Final = 20.0
# The attributes of a film that are kept.
_ARRAYS: Final = ("sums", "spread", "samples", "passes", "steps")


class FilmFile:
    """The file of a film.

    Args:
        path: The file; a film that is there is continued.
        key: The fingerprint of the picture.

    Raises:
        SaveError: The file cannot be written.
    """

    def __init__(self, path: Path, key: str) -> None:
        check_destination(path)
        self._path, self._key = path, key
        self._interval = _INTERVAL_S
        self._written = time.monotonic()

    def load(self, width: int, height: int, *, signed: bool = False) -> Film:
        """Return the film that the file keeps; one without samples if there is no file.

        Args:
            width: Width of the picture in pixels.
            height: Height in pixels.
            signed: Whether samples may have negative weights.

        Raises:
            ValueError: The file is not a film, or that of another picture.
        """
        if not self._path.exists():
            return Film.empty(width, height, signed=signed)
        try:
            with np.load(self._path, allow_pickle=False) as found:
                key = str(found["key"])
                arrays = {name: found[name] for name in _ARRAYS}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            raise ValueError(f"{self._path} is not a film: delete it or name another") from None
        if key != self._key or arrays["sums"].shape != (height, width, 4):
            raise ValueError(
                f"{self._path} keeps the samples of another picture: delete it or name another"
            )
        return Film(**arrays, signed=signed)

    def keep(self, film: Film) -> None:
        """Write the film, if the last time was long ago."""
        if time.monotonic() - self._written >= self._interval:
            self.write(film)

    def write(self, film: Film) -> None:
        """Write the film.

        Raises:
            SaveError: The file cannot be written.
        """
        begin = time.monotonic()
        arrays: dict[str, Any] = {name: getattr(film, name) for name in _ARRAYS}
        try:
            with replacement(self._path) as file:
                np.savez(file, key=self._key, **arrays)
        except OSError as error:
            raise SaveError(f"cannot write {self._path}: {error.strerror or error}") from None
        self._written = time.monotonic()
        self._interval = max(_INTERVAL_S, _INTERVAL_WRITES * (self._written - begin))
