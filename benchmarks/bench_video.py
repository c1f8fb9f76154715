"""A video of the raymarcher: rendering alone, encoding alone, both as ``distal.video`` does them.

640x480, 10 s at 60 fps, mp4, on the CPU. A round runs the three one after the other: other work on
the machine affects all of them. Rendering alone makes and drops the pictures; encoding
alone encodes 60 pictures from memory repeatedly, with as many threads as in a video, joined
at the end. The ratio is that of a whole video to the slower of the two; the sum shows what doing
one after the other would take. Where rendering alone keeps both processors busy, encoding
cannot overlap with it for free: then the bound is all the processor time, shared evenly (last
column).

    python benchmarks/bench_video.py [--rounds 3] [--seconds 10]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import distal
from distal.devices.threads import usable_threads
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.video import video
from distal.video.encoding import encoder_threads
from distal.video.formats import FORMATS, codec_of
from distal.video.pixels import Converter
from distal.video.segments import Piece, join

SIZE, RATE = (640, 480), Fraction(60)
HELD = 60


class Stage:
    """Wall and processor seconds of what is run, round by round."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.wall: list[float] = []
        self.processor: list[float] = []

    def run(self, work: object) -> None:
        """Run once more."""
        begin, used = time.perf_counter(), time.process_time()
        work()  # type: ignore[operator]
        self.wall.append(time.perf_counter() - begin)
        self.processor.append(time.process_time() - used)

    def line(self, frames: int) -> str:
        """What a person reads."""
        wall = statistics.median(self.wall)
        each = wall / frames * 1e3
        processor = statistics.median(self.processor) / frames * 1e3
        return f"{self.name:16} {wall:8.2f} s {each:7.2f} ms a frame {processor:7.2f} ms processor"


def render_alone(image: object, frames: int) -> None:
    """Make the pictures."""
    for i in range(frames):
        executor().render(image, RenderOptions(size=SIZE, time=float(i / RATE), index=i))


def encode_alone(pictures: list[object], frames: int, folder: Path) -> None:
    """Encode pictures that are there, in pieces of two seconds, and join these."""
    codec, pieces = codec_of(FORMATS[".mp4"], 80.0), []
    converter = Converter(codec)
    for first in range(0, frames, 120):
        count = min(120, frames - first)
        path = folder / f"{first}.mp4"
        piece = Piece(path, codec, SIZE, RATE, encoder_threads())
        for i in range(first, first + count):
            at = i % (2 * HELD)  # forth and back, so that it moves smoothly
            piece.add(converter.frame_of(pictures[min(at, 2 * HELD - 1 - at)].levels))
        piece.finish()
        pieces.append((path, count))
    join(pieces, folder / "alone.mp4", FORMATS[".mp4"], RATE, {})


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=int, default=10)
    options = parser.parse_args()
    frames = options.seconds * 60
    image = distal.load("example:raymarcher")
    pictures = [
        executor().render(image, RenderOptions(size=SIZE, time=float(i / RATE)))
        for i in range(HELD)
    ]
    render, encode, both = Stage("rendering alone"), Stage("encoding alone"), Stage("video")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for _ in range(options.rounds):
            render.run(lambda: render_alone(image, frames))
            encode.run(lambda: encode_alone(pictures, frames, folder))
            both.run(
                lambda: video(
                    image, folder / "out.mp4", duration=options.seconds, fps=60, size=SIZE
                )
            )
        size = (folder / "out.mp4").stat().st_size
    for stage in (render, encode, both):
        print(stage.line(frames))
    rounds = range(options.rounds)
    slower = [max(render.wall[i], encode.wall[i]) for i in rounds]
    ratios = [both.wall[i] / slower[i] for i in rounds]
    apart = [(render.wall[i] + encode.wall[i]) / slower[i] for i in rounds]
    used = [render.processor[i] + encode.processor[i] for i in rounds]
    bound = [used[i] / usable_threads() / slower[i] for i in rounds]
    print(
        f"ratio to the slower {statistics.median(ratios):.2f} "
        f"(one after the other {statistics.median(apart):.2f}, "
        f"all processor time on {usable_threads()} processors {statistics.median(bound):.2f}); "
        f"{size / 1e6:.2f} MB"
    )


if __name__ == "__main__":
    main()
