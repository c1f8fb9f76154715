"""Random solids with narrow bores, slots, walls, ribs, floors and gaps, whose topology is known.

Input: the name of a kind and a seed. Output: a solid, and how many closed surfaces and handles its
mesh must have. Sizes are from a twentieth of the default cell to two of it; most solids are turned.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal import Box, Cylinder, Sphere, union

CELL: Final = 200.0 / 24.0  # of a plate with sides of 200


@dataclass(frozen=True, slots=True)
class NarrowSolid:
    """A solid with a known topology.

    Attributes:
        shape: The solid.
        surfaces: How many closed surfaces it has.
        handles: How many handles these have together.
    """

    shape: Any
    surfaces: int
    handles: int


def topology_of(made: Any) -> tuple[int, int]:
    """Return how many closed surfaces a mesh has, and how many handles these have together."""
    triangles, count = np.asarray(made.triangles), len(made.points)
    label = np.arange(count)
    edges = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    while True:
        least = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        following = label.copy()
        np.minimum.at(following, edges[:, 0], least)
        np.minimum.at(following, edges[:, 1], least)
        following = following[following]
        if (following == label).all():
            break
        label = following
    surfaces = len(np.unique(label))
    euler = count - len(triangles) // 2  # a closed mesh has 3/2 edges for each triangle
    return surfaces, surfaces - euler // 2


class Sizes:
    """Random sizes, turns and places."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def even(self, low: float, high: float) -> float:
        """A number between two."""
        return float(self.rng.uniform(low, high))

    def scaled(self, low: float, high: float) -> float:
        """A number between two, each share of it as likely."""
        return math.exp(self.even(math.log(low), math.log(high)))

    def whole(self, low: int, high: int) -> int:
        """A whole number from one to below another."""
        return int(self.rng.integers(low, high))

    def turned(self, shape: Any) -> Any:
        """A shape, most often turned."""
        if self.rng.random() < 0.4:
            return shape
        x, y, z = (self.even(-1.0, 1.0) for _ in range(3))
        return shape.rotate(x=x).rotate(y=y).rotate(z=z)


def plate(sizes: Sizes) -> NarrowSolid:
    """A plate with bores, slots and pockets, some tilted, some near its edge."""
    thick = sizes.even(3.0, 14.0)
    cut: list[Any] = []
    places: list[tuple[Any, float]] = []
    handles = 0
    for _ in range(sizes.whole(1, 5)):
        width = CELL * sizes.scaled(1.0 / 20.0, 2.0)
        tilt = sizes.even(-0.6, 0.6) if sizes.rng.random() < 0.5 else 0.0
        reach = width * 2.2 + thick * abs(math.tan(tilt)) + 0.3
        place = _free(sizes, places, reach, 100.0 - reach / 2.0 - width * 0.7)
        if place is None:
            continue
        places.append((place, reach))
        x, z = (float(number) for number in place)
        kind, turn = sizes.whole(0, 4), sizes.even(0.0, 3.0)
        if kind == 0:
            tool = Cylinder(width / 2.0, 60.0).rotate(x=tilt)
        elif kind == 1:
            tool = Box(2.0 * width, 60.0, width * 0.8).rotate(y=turn).rotate(x=tilt)
        elif kind == 2:
            tool = Cylinder(width / 2.0, thick).translate(y=thick * 0.5)
        else:
            tool = Box(width, thick, width).rotate(y=turn).translate(y=thick * 0.45)
        handles += kind < 2
        cut.append(tool.translate(x, 0.0, z))
    return NarrowSolid(Box(200, thick, 200) - union(*cut), 1, handles)


def _free(sizes: Sizes, places: list[tuple[Any, float]], reach: float, end: float) -> Any:
    for _ in range(50):
        place = sizes.rng.uniform(-98.0, 98.0, 2)
        apart = all(np.hypot(*(place - other)) > reach + r for other, r in places)
        if apart and max(abs(place)) < end:
            return place
    return None


