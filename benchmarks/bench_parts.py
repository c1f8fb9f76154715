"""How a scene's cost grows with the number of its parts: objects, first picture, frame, memory.

The parts (boxes, spheres and rings of many colors) stand on a square grid, so that the same share
of the rays hits them whatever their number is. One sun with shadows, then the default lights
(``look``), 640x480, one sample, two threads. Each count is measured in a fresh process with an
empty kernel cache.

``occlusion`` is the time of a frame with ambient light and default occlusion, over that of the same
frame without occlusion: seconds of the processor, in turn. ``cold`` is a picture with occlusion.

With ``--moving``, each part rises and falls and turns by expressions of the time. The same parts
that stand still are drawn in turn with them, and the time to compute the boxes of a picture and to
refit their tree is measured.

    python benchmarks/bench_parts.py [--counts 100 1000 10000 100000] [--plot growth.png] [--moving]
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from PIL import Image, ImageDraw

COUNTS = (100, 1000, 10_000, 100_000)
COLORS = {
    "objects": "#2a9d8f",
    "cold": "#e76f51",
    "frame": "#264653",
    "look": "#7b2cbf",
    "occlusion": "#d62828",
    "memory": "#b08900",
}
COLUMNS = tuple(COLORS)

MEASURED = """
import json, random, resource, sys
from time import perf_counter, process_time, sleep
import numpy, llvmlite.binding, distal.runtime.executor, distal.devices.cpu
from distal import AmbientLight, Box, Camera, DistantLight, Plane, Scene, Sphere, Torus, union

