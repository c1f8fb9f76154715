"""How long Mesa's software driver takes for a frame of a given fragment text.

In: a GLSL text that reads u_time and u_resolution (u_aspect too, if it likes). Out: the median
milliseconds of one frame, each drawn at another time so that nothing can be reused, on a stated
number of threads. It knows nothing of distal: this is the driver that our CPU device is held to.

    python benchmarks/rivals/llvmpipe.py benchmarks/rivals/raymarcher.frag
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent))

from tests.egl import EglShader, EglUnavailableError, ShaderRejectedError, context, renderer

FRAME_STEP_S = 1.0 / 60.0
WARM_UP_FRAMES = 3  # the driver compiles on the first draw and grows its tile buffers on the next


@dataclass(frozen=True)
class FrameTimes:
    """Milliseconds a frame: until drawn, and until its bytes are with the caller."""

    drawn_ms: list[float]
    read_ms: list[float]

    @property
    def median_drawn_ms(self) -> float:
        """The figure to compare with: nothing but the drawing, which favours the driver."""
        return statistics.median(self.drawn_ms)

    @property
    def median_read_ms(self) -> float:
        """The same with the copy of the 8-bit picture into the caller's memory."""
        return statistics.median(self.read_ms)


def use_threads(count: int) -> None:
    """Ask for llvmpipe on ``count`` threads; only works before the process's first context."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    os.environ["GALLIUM_DRIVER"] = "llvmpipe"
    os.environ["LP_NUM_THREADS"] = str(count)


def measure(
    fragment_text: str,
    *,
    version: str | None = None,
    vertex_text: str | None = None,
    size: tuple[int, int] = (640, 480),
    frames: int = 30,
    start_s: float = 0.0,
) -> FrameTimes:
    """Draw ``frames`` frames of an animation into an 8-bit target, finishing each.

    Raises:
        EglUnavailableError: if the context is not on llvmpipe: the figure would mean another thing.
    """
    if "llvmpipe" not in renderer():
        raise EglUnavailableError(f"the driver is {renderer()}, not llvmpipe")
    width, height = size
    shader = EglShader(fragment_text, version, vertex_text)
    target = context().simple_framebuffer(size, components=4, dtype="f1")
    pixels = bytearray(width * height * 4)
    fixed = {"u_resolution": [width, height], "u_aspect": width / height}
    fixed = {name: value for name, value in fixed.items() if name in shader.uniforms}
    drawn_ms, read_ms = [], []
    for frame in range(WARM_UP_FRAMES + frames):
        moving = {"u_time": start_s + frame * FRAME_STEP_S} if "u_time" in shader.uniforms else {}
        begin = time.perf_counter()
        shader.draw(target, fixed | moving)
        context().finish()
        drawn = time.perf_counter()
        target.read_into(pixels, components=4)
        read = time.perf_counter()
        if frame >= WARM_UP_FRAMES:
            drawn_ms.append((drawn - begin) * 1e3)
            read_ms.append((read - begin) * 1e3)
    target.release()
    shader.release()
    return FrameTimes(drawn_ms, read_ms)


def main() -> int:
    """Measure what the command line names; 1 with the reason on stderr if that cannot be done."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("fragment", type=Path, metavar="FRAG")
    parser.add_argument("--vertex", type=Path, help="text of the vertex stage that feeds it")
    parser.add_argument("--version", default="100", help="for texts without a #version line")
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--frames", type=int, default=30)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--start", type=float, default=0.0, help="u_time of the first frame")
    options = parser.parse_args()
    if min(options.width, options.height, options.frames, options.threads) < 1:
        parser.error("width, height, frames and threads are at least 1")
    use_threads(options.threads)
    try:
        times = measure(
            options.fragment.read_text("utf-8"),
            version=options.version,
            vertex_text=options.vertex.read_text("utf-8") if options.vertex else None,
            size=(options.width, options.height),
            frames=options.frames,
            start_s=options.start,
        )
    except (OSError, ValueError, EglUnavailableError, ShaderRejectedError) as error:
        print(f"llvmpipe: {error}", file=sys.stderr)
        return 1
    print(
        f"{options.fragment.name}: {times.median_drawn_ms:.2f} ms/frame drawn"
        f" (fastest {min(times.drawn_ms):.2f}), {times.median_read_ms:.2f} with read-back;"
        f" {options.width}x{options.height}, {options.frames} frames, {options.threads} threads,"
        f" load {os.getloadavg()[0]:.1f}; {renderer()}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
