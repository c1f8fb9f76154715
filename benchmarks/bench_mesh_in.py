"""A mesh of 291,840 triangles onto a grid of about 64^3: distal, and libigl if it is installed.

The mesh is a bent torus with ripples, made here; both get the same arrays and the same nodes. Times
are CPU seconds of the process (all threads), interleaved, because the machine may be shared:

    pip install libigl    # optional; never a dependency
    python benchmarks/bench_mesh_in.py [--runs 5] [--around 512] [--across 285]
"""

from __future__ import annotations

import argparse
import importlib
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.polygons.distances import Distances, distances
from distal.polygons.triangles import SourceTriangles


def rippled_torus(around: int, across: int) -> SourceTriangles:
    """Return a closed mesh of ``2 * around * across`` triangles."""
    u = 2.0 * np.pi * np.arange(around)[:, None] / around
    v = 2.0 * np.pi * np.arange(across)[None] / across
    tube = 0.45 + 0.03 * np.sin(9.0 * u) * np.cos(5.0 * v)
    out = 1.0 + tube * np.cos(v)
    height = tube * np.sin(v) + 0.4 * np.sin(2.0 * u)
    points = np.stack([out * np.cos(u), height, out * np.sin(u)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    steps = ((0, 0), (0, 1), (1, 1), (1, 0))
    a, b, c, d = (((i + s) % around * across + (j + t) % across).reshape(-1) for s, t in steps)
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return SourceTriangles(points, triangles.astype(np.int64))


def nodes_of(found: Distances) -> NDArray[np.float64]:
    """Return the places of the nodes, (n, 3)."""
    z, y, x = np.indices(found.values.shape)
    return (np.stack([x, y, z], axis=-1) * found.spacing + found.low).reshape(-1, 3)


def cpu_seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the CPU seconds of a call, and its result."""
    begin = time.process_time()
    result = work()
    return time.process_time() - begin, result


def main() -> None:
    """Measure, and print the medians and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--around", type=int, default=512)
    parser.add_argument("--across", type=int, default=285)
    asked = parser.parse_args()
    mesh = rippled_torus(asked.around, asked.across)
    first, found = cpu_seconds(lambda: distances(mesh))
    sizes = " x ".join(map(str, found.values.shape[::-1]))
    print(f"{len(mesh.triangles):,} triangles, {sizes} nodes; first call {first:.3f} CPU s")
    try:
        igl = importlib.import_module("igl")
    except ImportError:
        igl = None
        print("libigl is not installed: only distal is measured")
    nodes, signs = nodes_of(found), {}
    ours, theirs = [], {"pseudonormal": [], "fast winding number": []}
    for _ in range(asked.runs):
        ours.append(cpu_seconds(lambda: distances(mesh))[0])
        if igl is None:
            continue
        kinds = (
            igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL,
            igl.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER,
        )
        for (name, times), kind in zip(theirs.items(), kinds, strict=True):
            seconds, result = cpu_seconds(
                lambda kind=kind: igl.signed_distance(nodes, mesh.points, mesh.triangles, kind)
            )
            times.append(seconds)
            signs[name] = result[0]
    print(f"distal: {statistics.median(ours):.3f} CPU s ({min(ours):.3f} to {max(ours):.3f})")
    for name, times in theirs.items():
        if times:
            middle = statistics.median(times)
            away = np.abs(signs[name].reshape(-1) - found.values.reshape(-1)) / found.spacing
            near = np.abs(found.values.reshape(-1)) < found.spacing
            print(
                f"libigl, {name}: {middle:.3f} CPU s; distal takes "
                f"{statistics.median(ours) / middle:.2f} of it; values differ by "
                f"{away[near].max():.2g} spacings near the surface, {away.max():.2g} elsewhere"
            )


if __name__ == "__main__":
    main()