count, device = int(sys.argv[1]), sys.argv[2]
random.seed(1)
begin = perf_counter()
side = round(count**0.5)
step = 4.0 / side
parts = []
for i in range(count):
    a = random.uniform(0.25, 0.4) * step
    part = (Sphere(a), Box(a, 1.4 * a, a), Torus(a, 0.4 * a).rotate(x=random.uniform(0, 3)))[i % 3]
    place = ((i % side + 0.5) * step - 2.0, 0.5 * step, (i // side + 0.5) * step - 2.0)
    parts.append(part.translate(place).paint([random.uniform(0.1, 0.9) for _ in range(3)]))
whole = union(parts)
objects = perf_counter() - begin
sun = DistantLight((1, 2, 1.5), angle=0.01)
camera = Camera((3, 3, 4), target=(0, 0, 0))
scene = Scene(whole | Plane(), lights=sun, camera=camera)


def frame(scene, clock=perf_counter):
    begin = clock()
    scene.render(size=(640, 480), samples=1, device=device)
    return clock() - begin


around = {"lights": [sun, AmbientLight(0.3)], "camera": camera}
occluded = [Scene(whole | Plane(), **around), Scene(whole | Plane(), ambient_occlusion=0, **around)]
frame(occluded[0])
cold = perf_counter() - begin
frame(occluded[1])
frame(scene)
frames = [frame(scene) for _ in range(5)]
look = Scene(whole | Plane(), camera=camera)
looks = [frame(look) for _ in range(6)]
sleep(2.0)  # until all kernels are optimized ones
pairs = [[frame(each, process_time) for each in occluded] for _ in range(7)]
occlusion = min(pair[0] for pair in pairs) / min(pair[1] for pair in pairs)
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps({"objects": objects, "cold": cold, "frame": min(frames), "look": min(looks),
    "occlusion": occlusion, "memory": memory}))
"""

MOVING = """
import json, random, sys
from time import perf_counter
import numpy
from distal import Box, Camera, DistantLight, Plane, Scene, Sphere, Torus, time, union
from distal.scene.lowering.parts.table import rolled

count, device = int(sys.argv[1]), sys.argv[2]


def parts(now):
    random.seed(1)
    side = round(count**0.5)
    step = 4.0 / side
    for i in range(count):
        a, phase = random.uniform(0.25, 0.4) * step, random.uniform(0.0, 6.0)
        part = (
            Sphere(a), Box(a, 1.4 * a, a).rotate(y=now + phase), Torus(a, 0.4 * a).rotate(x=phase)
        )[i % 3]
        height = 0.5 * step + 0.3 * step * numpy.sin(2.0 * now + phase)
        place = ((i % side + 0.5) * step - 2.0, height, (i // side + 0.5) * step - 2.0)
        yield part.translate(place).paint([random.uniform(0.1, 0.9) for _ in range(3)])


def least(work):
    found = []
    for _ in range(7):
        begin = perf_counter()
        work()
        found.append(perf_counter() - begin)
    return min(found)


begin = perf_counter()
moving = union(parts(time))
result = {"objects": perf_counter() - begin}
lights = DistantLight((1, 2, 1.5), angle=0.01)
camera = Camera((3, 3, 4), target=(0, 0, 0))
frame = {"size": (640, 480), "samples": 1, "device": device, "time": 0.7}
scenes = {"look": Scene(moving | Plane(), camera=camera)}
scenes["look"].render(**frame)
for name, whole in (("still", union(parts(0.7))), ("moving", moving)):
    scenes[name] = Scene(whole | Plane(), lights=lights, camera=camera)
    begin = perf_counter()
    scenes[name].render(**frame)
    result["cold"] = perf_counter() - begin
times = {name: [] for name in scenes}
for _ in range(7):
    for name, scene in scenes.items():
        begin = perf_counter()
        scene.render(**frame)
        times[name].append(perf_counter() - begin)
result |= {name: min(found) for name, found in times.items()}
boxes = rolled(scenes["moving"].shape.node).table.boxes
result["refit"] = least(lambda: boxes.at({}, 0.7))
print(json.dumps(result))
"""


def measured(count: int, device: str, program: str = MEASURED) -> dict[str, float]:
    """Return seconds and megabytes for a number of parts."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DISTAL_CACHE_DIR": cache}
        command = [sys.executable, "-c", program, str(count), device]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def exponent(rows: dict[int, dict[str, float]], column: str) -> float:
    """Return how a column grows with the count between the last two counts."""
    (a, first), (b, last) = list(rows.items())[-2:]
    return math.log(last[column] / first[column]) / math.log(b / a)


def plot(rows: dict[int, dict[str, float]], path: Path, colors: Mapping[str, str] = COLORS) -> None:
    """Draw columns over the count, both logarithmic, each from its first value.

    Args:
        rows: The columns of each count.
        path: The picture.
        colors: The names of the columns that are drawn, and their colors.
    """
    width, height, margin = 720, 480, 60
    image = Image.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(image)
    low, high = math.log10(min(rows)), math.log10(max(rows))
    decades = max(
        1.0, max(math.log10(r[c] / rows[min(rows)][c]) for r in rows.values() for c in colors)
    )

    def place(count: int, ratio: float) -> tuple[float, float]:
        x = margin + (math.log10(count) - low) / (high - low) * (width - 3 * margin)
        return x, height - margin - max(math.log10(ratio), 0.0) / decades * (height - 2 * margin)

    for count in rows:
        draw.line((*place(count, 1.0), *place(count, 10.0**decades)), "#dddddd")
        draw.text((place(count, 1.0)[0] - 20, height - margin + 10), f"{count:,}", "black")
    for decade in range(math.ceil(decades)):
        draw.line((*place(min(rows), 10.0**decade), *place(max(rows), 10.0**decade)), "#dddddd")
        draw.text((10, place(min(rows), 10.0**decade)[1] - 6), f"x{10**decade}", "black")
    for name, color in colors.items():
        first = rows[min(rows)][name]
        points = [place(count, row[name] / first) for count, row in rows.items()]
        draw.line(points, color, 3)
        draw.text((points[-1][0] + 8, points[-1][1] - 6), name, color)
    image.save(path)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--moving", action="store_true")
    options = parser.parse_args()
    if options.moving:
        print("  parts   objects      cold     still    moving      look     refit")
        for count in options.counts:
            row = measured(count, options.device, MOVING)
            seconds = f"{row['objects']:8.2f} s{row['cold']:8.2f} s"
            frames = "".join(
                f"{1000 * row[n]:7.1f} ms" for n in ("still", "moving", "look", "refit")
            )
            print(f"{count:7,}{seconds}{frames}", flush=True)
        return
    print("  parts   objects      cold     frame      look  occlusion   memory")
    rows: dict[int, dict[str, float]] = {}
    for count in options.counts:
        row = rows[count] = measured(count, options.device)
        seconds = f"{row['objects']:8.2f} s{row['cold']:8.2f} s"
        frames = "".join(f"{1000 * row[n]:7.1f} ms" for n in ("frame", "look"))
        rest = f"{row['occlusion']:11.2f}{row['memory']:6.0f} MB"
        print(f"{count:7,}{seconds}{frames}{rest}", flush=True)
    if len(rows) > 1:
        grown = ", ".join(f"{name} {exponent(rows, name):.2f}" for name in COLUMNS)
        print(f"exponents between the last two: {grown}")
        if options.plot:
            plot(rows, options.plot)


if __name__ == "__main__":
    main()
