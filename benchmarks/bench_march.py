"""Cost of rays and normals: the hybrid march against sphere tracing, exact normals against taps.

The rays of ``example:sea`` at several times: evaluations of the field by each march, and how far
each ends from the true sea, which sphere tracing finds in 64 bits with a hundred thousandth of the
usual threshold. Then the bunny under each way to find normals, interleaved round by round. Prints
tables.

    python benchmarks/bench_march.py [--rounds 9]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time as clock
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "examples"))

import bunny
import sea
import sea_sphere_tracing

from distal.fields.guarantees import Bounds
from distal.lang import Frame, func, image, vec2, vec3, vec4
from distal.render.camera import Ray, look_at
from distal.render.heightfield_march import STRIDE, march_heightfield
from distal.render.march import Hit, March
from distal.render.normals import EXACT, FORWARD, SIX_TAPS, TETRAHEDRON, normal
from distal.render.segment import segment
from distal.render.settings import grown_bounds, hit_threshold, march_numbers, stride_over

SIZE = (640, 400)
TIMES = (0.0, 1.7, 5.3, 40.0)
THREADS = 2
STEPS = 1000
UP = (0.0, 1.0, 0.0)
ENDLESS = 1e18
SWELL = sea.swell.default
SLOPE = float(np.sqrt(1.0 + (sea.STEEPEST * SWELL) ** 2))
TRUE = 1e-8


@func
def slab() -> Bounds:
    """The box that the waves keep within."""
    low = vec3(-ENDLESS, sea.TROUGH * SWELL, -ENDLESS)
    return grown_bounds(Bounds(low, vec3(ENDLESS, sea.CREST * SWELL, ENDLESS)))


@func
def sea_ray(uv: vec2) -> Ray:
    """A ray of the example's camera."""
    return look_at(uv, sea.EYE, sea.TARGET, UP, fov=sea.FOV)


@func
def sea_hit(frame: Frame, hybrid: bool) -> vec4:
    """A pixel's march over the sea."""
    threshold = hit_threshold(frame.resolution, slab(), sea_ray)
    numbers = march_numbers(SLOPE, 0.001, sea.FAR, threshold)
    ray = sea_ray((2.0 * frame.coord - frame.resolution) / frame.resolution.y)
    time = frame.time
    if hybrid:
        stride = stride_over(slab(), STRIDE.first, STRIDE.growth)
        return told(
            march_heightfield(
                lambda p: sea.water(p, SWELL, time), ray, slab(), numbers, stride, STEPS
            )
        )
    return told(segment(lambda p: sea.water(p, SWELL, time), ray, 0.0, 0.0, slab(), numbers, STEPS))


@func
def told(hit: Hit) -> vec4:
    """Evaluations, way and whether there was a hit, as a pixel."""
    return vec4(float(hit.steps), hit.t, 1.0 if hit.found else 0.0, 1.0)


@image
def by_hybrid(frame: Frame) -> vec4:
    """The hybrid march."""
    return sea_hit(frame, True)


@image
def by_spheres(frame: Frame) -> vec4:
    """Sphere tracing."""
    return sea_hit(frame, False)


@func
def true_sea(u: float, v: float, time: float) -> vec2:
    """Where a ray meets the sea, and whether it does."""
    numbers = March(SLOPE, 0.001, sea.FAR, TRUE)
    ray = sea_ray(vec2(u, v))
    hit = segment(lambda p: sea.water(p, SWELL, time), ray, 0.0, 0.0, slab(), numbers, 20 * STEPS)
    return vec2(hit.t, 1.0 if hit.found else 0.0)


def truth(time: float) -> Any:
    """Where every fourth pixel's ray meets the sea, and whether."""
    width, height = SIZE
    across = (2.0 * np.arange(0, width, 2) + 1.0 - width) / height
    up = (height - 2.0 * np.arange(0, height, 2) - 1.0) / height
    u, v = np.meshgrid(across, up)
    found = np.asarray(true_sea(u.ravel(), v.ravel(), np.full(u.size, time)))
    return found.reshape(*u.shape, 2)