def array(sizes: Sizes) -> NarrowSolid:
    """A plate with an array of bores."""
    apart = sizes.scaled(10.0, 40.0)
    count = int(min(12, 180 // apart))
    width = sizes.scaled(0.4, 0.8 * apart)
    bores = Cylinder(width / 2.0, 30.0).repeat(apart, 60.0, apart, count=(count, 1, count))
    return NarrowSolid(sizes.turned(Box(200, 8, 200) - bores), 1, count * count)


def cut_array(sizes: Sizes) -> NarrowSolid:
    """A plate with those of an array of slots that a box does not take away."""
    apart = sizes.scaled(12.0, 40.0)
    count = int(min(8, 150 // apart))
    width = sizes.scaled(0.6, 0.4 * apart)
    slots = Box(width, 30.0, min(2.0 * width, 0.8 * apart))
    slots = slots.repeat(apart, 60.0, apart, count=(count, 1, count))
    middles = (np.arange(count) - (count - 1) / 2.0) * apart
    side = float(middles[0]) + apart / 2.0  # between the first column and the second
    kept = int((middles > side).sum()) * count
    cut = slots - Box(200, 60, 400).translate(side - 100.0, 0, 0)
    return NarrowSolid(sizes.turned(Box(200, 8, 200) - cut), 1, kept)


def walls(sizes: Sizes) -> NarrowSolid:
    """A plate with openings, and thin walls between them."""
    count = sizes.whole(2, 6)
    width, wall = sizes.scaled(1.0, 12.0), sizes.scaled(0.08, 3.0)
    apart = width + wall
    cut = [
        Box(width, 40, width * 1.3).translate((i - (count - 1) / 2.0) * apart + 0.123, 0, 0.37)
        for i in range(count)
    ]
    return NarrowSolid(sizes.turned(Box(100, 8, 100) - union(*cut)), 1, count)


def ribs(sizes: Sizes) -> NarrowSolid:
    """A plate with ribs."""
    thick = sizes.scaled(0.3, 3.0)
    some = [Box(thick, 20, 60).translate(-40 + 17.3 * i, 11, 0) for i in range(sizes.whole(1, 5))]
    return NarrowSolid(sizes.turned(union(Box(100, 4, 60), *some)), 1, 0)


def gap(sizes: Sizes) -> NarrowSolid:
    """Two boxes with a gap between them."""
    apart = sizes.scaled(0.08, 3.0)
    both = Box(40, 20, 40) | Box(30, 20, 30).translate(1.3, 20 + apart, 2.1)
    return NarrowSolid(sizes.turned(both), 2, 0)


def floor(sizes: Sizes) -> NarrowSolid:
    """A plate with a pocket that leaves a thin floor."""
    thick, width = sizes.scaled(0.1, 2.0), sizes.even(5.0, 40.0)
    pocket = Box(width, 10, width)
    pocket = pocket.translate(sizes.even(-20, 20), thick, sizes.even(-20, 20))
    return NarrowSolid(sizes.turned(Box(100, 10, 100) - pocket), 1, 0)


def tube(sizes: Sizes) -> NarrowSolid:
    """A tube with a thin wall."""
    radius, wall = sizes.even(2.0, 40.0), sizes.scaled(0.15, 1.5)
    bore = Cylinder(radius - min(wall, radius * 0.5), 80)
    return NarrowSolid(sizes.turned(Cylinder(radius, 60) - bore), 1, 1)


def struts(sizes: Sizes) -> NarrowSolid:
    """A lattice of rods with balls at its nodes."""
    count, radius, side = sizes.whole(2, 4), sizes.scaled(0.15, 1.0), 20.0
    long, half = (count - 1) * side, (count - 1) * side / 2.0
    parts: list[Any] = []
    for i in range(count):
        for j in range(count):
            rod = Cylinder(radius, long)
            parts.append(rod.translate(i * side, half, j * side))
            parts.append(rod.rotate(z=math.pi / 2).translate(half, i * side, j * side))
            parts.append(rod.rotate(x=math.pi / 2).translate(i * side, j * side, half))
            for k in range(count):
                parts.append(Sphere(1.5 * radius).translate(i * side, j * side, k * side))
    handles = 3 * count * count * (count - 1) - count**3 + 1
    return NarrowSolid(sizes.turned(union(*parts)), 1, handles)


def edge_bore(sizes: Sizes) -> NarrowSolid:
    """A plate with a bore that a thin wall parts from its side."""
    radius, wall = sizes.scaled(0.3, 4.0), sizes.scaled(0.1, 2.0)
    bore = Cylinder(radius, 40).translate(100.0 - radius - wall, 0, sizes.even(-60, 60))
    return NarrowSolid(sizes.turned(Box(200, 8, 200) - bore), 1, 1)


def void(sizes: Sizes) -> NarrowSolid:
    """A ball with a hollow under a thin skin."""
    radius, skin = sizes.even(5.0, 20.0), sizes.scaled(0.1, 1.5)
    return NarrowSolid(sizes.turned(Sphere(radius) - Sphere(radius - skin)), 2, 0)


KINDS: Final[dict[str, Callable[[Sizes], NarrowSolid]]] = {
    make.__name__: make
    for make in (
        plate,
        array,
        cut_array,
        walls,
        ribs,
        gap,
        floor,
        tube,
        struts,
        edge_bore,
        void,
    )
}


def narrow_solid(kind: str, seed: int) -> NarrowSolid:
    """Return a random solid of a kind."""
    return KINDS[kind](Sizes(seed))
