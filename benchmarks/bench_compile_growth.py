"""How compile time grows with the number of parts: seconds of each stage, and the exponent.

For equal parts (spheres of several sizes and colors) and different parts, without acceleration, so
that the code of every part is compiled. CPU seconds of fresh processes with an empty kernel cache.

    python benchmarks/bench_compile_growth.py [--counts 25 50 100 200 400] [--accelerated]
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from typing import Any

COUNTS = (25, 50, 100, 200, 400)
KINDS = ("equal", "different")
STAGES = ("objects", "lowering", "passes", "text", "llvm", "total")

MEASURED = """
import json, random, sys
from time import process_time
import numpy, llvmlite.binding, distal.runtime.executor, distal.devices.cpu as cpu
import distal.devices.object_files as object_files
import distal.compiler.driver as driver
import distal
from distal import Box, Capsule, Cone, Cylinder, Octahedron, Scene, Sphere, Torus

kind, count, accelerated = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "True"
random.seed(1)
seconds = dict.fromkeys(("passes", "text", "llvm"), 0.0)


def timed(stage, function):
    def call(*args, **named):
        begin = process_time()
        try:
            return function(*args, **named)
        finally:
            seconds[stage] += process_time() - begin
    return call


driver.run_passes = timed("passes", driver.run_passes)
cpu.emit_modules = timed("text", cpu.emit_modules)
object_files.compile_objects = timed("llvm", object_files.compile_objects)


def part(i):
    if kind == "equal":
        shape = Sphere(0.3 + 0.001 * i)
    else:
        made = (Sphere(0.3), Box(0.5), Torus(0.3, 0.1), Cylinder(0.2, 0.6), Cone(0.3, 0.6),
                Capsule(0.2, 0.5), Octahedron(0.4))
        shape = made[i % 7].rotate(x=0.1 * i) if i % 2 else made[i % 7]
        shape = shape.round(0.01 * (i % 5 + 1)) if i % 3 == 0 else shape
    place = [random.uniform(-5, 5) for _ in range(3)]
    return shape.translate(*place).paint(tuple(random.random() for _ in range(3)))


begin = process_time()
parts = [part(i) for i in range(count)]
shape = parts[0]
for other in parts[1:]:
    shape = shape | other
scene = Scene(shape, acceleration=accelerated)
made = process_time()
picture = scene.render(size=(64, 48), samples=1, threads=1)
assert not picture.stats["cache_hit"]
whole = process_time() - made
seconds["lowering"] = whole - sum(seconds.values())
print(json.dumps({**seconds, "objects": made - begin, "total": process_time() - begin}))
"""


def measured(kind: str, count: int, *, accelerated: bool) -> dict[str, float]:
    """CPU seconds of each stage, in a fresh process."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
        environment.pop("DISTAL_VERIFY", None)
        words = [sys.executable, "-c", MEASURED, kind, str(count), str(accelerated)]
        done = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def exponent(counts: list[int], seconds: list[float]) -> float:
    """The slope of the line through the logarithms: time grows as the count to this power."""
    xs = [math.log(n) for n in counts]
    ys = [math.log(max(s, 1e-6)) for s in seconds]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    covariance = sum((a - x) * (b - y) for a, b in zip(xs, ys, strict=True))
    return covariance / sum((a - x) ** 2 for a in xs)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS)
    parser.add_argument("--accelerated", action="store_true")
    asked = parser.parse_args()
    for kind in KINDS:
        rows = [measured(kind, n, accelerated=asked.accelerated) for n in asked.counts]
        print(f"\n{kind + ' parts':16}" + "".join(f"{stage:>10}" for stage in STAGES))
        for count, row in zip(asked.counts, rows, strict=True):
            print(f"{count:<16}" + "".join(f"{row[stage]:10.2f}" for stage in STAGES))
        if len(asked.counts) > 1:
            powers = (exponent(asked.counts, [row[stage] for row in rows]) for stage in STAGES)
            print(f"{'exponent':16}" + "".join(f"{power:10.2f}" for power in powers))


if __name__ == "__main__":
    main()