def marches() -> None:
    """Evaluations of the field, and how near to the truth rays end."""
    print("sea 640x400        evaluations of the field       mean  off by    by     hit or not,")
    print("time  march        a pixel  a pixel of water       off   > 1 %  > 5 %     wrongly")
    for time in TIMES:
        true = truth(time)
        counts = []
        for name, march_by in (("hybrid", by_hybrid), ("spheres", by_spheres)):
            told_by = march_by.render(size=SIZE, time=time, threads=THREADS).array
            steps, t, hits = (told_by[..., i] for i in range(3))
            counts.append((steps.mean(), steps[hits > 0].mean()))
            seen = (hits[::2, ::2] > 0) & (true[..., 1] > 0)
            off = np.abs(t[::2, ::2] / true[..., 0] - 1.0)[seen]
            wrong = ((hits[::2, ::2] > 0) != (true[..., 1] > 0)).mean()
            print(
                f"{time:4.1f}  {name:8} {counts[-1][0]:11.2f} {counts[-1][1]:17.2f}"
                f" {100 * off.mean():9.2f} % {100 * (off > 0.01).mean():5.2f} %"
                f" {100 * (off > 0.05).mean():4.2f} % {100 * wrong:9.3f} %"
            )
        ratios = [spheres / hybrid for hybrid, spheres in zip(*counts, strict=True)]
        print(f"      fewer by {ratios[0]:9.2f}x {ratios[1]:16.2f}x")


@func
def bunny_distance(p: vec3) -> float:
    """The field alone."""
    return bunny.bunny(p)


@func
def exact(p: vec3) -> vec3:
    """By the derivative."""
    return normal(lambda q: bunny.bunny(q), p, EXACT, 1e-3)


@func
def six_taps(p: vec3) -> vec3:
    """By six differences."""
    return normal(lambda q: bunny.bunny(q), p, SIX_TAPS, 1e-3)


@func
def tetrahedron(p: vec3) -> vec3:
    """By four."""
    return normal(lambda q: bunny.bunny(q), p, TETRAHEDRON, 1e-3)


@func
def forward(p: vec3) -> vec3:
    """By three, and one at the place itself."""
    return normal(lambda q: bunny.bunny(q), p, FORWARD, 1e-3)


def normals(rounds: int) -> None:
    """What each way to find normals costs the cores, at places near the bunny's surface."""
    ways: list[Any] = [bunny_distance, exact, six_taps, tetrahedron, forward]
    scattered = np.random.default_rng(0).uniform((-1.0, 0.0, -0.6), (1.0, 2.1, 0.6), (1 << 20, 3))
    near = np.abs(bunny_distance(scattered)) < 0.02
    points = np.resize(scattered[near], (1 << 18, 3)).astype(np.float32)
    times: dict[str, list[float]] = {way.name: [] for way in ways}
    for round_number in range(rounds + 1):  # the first compiles
        for way in ways:
            begin = clock.process_time()
            way(points)
            if round_number > 0:
                times[way.name].append((clock.process_time() - begin) * 1e9 / len(points))
    true = exact(points)
    base = min(times["bunny_distance"])
    print("bunny, ns a point      median  fastest  in evaluations   degrees from exact, mean")
    for way in ways:
        median, fastest = statistics.median(times[way.name]), min(times[way.name])
        off = 0.0
        if way is not bunny_distance:
            cosine = (np.asarray(way(points)) * true).sum(axis=1)
            off = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).mean())
        print(f"{way.name:20} {median:8.1f} {fastest:8.1f} {fastest / base:12.2f} {off:18.3f}")


def pictures() -> None:
    """The finished pictures of both marches, in milliseconds."""
    for name, scene in (("hybrid", sea.scene), ("spheres", sea_sphere_tracing.scene)):
        scene.render(size=SIZE, threads=THREADS)
        times = []
        for time in TIMES:
            begin = clock.perf_counter()
            scene.render(size=SIZE, time=time, threads=THREADS)
            times.append((clock.perf_counter() - begin) * 1e3)
        print(f"picture by {name:8} {statistics.median(times):8.1f} ms")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    marches()
    pictures()
    normals(options.rounds)


if __name__ == "__main__":
    main()
