"""Pieces of a video: encoded one by one, joined without encoding again.

Input: pictures; later the pieces' paths. Output: a file for each piece, whole or
not there, and one file of all. Each piece begins with a key frame and needs no other. Knows nothing
of scenes and of who decides where a piece ends.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

from distal.images.atomic_files import SaveError, move_into_place
from distal.video.formats import Codec, VideoFormat, library
from distal.video.pixels import tag

# MP4 takes the packets of both codecs and any clock; Matroska's counts milliseconds only.
PIECE_SUFFIX: Final = ".mp4"


class Piece:
    """One piece while it is encoded.

    Args:
        path: Its file once it is complete.
        codec: How it is encoded.
        size: Width and height in pixels.
        rate: Frames a second.
        threads: How many the encoder uses.
    """

    def __init__(
        self, path: Path, codec: Codec, size: tuple[int, int], rate: Fraction, threads: int
    ) -> None:
        self._path = path
        self._partial = partial(path)
        self._rate = rate
        self._count = 0
        with writing(path):
            self._container = library().open(str(self._partial), "w", format="mp4")
            stream = self._container.add_stream(codec.encoder, rate=rate)
            stream.width, stream.height = size
            stream.pix_fmt = codec.pixels
            stream.options = dict(codec.options)
            stream.codec_context.time_base = 1 / rate
            stream.codec_context.thread_count = threads
            tag(stream.codec_context, codec)
        self._stream = stream

    def add(self, frame: Any) -> None:
        """Encode the next picture, as a ``Converter`` made it."""
        frame.pts, frame.time_base = self._count, 1 / self._rate
        self._count += 1
        with writing(self._path):
            self._container.mux(self._stream.encode(frame))

    def finish(self) -> None:
        """Encode what is still waiting, and let the file appear."""
        with writing(self._path):
            self._container.mux(self._stream.encode(None))
            self._container.close()
            move_into_place(self._partial, self._path)

    def abandon(self) -> None:
        """Leave nothing."""
        with suppress(Exception):  # an encoder that was broken off may complain
            self._container.close()
        with suppress(OSError):
            self._partial.unlink()


def join(
    pieces: Sequence[tuple[Path, int]],
    path: Path,
    format: VideoFormat,
    rate: Fraction,
    texts: Mapping[str, str],
) -> None:
    """One file of all pieces, its packets as they are.

    Args:
        pieces: Each one's file and its number of frames, in order.
        path: Where the file appears when it is whole; in the folder of the pieces.
        format: mp4 or webm.
        rate: Frames a second.
        texts: The container's metadata.

    Raises:
        SaveError: A piece cannot be read or the file not be written.
    """
    # Without this flag Matroska's files carry a random number: one video would be two files.
    options = {"fflags": "+bitexact"}
    if format.name == "mp4":
        options["movflags"] = "+faststart"
    with whole_or_nothing(path):
        out = library().open(str(path), "w", format=format.name, options=options)
        try:
            out.metadata.update(texts)
            _copy(pieces, out, rate)
        except BaseException:
            with suppress(Exception):  # the first error is reported, not that the end is missing
                out.close()
            raise
        out.close()


def _copy(pieces: Sequence[tuple[Path, int]], out: Any, rate: Fraction) -> None:
    stream, first = None, 0
    for file, count in pieces:
        source, packets = _read(file, first, count, rate)
        with source:
            if stream is None:
                stream = out.add_stream_from_template(source.streams.video[0])
                stream.time_base = 1 / rate
            for packet in packets:
                packet.stream = stream
                out.mux(packet)
        first += count


def _read(file: Path, first: int, count: int, rate: Fraction) -> tuple[Any, list[Any]]:
    """A piece and its packets; one that is damaged goes, so that it is made again."""
    packets = []
    with suppress(OSError, library().FFmpegError):
        source = library().open(str(file))
        packets = list(_shifted(source, first, rate))
        if len(packets) == count:
            return source, packets
        source.close()
    with suppress(OSError):
        file.unlink()
    raise SaveError(
        f"{file} was damaged: {len(packets)} frames, not {count}; the same command makes it again"
    )


def _shifted(source: Any, first: int, rate: Fraction) -> Iterator[Any]:
    """A piece's packets, counted in frames from the video's beginning."""
    for packet in source.demux(video=0):
        if packet.pts is None or packet.dts is None:  # the end's empty packet
            continue
        clock = packet.time_base * rate
        packet.pts = first + round(packet.pts * clock)
        packet.dts = first + round(packet.dts * clock)
        packet.duration = 1
        packet.time_base = 1 / rate
        yield packet


def partial(path: Path) -> Path:
    """The name of a file that is not whole yet."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Tell failures of the file system and of FFmpeg in one line."""
    try:
        yield
    except OSError as error:  # FFmpeg's errors of files are these too
        raise SaveError(f"cannot write {path}: {error.strerror or error}") from error
    except library().FFmpegError as error:
        raise SaveError(f"cannot write {path}: {error}") from error


@contextmanager
def whole_or_nothing(path: Path) -> Iterator[None]:
    """Tell failures as ``writing`` does, and leave nothing: half a file may fill a disk."""
    try:
        with writing(path):
            yield
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise
