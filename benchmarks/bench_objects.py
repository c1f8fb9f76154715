"""What objects cost: a scene of objects against a shader that calls the library by itself.

``example:raymarcher_objects`` and ``raymarcher_library.py`` here are one picture. One run,
interleaved frame by frame, two threads, 640x480, every frame at another time; the last pictures are
compared, so that no cached frame is measured. Prints a table: wall time, and the time that the
cores worked, which other work on the machine does not change much.

    python benchmarks/bench_objects.py [--frames 40]
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path
from typing import Any

import numpy as np

import distal

SIZE = (640, 480)
THREADS = 2
FRAME_STEP_S = 1.0 / 60.0
LIBRARY = Path(__file__).with_name("raymarcher_library.py")
PICTURES = {"raymarcher_library": str(LIBRARY), "raymarcher_objects": "example:raymarcher_objects"}


def one_frame(image: Any, seconds: float) -> tuple[float, float]:
    """Milliseconds of a frame, called as a person calls it: by the clock, and of the cores."""
    clock, cores = time.perf_counter(), time.process_time()
    image.render(size=SIZE, time=seconds, threads=THREADS)
    return (time.perf_counter() - clock) * 1e3, (time.process_time() - cores) * 1e3


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--frames", type=int, default=40)
    options = parser.parse_args()
    images = [distal.load(place) for place in PICTURES.values()]
    times: list[list[tuple[float, float]]] = [[] for _ in images]
    for image in images:
        one_frame(image, 0.0)
    for frame in range(options.frames):
        for image, found in zip(images, times, strict=True):
            found.append(one_frame(image, frame * FRAME_STEP_S))
    seconds = options.frames * FRAME_STEP_S
    pictures = [image.render(size=SIZE, time=seconds).array for image in images]
    rows = [
        (statistics.median(w for w, _ in t), min(t)[0], statistics.median(c for _, c in t))
        for t in times
    ]
    print(f"{'640x480, 2 threads':24} median ms  fastest  cores ms")
    for name, row in zip(PICTURES, rows, strict=True):
        print(f"{name:24} {row[0]:9.2f} {row[1]:8.2f} {row[2]:9.2f}")
    ratios = [objects / library for library, objects in zip(*rows, strict=True)]
    print(f"{'objects / library':24} {ratios[0]:8.2f}x {ratios[1]:7.2f}x {ratios[2]:8.2f}x")
    print(f"the pictures differ by at most {np.abs(pictures[0] - pictures[1]).max() * 255:.4f}/255")


if __name__ == "__main__":
    main()
