"""``scene.video(…)``: render and write a sequence.

Input: an animated picture, a path, a duration and a frame rate. Output: the file, or numbered
pictures. Frames are rendered on several threads while others encode them. Finished parts are kept,
and the same call continues from there. ``formats`` describes how files are encoded.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import Any, Final

import numpy as np

from distal.devices.base import cancel_test
from distal.devices.threads import usable_threads
from distal.file_writer import check_destination
from distal.images.picture import Picture
from distal.lang.render_options import FrameProgress, RenderOptions
from distal.version import __version__
from distal.video.animation import Animation, animate
from distal.video.encoding import Encoding, piece_name
from distal.video.formats import (
    FRAMES,
    Codec,
    VideoError,
    VideoFormat,
    check_rate,
    check_size,
    codec_of,
    format_of,
    library,
    numbered,
    read_quality,
)
from distal.video.frame_rendering import FrameRendering, FrameSteps
from distal.video.frames import Frames, make_folder
from distal.video.moving_picture import MovingPicture, moving_picture
from distal.video.segments import join
from distal.video.store import Store, Tell
from distal.video.timing import Timing, timing

# Frames in the folder of finished parts.
_KEPT: Final = "frame-%05d.png"
# A loop jumps if its ends differ by more than this: three steps of 255 on average.
_JUMP: Final = 3.0 / 255.0


@dataclass(frozen=True, slots=True)
class FinishedSequence:
    """A finished sequence.

    Attributes:
        path: The file, or the pattern of the files.
        frames: Number of frames.
        rendered: Number of frames rendered by this call; the others already existed.
        size: Width and height in pixels.
        rate: Frames per second.
        bytes: Size of the file, or of all files.
        seconds: Duration of the call.
    """

    path: Path
    frames: int
    rendered: int
    size: tuple[int, int]
    rate: Fraction
    bytes: int
    seconds: float

    def __str__(self) -> str:
        frames = "1 frame" if self.frames == 1 else f"{self.frames} frames"
        lasts = f"{float(self.frames / self.rate):.4g} s"
        return (
            f"{self.path}: {frames}, {self.size[0]}x{self.size[1]}, {lasts}, "
            f"{_amount(self.bytes)}; {self.seconds:.1f} s"
        )


def record(
    obj: Any,
    path: str | PathLike[str],
    options: RenderOptions,
    *,
    duration: float | Fraction | str,
    fps: float | Fraction | str = 30,
    start: float | Fraction | str = 0.0,
    loop: bool = False,
    quality: str | float = "high",
    keep_frames: str | PathLike[str] | None = None,
    fresh: bool = False,
    progress: FrameProgress | None = None,
    tell: Tell | None = None,
) -> FinishedSequence:
    """Render a video or a sequence of pictures, depending on the suffix.

    Frame i of ``round(duration * fps)`` shows the time ``start + i / fps``: with a duration of one
    period the last frame is one step before the first. An interrupted run continues where it
    stopped. Needs the extra ``video`` for mp4 and webm.

    Args:
        obj: A scene, a shape or an ``@image``.
        path: Ends in .mp4, .webm, .gif, .apng or .webp, or is like ``frames/%05d.png``, whose
            folder is created.
        options: How each frame is rendered.
        duration: Seconds.
        fps: Frames per second: 30, 29.97 or "30000/1001".
        start: The time of the first frame in seconds.
        loop: Whether gif, apng and webp repeat forever; otherwise they are played once.
        quality: "low", "medium", "high", a number from 0 to 100, or "lossless".
        keep_frames: A folder to which every frame is also written as a PNG file; it is created.
        fresh: Render all frames again, even after an interrupted call.
        progress: Called with the finished frames, all frames, and the kind of work.
        tell: Called with a line of text, for example that an interrupted run continues.

    Raises:
        SaveError: The file cannot be written, or PyAV is missing.
        VideoError: An option is invalid or not supported by the format.
        CompileError: The scene has mistakes; parts that are complete by then are kept.
    """
    begin = time.perf_counter()
    output = Path(path)
    format = format_of(output)
    when = timing(start, duration, fps)
    check_rate(when.rate, format)
    chosen = read_quality(quality, format)
    check_size(options.size, format, chosen)
    folder = None if keep_frames is None else Path(keep_frames)
    if format is FRAMES:
        if folder is not None:
            raise VideoError(f"{output} are the frames; keep_frames is for videos")
    else:
        library()
        check_destination(output)
    stop, is_cancelled = threading.Event(), cancel_test(options.cancel)
    options = replace(
        options,
        time=when.time(0),
        delta=float(1 / when.rate),
        cancel=lambda: stop.is_set() or is_cancelled(),
    )
    shown: dict[str, Any] = {n: getattr(options, n) for n in ("view", "samples", "mode", "shutter")}
    if options.steering is not None:
        shown["steering"] = options.steering.numbers
    job = _RecordingJob(
        output=output,
        format=format,
        moving=moving_picture(obj, options),
        timing=when,
        quality=chosen,
        loop=loop,
        fresh=fresh,
        shown=shown,
        progress=progress or (lambda done, total, what: None),
        tell=tell or (lambda words: None),
        stop=stop,
    )
    if loop:
        job.compare_ends()
    rendered, size_bytes = job.run(folder)
    seconds = time.perf_counter() - begin
    return FinishedSequence(
        output, when.count, rendered, options.size, when.rate, size_bytes, seconds
    )


@dataclass(frozen=True, slots=True)
class _RecordingJob:
    output: Path
    format: VideoFormat
    moving: MovingPicture
    timing: Timing
    quality: float | str
    loop: bool
    fresh: bool
    shown: Mapping[str, Any]
    progress: FrameProgress
    tell: Tell
    stop: threading.Event

    def run(self, keep: Path | None) -> tuple[int, int]:
        """Make the file; return the number of frames rendered and the bytes written."""
        if self.format is FRAMES:
            return self._numbered()
        kept = None
        if keep is not None:
            make_folder(keep)
            kept = self._frames(keep / "%05d.png")
        store = Store(self.output)
        store.open(self._manifest(), self.fresh, self.tell)
        try:
            rendered = (
                self._encoded(store, kept) if self.format.encoded else self._animated(store, kept)
            )
        except BaseException:
            self._report_kept(store)
            raise
        finally:
            store.close()
        return rendered, self.output.stat().st_size

    # The kinds of output

    def _numbered(self) -> tuple[int, int]:
        make_folder(self.output.parent)
        frames = self._frames(self.output)
        check_destination(frames.files[-1])
        rendered = self._write_frames(frames)
        return rendered, sum(file.stat().st_size for file in frames.files)

    def _animated(self, store: Store, kept: Frames | None) -> int:
        frames = kept or self._frames(store.path(_KEPT))
        rendered = self._write_frames(frames)
        what = Animation(frames.files, self.timing.rate, self.quality, self.loop, self.texts())
        whole = store.path(f"whole.partial.{self.format.name}")
        animate(what, whole, self.format, lambda i: self.progress(i, self.timing.count, "encoding"))
        store.appear(whole)
        return rendered

    def _encoded(self, store: Store, kept: Frames | None) -> int:
        codec = codec_of(self.format, self.quality)
        pieces = {store.path(piece_name(frames)): frames for frames in self.timing.pieces}
        frames = kept or self._frames(store.path(_KEPT))
        rendering = self._rendering()
        while not self._encode_pieces(pieces, codec, frames, rendering, keeps=kept is not None):
            self._complete(pieces, frames, rendering)
        whole = store.path(f"whole.partial.{self.format.name}")
        counted = [(file, len(frames)) for file, frames in pieces.items()]
        sound = self.moving.sound(self.timing.start, self.timing.duration)
        join(counted, whole, self.format, self.timing.rate, self.texts(), sound)
        store.appear(whole)
        return len(rendering.rendered)

    def _encode_pieces(
        self,
        pieces: Mapping[Path, range],
        codec: Codec,
        frames: Frames,
        rendering: FrameRendering,
        *,
        keeps: bool,
    ) -> bool:
        """Make the segments that are not there; return whether all are there then.

        Args:
            pieces: Their files, with the indices of their frames.
            codec: The codec.
            frames: Where frames are kept as pictures.
            rendering: Renders the frames that are not kept.
            keeps: Whether all frames are to be kept as pictures.
        """
        there = {
            i
            for i in range(self.timing.count)
            if (not self.fresh or i in rendering.rendered) and frames.is_there(i)
        }
        missing = {
            file: of_piece
            for file, of_piece in pieces.items()
            if not file.exists() or (keeps and not there.issuperset(of_piece))
        }
        wanted = [i for of_piece in missing.values() for i in of_piece]
        codec_and_size = codec, self.moving.size, self.timing.rate
        encoding = Encoding(missing, *codec_and_size, frames, keeps_all=keeps)
        again = {i: encoding.ready_again for i in wanted if i in there}
        way = FrameSteps(encoding.ready, encoding.take, again=again, without=encoding.ready_without)
        try:
            rendering.render(wanted, way)
        finally:
            encoding.abandon()
        return not rendering.failed

    def _complete(
        self, pieces: Mapping[Path, range], frames: Frames, rendering: FrameRendering
    ) -> None:
        """Keep all frames of incomplete segments as pictures, the failed ones if a repeat succeeds.

        Raises:
            DeviceError: It does not.
        """
        incomplete = [i for file, of_piece in pieces.items() if not file.exists() for i in of_piece]
        lost = [i for i in incomplete if i not in rendering.failed and not frames.is_there(i)]
        rendering.render(lost, self._as_pictures(frames))
        rendering.repeat(self._as_pictures(frames))
        rendering.check()

    # Frames

    def _frames(self, pattern: Path) -> Frames:
        count = range(self.timing.count)
        files = [numbered(pattern, i) for i in count]
        return Frames(files, [self.timing.time(i) for i in count], self.moving)

    def _write_frames(self, frames: Frames) -> int:
        wanted = [i for i in range(self.timing.count) if self.fresh or not frames.is_there(i)]
        rendering, way = self._rendering(), self._as_pictures(frames)
        rendering.render(wanted, way)
        rendering.repeat(way)
        rendering.check()
        return len(wanted)

    def _rendering(self) -> FrameRendering:
        return FrameRendering(self.moving, self.timing, self.progress, self.tell, self.stop)

    def _as_pictures(self, frames: Frames) -> FrameSteps[tuple[int, Picture]]:
        # Measured: 13 ms for a PNG of 640x480, and 6 ms for rendering it on two processors.
        workers = max(1, min(4, usable_threads()))
        return FrameSteps(lambda i, made: (i, made), lambda item: frames.write(*item), workers)

    def compare_ends(self) -> None:
        """Report a loop that jumps: the picture one period later is different."""
        width, height = self.moving.size
        shrink = max(1, max(width, height) // 160)
        size = (max(1, width // shrink), max(1, height // shrink))
        begin, end = self.timing.start, self.timing.start + self.timing.duration
        first, last = (self.moving.picture(0, float(t), size).array for t in (begin, end))
        off = np.abs(np.clip(first, 0.0, 1.0) - np.clip(last, 0.0, 1.0))[..., :3]
        if float(np.nan_to_num(off).mean()) > _JUMP:
            self.tell(
                f"the picture at {float(end):g} s is not that at {float(begin):g} s: "
                "the loop will jump"
            )
        if not self.format.loops:
            what = "pictures have" if self.format is FRAMES else f"{self.format.name} has"
            self.tell(f"{what} no mark for loops: whoever plays it decides")

    # Manifest and metadata

    def _manifest(self) -> dict[str, Any]:
        """Return everything that segments depend on; not the duration, so that it may grow."""
        made = {
            "distal": __version__,
            "program": self.moving.fingerprint,
            "parameters": dict(self.moving.parameters),
            "size": list(self.moving.size),
            "fps": str(self.timing.rate),
            "start": str(self.timing.start),
            "device": self.moving.options.device,
            **self.shown,
        }
        if self.format.encoded:
            made |= {"quality": self.quality, "pyav": library().__version__}
        plain: dict[str, Any] = json.loads(json.dumps(made, default=repr))
        return plain

    def texts(self) -> dict[str, str]:
        """Return the metadata of the file."""
        comment = {
            "software": f"distal {__version__}",
            "source": self.moving.name,
            "source_hash": self.moving.source_hash,
            "parameters": dict(self.moving.parameters),
            "start": float(self.timing.start),
            "duration": float(self.timing.duration),
            "fps": str(self.timing.rate),
            "frames": self.timing.count,
            "size": f"{self.moving.size[0]}x{self.moving.size[1]}",
            **self.shown,
        }
        return {
            "title": self.moving.name,
            "comment": json.dumps(comment, sort_keys=True, default=repr),
            "software": f"distal {__version__}",
        }

    def _report_kept(self, store: Store) -> None:
        if self.format.encoded:
            there = [f for f in self.timing.pieces if store.path(piece_name(f)).exists()]
            in_pieces = {i for frames in there for i in frames}
            single = {i for i in range(self.timing.count) if store.path(_KEPT % i).exists()}
            kept = len(in_pieces | single)
        else:
            kept = len(store.items())
        if kept:
            self.tell(
                f"{kept} of {self.timing.count} frames are kept in {store.folder}; "
                "continue with the same command"
            )


def _amount(count: int) -> str:
    """Format a number of bytes for people."""
    if count >= 10**6:
        return f"{count / 1e6:.1f} MB"
    return f"{count / 1e3:.1f} kB" if count >= 1000 else f"{count} bytes"
