"""The raymarcher's frame: our CPU device and our GLSL against the hand-written shader.

One run, interleaved round by round, two threads for everything, 640x480, every frame at another
time; the last pictures are compared, so that no cached frame is measured. Prints a table.

    python benchmarks/bench_raymarcher.py [--rounds 7] [--frames 10]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np

import distal
from benchmarks.rivals.llvmpipe import use_threads
from tests.egl import EglShader, context, renderer

SIZE = (640, 480)
THREADS = 2
FRAME_STEP_S = 1.0 / 60.0

Draw = Callable[[float], float]  # draws the frame at a time; milliseconds it took


def cpu_device() -> tuple[Draw, Callable[[float], np.ndarray]]:
    """The CPU device, called as a person calls it."""
    image = distal.load("example:raymarcher")

    def picture(seconds: float) -> np.ndarray:
        return image.render(size=SIZE, time=seconds, threads=THREADS).array

    def draw(seconds: float) -> float:
        begin = time.perf_counter()
        picture(seconds)
        return (time.perf_counter() - begin) * 1e3

    return draw, picture


def shader(fragment: str, vertex: str | None, names: dict[str, str]) -> tuple[Draw, Callable]:
    """A GLSL text on llvmpipe, drawn into 8 bits and finished."""
    if "llvmpipe" not in renderer():
        sys.exit(f"the driver is {renderer()}, not llvmpipe: the ratios would mean another thing")
    program = EglShader(fragment, vertex_text=vertex)
    target = context().simple_framebuffer(SIZE, components=4, dtype="f1")

    def uniforms(seconds: float) -> dict[str, object]:
        return {names["resolution"]: SIZE, names["time"]: seconds}

    def draw(seconds: float) -> float:
        begin = time.perf_counter()
        program.draw(target, uniforms(seconds))
        context().finish()
        return (time.perf_counter() - begin) * 1e3

    return draw, lambda seconds: program.render(SIZE, uniforms(seconds))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--frames", type=int, default=10)
    options = parser.parse_args()
    use_threads(THREADS)
    rival = (Path(__file__).parent / "rivals" / "raymarcher.frag").read_text("utf-8")
    emitted = distal.compile(distal.load("example:raymarcher"), target="glsl-es300")
    plain = {"resolution": "resolution", "time": "time"}
    prefixed = {"resolution": "u_resolution", "time": "u_time"}
    runners = {
        "hand-written GLSL, llvmpipe": shader(rival, None, prefixed),
        "emitted GLSL, llvmpipe": shader(emitted.text, emitted.vertex, plain),
        "CPU device, render()": cpu_device(),
    }
    for draw, _ in runners.values():
        for i in range(3):
            draw(i * FRAME_STEP_S)
    times: dict[str, list[float]] = {name: [] for name in runners}
    frame = 0
    for _ in range(options.rounds):
        start = frame
        for name, (draw, _) in runners.items():
            frame = start
            for _ in range(options.frames):
                frame += 1
                times[name].append(draw(frame * FRAME_STEP_S))
    seconds = frame * FRAME_STEP_S
    pictures = {name: picture(seconds)[..., :3] for name, (_, picture) in runners.items()}
    names = list(runners)
    base = statistics.median(times[names[0]])
    print(f"{'640x480, 2 threads':32}  median ms  fastest  speed-up   differs")
    for name in names:
        median = statistics.median(times[name])
        off = np.abs(np.clip(pictures[name], 0, 1) - np.clip(pictures[names[0]], 0, 1)).mean() * 255
        print(f"{name:32} {median:10.2f} {min(times[name]):8.2f} {base / median:8.2f}x {off:9.4f}")


if __name__ == "__main__":
    main()
