"""Frames as PNG files that a later run can use again.

Input: pictures and their destinations. Output: files that contain a key, a hash of everything that
the frame depends on. A later run keeps files with the right key.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL.PngImagePlugin import PngImageFile

from distal.file_writer import SaveError, replacement
from distal.foreign_files import need_pixels, opened
from distal.images.picture import Picture
from distal.images.png import encode
from distal.video.moving_picture import MovingPicture

KEY: Final = "distal:frame"


class Frames:
    """The files of the frames of a sequence.

    Args:
        files: The file of each frame.
        times: The time of each frame in seconds.
        moving: Renders the frames. Its device is part of the key, because the pictures of two
            devices differ slightly.
    """

    def __init__(
        self, files: Sequence[Path], times: Sequence[float], moving: MovingPicture
    ) -> None:
        self.files = files
        parameters, device = sorted(moving.parameters.items()), moving.options.device
        self._common = repr((moving.fingerprint, parameters, moving.size, device))
        self._times = times

    def is_there(self, index: int) -> bool:
        """Return whether the file of a frame exists and has the right key."""
        try:
            with PngImageFile(self.files[index]) as picture:
                return picture.info.get(KEY) == self.key(index)
        except Exception:  # Pillow raises many kinds of exceptions for broken files
            return False

    def write(self, index: int, picture: Picture) -> None:
        """Write a frame's file.

        Raises:
            SaveError: It cannot be written.
        """
        texts = {**picture.metadata, KEY: self.key(index)}
        with replacement(self.files[index]) as file:
            file.write(encode(picture.array, texts))

    def levels(self, index: int) -> NDArray[np.uint8]:
        """Return a frame that is there: 8 bits for red, green, blue and alpha."""
        return levels_of(self.files[index], "RGBA")

    def remove(self, indices: Iterable[int]) -> None:
        """Delete the files of frames, where they exist."""
        for index in indices:
            self.files[index].unlink(missing_ok=True)

    def key(self, index: int) -> str:
        """Return the hash of everything that a frame depends on."""
        key = f"{self._common} {index} {self._times[index]!r}"
        return hashlib.sha256(key.encode()).hexdigest()


def levels_of(file: Path, mode: str) -> NDArray[np.uint8]:
    """Return the pixels of a frame's file.

    Args:
        file: A PNG file.
        mode: "RGB" or "RGBA".

    Raises:
        SaveError: It cannot be read.
    """
    with opened("frame", file, error=SaveError) as data, PngImageFile(io.BytesIO(data)) as picture:
        need_pixels(*picture.size, 12)
        return np.array(picture.convert(mode))


def make_folder(folder: Path) -> None:
    """Make the folder of the frames and its parent folders.

    Raises:
        SaveError: It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SaveError(f"cannot make the folder {folder}: {error.strerror or error}") from None
