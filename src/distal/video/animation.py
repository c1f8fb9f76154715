"""Write animated pictures, GIF, APNG or WebP, from frames in files.

Input: the PNG files of the frames, in order. Output: one file. Only a few frames are in memory at
a time. Does not depend on scenes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import Image

from distal.file_writer import SaveError
from distal.video.formats import LOSSLESS, VideoFormat, library
from distal.video.pixels import BT709, FULL, RGB, SRGB
from distal.video.segments import whole_or_nothing
from distal.video.texts import with_texts

Progress = Callable[[int], Any]
# One palette for all frames, and error diffusion. Measured on the raymarcher, 320x240, 40 frames:
# dB of the blurred difference (dithering as the eye sees it) and kB: this 57.7, 377; Bayer 48.6,
# 427; Pillow with one palette 52.3, 749; Pillow with a palette per frame 59.7, 425, but colors of
# still parts then change from frame to frame.
_DITHER: Final = "dither=sierra2_4a:diff_mode=rectangle"


@dataclass(frozen=True, slots=True)
class Animation:
    """The frames of an animated picture and how they are shown.

    Attributes:
        files: PNG files of one size, in order.
        rate: Frames per second.
        quality: For webp: 0 to 100, or "lossless".
        loop: Whether it repeats forever; otherwise it is played once.
        texts: Metadata: title, comment and others.
    """

    files: Sequence[Path]
    rate: Fraction
    quality: float | str
    loop: bool
    texts: Mapping[str, str]

    def times(self, ticks: int) -> list[int]:
        """Return when each frame begins and the last one ends, in a clock of ``ticks`` per second.

        Each time is rounded to the nearest tick, so errors do not add up; the durations of frames
        may differ by one tick.
        """
        exact = (i * ticks / self.rate for i in range(len(self.files) + 1))
        return [math.floor(time + Fraction(1, 2)) for time in exact]


def animate(made: Animation, path: Path, format: VideoFormat, progress: Progress) -> None:
    """Write one file with all frames.

    Args:
        made: The frames, and how they are shown.
        path: The file to write, usually a temporary one.
        format: gif, apng or webp.
        progress: Called with the number of finished frames.

    Raises:
        SaveError: A frame cannot be read, or the file cannot be written.
    """
    write = {"gif": _gif, "apng": _apng, "webp": _webp}[format.name]
    with whole_or_nothing(path):
        write(made, path, progress)
        with_texts(path, format, made.texts)


def _gif(made: Animation, path: Path, progress: Progress) -> None:
    palette = _palette(made)
    graph = library().filter.Graph()
    pictures, colors = _source(graph, _frame(made.files[0], 0)), _source(graph, palette)
    use, end = graph.add("paletteuse", _DITHER), graph.add("buffersink")
    pictures.link_to(use, 0, 0)
    colors.link_to(use, 0, 1)
    use.link_to(end)
    graph.configure()
    colors.push(palette)
    colors.push(None)
    times = made.times(100)
    options = {"loop": "0" if made.loop else "-1", "final_delay": str(times[-1] - times[-2])}

    def frames() -> Iterator[Any]:
        for i, file in enumerate(made.files):
            pictures.push(_frame(file, i))
            yield from _pulled(end)
        pictures.push(None)
        yield from _pulled(end)

    _mux(frames(), path, _Muxing("gif", "gif", Fraction(1, 100), {}, options), times, progress)


def _palette(made: Animation) -> Any:
    """Return the palette: the best 255 colors for all frames, and one for unchanged pixels."""
    graph = library().filter.Graph()
    source = _source(graph, _frame(made.files[0], 0))
    generate, end = graph.add("palettegen", "stats_mode=full"), graph.add("buffersink")
    source.link_to(generate)
    generate.link_to(end)
    graph.configure()
    for i, file in enumerate(made.files):
        source.push(_frame(file, i))
    source.push(None)
    palette = end.pull()
    palette.pts, palette.time_base = 0, Fraction(1)
    return palette


def _source(graph: Any, frame: Any) -> Any:
    return graph.add_buffer(
        width=frame.width, height=frame.height, format=frame.format.name, time_base=Fraction(1)
    )


def _pulled(end: Any) -> Iterator[Any]:
    """Yield the frames that a graph has finished."""
    av = library()
    while True:
        try:
            yield end.pull()
        except (av.error.BlockingIOError, av.error.EOFError):
            return


def _apng(made: Animation, path: Path, progress: Progress) -> None:
    # The format stores a delay as a fraction, so nothing is rounded.
    count = len(made.files)
    options = {"plays": "0" if made.loop else "1", "final_delay": str(1 / made.rate)}
    muxing = _Muxing("apng", "apng", 1 / made.rate, {"pred": "mixed"}, options)
    _mux(_frames(made), path, muxing, list(range(count + 1)), progress)


def _webp(made: Animation, path: Path, progress: Progress) -> None:
    exact = made.quality == LOSSLESS
    how = {"lossless": "1"} if exact else {"quality": f"{made.quality:g}"}
    options = {"loop": "0" if made.loop else "1"}
    # Not libwebp_anim, which keeps blocks that changed little since the previous frame: where light
    # changes slowly, parts of old frames remain visible, and files were not smaller (the
    # raymarcher, 160x120, 8 frames at quality 80: 13.1 kB against 12.0).
    muxing = _Muxing("webp", "libwebp", Fraction(1, 1000), how, options)
    frames = (frame.reformat(format="bgra", threads=1) for frame in _frames(made))
    _mux(frames, path, muxing, made.times(1000), progress)


@dataclass(frozen=True, slots=True)
class _Muxing:
    container: str
    encoder: str
    clock: Fraction
    encoding: Mapping[str, str]
    options: Mapping[str, str]


def _mux(
    frames: Iterator[Any], path: Path, how: _Muxing, times: Sequence[int], progress: Progress
) -> None:
    """Encode frames into a file, each starting at its time.

    Args:
        frames: The frames, in order.
        path: The file.
        how: The container, the encoder and their options.
        times: The start of each frame and the end of the last, in ticks of the clock.
        progress: Called with the number of finished frames.
    """
    container = library().open(str(path), "w", format=how.container, options=dict(how.options))
    stream: Any = None
    with container:
        for i, frame in enumerate(frames):
            if stream is None:
                stream = container.add_stream(how.encoder, rate=1 / how.clock)
                stream.width, stream.height = frame.width, frame.height
                stream.pix_fmt = frame.format.name
                stream.options = dict(how.encoding)
                stream.codec_context.time_base = how.clock
                _tag(stream.codec_context)
            frame.pts, frame.time_base = times[i], how.clock
            frame.duration = times[i + 1] - times[i]
            packets = stream.encode(frame)
            if how.encoder == "libwebp":  # it does not set the duration of the last frame
                for packet in packets:
                    packet.duration = frame.duration
            container.mux(packets)
            progress(i + 1)
        container.mux(stream.encode(None))


def _tag(context: Any) -> None:
    context.sample_aspect_ratio = Fraction(1)
    context.color_primaries, context.color_trc = BT709, SRGB
    context.colorspace, context.color_range = RGB, FULL


def _frames(made: Animation) -> Iterator[Any]:
    """Yield the frames in one pixel format: with alpha if any frame has it."""
    alpha = any(_mode(file) == "RGBA" for file in made.files)
    for i, file in enumerate(made.files):
        yield _frame(file, i, alpha=alpha)


def _mode(file: Path) -> str:
    with Image.open(file) as picture:
        return picture.mode


def _frame(file: Path, index: int, *, alpha: bool = False) -> Any:
    """Read a frame from a PNG file."""
    try:
        with Image.open(file) as picture:
            levels = np.array(picture.convert("RGBA" if alpha else "RGB"))
    except (OSError, SyntaxError) as error:
        raise SaveError(f"cannot read the frame {file}: {error}") from None
    frame = library().VideoFrame.from_ndarray(levels, "rgba" if alpha else "rgb24")
    frame.pts, frame.time_base = index, Fraction(1)
    return frame
