"""Meshes beside other programs: Fidget and fogleman/sdf, if they are installed by hand.

Fidget divides the cube from -1 to 1 seven times, so its cells are 1/64 long; distal meshes the
same ``.vm`` files at this spacing. distal also measures its errors, which the others do not: its
time is printed with that and without, for equal cells and for cells that are joined as Fidget does
it. fogleman/sdf gets the CSG scene as its own code. Times are
CPU seconds of a process, interleaved.

    cargo build --release --manifest-path benchmarks/rivals/fidget_mesh/Cargo.toml
    python benchmarks/bench_mesh_rivals.py --models FOLDER --fidget PROGRAM --fogleman PYTHON
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from distal import Shape
from distal.mesh import extract
from distal.mesh.bricks import Slopes
from distal.mesh.dividing import divided
from distal.mesh.extract import Extent, extracted
from distal.mesh.kernels import FieldKernels

sys.path.insert(0, str(Path(__file__).resolve().parent))
from bench_meshes import public_scene

DEPTH: Final = 7
# Joined cells are divided again where they are farther from the surface than this: Fidget's error.
TOLERANCE: Final = 0.005
# The error of equal cells at fogleman/sdf's step.
ERROR_OF_EQUAL: Final = 0.0006
# The largest gradient of each model at 200,000 places, near the surface, rounded up.
SLOPES: Final = {"csg": 1.0, "gyroid": 52.0, "bear": 13.0, "colonnade": 32.0}
_FOGLEMAN: Final = """
import sys, time
from sdf import *
f = sphere(1) & box(1.5)
c = cylinder(0.5)
f -= c.orient(X) | c.orient(Y) | c.orient(Z)
for line in sys.stdin:
    wall, cpu = time.perf_counter(), time.process_time()
    points = f.generate(verbose=False, workers=2, **eval(line))
    print(time.process_time() - cpu, time.perf_counter() - wall, len(points) // 3, flush=True)
"""


class Rival:
    """A program that makes a mesh for each line that it gets, and answers with its times."""

    def __init__(self, command: list[str]) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(self, line: str) -> list[float]:
        """Return the numbers of its answer."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return [float(number) for number in self.process.stdout.readline().split()]


class Measuring:
    """Counts the processor's seconds that distal takes to measure its errors."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._measured = extract.measured
        extract.measured = self

    def __call__(self, *given: Any) -> Any:
        """Measure, and add the time."""
        begin = time.process_time()
        found = self._measured(*given)
        self.seconds += time.process_time() - begin
        return found


MEASURING = Measuring()


def timed(call: Callable[[], Any]) -> tuple[float, float, float]:
    """The processor's seconds, the clock's, and the processor's without measuring."""
    cpu, wall, MEASURING.seconds = time.process_time(), time.perf_counter(), 0.0
    call()
    whole = time.process_time() - cpu
    return whole, time.perf_counter() - wall, whole - MEASURING.seconds


def beside_fidget(program: str, models: Path, runs: int) -> None:
    """Print CPU seconds of Fidget's two evaluators and of distal."""
    cube = Extent(np.full(3, -1.0), np.full(3, 1.0), Slopes(1.0, 1.0))
    for name, slope in SLOPES.items():
        rival = Rival([program, str(models / f"{name}.vm"), str(DEPTH)])
        corners = ((-1.0,) * 3, (1.0,) * 3)
        shape = Shape.from_vm(models / f"{name}.vm", slope=slope, bounds=corners)
        kernels = FieldKernels(shape.node, {}, 0.0)
        extent = Extent(cube.low, cube.high, Slopes(slope, slope))

        def ours(kernels: FieldKernels = kernels, extent: Extent = extent) -> Any:
            return extracted(kernels, extent, 2.0**-6, 1.0, 10**6, lambda share: None)

        def joined(kernels: FieldKernels = kernels, extent: Extent = extent) -> Any:
            watch = lambda share: None  # noqa: E731
            found = extracted(kernels, extent, 2.0**-6, 1.0, 10**6, watch, TOLERANCE)
            return divided(kernels, extent, found, TOLERANCE, watch, joined_only=True)

        made, fewer = ours(), joined()
        keys = ("vm", "jit", "distal", "bare", "joined", "bare joined")
        times: dict[str, list[float]] = {key: [] for key in keys}
        for _ in range(runs):
            for evaluator in ("vm", "jit"):
                times[evaluator].append(rival.run(evaluator)[0])
            whole, _, bare = timed(ours)
            times["distal"].append(whole)
            times["bare"].append(bare)
            whole, _, bare = timed(joined)
            times["joined"].append(whole)
            times["bare joined"].append(bare)
        middle = {key: statistics.median(found) for key, found in times.items()}
        faster = min(middle["vm"], middle["jit"])
        print(
            f"{name}: Fidget {middle['vm']:.3f} (VM), {middle['jit']:.3f} (JIT), "
            f"{rival.run('vm')[1]:,.0f} triangles; distal {middle['distal']:.3f}, "
            f"{len(made.made.triangles):,} triangles, error {made.accuracy.largest:.2g}: "
            f"{middle['distal'] / faster:.2f} of its CPU, {middle['bare'] / faster:.2f} without "
            f"measuring; joined {len(fewer.made.triangles):,} triangles, error "
            f"{fewer.accuracy.largest:.2g}, {middle['joined'] / faster:.2f} of its CPU, "
            f"{middle['bare joined'] / faster:.2f} without measuring",
            flush=True,
        )


def beside_fogleman(python: str, runs: int) -> None:
    """Print times of fogleman/sdf and of distal: the same step, and its own largest error."""
    rival = Rival([python, "-c", _FOGLEMAN])
    asked = "dict(samples=2**22)"
    shape = public_scene()
    low, high = (np.array(corner) for corner in shape.bounds())
    extent = Extent(low, high, Slopes(shape.slope, shape.divisor))
    kernels = FieldKernels(shape.node, {}, 0.0)
    step = float(((high - low).prod() / 2.0**22) ** (1.0 / 3.0))
    watch = lambda share: None  # noqa: E731

    def joined() -> Any:
        found = extracted(kernels, extent, step, ERROR_OF_EQUAL, 10**6, watch, ERROR_OF_EQUAL)
        return divided(kernels, extent, found, ERROR_OF_EQUAL, watch, joined_only=True)

    for label, call in (
        ("the same step, equal cells", lambda: extracted(kernels, extent, step, 1.0, 10**6, watch)),
        ("the same step, joined cells", joined),
        ("a tenth of its largest error", lambda: shape.mesh(tolerance=0.00057)),
        ("its largest error", lambda: shape.mesh(tolerance=0.0057)),
    ):
        made = call()
        rival.run(asked)
        theirs, ours = [], []
        for _ in range(runs):
            theirs.append(rival.run(asked))
            ours.append(timed(call))
        cpu, wall, count = (statistics.median(column) for column in zip(*theirs, strict=True))
        own = (statistics.median(column) for column in zip(*ours, strict=True))
        own_cpu, own_wall, bare = own
        triangles = len(getattr(made, "made", made).triangles)
        print(
            f"{label}: fogleman/sdf {cpu:.3f} CPU s, {wall:.3f} s, {count:,.0f} triangles; distal "
            f"{own_cpu:.3f} CPU s, {own_wall:.3f} s, {triangles:,} triangles: {own_cpu / cpu:.2f} "
            f"of its CPU, {own_wall / wall:.2f} of its time, {bare / cpu:.2f} of its CPU without "
            "measuring",
            flush=True,
        )


def main() -> None:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--models", type=Path)
    parser.add_argument("--fidget")
    parser.add_argument("--fogleman")
    asked = parser.parse_args()
    if asked.fidget:
        beside_fidget(asked.fidget, asked.models, asked.runs)
    if asked.fogleman:
        beside_fogleman(asked.fogleman, asked.runs)


if __name__ == "__main__":
    main()
