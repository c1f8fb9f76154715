"""Meshes: processor seconds of the stages, and of whole meshes within a tolerance.

The processor's time is measured, of all threads, because the machine may be shared. The first call
compiles the shape's kernels or loads them; it is not counted.

    python benchmarks/bench_meshes.py [--runs 5]
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from distal import Box, Cylinder, Sphere
from distal.mesh.bricks import Slopes
from distal.mesh.extract import Extent, extracted
from distal.mesh.kernels import FieldKernels


def public_scene() -> Any:
    """The scene that libraries of distance functions show on their first page."""
    bar = Cylinder(0.5, 4.0)
    bars = bar | bar.rotate(x=np.pi / 2.0) | bar.rotate(z=np.pi / 2.0)
    return (Sphere(1.0) & Box(1.5)) - bars


SHAPES = {
    "sphere": Sphere(1.0),
    "CSG": public_scene(),
    "turned box": Box(1.0, 0.7, 0.4).rotate(x=0.3, y=0.5, z=0.7),
    "rounded part": Box(2.0, 1.0, 0.5).round(0.1) - Cylinder(0.25, 2.0),
}


def seconds_of(call: Callable[[], Any], runs: int) -> tuple[float, Any]:
    """The median of the processor's seconds, and the result."""
    found = call()
    times = []
    for _ in range(runs):
        begin = time.process_time()
        call()
        times.append(time.process_time() - begin)
    return statistics.median(times), found


def main() -> None:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    shape = SHAPES["CSG"]
    low, high = (np.array(corner) for corner in shape.bounds())
    extent = Extent(low, high, Slopes(shape.slope, shape.divisor))
    kernels = FieldKernels(shape.node, {}, 0.0)
    for step in (0.05, 1.0 / 64.0, 0.0105):
        made = lambda step=step: extracted(  # noqa: E731
            kernels, extent, step, 0.05 * step, 100_000, lambda share: None
        )
        seconds, found = seconds_of(made, runs)
        print(
            f"CSG, cells of {step:.4f}: {seconds:.3f} s, {len(found.made.triangles):,} triangles, "
            f"error {found.accuracy.largest:.2g} / {found.accuracy.mean:.2g}"
        )
    for name, solid in SHAPES.items():
        size = max(b - a for a, b in zip(*solid.bounds(), strict=True))
        for share in (0.01, 0.001):
            tolerance = share * size
            seconds, mesh = seconds_of(lambda: solid.mesh(tolerance), min(runs, 3))  # noqa: B023
            report = mesh.report
            print(
                f"{name}, tolerance {tolerance:.4f}: {seconds:.3f} s, "
                f"{report['triangles']:,} triangles, error {report['error']['largest']:.2g}, "
                f"cells of {report['spacing']:.4f}"
            )


if __name__ == "__main__":
    main()
