"""Flat and solid models by tapes: from the file to the picture, a frame, and the ordinary way.

The text model is made here: rows of letter-like unions, and so is a gyroid in a sphere. Fidget's
model files (its repository's ``models/``) are measured too where they are at hand. Times of solids
are those of the process, because the machine may be shared:

    python benchmarks/bench_tape.py [MODEL.vm ...] [--size 1024] [--runs 30]
    DISTAL_MODELS=path/to/models python benchmarks/bench_tape.py
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from distal import Scene, Shape

FOLDER = "DISTAL_MODELS"
SOLID_GOALS = (
    "goals for heights and normals at 1024^3: colonnade 40 ms, gyroid-sphere 100 ms, bear 1.5 s, "
    "on 2 threads"
)
# What no point of the models exceeds where rays go.
SLOPES = {"gyroid-sphere": 50.0, "colonnade": 33.0, "bear": 12.0}
GYROID = """x var-x
y var-y
z var-z
scale const 30
sx mul x scale
sy mul y scale
sz mul z scale
sin_x sin sx
cos_x cos sx
sin_y sin sy
cos_y cos sy
sin_z sin sz
cos_z cos sz
xy mul sin_x cos_y
yz mul sin_y cos_z
zx mul sin_z cos_x
two add xy yz
gyroid add two zx
both abs gyroid
width const 0.2
sheet sub both width
xx square sx
yy square sy
zz square sz
flat add xx yy
all add flat zz
root sqrt all
radius const 25
sphere sub root radius
result max sphere sheet
"""
GOALS = "goals for prospero at 1024x1024: file to picture 0.3 s, frame 6 ms (aim 4) on 2 threads"

# A fresh process with a warm cache, the imports of NumPy, LLVM and distal left out.
FILE_TO_PICTURE = """
import sys, time
import numpy, llvmlite.binding, distal.runtime.executor, distal.runtime.fills
from distal import Scene, Shape
path, size = sys.argv[1], int(sys.argv[2])
begin = time.perf_counter()
Shape.from_vm(path).fill((size, size), samples=1)
print(time.perf_counter() - begin)
"""


def letters(columns: int, rows: int) -> str:
    """Return a text of ``columns`` by ``rows`` letters: a ring or half of one, and a bar."""
    lines = ["x var-x", "y var-y"]

    def add(operation: str, *operands: str) -> str:
        lines.append(f"v{len(lines)} {operation} {' '.join(operands)}")
        return lines[-1].split()[0]

    def number(value: float) -> str:
        return add("const", repr(value))

    step = 2.0 / columns
    radius, width = 0.28 * step, 0.05 * step
    parts = []
    for row in range(rows):
        for column in range(columns):
            kind = (column * 7 + row * 3) % 4
            across = add("sub", "x", number(-1.0 + (column + 0.5) * step))
            up = add("sub", "y", number(1.0 - (row + 0.5) * 2.0 / rows))
            squares = [add("square", across), add("square", up)]
            distance = add("sub", add("sqrt", add("add", *squares)), number(radius))
            letter = add("sub", add("abs", distance), number(width))
            if kind % 2:
                letter = add("max", letter, across if kind == 1 else add("neg", across))
            beside = add("abs", add("add", across, number(radius if kind == 1 else -radius)))
            bar = add(
                "max", add("sub", beside, number(width)), add("sub", add("abs", up), number(radius))
            )
            parts.append(add("min", letter, bar))
    while len(parts) > 1:
        pairs = zip(parts[::2], parts[1::2], strict=False)
        parts = [add("min", *pair) for pair in pairs] + parts[len(parts) & ~1 :]
    return "\n".join(lines) + "\n"


def median_ms(run: object, runs: int) -> float:
    """The median of several runs, in milliseconds."""
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        run()  # type: ignore[operator]
        times.append(time.perf_counter() - begin)
    return 1e3 * statistics.median(times)


def measure(path: Path, size: int, runs: int) -> None:
    """Print one model's figures."""
    words = [sys.executable, "-c", FILE_TO_PICTURE, str(path), str(size)]
    fresh = [
        float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
        for _ in range(6)
    ][1:]
    shape = Shape.from_vm(path)
    picture = shape.fill((size, size), samples=1, box=((-1, -1), (1, 1)))
    print(f"\n{path.name}: {picture.stats['operations']} operations, {size}x{size}")
    print(f"  file to picture, fresh process   {statistics.median(fresh):8.3f} s")
    for threads, samples in ((1, 1), (2, 1), (2, 4)):
        frame = median_ms(
            lambda threads=threads, samples=samples: shape.fill(
                (size, size), samples=samples, box=((-1, -1), (1, 1)), threads=threads
            ),
            runs,
        )
        print(f"  frame, {threads} threads, {samples} samples      {frame:8.2f} ms")
    axis = (np.arange(size, dtype=np.float32) + np.float32(0.5)) * np.float32(2.0 / size) - 1
    points = np.stack(np.meshgrid(axis, -axis), axis=-1).reshape(-1, 2)
    begin = time.perf_counter()
    shape(points[:64])
    compiled = time.perf_counter() - begin
    begin = time.perf_counter()
    values = shape(points).reshape(size, size)
    ordinary = 1e3 * (time.perf_counter() - begin)
    frame = median_ms(lambda: shape.fill((size, size), samples=1, box=((-1, -1), (1, 1))), runs)
    print(f"  ordinary kernel: first values    {compiled:8.2f} s (from the cache if it is warm)")
    ratio = ordinary / frame
    print(f"  ordinary kernel: all pixels      {ordinary:8.1f} ms, {ratio:.0f} times a frame")
    differing = int(((values < 0) != (picture.array[..., 0] > 0.5)).sum())
    print(f"  pixels that differ               {differing:8d}")


