"""Films on two processes of one thread beside one process of two threads; what a task costs.

    python benchmarks/bench_cluster.py [--frames 96] [--rounds 5] [--films empty,raymarcher,castle]

Medians of rounds, interleaved, by the clock, and processor time, which other work on the machine
changes less. The cost of a frame is the time of a film of almost empty frames, beside the local
one. The limit of the scheduler is the time of tasks that do nothing.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import psutil

import distal
from distal.cluster import WorkerPool, connected
from distal.lang import Frame, image, vec3
from distal.video import video

SIZE: Final = (640, 480)


@image
def empty(frame: Frame) -> vec3:
    """Almost nothing to compute."""
    return vec3(frame.time, 0.5, 0.5)


def busy_s(workers: Sequence[psutil.Process]) -> tuple[float, float]:
    """Return the processor seconds so far of this process, and of the workers."""
    times = [process.cpu_times() for process in workers]
    return time.process_time(), float(sum(t.user + t.system for t in times))


def seconds(obj: Any, path: Path, frames: int, pool: WorkerPool | None) -> float:
    """Return how long a film takes."""
    begin = time.perf_counter()
    threads = 2 if pool is None else None
    video(
        obj,
        path,
        duration=frames / 24,
        fps=24,
        size=SIZE,
        fresh=True,
        threads=threads,
        cluster=pool,
    )
    return time.perf_counter() - begin


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=96)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--films", default="empty,raymarcher,castle")
    given = parser.parse_args()
    names = given.films.split(",")
    films = {n: empty if n == "empty" else distal.load(f"example:{n}") for n in names}
    with tempfile.TemporaryDirectory() as folder, connected("local:2") as pool:
        path = Path(folder) / "film.mp4"
        workers = [psutil.Process(p) for p in pool.client.run(os.getpid).values()]
        for name, obj in films.items():
            seconds(obj, path, 24, None), seconds(obj, path, 24, pool)
            times = [
                (seconds(obj, path, given.frames, None), seconds(obj, path, given.frames, pool))
                for _ in range(given.rounds)
            ]
            alone, together = (statistics.median(column) for column in zip(*times, strict=True))
            cost = 1000.0 * (together - alone) / given.frames
            print(
                f"{name}: local {alone:.2f} s, cluster {together:.2f} s, "
                f"{together / alone:.2f} of it; {cost:.1f} ms more a frame"
            )
            spent = [busy_s(workers)]
            for used in (None, pool):
                seconds(obj, path, given.frames, used)
                spent.append(busy_s(workers))
            (a, _), (b, c), (d, e) = spent
            local, client, others = (1000.0 * x / given.frames for x in (b - a, d - b, e - c))
            print(
                f"  processor time of a frame: local {local:.1f} ms; cluster: client and scheduler "
                f"{client:.1f} ms, workers {others:.1f} ms"
            )
        begin = time.perf_counter()
        tasks = pool.client.map(abs, range(2000), pure=False)
        pool.client.gather(tasks)
        print(f"a task that does nothing: {(time.perf_counter() - begin) / 2000 * 1000.0:.2f} ms")


if __name__ == "__main__":
    main()
