"""A mesh of 291,840 triangles on a fine grid: bricks near the surface against all samples.

Prints the numbers that each stores, what they take in memory (a texel has 16 bytes, a number of a
buffer 4) and in a page, and the CPU seconds of pictures, interleaved, because the machine may be
shared:

    python benchmarks/bench_bricks.py [--along 256] [--runs 3]
"""

from __future__ import annotations

import argparse
import statistics
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from benchmarks.bench_mesh_in import cpu_seconds, rippled_torus
from distal import Camera, Scene, Shape
from distal.export.page import page
from distal.export.page_options import PageOptions
from distal.lang.resources import Buffer, Texture3D
from distal.polygons.bricks import MOST_DENSE
from distal.polygons.distances import distances
from distal.polygons.sparse import brick_distances
from distal.scene.objects.volume_shapes import brick_node, grid_node
from distal.scene.viewing.viewable import viewable


def main() -> None:
    """Measure, and print the ratios."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--along", type=int, default=256)
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args()
    mesh = rippled_torus(512, 285)
    step = float(np.ptp(mesh.points, axis=0).max()) / asked.along
    brick_distances(rippled_torus(64, 32))  # compiles
    seconds, sparse = cpu_seconds(lambda: brick_distances(mesh, step))
    numbers = sparse.bricks.numbers.size
    print(f"bricks: {sparse.bricks.samples} samples, {sparse.bricks.stored:,} bricks stored,")
    print(f"  {numbers:,} numbers, {4 * numbers / 1e6:.1f} MB; computed in {seconds:.2f} CPU s")
    size = tuple(n * sparse.spacing for n in sparse.bricks.samples)
    node = brick_node(Buffer(sparse.bricks.numbers), sparse.bricks, size, 1.0, None)
    shapes = {"bricks": Shape._of(node)}
    if np.prod(sparse.bricks.samples) < 1.2 * MOST_DENSE:
        seconds, whole = cpu_seconds(lambda: distances(mesh, step))
        count = whole.values.size
        print(f"all: {count:,} numbers, {16 * count / 1e6:.1f} MB; computed in {seconds:.2f} CPU s")
        print(f"  bricks take {numbers / (4 * count):.3f} of the memory")
        size = tuple(n * whole.spacing for n in whole.values.shape[::-1])
        # The first samples of both are in one place.
        moved = 0.5 * (np.array(whole.values.shape[::-1]) - sparse.bricks.samples) * step
        volume = Texture3D(whole.values, wrap="clamp")
        shapes["all"] = Shape._of(grid_node(volume, size, 1.0, None)).translate(*moved.tolist())
    scenes = {
        name: Scene(shape, camera=Camera(position=(1.5, 1.8, 2.5), target=(0.0, 0.0, 0.0)))
        for name, shape in shapes.items()
    }
    for name, scene in scenes.items():
        text = page(viewable(scene), PageOptions(size=(480, 360), views=("color",)), b"").text
        print(f"page with {name}: {len(text) / 1e6:.1f} MB")
    times = {name: [] for name in scenes}
    pictures = {}
    for run in range(asked.runs + 1):
        for name, scene in scenes.items():
            seconds, pictures[name] = cpu_seconds(lambda s=scene: s.render(size=(480, 360)))
            if run:
                times[name].append(seconds)
    for name, values in times.items():
        print(f"picture with {name}: {statistics.median(values):.3f} CPU s")
    if "all" in pictures:
        away = np.abs(pictures["all"].array - pictures["bricks"].array)
        ratio = statistics.median(times["bricks"]) / statistics.median(times["all"])
        print(f"bricks take {ratio:.2f} of the time; pictures differ by {away.max():.3g} at most")


if __name__ == "__main__":
    main()
