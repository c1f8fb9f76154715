"""The time from the objects of a scene to its first picture, with an empty kernel cache.

Each case in a fresh process, 640x480, one sample, the least of several runs: by the clock, and the
time that the cores worked, which other work on the machine changes less. ``objects`` is the part
until the scene is handed to ``Scene``. The imports of NumPy, llvmlite and the devices are not
counted. Cases with many parts are drawn small where the frame itself would take seconds.

    python benchmarks/bench_cold.py [--cases kinds different] [--runs 3]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from typing import Any

# Each: the kind of scene, the count, the goals in seconds by the clock (objects, first picture).
CASES: dict[str, tuple[str, int, float | None, float | None]] = {
    "one ball": ("equal", 1, None, None),
    "10,000 parts of 3 kinds": ("parts", 10_000, 0.5, 2.0),
    "10,000 parts, default look": ("look", 10_000, None, None),
    "10,000 moving parts": ("moving", 10_000, None, None),
    "the catalogue, 53 kinds": ("catalogue", 0, None, 1.5),
    "200 different parts": ("different", 200, None, 6.0),
    "400 equal parts without acceleration": ("equal", 400, None, 5.0),
    "100,000 parts of 3 kinds": ("parts", 100_000, None, 6.0),
}

MEASURED = """
import json, random, sys
from time import perf_counter, process_time
import numpy, llvmlite.binding, distal.runtime.executor, distal.devices.cpu
import distal
from distal import Box, Camera, Capsule, Cone, Cylinder, DistantLight, Octahedron
from distal import Plane, Scene, Sphere, Torus, time, union

kind, count = sys.argv[1], int(sys.argv[2])
random.seed(1)


def many(now):
    side = round(count**0.5)
    step = 4.0 / side
    for i in range(count):
        a, turn = random.uniform(0.25, 0.4) * step, random.uniform(0.0, 3.0)
        height = 0.5 * step
        if now is not None:
            height = height + 0.3 * step * numpy.sin(2.0 * now + turn)
            turn = now + turn
        part = (Sphere(a), Box(a, 1.4 * a, a), Torus(a, 0.4 * a).rotate(x=turn))[i % 3]
        place = ((i % side + 0.5) * step - 2.0, height, (i // side + 0.5) * step - 2.0)
        yield part.translate(place).paint([random.uniform(0.1, 0.9) for _ in range(3)])


def one(i):
    if kind == "equal":
        shape = Sphere(0.3 + 0.001 * i)
    else:
        made = (Sphere(0.3), Box(0.5), Torus(0.3, 0.1), Cylinder(0.2, 0.6), Cone(0.3, 0.6),
                Capsule(0.2, 0.5), Octahedron(0.4))
        shape = made[i % 7].rotate(x=0.1 * i) if i % 2 else made[i % 7]
        shape = shape.round(0.01 * (i % 5 + 1)) if i % 3 == 0 else shape
    place = [random.uniform(-5, 5) for _ in range(3)]
    return shape.translate(*place).paint(tuple(random.random() for _ in range(3)))


clock, cores = perf_counter(), process_time()
size = (640, 480)
if kind == "catalogue":
    scene = distal.load("example:catalogue")
    objects = perf_counter() - clock, process_time() - cores
elif kind in ("parts", "moving", "look"):
    whole = union(many(time if kind == "moving" else None))
    objects = perf_counter() - clock, process_time() - cores
    lights = {} if kind == "look" else {"lights": DistantLight((1, 2, 1.5), angle=0.01)}
    scene = Scene(whole | Plane(), camera=Camera((3, 3, 4), target=(0, 0, 0)), **lights)
else:
    whole = one(0)
    for i in range(1, count):
        whole = whole | one(i)
    objects = perf_counter() - clock, process_time() - cores
    scene = Scene(whole, acceleration=kind == "different")
    size = (64, 48)
picture = scene.render(size=size, samples=1)
assert not picture.stats["cache_hit"]
cold = perf_counter() - clock, process_time() - cores
print(json.dumps({"objects": objects, "cold": cold}))
"""


def measured(kind: str, count: int) -> dict[str, Any]:
    """Return seconds by the clock and of the cores, in a fresh process."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
        environment.pop("DISTAL_VERIFY", None)
        command = [sys.executable, "-c", MEASURED, kind, str(count)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="+", default=[], help="words of the cases to measure")
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args()
    print(f"{'':38}{'objects: clock':>15}{'cores':>7}{'goal':>6}", end="")
    print(f"{'picture: clock':>17}{'cores':>7}{'goal':>6}")
    for name, (kind, count, *goals) in CASES.items():
        if asked.cases and not any(word in name for word in asked.cases):
            continue
        runs = [measured(kind, count) for _ in range(asked.runs)]
        row = f"{name:38}"
        for column, wide, goal in zip(("objects", "cold"), (15, 17), goals, strict=True):
            clock, cores = (min(run[column][i] for run in runs) for i in (0, 1))
            wanted = "" if goal is None else f"{goal:.1f}"
            row += f"{clock:{wide}.2f}{cores:7.2f}{wanted:>6}"
        print(row, flush=True)


if __name__ == "__main__":
    main()