def process_ms(run: object, runs: int) -> tuple[float, float]:
    """The median times of the process, and by the clock, in milliseconds."""
    times = []
    for _ in range(runs):
        begin = time.process_time(), time.perf_counter()
        run()  # type: ignore[operator]
        times.append((time.process_time() - begin[0], time.perf_counter() - begin[1]))
    process, clock = zip(*times, strict=True)
    return 1e3 * statistics.median(process), 1e3 * statistics.median(clock)


def measure_solid(path: Path, size: int, runs: int) -> None:
    """Print one solid's figures."""
    shape = Shape.from_vm(path)
    box = ((-1.0,) * 3, (1.0,) * 3)
    seen = shape.heights((size, size), box=box)
    print(f"\n{path.name}: {seen.stats['operations']} operations, {size}^3 samples")
    print(f"  rays that hit                    {np.isfinite(seen.heights).mean():8.2f}")
    for threads in (1, 2):
        process, clock = process_ms(
            lambda threads=threads: shape.heights((size, size), box=box, threads=threads), runs
        )
        print(
            f"  heights, {threads} threads: of the process {process:8.1f} ms, clock {clock:8.1f} ms"
        )
    # The ordinary way marches by a slope, and needs to know where the shape is.
    whole = Shape.from_vm(path, slope=SLOPES.get(path.stem, 1.0), bounds=box)
    scene = Scene(whole)
    scene.render((size, size), view="normal", samples=1)
    ordinary, _ = process_ms(lambda: scene.render((size, size), view="normal", samples=1), 3)
    print(f'  ordinary kernel, view="normal"   {ordinary:8.1f} ms, {ordinary / process:.1f} times')


def models(given: list[str]) -> list[Path]:
    """The model files at hand."""
    folder = os.environ.get(FOLDER)
    found = [Path(name) for name in given]
    if not found and folder:
        found = sorted(Path(folder).glob("*.vm"))
    if not found:
        print(f"Fidget's models are not at hand: name files, or set {FOLDER} to its models/")
    return found


def main() -> None:
    """Print the figures of every model."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=30)
    asked = parser.parse_args()
    print(GOALS)
    print(SOLID_GOALS)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "letters.vm"
        made.write_text(letters(30, 20), encoding="utf-8")
        gyroid = Path(folder) / "gyroid-sphere.vm"
        gyroid.write_text(GYROID, encoding="utf-8")
        for path in (made, gyroid, *models(asked.models)):
            if Shape.from_vm(path).flat:
                measure(path, asked.size, asked.runs)
            else:
                measure_solid(path, asked.size, min(asked.runs, 9))


if __name__ == "__main__":
    main()
