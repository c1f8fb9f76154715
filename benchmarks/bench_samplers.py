"""Compare random numbers for paths: the error of integrals against samples, and their cost.

Four samplers: independent numbers (PCG), Kronecker's R2 with a random offset for each pixel, pairs
of ``points.scattered_stream`` and of ``points.dithered_stream``. Integrands: three on the square,
and a floor under a lamp behind a ball, of six random numbers: a place in the pixel, a direction to
the lamp, a direction of light that the floor scatters. Prints the error (rms over pixels, relative
to the mean) of a pixel, and of the mean of 4 x 4 pixels, which is what an eye at a distance sees.

    python benchmarks/bench_samplers.py
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from distal.lang import floor, func, ivec2, pcg, uint, vec2
from distal.render.sampling import points

SIDE = 64
COUNTS = (1, 4, 16, 64, 256)
FROM_24_BITS = 5.9604644775390625e-08


@func
def independent(pixel: ivec2, sample: int, bits: int, decision: int) -> vec2:
    """Independent numbers."""
    place = uint(pixel.x) + pcg(uint(pixel.y) + pcg(uint(sample) + pcg(uint(decision))))
    first = pcg(place)
    return vec2(float(first >> uint(8)), float(pcg(first) >> uint(8))) * FROM_24_BITS


@func
def kronecker(pixel: ivec2, sample: int, bits: int, decision: int) -> vec2:
    """Martin Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018)."""
    offset = independent(pixel, 0, bits, decision)
    place = vec2(uint(sample) * uint(3242174889), uint(sample) * uint(2447445414)) / 4294967296.0
    moved = place + offset
    return moved - floor(moved)


@func
def scattered(pixel: ivec2, sample: int, bits: int, decision: int) -> vec2:
    """Pairs of independent pixels."""
    return points.pair(points.scattered_stream(pixel, sample, uint(1)), decision)


@func
def dithered(pixel: ivec2, sample: int, bits: int, decision: int) -> vec2:
    """Pairs along a curve over the picture."""
    return points.pair(points.dithered_stream(pixel, sample, bits, uint(1)), decision)


@func
def many_independent(pixel: ivec2, count: int) -> vec2:
    """The sum of the pairs of ``count`` samples, as the other three: to measure their cost."""
    total = vec2(0.0)
    for i in range(count):
        total += independent(pixel, i, 8, 3)
    return total


@func
def many_kronecker(pixel: ivec2, count: int) -> vec2:
    """As ``many_independent``."""
    total = vec2(0.0)
    for i in range(count):
        total += kronecker(pixel, i, 8, 3)
    return total


@func
def many_scattered(pixel: ivec2, count: int) -> vec2:
    """As ``many_independent``."""
    total = vec2(0.0)
    for i in range(count):
        total += scattered(pixel, i, 8, 3)
    return total


@func
def many_dithered(pixel: ivec2, count: int) -> vec2:
    """As ``many_independent``."""
    total = vec2(0.0)
    for i in range(count):
        total += dithered(pixel, i, 8, 3)
    return total


MANY = {
    "PCG": many_independent,
    "R2": many_kronecker,
    "scattered": many_scattered,
    "dithered": many_dithered,
}
SAMPLERS = {"PCG": independent, "R2": kronecker, "scattered": scattered, "dithered": dithered}


def draw(sampler: Any, count: int, decision: int) -> Any:
    """Numbers (pixel, sample, 2) of all pixels."""
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    pixels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32).repeat(count, 0)
    samples = np.tile(np.arange(count, dtype=np.int32), SIDE * SIDE)
    bits = int(np.log2(count))
    found = np.asarray(sampler(pixels, samples, bits, decision), float)
    return found.reshape(SIDE * SIDE, count, 2)


def smooth(u: Any) -> Any:
    """A smooth bump."""
    return np.exp(-4 * ((u[..., 0] - 0.3) ** 2 + (u[..., 1] - 0.6) ** 2))


def disc(u: Any) -> Any:
    """The inside of a circle."""
    return ((u[..., 0] - 0.4) ** 2 + (u[..., 1] - 0.55) ** 2 < 0.1).astype(float)


def corner(u: Any) -> Any:
    """A slope with a straight edge."""
    return (u[..., 0] * 0.7 + u[..., 1] < 0.8).astype(float) * (1 + u[..., 0])


def hits_ball(origin: Any, direction: Any, middle: Any, radius: float) -> Any:
    """Whether rays meet a ball ahead of them."""
    to = middle - origin
    along = (to * direction).sum(-1)
    return (along > 0) & ((to * to).sum(-1) - along**2 < radius**2)


def floor_light(pixel: Any, lamp: Any, bounce: Any) -> Any:
    """A floor seen from above, lit by a square lamp past a ball, and by a colored sky."""
    y, x = np.divmod(np.arange(SIDE * SIDE), SIDE)
    at = np.stack([x, y], 1)[:, None, :] + pixel
    p = np.stack([4 * at[..., 0] / SIDE - 2, np.zeros(at.shape[:2]), 4 * at[..., 1] / SIDE - 2], -1)
    on_lamp = np.stack(
        [2 * lamp[..., 0] - 1, np.full(lamp.shape[:2], 3.0), 2 * lamp[..., 1] - 1], -1
    )
    to = on_lamp - p
    squared = (to * to).sum(-1)
    to = to / np.sqrt(squared)[..., None]
    ball = np.array([0.3, 0.8, 0.1])
    direct = np.where(hits_ball(p, to, ball, 0.6), 0, 8 * to[..., 1] ** 2 / squared)
    radius, turn = np.sqrt(bounce[..., 0]), 2 * np.pi * bounce[..., 1]
    up = np.stack([radius * np.cos(turn), np.sqrt(1 - bounce[..., 0]), radius * np.sin(turn)], -1)
    sky = np.where(hits_ball(p, up, ball, 0.6), 0.1, 0.3 + 0.7 * np.maximum(up[..., 0], 0))
    return direct + sky


def errors(values: Any, truth: Any) -> tuple[float, float]:
    """The error of a pixel and of the mean of 4 x 4, relative to the mean."""
    off = (values.mean(1) - truth).reshape(SIDE, SIDE)
    blocks = off.reshape(SIDE // 4, 4, SIDE // 4, 4).mean((1, 3))
    scale = np.mean(truth)
    return float(np.sqrt((off**2).mean()) / scale), float(np.sqrt((blocks**2).mean()) / scale)


def main() -> None:
    """Print errors and costs."""
    fine = (np.arange(1500) + 0.5) / 1500
    cells = np.stack(np.meshgrid(fine, fine, indexing="ij"), -1)
    flat = {"smooth": smooth, "disc": disc, "corner": corner}
    truths = {name: integrand(cells).mean() for name, integrand in flat.items()}
    reference = np.zeros(SIDE * SIDE)
    for part in range(8):
        drawn = [draw(scattered, 1024, 1000 + 3 * part + k) for k in range(3)]
        reference += floor_light(*drawn).mean(1) / 8
    for name in (*flat, "floor"):
        print(f"\n{name}: error of a pixel | of 4 x 4 pixels, at {COUNTS} samples")
        for label, sampler in SAMPLERS.items():
            found = []
            for count in COUNTS:
                drawn = [draw(sampler, count, k) for k in range(3)]
                values = flat[name](drawn[0]) if name in flat else floor_light(*drawn)
                truth = truths[name] if name in flat else reference
                found.append(errors(values, truth))
            pixel = " ".join(f"{e[0]:.5f}" for e in found)
            print(f"  {label:10} {pixel} | " + " ".join(f"{e[1]:.5f}" for e in found))
    print("\nprocessor time of a pair, ns")
    y, x = np.mgrid[0:SIDE, 0:SIDE]
    pixels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32)
    for label, many in MANY.items():
        best = 1e9
        for _ in range(7):
            start = time.process_time()
            many(pixels, 1024)
            best = min(best, time.process_time() - start)
        print(f"  {label:10} {best / (SIDE * SIDE * 1024) * 1e9:.2f}")


if __name__ == "__main__":
    main()
