"""How the cost of a smooth union grows with its members: grid, first picture, frame, memory.

Balls of many colors fill a cube, at equal density whatever their number is, above a floor. One sun
with shadows, then the default lights (``look``), 640x480, one sample, two threads. Each count is
measured in a fresh process with an empty kernel cache. Times are those of the processor, so that
other programs matter less.

    python benchmarks/bench_smooth_union.py [--counts 50 200 1000] [--linear] [--plot growth.png]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from bench_parts import exponent, plot

COUNTS = (50, 200, 1000, 5000)
COLORS = {"grid": "#2a9d8f", "cold": "#e76f51", "frame": "#264653", "megabytes": "#b08900"}
COLUMNS = ("grid", "cold", "frame", "look", "wall", "memory", "megabytes", "longest", "mean")

MEASURED = """
import json, resource, sys
from time import perf_counter, process_time
import numpy as np, llvmlite.binding, distal.runtime.executor, distal.devices.cpu
from distal import Camera, DistantLight, Plane, Scene, Sphere, union
from distal.scene.lowering.smooth.cells import celled

count, accelerated = int(sys.argv[1]), sys.argv[2] == "1"
rng = np.random.default_rng(1)
step = count ** (-1 / 3)
balls = [
    Sphere(float(rng.uniform(0.45, 0.78) * step))
    .translate(*rng.uniform(-1, 1, 3))
    .paint(tuple(rng.uniform(0.1, 0.9, 3)))
    for _ in range(count)
]
shape = union(balls, smooth=0.15 * step)
begin = process_time()
found = celled(shape.node).grids if accelerated else ()
grid = process_time() - begin
scene = Scene(
    shape | Plane(y=-1.3),
    lights=DistantLight((1, 2, 1.5), angle=0.01),
    camera=Camera((2, 2, 4), target=(0, 0, 0)),
    acceleration=accelerated,
)
scene.render(size=(640, 480), samples=1)
cold = process_time() - begin
frames, walls = [], []
for _ in range(7):
    start, wall = process_time(), perf_counter()
    scene.render(size=(640, 480), samples=1)
    frames.append(process_time() - start)
    walls.append(perf_counter() - wall)
look = Scene(shape | Plane(y=-1.3), camera=scene.camera, acceleration=accelerated)
looks = []
for _ in range(5):
    start = process_time()
    look.render(size=(640, 480), samples=1)
    looks.append(process_time() - start)
made = found[0].grid if found else None
print(json.dumps({
    "grid": grid, "cold": cold, "frame": min(frames), "look": min(looks), "wall": min(walls),
    "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    "megabytes": made.bytes / 1e6 if made else 0.0,
    "longest": made.longest if made else count, "mean": made.mean if made else count,
}))
"""


def measured(count: int, accelerated: bool) -> dict[str, float]:
    """Return seconds, megabytes and the lengths of the lists for a number of balls."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
        command = [sys.executable, "-c", MEASURED, str(count), str(int(accelerated))]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=list(COUNTS))
    parser.add_argument("--linear", action="store_true", help="measure without lists for cells")
    parser.add_argument("--plot", type=Path, help="write a log-log picture of the growth")
    options = parser.parse_args()
    rows: dict[int, dict[str, float]] = {}
    print("balls".rjust(8), *(name.rjust(10) for name in COLUMNS))
    for count in options.counts:
        rows[count] = measured(count, not options.linear)
        print(f"{count:8d}", *(f"{rows[count][name]:10.3f}" for name in COLUMNS), flush=True)
    if len(rows) > 1:
        first, last = rows[options.counts[0]], rows[options.counts[-1]]
        print(f"frame of the last / of the first: {last['frame'] / first['frame']:.2f}")
        drawn = [name for name in COLORS if first[name] > 0.0]
        grown = ", ".join(f"{name} {exponent(rows, name):.2f}" for name in drawn)
        print(f"exponents between the last two: {grown}")
        if options.plot:
            plot(rows, options.plot, {name: COLORS[name] for name in drawn})


if __name__ == "__main__":
    main()
