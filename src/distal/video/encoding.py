"""Encode frames into the segments of a video while other frames are rendered.

Input: pictures with their indices, in order. Output: complete segments. Frames are converted on the
threads that render, and encoded on a separate thread.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

from distal.devices.threads import usable_threads
from distal.images.picture import Picture
from distal.video.formats import Codec
from distal.video.frames import Frames
from distal.video.pixels import Converter
from distal.video.segments import PIECE_SUFFIX, Piece

# Once a segment takes longer, its frames are kept as pictures too: this is what a crash may cost.
KEEP_AFTER_S: Final = 10.0


class Encoding:
    """Encodes frames in order, segment by segment, on one thread.

    Args:
        pieces: The segment files to write, with the indices of their frames, in order.
        codec: The codec.
        size: Width and height in pixels.
        rate: Frames per second.
        frames: Where frames are written as pictures too.
        keeps_all: Whether each frame is written; otherwise those of a segment that takes long,
            until it is complete.
    """

    def __init__(
        self,
        pieces: Mapping[Path, range],
        codec: Codec,
        size: tuple[int, int],
        rate: Fraction,
        frames: Frames,
        *,
        keeps_all: bool,
    ) -> None:
        self._pieces = iter(pieces.items())
        self._ranges = list(pieces.values())
        self._codec = codec
        self._converters = threading.local()  # a converter has tables for use by a single thread
        self._size, self._rate = size, rate
        self._frames, self._keeps_all = frames, keeps_all
        self._piece: Piece | None = None
        self._in_piece = range(0)
        self._broken: set[int] = set()  # frames of segments of which one frame failed
        self._begin = time.monotonic()

    def ready(self, index: int, picture: Picture) -> tuple[int, Any, Picture | None]:
        """Convert a frame for the queue, on the thread that rendered it, while it is in the cache.

        A frame of 8 bits is a tenth of the size of its picture; immediate conversion saves 0.8 ms
        of processor time at 640x480.
        """
        frame = self._converter().frame_of(picture.levels)
        is_late = time.monotonic() - self._begin > KEEP_AFTER_S
        is_kept = self._keeps_all or is_late or index in self._broken
        return index, frame, picture if is_kept else None

    def ready_without(self, index: int) -> tuple[int, None, None]:
        """Return a frame that failed, for the queue: its segment stays incomplete.

        The other frames of its segment are kept as pictures from now on.
        """
        self._broken.update(next(frames for frames in self._ranges if index in frames))
        return index, None, None

    def ready_again(self, index: int) -> tuple[int, Any, None]:
        """Return a frame that an earlier run has kept, for the queue."""
        return index, self._converter().frame_of(self._frames.levels(index)), None

    def _converter(self) -> Converter:
        if not hasattr(self._converters, "own"):
            self._converters.own = Converter(self._codec)
        own: Converter = self._converters.own
        return own

    def take(self, item: tuple[int, Any, Picture | None]) -> None:
        """Encode the next frame, or keep it as a picture if its segment cannot be complete."""
        index, frame, picture = item
        if index not in self._in_piece:
            path, self._in_piece = next(self._pieces)
            self._piece = Piece(path, self._codec, self._size, self._rate, encoder_threads())
        if picture is not None:
            self._frames.write(index, picture)
        if frame is None:
            self.abandon()
        if self._piece is None:
            return
        self._piece.add(frame)
        if index == self._in_piece[-1]:
            self._piece.finish()
            self._piece = None
            self._begin = time.monotonic()
            if not self._keeps_all:
                self._frames.remove(self._in_piece)

    def abandon(self) -> None:
        """Remove an incomplete segment."""
        if self._piece is not None:
            self._piece.abandon()
            self._piece = None


def encoder_threads() -> int:
    """Return half the processors: rendering needs the others, and one alone would be too slow."""
    return max(1, min(8, usable_threads() // 2))


def piece_name(frames: range) -> str:
    """Return the file name of a segment, made of its first and last frame."""
    return f"{frames[0]:06d}-{frames[-1]:06d}{PIECE_SUFFIX}"
