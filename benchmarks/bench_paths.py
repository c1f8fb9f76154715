"""Samples per CPU-second of paths, against Mitsuba 3 on the twin scene in the same run.

The glass scene of ``sdfray_glass``'s kind: a ball and a turned box of glass over a checker, under
three lamps, 480x320. Rounds take turns, so that other work on the machine meets all of them; the
best round of each counts. The time is that of the process on all cores, without compilation.
"marched" rounds the edges of the box by .001, so that both solids are marched; "blended" joins them
smoothly. Mitsuba's ``path`` has no strategy for caustics: the ratios of plain paths compare like
with like, those with photons have more to do. Without Mitsuba (``pip install -e '.[twins]'``) only
our own figures are printed.

    python benchmarks/bench_paths.py [--rounds 8] [--spp 16] [--size 480 320]
"""

from __future__ import annotations

import argparse
import importlib
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np

from distal import Box, Scene, Sphere, glass
from tests.paths.twins import Lamp, Paint, Solid, Twin

CLEAR = Paint("glass", (1.0, 1.0, 1.0))
TWIN = Twin(
    (
        Solid("ball", (1.0,), (1.2, 0.0, 0.0), CLEAR),
        Solid("box", (1.4, 1.4, 1.4), (-1.5, -0.2, 0.0), CLEAR, 30.0),
        Solid(
            "plane",
            (),
            (0.0, -1.0, 0.0),
            Paint(color=(0.95, 0.95, 0.95), dark=(0.05, 0.05, 0.05)),
        ),
    ),
    (
        Lamp("point", (2.0, 2.5, -2.0), (12.5, 0.0, 0.0), 0.5),
        Lamp("point", (-2.0, 2.5, 0.0), (0.0, 12.5, 0.0), 0.5),
        Lamp("point", (2.0, 2.5, 2.0), (0.0, 0.0, 12.5), 0.5),
    ),
    eye=(3.0, 1.5, 9.0),
    target=(0.0, -0.3, 0.0),
    fov=40.0,
)


def of_shape(solids: Any) -> Scene:
    """Return the scene with other solids over its floor."""
    whole = TWIN.ours()
    shape = solids.paint(glass()) | TWIN.solids[2].ours()
    return Scene(
        shape, lights=whole.lights, camera=whole.camera, background=(0.0, 0.0, 0.0), floor=False
    )


def ours(scene: Scene, size: tuple[int, int], spp: int, *, caustics: bool) -> Callable[[int], None]:
    """Return what renders a round of a scene, compiled."""

    def draw(seed: int) -> None:
        scene.render(size=size, mode="path", spp=spp, seed=seed, caustics=caustics)

    draw(0)
    return draw


def theirs(size: tuple[int, int], spp: int) -> Callable[[int], None] | None:
    """Return what renders a round with Mitsuba, compiled; None if it is not installed."""
    try:
        mi = importlib.import_module("mitsuba")
    except ImportError:
        print("Mitsuba is not installed: no ratios")
        return None
    mi.set_variant("llvm_ad_rgb")
    scene = mi.load_dict(TWIN.theirs(mi, size))

    def draw(seed: int) -> None:
        np.array(mi.render(scene, spp=spp, seed=seed))

    draw(0)
    draw(1)
    return draw


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--size", type=int, nargs=2, default=(480, 320))
    asked = parser.parse_args()
    size = (asked.size[0], asked.size[1])
    ball = Sphere(1.0).translate(1.2, 0.0, 0.0)
    box = Box(1.4).rotate(y=np.radians(30.0))
    place = (-1.5, -0.2, 0.0)
    rounded = Box(1.4).round(1e-3).rotate(y=np.radians(30.0)).translate(place)
    scenes = {
        "closed hits": TWIN.ours(),
        "marched beside a closed floor": of_shape(ball | rounded),
        "blended": of_shape(ball.union(box.translate(place), smooth=0.3)),
    }
    runners: dict[str, Callable[[int], None]] = {}
    mitsuba = theirs(size, asked.spp)
    if mitsuba is not None:
        runners["Mitsuba llvm_ad_rgb"] = mitsuba
    for name, scene in scenes.items():
        runners[name] = ours(scene, size, asked.spp, caustics=False)
        runners[f"{name}, with photons"] = ours(scene, size, asked.spp, caustics=True)
    best = dict.fromkeys(runners, float("inf"))
    for seed in range(2, 2 + asked.rounds):
        for name, draw in runners.items():
            begin = time.process_time()
            draw(seed)
            best[name] = min(best[name], time.process_time() - begin)
    samples = size[0] * size[1] * asked.spp
    base = best.get("Mitsuba llvm_ad_rgb")
    for name, seconds in best.items():
        ratio = "" if base is None else f"{base / seconds:7.2f} of Mitsuba"
        print(f"{name:44}{samples / seconds / 1e6:7.2f} M samples a CPU-second{ratio}")


if __name__ == "__main__":
    main()
