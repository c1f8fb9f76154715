"""Files that keep the samples of a picture while it is rendered.

Input: a film and the fingerprint of its picture. Output: a file, replaced in one step, so that a
process that is killed loses only the passes since the last one. Does not depend on how samples are
made.
"""

from __future__ import annotations

import time
import zipfile
from pathlib import Path
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.file_writer import SaveError, check_destination, replacement
from distal.foreign_files import reading
from distal.runtime.accumulation import Film

# Seconds between two writes; a slow disk is written to less often.
_INTERVAL_S: Final = 10.0
_INTERVAL_WRITES: Final = 20.0
# The attributes of a film that are kept.
_ARRAYS: Final = ("sums", "spread", "samples", "passes", "steps")
_KEY: Final = "key"
_LONGEST_KEY: Final = 4096  # bytes

Header: TypeAlias = tuple[np.dtype[Any], tuple[int, ...]]


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
            size = self._path.stat().st_size
        except OSError:
            size = 0  # reading it says why
        with reading("film", str(self._path), size, error=ValueError):
            arrays = self._arrays(width, height)
        if arrays is None:
            raise ValueError(
                f"{self._path} keeps the samples of another picture: delete it or name another"
            )
        return Film(**arrays, signed=signed)

    def _arrays(self, width: int, height: int) -> dict[str, NDArray[Any]] | None:
        """Return the arrays of the file; None if they are those of another picture.

        What an array says of itself is compared before it is read.
        """
        expected = _expected(width, height)
        with zipfile.ZipFile(self._path) as archive:
            dtype, shape = _header(archive, _KEY)
            if dtype.kind != "U" or shape or dtype.itemsize > _LONGEST_KEY:
                raise LoadError("it has no key")
            if str(_read(archive, _KEY)) != self._key:
                return None
            headers = {name: _header(archive, name) for name in _ARRAYS}
            for name, (dtype, shape) in headers.items():
                if (dtype, shape) != expected[name]:
                    raise LoadError(f"its '{name}' is {dtype} {shape}")
            return {name: _read(archive, name) for name in _ARRAYS}

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


def _expected(width: int, height: int) -> dict[str, Header]:
    """Return the type and the shape of each array of a film."""
    one = Film.empty(1, 1)
    plane = height, width
    shapes = {"sums": (*plane, 4), "steps": (3, *plane)}
    return {name: (getattr(one, name).dtype, shapes.get(name, plane)) for name in _ARRAYS}


def _header(archive: zipfile.ZipFile, name: str) -> Header:
    with archive.open(f"{name}.npy") as file:
        if np.lib.format.read_magic(file) != (1, 0):
            raise LoadError(f"its '{name}' is of a later version of NumPy's format")
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    return dtype, shape


def _read(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    with archive.open(f"{name}.npy") as file:
        array: NDArray[Any] = np.lib.format.read_array(file, allow_pickle=False)
    return array
