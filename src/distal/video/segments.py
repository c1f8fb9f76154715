"""Segments of a video: encode them separately, and join them without encoding again.

Input: pictures; later the paths of segments. Output: a file for each segment, which appears when
complete, and one file of all segments. Each segment begins with a key frame and does not refer to
others. Does not depend on scenes or on where segments end.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

from distal.file_writer import SaveError, move_into_place
from distal.sounds.reading import Samples
from distal.video.formats import Codec, VideoFormat, library
from distal.video.pixels import tag
from distal.video.soundtrack import Soundtrack

# MP4 can store the packets of both codecs with any clock; Matroska's clock counts milliseconds.
PIECE_SUFFIX: Final = ".mp4"


class Piece:
    """A segment that is being encoded.

    Args:
        path: Its file when it is complete.
        codec: The codec.
        size: Width and height in pixels.
        rate: Frames per second.
        threads: Number of threads of the encoder.
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
        """Encode the next frame, as converted by a ``Converter``."""
        frame.pts, frame.time_base = self._count, 1 / self._rate
        self._count += 1
        with writing(self._path):
            self._container.mux(self._stream.encode(frame))

    def finish(self) -> None:
        """Encode the remaining frames, and move the file to its path."""
        with writing(self._path):
            self._container.mux(self._stream.encode(None))
            self._container.close()
            move_into_place(self._partial, self._path)

    def abandon(self) -> None:
        """Remove the incomplete file."""
        with suppress(Exception):  # an interrupted encoder may raise an error
            self._container.close()
        with suppress(OSError):
            self._partial.unlink()


def join(
    pieces: Sequence[tuple[Path, int]],
    path: Path,
    format: VideoFormat,
    rate: Fraction,
    texts: Mapping[str, str],
    sound: Samples | None = None,
) -> None:
    """Join segments to one file; their packets are copied.

    Args:
        pieces: The file and the number of frames of each segment, in order.
        path: The file to write, in the folder of the segments.
        format: mp4 or webm.
        rate: Frames per second.
        texts: Metadata of the container.
        sound: What is heard from the first frame on; None for a silent video.

    Raises:
        SaveError: A segment cannot be read, or the file cannot be written.
    """
    # Without this flag Matroska files contain a random number, so equal videos would differ.
    options = {"fflags": "+bitexact"}
    if format.name == "mp4":
        options["movflags"] = "+faststart"
    with whole_or_nothing(path):
        out = library().open(str(path), "w", format=format.name, options=options)
        try:
            out.metadata.update(texts)
            _copy(pieces, out, rate, format, sound)
        except BaseException:
            with suppress(Exception):  # report the first error, not the one of closing
                out.close()
            raise
        out.close()


def _copy(
    pieces: Sequence[tuple[Path, int]],
    out: Any,
    rate: Fraction,
    format: VideoFormat,
    sound: Samples | None,
) -> None:
    stream, track, first = None, None, 0
    for file, count in pieces:
        source, packets = _read(file, first, count, rate)
        with source:
            if stream is None:
                stream = out.add_stream_from_template(source.streams.video[0])
                stream.time_base = 1 / rate
                track = None if sound is None else Soundtrack(out, format, sound)
            for packet in packets:
                packet.stream = stream
                out.mux(packet)
        first += count
        if track is not None:  # beside the pictures that it is heard with
            track.write(first / rate)
    if track is not None:
        track.write(None)


def _read(file: Path, first: int, count: int, rate: Fraction) -> tuple[Any, list[Any]]:
    """Open a segment and read its packets; delete a damaged one, so that it is encoded again."""
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
    """Yield the packets of a segment, with times counted in frames from the start of the video."""
    for packet in source.demux(video=0):
        if packet.pts is None or packet.dts is None:  # the empty packet at the end
            continue
        clock = packet.time_base * rate
        packet.pts = first + round(packet.pts * clock)
        packet.dts = first + round(packet.dts * clock)
        packet.duration = 1
        packet.time_base = 1 / rate
        yield packet


def partial(path: Path) -> Path:
    """Return the name of a file that is not complete yet."""
    return path.with_name(f"{path.stem}.partial{path.suffix}")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Convert errors of the file system and of FFmpeg to one line.

    Raises:
        SaveError: There was such an error in the block.
    """
    try:
        yield
    except OSError as error:  # includes FFmpeg's errors about files
        raise SaveError(f"cannot write {path}: {error.strerror or error}") from error
    except library().FFmpegError as error:
        raise SaveError(f"cannot write {path}: {error}") from error


@contextmanager
def whole_or_nothing(path: Path) -> Iterator[None]:
    """Convert errors as ``writing`` does, and delete the incomplete file, which may be large."""
    try:
        with writing(path):
            yield
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise
