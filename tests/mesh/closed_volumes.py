"""Random solids whose volumes have closed forms, for tests and sweeps of ``measure``.

    python -m tests.mesh.closed_volumes 400 7    # so many solids, from this seed

prints the largest deviation over stated error of each kind, and fails if one is more than 1.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal import (
    Box,
    CappedCone,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Octahedron,
    Polygon,
    Prism,
    Sphere,
    Torus,
    union,
)

BALL = 4.0 / 3.0 * math.pi


@dataclass(frozen=True)
class Closed:
    """A solid with its volume, and its area and center of mass where they are simple."""

    kind: str
    shape: Any
    volume: float
    area: float | None = None
    center: tuple[float, float, float] | None = None


class Dice:
    """Random numbers of one solid."""

    def __init__(self, seed: int, number: int) -> None:
        self.rng = np.random.default_rng((seed, number))

    def __call__(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def whole(self, low: int, high: int) -> int:
        return int(self.rng.integers(low, high + 1))

    def turned(self, shape: Any) -> Any:
        """Turn a shape, or leave it along the axes."""
        if self.whole(0, 3) == 0:
            return shape
        return shape.rotate(x=self(0, 3), y=self(0, 3), z=self(0, 3))

    def placed(self, shape: Any) -> Any:
        """Turn a shape and move it a little."""
        return self.turned(shape).translate(self(-1, 1), self(-1, 1), self(-1, 1))


def ball(d: Dice) -> tuple[Any, float, float]:
    r = d(0.3, 1.5)
    return Sphere(r), BALL * r**3, 4 * math.pi * r * r


def block(d: Dice) -> tuple[Any, float, float]:
    a, b, c = d(0.3, 2), d(0.3, 2), d(0.3, 2)
    return Box(a, b, c), a * b * c, 2 * (a * b + b * c + c * a)


def rod(d: Dice) -> tuple[Any, float, float]:
    r, h = d(0.2, 1), d(0.3, 2)
    return Cylinder(r, h), math.pi * r * r * h, 2 * math.pi * r * (r + h)


def spike(d: Dice) -> tuple[Any, float, float]:
    r, h = d(0.3, 1), d(0.3, 2)
    return Cone(r, h), math.pi * r * r * h / 3, math.pi * r * (r + math.hypot(r, h))


def frustum(d: Dice) -> tuple[Any, float, float]:
    a, b, h = d(0.3, 1), d(0.1, 1), d(0.3, 2)
    side = math.pi * (a + b) * math.hypot(a - b, h)
    volume = math.pi * h * (a * a + a * b + b * b) / 3
    return CappedCone(a, b, h), volume, side + math.pi * (a * a + b * b)


def ring(d: Dice) -> tuple[Any, float, float]:
    major = d(0.6, 1.5)
    minor = major * d(0.08, 0.6)
    return (
        Torus(major, minor),
        2 * math.pi**2 * major * minor**2,
        4 * math.pi**2 * major * minor,
    )


def pill(d: Dice) -> tuple[Any, float, float]:
    r, h = d(0.2, 0.8), d(0.3, 2)
    # ``height`` is the distance of the centers of the balls at the ends.
    return (
        Capsule(r, h),
        BALL * r**3 + math.pi * r * r * h,
        4 * math.pi * r * r + 2 * math.pi * r * h,
    )


def egg(d: Dice) -> tuple[Any, float, None]:
    a, b, c = d(0.3, 1.2), d(0.3, 1.2), d(0.3, 1.2)
    return Ellipsoid((a, b, c)), BALL * a * b * c, None


def hexagon(d: Dice) -> tuple[Any, float, float]:
    n, inradius, h = d.whole(3, 9), d(0.2, 1), d(0.3, 2)
    side = 2 * inradius * math.tan(math.pi / n)
    face = n * side * inradius / 2
    return Prism(inradius, h, count=n), face * h, 2 * face + n * side * h


def diamond(d: Dice) -> tuple[Any, float, float]:
    r = d(0.3, 1.5)
    return Octahedron(r), BALL / math.pi * r**3, 4 * math.sqrt(3) * r * r


def star(d: Dice) -> tuple[Any, float, float]:
    n, h = d.whole(3, 12), d(0.2, 1.5)
    angles = np.sort(np.arange(n) + d.rng.uniform(0.1, 0.9, n)) * 2 * np.pi / n
    if n < 5:
        angles = np.arange(n) * 2 * np.pi / n
    radii = d.rng.uniform(0.5, 1.3, n)
    points = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    after = np.roll(points, -1, axis=0)
    face = 0.5 * float((points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]).sum())
    around = float(np.linalg.norm(after - points, axis=1).sum())
    shape = Polygon([tuple(p) for p in points.tolist()]).extrude(h)
    return shape, face * h, 2 * face + around * h


def shell(d: Dice) -> tuple[Any, float, float]:
    r = d(0.5, 1.5)
    s = r * d(0.4, 0.97)
    return Sphere(r) - Sphere(s), BALL * (r**3 - s**3), 4 * math.pi * (r * r + s * s)


def hollow_box(d: Dice) -> tuple[Any, float, float]:
    a, b, c = d(0.8, 2), d(0.8, 2), d(0.8, 2)
    w = d(0.03, 0.3)
    inner = (a - 2 * w, b - 2 * w, c - 2 * w)
    area = 2 * (a * b + b * c + c * a)
    area += 2 * (inner[0] * inner[1] + inner[1] * inner[2] + inner[2] * inner[0])
    return Box(a, b, c) - Box(*inner), a * b * c - math.prod(inner), area


def tube(d: Dice) -> tuple[Any, float, float]:
    r, h = d(0.4, 1), d(0.3, 2)
    s = r * d(0.1, 0.95)
    area = 2 * math.pi * (r + s) * h + 2 * math.pi * (r * r - s * s)
    return Cylinder(r, h) - Cylinder(s, 2 * h), math.pi * (r * r - s * s) * h, area


def plate_with_bores(d: Dice) -> tuple[Any, float, None]:
    nx, nz, thick = d.whole(1, 6), d.whole(1, 4), d(0.1, 0.6)
    shape, volume = Box(nx, thick, nz), nx * thick * nz
    bores = []
    for i in range(nx):
        for j in range(nz):
            r = d(0.02, 0.4)
            x, z = i + 0.5 - nx / 2, j + 0.5 - nz / 2
            bores.append(Cylinder(r, 2 * thick).translate(x, 0, z))
            volume -= math.pi * r * r * thick
    return shape - union(*bores), volume, None


def pocketed(d: Dice) -> tuple[Any, float, None]:
    a, b, c = d(1, 2), d(1, 2), d(1, 2)
    r = d(0.1, 0.45) * min(a, b, c)
    return (
        Box(a, b, c) - Sphere(r).translate(a / 2, 0, 0),
        a * b * c - BALL * r**3 / 2,
        None,
    )


def stepped_shaft(d: Dice) -> tuple[Any, float, None]:
    parts, volume, y = [], 0.0, 0.0
    for _ in range(d.whole(2, 6)):
        r, h = d(0.1, 1), d(0.1, 1.5)
        parts.append(Cylinder(r, h).translate(y=y + h / 2))
        volume += math.pi * r * r * h
        y += h
    return union(*parts), volume, None


def socket_screw(d: Dice) -> tuple[Any, float, None]:
    r, length = d(0.2, 0.5), d(1, 4)
    head, high = r * d(1.4, 2), r * d(1, 2)
    across, deep = head * d(0.3, 0.6), high * d(0.3, 0.7)
    hexagon = Prism(across, 2 * deep, count=6)
    # A prism stands along y or z: its own box says which.
    low, top = hexagon.bounds()
    axis = int(np.argmin([abs(t - b - 2 * deep) for b, t in zip(low, top, strict=True)]))
    if axis == 2:
        hexagon = hexagon.rotate(x=math.pi / 2)
    shape = Cylinder(head, high).translate(y=high / 2) - hexagon.translate(y=high)
    shape |= Cylinder(r, length).translate(y=-length / 2)
    socket = 6 * across**2 * math.tan(math.pi / 6) * deep
    return shape, math.pi * (head**2 * high + r * r * length) - socket, None


def lens(d: Dice) -> tuple[Any, float, None]:
    r, apart = d(0.5, 1.5), d(0.2, 1.6)
    apart *= r
    volume = math.pi * (4 * r + apart) * (2 * r - apart) ** 2 / 12
    return Sphere(r).translate(x=-apart / 2) & Sphere(r).translate(x=apart / 2), volume, None


def crossed_rods(d: Dice) -> tuple[Any, float, None]:
    r = d(0.3, 1)
    return Cylinder(r, 4 * r) & Cylinder(r, 4 * r).rotate(x=math.pi / 2), 16 / 3 * r**3, None


def cap(d: Dice) -> tuple[Any, float, None]:
    r = d(0.5, 1.5)
    h = r * d(0.1, 1.9)
    cut = Box(4 * r, 4 * r, 4 * r).translate(y=3 * r - h)
    return Sphere(r) & cut, math.pi * h * h * (3 * r - h) / 3, None


def balls_in_wide_box(d: Dice) -> tuple[Any, float, float]:
    n, r, wide = d.whole(5, 40), d(0.02, 0.2), d(10, 60)
    places: list[Any] = []
    while len(places) < n:
        p = d.rng.uniform(-wide / 2, wide / 2, 3)
        if all(np.linalg.norm(p - q) > 2.2 * r for q in places):
            places.append(p)
    shape = union(*(Sphere(r).translate(*map(float, p)) for p in places))
    return shape, n * BALL * r**3, n * 4 * math.pi * r * r


def grid(d: Dice) -> tuple[Any, float, float]:
    n, r, apart = d.whole(3, 7), d(0.05, 0.3), d(1, 3)
    return (
        Sphere(r).repeat(apart, apart, apart, count=(n, n, 1)),
        n * n * BALL * r**3,
        n * n * 4 * math.pi * r * r,
    )


def fins(d: Dice) -> tuple[Any, float, None]:
    n, thick, high = d.whole(2, 9), d(0.02, 0.3), d(0.5, 2)
    base = Box(n, 0.4, 1.5)
    parts = [Box(thick, high, 1.5).translate(i + 0.5 - n / 2, 0.2 + high / 2, 0) for i in range(n)]
    return union(base, *parts), n * 0.4 * 1.5 + n * thick * high * 1.5, None


SIMPLE = (ball, block, rod, spike, frustum, ring, pill, egg, hexagon, diamond, star)


def apart(d: Dice) -> tuple[Any, float, float | None]:
    """Several simple solids beside each other."""
    parts, volume, area, x = [], 0.0, 0.0, 0.0
    for _ in range(d.whole(2, 5)):
        shape, part, skin = SIMPLE[d.whole(0, len(SIMPLE) - 1)](d)
        size = d(0.2, 1.0)
        low, high = shape.bounds()
        reach = math.sqrt(sum(max(abs(a), abs(b)) ** 2 for a, b in zip(low, high, strict=True)))
        x += size * reach
        parts.append(d.turned(shape).scale(size).translate(x, d(-1, 1), d(-1, 1)))
        x += size * reach + d(0.1, 1)
        volume += part * size**3
        area = math.nan if skin is None else area + skin * size * size
    return union(*parts), volume, None if math.isnan(area) else area


KINDS: dict[str, Callable[[Dice], tuple[Any, float, float | None]]] = {
    make.__name__: make
    for make in (
        *SIMPLE,
        *(shell, hollow_box, tube, plate_with_bores, pocketed, stepped_shaft, socket_screw),
        *(lens, crossed_rods, cap, balls_in_wide_box, grid, fins, apart),
    )
}


def solid(number: int, seed: int = 0) -> Closed:
    """Return one of the random solids: kinds take turns, sizes and places are drawn."""
    d = Dice(seed, number)
    kind = list(KINDS)[number % len(KINDS)]
    shape, volume, area = KINDS[kind](d)
    shape = d.placed(shape)
    name = kind
    if d.whole(0, 3) == 0:
        size = 10.0 ** d(-5, 5)
        shape, volume = shape.scale(size), volume * size**3
        area = None if area is None else area * size**2
        name += f" of size {size:.2g}"
    elif d.whole(0, 4) == 0:
        far = 10.0 ** d(1, 4)
        shape = shape.translate(far, -far * d(0, 1), far * d(0, 1))
        name += f" at {far:.2g}"
    return Closed(name, shape, volume, area)


def deviations(found: Any, closed: Closed) -> Iterator[tuple[str, float]]:
    """Yield by how many of its errors each measure is off."""
    for name in ("volume", "area"):
        true = getattr(closed, name)
        if true is not None:
            quantity = getattr(found, name)
            # The closed form is rounded, too.
            yield name, abs(quantity.value - true) / (quantity.error + 1e-15 * abs(true))


def main(count: int, seed: int) -> int:
    """Measure so many solids; return how many measures are outside their errors."""
    bad = 0
    worst: dict[tuple[str, str], tuple[float, int]] = {}
    for number in range(count):
        closed = solid(number, seed)
        begin = time.process_time()
        found = closed.shape.measure()
        spent = time.process_time() - begin
        for name, off in deviations(found, closed):
            key = closed.kind.split()[0], name
            worst[key] = max(worst.get(key, (-1.0, 0)), (off, number))
            if not off <= 1.0:
                bad += 1
                true = getattr(closed, name)
                got = getattr(found, name)
                print(
                    f"{number} {closed.kind}: {name} {got.value:.9g} ± {got.error:.3g} is off by "
                    f"{off:.3g} errors of {true:.9g}, after {spent:.2g} s; {found.how}",
                    flush=True,
                )
    for (kind, name), (off, number) in sorted(worst.items(), key=lambda each: each[1][0]):
        print(f"{kind:<18} {name:<7} {off:.3g} (number {number})")
    print(f"{count} solids, seed {seed}: {bad} measures are outside their errors")
    return bad


if __name__ == "__main__":
    given = [int(text) for text in sys.argv[1:3]]
    sys.exit(main(*(given + [400, 0][len(given) :])) > 0)
