"""Time to equal error: our paths against a walk of random directions in GLSL on llvmpipe.

The walk (``rivals/random_walk.frag``) is that of the article whose pictures made us begin: uniform
directions in a hemisphere, lamps found by chance. The scene is a ball and a box of glass on a matte
floor under three lamps, with caustics. The reference is a long run of ours with other random
numbers; the error is the root mean square over tiles of 8x8 pixels, in parts of the mean. Both
errors fall with the square root of the time (two lengths of each show it), so that

    ratio = (seconds * error^2 of the walk) / (seconds * error^2 of ours).

Seconds are those of the processor, on all cores, without compilation.

    python benchmarks/bench_random_walk.py [--reference 2048]
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"

import numpy as np
from numpy.typing import NDArray

from distal import Box, Camera, Plane, PointLight, Scene, Sphere, glass, matte
from tests.egl import EglShader, renderer

SIZE = (240, 160)
TEXT = Path(__file__).parent / "rivals" / "random_walk.frag"
SAMPLES_OF_A_DRAW = 16


def scene() -> Scene:
    """Return the scene of the fragment stage."""
    ball = Sphere(1.0).translate(x=1.2)
    box = Box(1.4).rotate(y=np.radians(30.0)).translate((-1.5, -0.2, 0.0))
    floor = Plane(y=-1.0).paint(matte((0.6, 0.6, 0.6)))
    places = ((2.0, 2.5, -2.0), (-2.0, 2.5, 0.0), (2.0, 2.5, 2.0))
    colors = ("#f00", "#0f0", "#00f")
    return Scene(
        (ball | box).paint(glass(1.5)) | floor,
        lights=[
            PointLight(place, intensity=12.5, color=color, radius=0.5)
            for place, color in zip(places, colors, strict=True)
        ],
        camera=Camera((3.0, 1.5, 9.0), target=(0.0, -0.3, 0.0), fov_deg=40.0),
        background="#000",
        floor=False,
    )


def tiles(light: NDArray[Any]) -> NDArray[np.float64]:
    """Return the means of tiles of 8x8 pixels."""
    width, height = SIZE
    shaped = light[..., :3].astype(np.float64).reshape(height // 8, 8, width // 8, 8, 3)
    return np.asarray(shaped.mean(axis=(1, 3)))


def ours() -> Callable[[int, int], NDArray[Any]]:
    """Return what renders so many samples with a seed."""
    whole = scene()

    def draw(spp: int, seed: int) -> NDArray[Any]:
        return np.asarray(whole.render(size=SIZE, mode="path", spp=spp, seed=seed).linear)

    return draw


def walk() -> Callable[[int, int], NDArray[Any]]:
    """Return what renders so many walks with a seed."""
    shader = EglShader(TEXT.read_text())

    def draw(spp: int, seed: int) -> NDArray[Any]:
        total = np.zeros((SIZE[1], SIZE[0], 4))
        rounds = spp // SAMPLES_OF_A_DRAW
        for i in range(rounds):
            numbers = {"u_seed": 4096 * seed + i, "u_count": SAMPLES_OF_A_DRAW}
            total += shader.render(SIZE, {"u_size": SIZE, **numbers})
        return total / rounds

    return draw


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--reference", type=int, default=2048)
    asked = parser.parse_args()
    print(f"the walk runs on {renderer()}")
    programs = {"ours": ours(), "walk": walk()}
    expected = tiles(programs["ours"](asked.reference, 99))
    costs: dict[str, float] = {}
    for name, lengths in (("ours", (16, 64)), ("walk", (256, 1024))):
        programs[name](16, 0)
        for spp in lengths:
            begin = time.process_time()
            found = tiles(programs[name](spp, 1))
            seconds = time.process_time() - begin
            error = float(np.sqrt(np.mean((found - expected) ** 2)) / expected.mean())
            costs[name] = seconds * error**2
            mean = found.mean() / expected.mean()
            print(
                f"{name} {spp:5} samples {seconds:7.2f} CPU s  error {error:.4f}  "
                f"mean {mean:.4f} of the reference  seconds * error^2 {costs[name]:.2e}"
            )
    print(f"time to equal error: the walk takes {costs['walk'] / costs['ours']:.0f} times as long")


if __name__ == "__main__":
    main()
