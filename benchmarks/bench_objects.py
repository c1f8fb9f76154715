"""What objects cost: a scene of objects against a shader that calls the library by itself.

``example:raymarcher_objects`` and ``example:raymarcher_library`` are one picture. One run,
interleaved round by round, two threads, 640x480, every frame at another time; the last pictures are
compared, so that nothing remembered is measured. Prints a table.

    python benchmarks/bench_objects.py [--rounds 7] [--frames 5]
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import Any

import numpy as np

import distal

SIZE = (640, 480)
THREADS = 2
FRAME_STEP_S = 1.0 / 60.0


def milliseconds(image: Any, seconds: float) -> float:
    """How long one frame takes, called as a person calls it."""
    begin = time.perf_counter()
    image.render(size=SIZE, time=seconds, threads=THREADS)
    return (time.perf_counter() - begin) * 1e3


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--frames", type=int, default=5)
    options = parser.parse_args()
    objects = distal.load("example:raymarcher_objects")
    library = distal.load("example:raymarcher_library")
    runners = {"library, called by an @image": library, "objects, scene.render()": objects}
    for image in runners.values():
        milliseconds(image, 0.0)
    times: dict[str, list[float]] = {name: [] for name in runners}
    frame = 0
    for _ in range(options.rounds):
        start = frame
        for name, image in runners.items():
            for frame in range(start, start + options.frames):
                times[name].append(milliseconds(image, frame * FRAME_STEP_S))
        frame += 1
    pictures = {
        name: image.render(size=SIZE, time=frame * FRAME_STEP_S).array
        for name, image in runners.items()
    }
    first = next(iter(runners))
    base, least = statistics.median(times[first]), min(times[first])
    print(f"{'640x480, 2 threads':32}  median ms  fastest  of the first (fastest)  differs")
    for name in runners:
        median, fastest = statistics.median(times[name]), min(times[name])
        off = np.abs(pictures[name] - pictures[first]).max() * 255
        ratios = f"{median / base:12.2f}x {fastest / least:8.2f}x"
        print(f"{name:32} {median:10.2f} {fastest:8.2f} {ratios} {off:9.4f}")


if __name__ == "__main__":
    main()
