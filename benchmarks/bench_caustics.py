"""Caustics by photons against plain paths: the error after equal time, in tiles of 8x8 pixels.

A ball, a box and a cylinder of glass on a floor under one lamp, at 160x120. The reference of each
lamp is a long run of plain paths, which are unbiased, with other random numbers; its own error is
subtracted. Each mode gets the same CPU time after compilation, by the rate of a short run. Errors
are root mean squares over tiles and three seeds, in units of white.

    python benchmarks/bench_caustics.py [--seconds 4] [--reference 120]
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

import numpy as np

from distal import Box, Camera, Cylinder, Plane, PointLight, Scene, Sphere, glass, matte
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor

SIZE = (160, 120)
TILE = 8


def scene(radius: float) -> Scene:
    """The scene, with a lamp of a radius."""
    clear = glass(1.5)
    shapes = (
        Sphere(0.5).translate(-1.0, 0.5, 0.1),
        Box((0.8, 0.8, 0.8)).rotate(y=0.5).translate(0.15, 0.4, -0.4),
        Cylinder(0.35, 0.9).translate(1.15, 0.45, 0.2),
    )
    floor = Plane().paint(matte((0.7, 0.7, 0.7)))
    return Scene(
        [floor, *(shape.paint(clear) for shape in shapes)],
        lights=[PointLight((1.8, 3.6, -1.6), intensity=18.0, radius=radius)],
        camera=Camera((0.2, 2.4, 4.2), target=(0.0, 0.3, 0.2), fov_deg=40.0),
        background=(0.05, 0.06, 0.08),
        floor=False,
        exposure=1.0,
    )


def tiles(light: Any) -> Any:
    """The means of the tiles."""
    width, height = SIZE[0] // TILE, SIZE[1] // TILE
    return light[..., :3].reshape(height, TILE, width, TILE, 3).astype(float).mean(axis=(1, 3))


def picture(made: Scene, seconds: float, seed: int, *, caustics: bool) -> tuple[Any, int]:
    """The tiles of a picture that takes so much CPU time, and its samples."""
    view = made.view("color", paths=True, caustics=caustics)

    def drawn(samples: int) -> tuple[Any, float]:
        options = RenderOptions(size=SIZE, seed=seed, samples=samples)
        begin = time.process_time()
        light = executor().render(view, options).linear
        return light, time.process_time() - begin

    drawn(1)  # compiles
    _, used = drawn(32)
    count = max(1, round(32 * seconds / used))
    light, _ = drawn(count)
    return tiles(light), count


def main() -> None:
    """Print the errors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--reference", type=float, default=120.0)
    parser.add_argument("--radii", type=float, nargs="*", default=[0.5, 0.05])
    asked = parser.parse_args()
    for radius in asked.radii:
        made = scene(radius)
        parts = [picture(made, asked.reference / 4, 1000 + i, caustics=False) for i in range(4)]
        known = np.array([t for t, _ in parts])
        truth = known.mean(axis=0)
        own = known.var(axis=0, ddof=1).mean() / len(known)
        found = {}
        for caustics in (False, True):
            rows = [picture(made, asked.seconds, seed, caustics=caustics) for seed in range(3)]
            square = np.mean([np.mean((t - truth) ** 2) for t, _ in rows])
            found[caustics] = max(square - own, 0.0) ** 0.5
            name = "photons" if caustics else "plain paths"
            apart = np.mean([t.mean() for t, _ in rows]) / truth.mean() - 1.0
            print(
                f"radius {radius:5}  {name:12} {rows[0][1]:6} samples  error {found[caustics]:.5f}"
                f"  (mean {apart:+.4f})"
            )
            sys.stdout.flush()
        share = found[True] / found[False]
        print(f"radius {radius:5}  {share:.3f} of plain paths; reference's error {own**0.5:.5f}")


if __name__ == "__main__":
    main()
