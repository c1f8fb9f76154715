"""Render a film on two workers; print how objects and memory of this process grow.

    python -m tests.cluster.long_film 2000

Also those of the scheduler, which is in this process with "local". A process of its own, because
what runs tests keeps things as well. Counted in two windows of frames, while no task is on its way.
What a frame leaves grows in both. Heartbeats and connections of Dask add some hundred objects or
take them away, more on a busy machine, but no type of them grows by the number of frames, twice.
"""

from __future__ import annotations

import gc
import json
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import dask
import psutil
from distributed import Client

from distal.cluster import connected
from distal.lang import Frame, image, vec3
from distal.video import video
from tests.cluster.schedulers import wait

# The pixels of a frame have 77 kB, far more than memory varies by itself.
SIZE = (160, 120)
# Dask's logs, shortened, are full by the first of these frames; the two windows are equal.
LOGS = {"distributed.admin.low-level-log-length": 20, "distributed.admin.log-length": 20}
FIRST, LAST = 100, 20
SAMPLES = 5


@image
def plain(frame: Frame) -> vec3:
    """Another color in each frame."""
    return vec3(frame.coord.x / 32.0, frame.coord.y / 32.0, frame.time * 0.01)


def settled(client: Client) -> tuple[Counter[type], int]:
    """Return the objects of each type, and the bytes of this process, while nothing is on its way.

    Of some counts the smallest, without what a heartbeat adds for a moment.
    """
    known = client.cluster.scheduler.tasks
    wait(lambda: len(known) <= 1 and len(client.futures) <= 1, 200.0)  # the program
    objects = client.sync(counted)
    for _ in range(SAMPLES - 1):
        time.sleep(0.1)
        objects &= client.sync(counted)
    return objects, psutil.Process().memory_info().rss


async def counted() -> Counter[type]:
    """Return the number of objects of each type; to be called on Dask's own thread.

    On another one the list of all objects would refer to tuples that Dask's thread is filling,
    which ends in a SystemError of CPython there.
    """
    gc.collect()
    return Counter(map(type, gc.get_objects()))


def main() -> None:
    """Print the figures of the window in which less was added, as JSON."""
    count, seen = int(sys.argv[1]), []
    window = (count - FIRST - LAST) // 2
    with (
        dask.config.set(LOGS),
        tempfile.TemporaryDirectory() as folder,
        connected("local:2") as pool,
    ):

        def progress(done: int, total: int, what: str) -> None:
            if done in (FIRST, FIRST + window, FIRST + 2 * window):
                seen.append(settled(pool.client))

        path = Path(folder) / "film.mp4"
        film = {"duration": count / 20, "fps": 20, "size": SIZE, "progress": progress}
        made = video(plain, path, cluster=pool, **film)
        kept = len(pool.client.futures) + len(pool.watch._tasks) + len(pool.watch._tried)
    (a, x), (b, y), (c, z) = seen
    grown = {kind: min(b[kind] - a[kind], c[kind] - b[kind]) for kind in c}
    kind = max(grown, key=lambda kind: grown[kind])
    found = {"rendered": made.rendered, "window": window, "kept": kept}
    found |= {"objects": grown[kind], "of": kind.__qualname__, "bytes": min(y - x, z - y)}
    print(json.dumps(found))


if __name__ == "__main__":
    main()
