"""Joined shapes as pieces: frames and first pictures beside those of a union of the same shapes.

Scenes: a box less n balls and the box united with them, plates with holes, smooth unions of balls,
shells, intersections; and plates and smooth unions that a slider changes, which are also measured
without pieces. One sharp sun with shadows, 640x480, one sample. Each scene is measured in a
fresh process with an empty kernel cache: seconds of the processor for the first picture and for the
fastest of five more, how many pieces there are, and their size.

With ``--meshes`` the meshes of plates with holes and of the plate united with pegs, at a tolerance
of .02: the first, and the faster of two more of shapes made anew.

    python benchmarks/bench_pieces.py [--meshes] [NAME ...]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence

MEASURED = """
import json, sys
from time import process_time
import numpy
from distal import Box, Camera, Cylinder, DistantLight, Ellipsoid, Scene, Sphere, union
from distal.lang import slider
from distal.scene.checks.piece_report import pieces_of

kind, count = sys.argv[1], int(sys.argv[2])


def balls(radius, seed=0):
    rng = numpy.random.default_rng(seed)
    return [Sphere(radius).translate(*p) for p in rng.uniform(-1, 1, (count, 3)).tolist()]


def posts(size=0.3):
    side = round(count**0.5)
    step = 4.0 / side
    at = [(i + 0.5) * step - 2 for i in range(side)]
    return union([Cylinder(size * step, 1).translate(x, 0, z) for x in at for z in at])


radius = 0.6 * count ** (-1 / 3)
SHAPES = {
    "difference": lambda: Box(2, 2, 2) - union(balls(radius)),
    "union": lambda: Box(2, 2, 2) | union(balls(radius)),
    "plate": lambda: Box(4, 0.1, 4) - posts(),
    "sliders": lambda: Box(4, 0.1, 4) - posts(slider("Size", 0.3, low=0.1, high=0.45)),
    "melting": lambda: union(
        balls(radius), smooth=slider("Smooth", 0.1 * radius, low=0.0, high=0.2 * radius)
    ),
    "pegs": lambda: Box(4, 0.1, 4) | posts(),
    "soft": lambda: union(balls(radius), smooth=0.1 * radius),
    "shell": lambda: union(balls(1.5 * radius)).shell(0.05) - Box(4, 4, 4).translate(2, 0, 0),
    "intersection": lambda: union(balls(radius)) & Ellipsoid(1.0, 0.8, 1.0),
}
if sys.argv[3] == "mesh":
    times = []
    for _ in range(3):
        shape, begin = SHAPES[kind](), process_time()
        mesh = shape.mesh(tolerance=0.02)
        times.append(process_time() - begin)
    print(json.dumps({"first": times[0], "next": min(times[1:]), "triangles": len(mesh.triangles)}))
    sys.exit()
begin = process_time()
scene = Scene(
    SHAPES[kind](),
    acceleration=sys.argv[3] != "whole",
    lights=DistantLight((1, 2, 1.5)),
    camera=Camera((3, 3, 4), target=(0, 0, 0)),
    floor=False,
)
frames = []
for _ in range(6):
    before = process_time()
    scene.render(size=(640, 480), samples=1)
    frames.append(process_time() - (before if frames else begin))
found = pieces_of(scene.shape.node)
print(json.dumps({"first": frames[0], "frame": min(frames[1:]),
    "pieces": found.count if found else 0, "bytes": found.bytes if found else 0}))
"""
CHANGING = ("sliders", "melting")
SCENES = (
    ("sliders", 100),
    ("sliders", 400),
    ("melting", 400),
    ("union", 1000),
    ("difference", 1000),
    ("union", 10_000),
    ("difference", 10_000),
    ("plate", 100),
    ("plate", 400),
    ("plate", 1500),
    ("soft", 1000),
    ("shell", 200),
    ("intersection", 300),
)
MESHES = (("plate", 100), ("pegs", 100), ("plate", 400), ("pegs", 400))


def measured(kind: str, count: int, what: str) -> dict[str, float]:
    """Return what was measured of a scene."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
        command = [sys.executable, "-c", MEASURED, kind, str(count), what]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--meshes", action="store_true", help="measure meshes in place of frames")
    options = parser.parse_args()
    (print_meshes if options.meshes else print_frames)(options.names)


def print_frames(names: Sequence[str]) -> None:
    """Measure the frames of scenes with these names, or of all."""
    print("scene                  first      frame   pieces       size")
    for kind, count in SCENES:
        if names and kind not in names:
            continue
        row = measured(kind, count, "frames")
        times = f"{row['first']:9.2f} s{1000 * row['frame']:8.1f} ms"
        size = f"{row['pieces']:9,}{row['bytes'] / 1e6:8.2f} MB"
        print(f"{kind:13}{count:7,}{times}{size}", flush=True)
        if kind in CHANGING:
            row = measured(kind, count, "whole")
            print(
                f"  whole{count:14,}{row['first']:9.2f} s{1000 * row['frame']:8.1f} ms", flush=True
            )


def print_meshes(names: Sequence[str]) -> None:
    """Measure the meshes of shapes with these names, or of all."""
    print("shape                  first       next  triangles")
    for kind, count in MESHES:
        if names and kind not in names:
            continue
        row = measured(kind, count, "mesh")
        times = f"{row['first']:9.2f} s{row['next']:9.2f} s"
        print(f"{kind:13}{count:7,}{times}{row['triangles']:11,}", flush=True)


if __name__ == "__main__":
    main()
