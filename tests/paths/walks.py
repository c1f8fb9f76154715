"""Random walks of rays that cross surfaces or are thrown back, held against closed forms.

A leak is a ray on the wrong side of a surface: somewhere on a segment the closed form, in doubles,
says that the point is on the other side, by more than a few rounding errors of its coordinates.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.fields.guarantees import UNBOUNDED, Bounds
from distal.lang import func, vec3
from distal.render.camera import Ray
from distal.render.closed_hits import Reached, covered, entered, segment_of_solids
from distal.render.march import OUT_OF_STEPS, Hit, March
from distal.render.segment import Landing, landing, segment
from distal.render.settings import grown_bounds
from tests.paths.solids import Solid

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]

STEPS = 256
FAR = 1000.0
BOUNCES = 24
# A place is known to half a unit in the last place of each coordinate, and a value of a field to a
# few times that; 2.8 units are the most that were found in 1e7 segments.
ALLOWED = 8.0
UNIT = 2.0**-23


@dataclass
class Count:
    """What a walk met.

    Attributes:
        segments: How many segments were followed.
        leaks: How many of them were on the wrong side of a surface.
        exhausted: How many ran out of steps.
        steps: Evaluations of the field in all of them.
        wrong: The largest depth on the wrong side, in units of the last place.
        off: The largest distance of a hit from the surface, likewise.
    """

    segments: int = 0
    leaks: int = 0
    exhausted: int = 0
    steps: int = 0
    wrong: float = 0.0
    off: float = 0.0

    def __add__(self, other: Count) -> Count:
        """Return what both met."""
        return Count(
            self.segments + other.segments,
            self.leaks + other.leaks,
            self.exhausted + other.exhausted,
            self.steps + other.steps,
            max(self.wrong, other.wrong),
            max(self.off, other.off),
        )


def programs(solid: Solid, steps: int = STEPS) -> tuple[Any, Any]:
    """The segment from a place, and the place on the surface at its end, as scene code."""
    field, divisor = solid.field, solid.divisor
    x, y, z = solid.half

    @func
    def shot(
        origin: vec3, direction: vec3, center: vec3, side: float, slope: float, part: int
    ) -> Hit:
        """The next crossing."""
        half = vec3(x, y, z)
        bounds = grown_bounds(Bounds(center - half, center + half))
        numbers = March(divisor, 0.0, FAR, 0.0)
        ray = Ray(origin, direction)
        return segment(lambda p: field(p - center), ray, side, slope, bounds, numbers, steps)

    @func
    def of_all(p: vec3, part: int) -> float:
        """The field of the solid."""
        return field(p)

    return shot, landing_in(of_all)


def closed_programs(parts: Any) -> tuple[Any, Any]:
    """As ``programs``, of two solids: the field and the chord of each."""
    (first_field, first_chord), (second_field, second_chord) = parts

    @func
    def shot(
        origin: vec3, direction: vec3, center: vec3, side: float, slope: float, part: int
    ) -> Hit:
        """The next crossing."""
        ray = Ray(origin, direction)
        first = first_chord(origin - center, direction)
        second = second_chord(origin - center, direction)
        entry = entered(Reached(UNBOUNDED, -1), first, -2, part, 0.0, ray)
        entry = entered(entry, second, -3, part, 0.0, ray)

        def covers(reached: Reached) -> Reached:
            return covered(covered(reached, first, -2, part, ray), second, -3, part, ray)

        return segment_of_solids(entry, covers, side, part, 0.0, FAR, 2)

    @func
    def of_one(p: vec3, part: int) -> float:
        """The field of a part."""
        return second_field(p) if part == -3 else first_field(p)

    return shot, landing_in(of_one)


def landing_in(field: Any) -> Any:
    """The place on the surface at the end of a segment, as scene code."""

    @func
    def landed(
        origin: vec3, direction: vec3, center: vec3, side: float, t: float, part: int
    ) -> Landing:
        """The place there."""
        hit = Hit(t, True, 0, side)
        return landing(lambda p: field(p - center, part), Ray(origin, direction), hit)

    return landed


def unit(v: NDArray[Any]) -> Doubles:
    """Vectors at length 1."""
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True), float)


def onward(n: Doubles, side: Floats, grazing: float, rng: np.random.Generator) -> Doubles:
    """Directions on a side of a surface by the cosine; a share of them within .001 of it."""
    about = n * side[:, None]
    scattered = unit(about + 0.999999 * unit(rng.normal(size=n.shape)))
    flat = scattered - n * (scattered * n).sum(axis=1)[:, None]
    low = unit(flat + about * (1e-3 * rng.random(len(n)))[:, None])
    return np.where((rng.random(len(n)) < grazing)[:, None], low, scattered)


def first_rays(
    solid: Solid, center: Floats, count: int, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Rays from all sides towards the solid."""
    half = 1.1 * np.minimum(np.array(solid.half), 1.2)
    target = center + rng.uniform(-half, half, (count, 3))
    origin = center + 4.0 * unit(rng.normal(size=(count, 3)))
    outside = solid.truth(origin - center) > 0.0
    origin, target = origin[outside].astype(np.float32), target[outside]
    return origin, unit(target - origin).astype(np.float32)


