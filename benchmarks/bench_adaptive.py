"""Adaptive samples of paths against the same number in each pixel: work to a given error.

Two scenes: the still life, and a small lamp over a glass ball, whose light on the floor is in few
pixels. Each is rendered to some estimated errors in both ways. Prints the mean number of samples of
a pixel, the CPU time, and the true error, against many samples with other random numbers.

Run: python benchmarks/bench_adaptive.py [SAMPLES_OF_THE_REFERENCE]
"""

from __future__ import annotations

import sys
import time

import numpy as np

import distal
from distal import Box, Camera, Plane, PointLight, Scene, Sphere, glass
from distal.runtime import allocation

SIZE = (80, 64)


def lamp_and_glass() -> Scene:
    """Return a small lamp over a ball of glass."""
    lamp = PointLight((1.0, 3.0, 0.5), intensity=12.0, radius=0.3)
    ball = Sphere(0.5).translate(y=0.7).paint(glass())
    block = Box((0.4, 0.4, 0.4)).translate((-1.0, 0.2, 0.0))
    camera = Camera((0.0, 2.0, 4.0), (0.0, 0.4, 0.0))
    return Scene(ball | block | Plane(), lights=lamp, camera=camera)


def uniform(film, refinement):
    """All tiles need as many samples as there may be."""
    tiles = film.samples[:: allocation.TILE_PX, :: allocation.TILE_PX]
    return np.full(tiles.shape, float(refinement.samples))


def error(picture, truth) -> float:
    """Return the root mean square of the luma's error, as ``noise`` counts it."""
    apart = (picture.linear - truth.linear)[..., :3].astype(float) @ (0.2126, 0.7152, 0.0722)
    bright = truth.linear[..., :3].astype(float) @ (0.2126, 0.7152, 0.0722)
    return float(np.sqrt(np.mean((apart / np.maximum(bright, 1.0)) ** 2)))


def main() -> None:
    """Print the table."""
    many = int(sys.argv[1]) if len(sys.argv) > 1 else 4096
    adaptive = allocation.wanted
    scenes = {"lamp and glass": (lamp_and_glass(), (0.05, 0.02))}
    scenes["still life"] = (distal.load("example:still_life"), (0.04,))
    print("scene, estimated error: way, samples, CPU s, true error")
    for name, (scene, goals) in scenes.items():
        truth = scene.render(SIZE, mode="path", spp=many, seed=1)
        for goal in goals:
            for way, wanted in (("uniform", uniform), ("adaptive", adaptive)):
                allocation.wanted = wanted
                begin = time.process_time()
                made = scene.render(SIZE, mode="path", noise=goal, spp=65536, seed=2)
                spent = time.process_time() - begin
                samples = made.stats["samples"]
                off = error(made, truth)
                print(f"{name}, {goal}: {way}, {samples:.0f}, {spent:.1f}, {off:.4f}", flush=True)
            allocation.wanted = adaptive


if __name__ == "__main__":
    main()
