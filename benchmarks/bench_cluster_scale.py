"""How many workers a cluster can have until its scheduler, or the machine that encodes, is busy.

    python benchmarks/bench_cluster_scale.py [--tasks 400] [--frames 48]

Measured here, in processor seconds: what a task costs the scheduler and the client; what a frame
costs the client, for films of two sizes, of which the encoder is a part; what a pixel costs a
worker. The table follows by division: a worker is busy for so long with a task, and in this time
the scheduler, or the client, serves so many others.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np
import psutil
from bench_cluster import empty

import distal
from distal.cluster import WorkerPool, connected
from distal.cluster.sizes import TASK_S, least_seconds
from distal.video import video

SMALL, LARGE = (640, 480), (1280, 960)
FRAME_4K, TILE = 3840 * 2160, 128 * 128
# Scenes and modes whose pixels are measured: one that is fast, one that is usual, one that is slow.
SCENES: Final = (("raymarcher", "direct", None), ("castle", "direct", None), ("castle", "path", 64))


@contextmanager
def cluster() -> Iterator[tuple[WorkerPool, psutil.Process]]:
    """A scheduler and a worker as processes of their own; give the scheduler's process too."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scheduler.json"
        common = ["--scheduler-file", str(file), "--host", "127.0.0.1"]
        common += ["--dashboard-address", "127.0.0.1:0"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        python = [sys.executable, "-m", "dask"]
        started = [subprocess.Popen([*python, "scheduler", "--port", "0", *common], **quiet)]
        try:
            while not file.exists():
                time.sleep(0.1)
            time.sleep(0.5)
            command = [*python, "worker", "--nthreads", "1", *common]
            started.append(subprocess.Popen(command, **quiet))
            with connected(str(file)) as pool:
                pool.client.wait_for_workers(1)
                yield pool, psutil.Process(started[0].pid)
        finally:
            for process in reversed(started):
                process.terminate()
                process.wait()


def busy_s(process: psutil.Process) -> float:
    """Return the processor seconds of a process so far."""
    times = process.cpu_times()
    return float(times.user + times.system)


def costs(process: psutil.Process, work: Callable[[], Any], count: int) -> tuple[float, float]:
    """Return the processor seconds of a process, and of this one, for each of some tasks."""
    begin, own = busy_s(process), time.process_time()
    work()
    return (busy_s(process) - begin) / count, (time.process_time() - own) / count


def film(pool: WorkerPool, size: tuple[int, int], frames: int) -> None:
    """Render a film of almost empty frames."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        video(empty, path, duration=frames / 24, fps=24, size=size, cluster=pool)


def of_a_pixel(name: str, mode: str, samples: int | None) -> float:
    """Return the processor seconds of a pixel of a scene."""
    scene = distal.load(f"example:{name}")
    size = (480, 270) if samples is None else (160, 90)
    given: dict[str, Any] = {"samples": samples, "threads": 1, "time": 1.0}
    if mode == "path":
        given["mode"] = mode
    scene.render((48, 27), **given)
    begin = time.process_time()
    scene.render(size, **given)
    return (time.process_time() - begin) / (size[0] * size[1])


def many(number: float) -> str:
    """Return a number of workers with two digits."""
    digits = max(0, len(str(int(number))) - 2)
    return f"{round(number, -digits):,.0f}"


def main() -> None:
    """Print what was measured, and the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--tasks", type=int, default=400)
    parser.add_argument("--frames", type=int, default=48)
    given = parser.parse_args()
    with cluster() as (pool, scheduler):
        nothing = lambda: pool.client.gather(  # noqa: E731
            pool.client.map(abs, range(given.tasks), pure=False)
        )
        nothing()
        scheduler_s, client_s = costs(scheduler, nothing, given.tasks)
        sent = pool.client.submit(np.zeros, 2**24, np.uint8, pure=False)
        _, byte_s = costs(scheduler, sent.result, 2**24)
        of_frame = {}
        for size in (SMALL, LARGE):
            film(pool, size, 8)
            _, of_frame[size] = costs(
                scheduler, lambda s=size: film(pool, s, given.frames), given.frames
            )
    pixels = {size: size[0] * size[1] for size in of_frame}
    of_pixel = (of_frame[LARGE] - of_frame[SMALL]) / (pixels[LARGE] - pixels[SMALL])
    frame_4k = of_frame[SMALL] + of_pixel * (FRAME_4K - pixels[SMALL])
    print(
        f"a task: scheduler {1e3 * scheduler_s:.2f} ms, client {1e3 * client_s:.2f} ms; "
        f"the client receives {1e-9 / max(byte_s, 1e-12):.1f} GB/s\n"
        f"a frame of a film at the client: 640x480 {1e3 * of_frame[SMALL]:.1f} ms, 3840x2160 "
        f"{1e3 * frame_4k:.0f} ms (4 bytes a pixel: {4e-6 * FRAME_4K:.0f} MB)\n"
    )
    print(
        "| task | seconds of a worker | bytes back | workers until the scheduler is busy "
        "| until the client is busy |\n|---|---|---|---|---|"
    )
    for name, mode, samples in SCENES:
        pixel_s = of_a_pixel(name, mode, samples)
        what = f"{name}, {mode}"
        for task, count, back, of_client in (
            ("4K frame of a film", FRAME_4K, 4, frame_4k),
            ("128x128 tile", TILE, 16, client_s + 16 * TILE * byte_s),
        ):
            seconds = count * pixel_s
            cells = (
                f"{what}: {task}",
                f"{seconds:.3g}",
                f"{back * count:,}",
                many(seconds / scheduler_s),
                many(seconds / of_client),
            )
            print(f"| {' | '.join(cells)} |")
    print(
        f"\nA task is assumed to cost {1e3 * TASK_S:g} ms. The shortest part of a picture is then:"
    )
    for slots in (2, 16, 64, 256, 1024):
        print(f"  {slots} workers: {1e3 * least_seconds(slots):.0f} ms")


if __name__ == "__main__":
    main()