def depth_behind(
    solid: Solid, segments: tuple[Floats, Floats, Floats, Floats], t: Doubles, fraction: Any
) -> Any:
    """How deep a point of each segment is on its wrong side, in units of the last place."""
    origin, direction, center, side = segments
    along = np.minimum(t, 8.0) * fraction
    place = origin.astype(float) + direction.astype(float) * along[:, None]
    value = solid.truth(place - center.astype(float)) * side / solid.divisor
    return -value / (UNIT * (np.abs(place).sum(axis=1) + along))


def walk(
    solid: Solid,
    center: Any,
    paths: int,
    *,
    grazing: float = 0.2,
    seed: int = 0,
    made: tuple[Any, Any] | None = None,
) -> Count:
    """Follow paths that cross each surface or are thrown back, half of them each."""
    shot, landed = made or programs(solid)
    rng = np.random.default_rng(seed)
    middle = np.asarray(center, np.float32)
    origin, direction = first_rays(solid, middle, paths, rng)
    side, slope = np.ones(len(origin), np.float32), np.zeros(len(origin), np.float32)
    part = np.full(len(origin), -1, np.int32)
    count = Count()
    for _ in range(BOUNCES):
        if len(origin) == 0:
            break
        centers = np.broadcast_to(middle, origin.shape)
        hit = shot(origin, direction, centers, side, slope, part)
        # A segment that ends where it begins, at the edge of two solids, is on no side.
        whole = (hit.lost != OUT_OF_STEPS) & (hit.t > 0.0)
        t = hit.t.astype(float)
        segments = (origin, direction, middle, side)
        wrong = np.zeros(len(t))
        for fraction in (0.03, 0.2, 0.5, 0.8, 0.97, rng.random(len(t))):
            behind = depth_behind(solid, segments, t, fraction)
            wrong = np.maximum(wrong, np.where(whole, behind, 0.0))
        found = hit.found
        count.segments += len(t)
        count.exhausted += int((hit.lost == OUT_OF_STEPS).sum())
        count.steps += int(hit.steps.sum())
        count.leaks += int((wrong > ALLOWED).sum())
        count.wrong = max(count.wrong, float(wrong.max()))
        off = np.abs(depth_behind(solid, segments, t, 1.0))[found & (t < 8.0)]
        count.off = max(count.off, float(off.max(initial=0.0)))
        origin, direction, side = origin[found], direction[found], side[found]
        part = np.asarray(hit.part, np.int32)[found]
        if len(origin) == 0:
            break
        place = landed(origin, direction, centers[found], side, hit.t[found], part)
        n = np.asarray(place.n, float)
        crosses = rng.random(len(n)) < 0.5
        side = np.where(crosses, -side, side).astype(np.float32)
        origin = np.asarray(place.p, np.float32)
        direction = onward(n, side, grazing, rng).astype(np.float32)
        leaves = (direction * n).sum(axis=1) * side * place.slope
        slope = np.maximum(leaves, 1e-9).astype(np.float32)
    return count


def fresnel(cosine: Doubles, eta: Doubles) -> Any:
    """The mirrored share, and the cosine beyond; ``eta`` is the index before by that beyond."""
    sine2 = (1.0 - cosine**2) * eta**2
    beyond = np.sqrt(np.maximum(1.0 - sine2, 0.0))
    across = (eta * cosine - beyond) / (eta * cosine + beyond)
    parallel = (cosine - eta * beyond) / (cosine + eta * beyond)
    return np.where(sine2 >= 1.0, 1.0, 0.5 * (across**2 + parallel**2)), beyond


def through_glass(
    solid: Solid, origin: Floats, direction: Floats, ior: float, rng: np.random.Generator
) -> Iterator[tuple[Any, Floats, Floats]]:
    """Each segment's hits, directions and sides of paths through glass, one share at a time."""
    shot, landed = programs(solid)
    side, slope = np.ones(len(origin), np.float32), np.zeros(len(origin), np.float32)
    while len(origin):
        centers = np.zeros_like(origin)
        hit = shot(origin, direction, centers, side, slope, np.full(len(origin), -1, np.int32))
        yield hit, direction, side
        found = hit.found
        origin, direction, side = origin[found], direction[found], side[found]
        if len(origin) == 0:
            return
        part = np.asarray(hit.part, np.int32)[found]
        place = landed(origin, direction, centers[found], side, hit.t[found], part)
        n = np.asarray(place.n, float) * side[:, None]
        before = direction.astype(float)
        cosine = -(before * n).sum(axis=1)
        eta = np.where(side > 0.0, 1.0 / ior, ior)
        mirrored, beyond = fresnel(cosine, eta)
        thrown = before + 2.0 * n * cosine[:, None]
        bent = before * eta[:, None] + n * (eta * cosine - beyond)[:, None]
        back = rng.random(len(n)) < mirrored
        direction = unit(np.where(back[:, None], thrown, bent)).astype(np.float32)
        side = np.where(back, side, -side).astype(np.float32)
        slope = np.abs((direction * n).sum(axis=1) * place.slope).astype(np.float32)
        origin = np.asarray(place.p, np.float32)
