"""Render a film on two workers; print how objects and memory of this process grow.

    python -m tests.cluster.long_film 2000

Also those of the scheduler, which is in this process with "local". A process of its own, because
what runs tests keeps things as well.
"""

from __future__ import annotations

import gc
import json
import sys
import tempfile
from pathlib import Path

import psutil

from distal.cluster import connected
from distal.lang import Frame, image, vec3
from distal.video import video

SIZE = (32, 32)


@image
def plain(frame: Frame) -> vec3:
    """Another color in each frame."""
    return vec3(frame.coord.x / 32.0, frame.coord.y / 32.0, frame.time * 0.01)


def main() -> None:
    """Print the figures as JSON."""
    count = int(sys.argv[1])
    process, seen, first, last = psutil.Process(), {}, max(150, count // 4), count - 40

    def progress(done: int, total: int, what: str) -> None:
        if done in (first, last):
            gc.collect()
            seen[done] = (len(gc.get_objects()), process.memory_info().rss)

    with tempfile.TemporaryDirectory() as folder, connected("local:2") as pool:
        path = Path(folder) / "film.mp4"
        film = {"duration": count / 20, "fps": 20, "size": SIZE, "progress": progress}
        made = video(plain, path, cluster=pool, **film)
        kept = len(pool.client.futures) + len(pool.watch._tasks) + len(pool.watch._tried)
    objects, memory = (b - a for a, b in zip(seen[first], seen[last], strict=True))
    found = {"rendered": made.rendered, "frames": last - first, "kept": kept}
    print(json.dumps({**found, "objects": objects, "bytes": memory}))


if __name__ == "__main__":
    main()
