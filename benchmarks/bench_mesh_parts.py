"""Whole meshes of narrow parts: triangles, and processor seconds of a first and a further mesh.

Only public calls are used, so that an earlier checkout can be measured in the same run:

    python benchmarks/bench_mesh_parts.py
    PYTHONPATH=other/src python benchmarks/bench_mesh_parts.py

The processor's time is that of all threads, because the machine may be shared.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable
from typing import Any, Final

import numpy as np

from distal import Bolt, Box, Cylinder, Shape, Text, union

FURTHER: Final = 3
BORE: Final = Cylinder(1.7, 40.0)
PLATE: Final = Box(200.0, 10.0, 200.0)


def bores(count: int) -> Shape:
    """Return a plate with so many bores at random places."""
    places = np.random.default_rng(1).uniform(-90.0, 90.0, (count, 2)).tolist()
    return PLATE - union(*(BORE.translate(x, 0.0, z) for x, z in places))


def rows_of_bores(count: int) -> Shape:
    """Return a plate with so many bores in rows of 15."""
    places = [(13.0 * (n // 15) - 90.0, 13.0 * (n % 15) - 90.0) for n in range(count)]
    return PLATE - union(*(BORE.translate(x, 0.0, z) for x, z in places))


def fins() -> Shape:
    """Return nine thin fins on a base."""
    fin = Box(0.6, 20.0, 60.0)
    base = Box(60.0, 6.0, 60.0).translate(0.0, -10.0, 0.0)
    return union(base, *(fin.translate(6.0 * n - 24.0, 0.0, 0.0) for n in range(9)))


def struts() -> Shape:
    """Return a lattice of upright and lying rods."""
    rod = Cylinder(1.0, 40.0)
    lying = rod.rotate(x=0.5 * math.pi)
    places = [(10.0 * i - 15.0, 10.0 * j - 15.0) for i in range(4) for j in range(4)]
    upright = (rod.translate(x, 0.0, z) for x, z in places)
    return union(*upright, *(lying.translate(x, y, 0.0) for x, y in places))


def text() -> Shape:
    """Return raised letters on a plate."""
    letters = Text("distal").scale(8.0).extrude(3.0).rotate(x=-0.5 * math.pi)
    return Box(60.0, 4.0, 20.0) | letters.translate(0.0, 2.5, 0.0)


PARTS: Final[dict[str, Callable[[], Any]]] = {
    "plate, 1 bore": lambda: PLATE - BORE.translate(2.2, 0.0, 81.0),
    "plate, 24 bores": lambda: bores(24),
    "plate, 200 bores": lambda: rows_of_bores(200),
    "array of 225 bores": lambda: (
        PLATE - Cylinder(2.0, 40.0).repeat(13.0, 0.0, 13.0, count=(15, 1, 15))
    ),
    "9 fins of .6": fins,
    "32 struts": struts,
    "raised text": text,
    "gap of .3": lambda: Box(20.0) | Box(20.0).translate(20.3, 0.0, 0.0),
    "M5 bolt": lambda: Bolt("M5", 25.0),
    "slot of 1.2": lambda: PLATE - Box(1.2, 40.0, 60.0),
}


def main() -> None:
    """Print a row for each part."""
    warnings.simplefilter("ignore")
    for name, part in PARTS.items():
        shape = part()
        seconds = []
        for _ in range(1 + FURTHER):
            begin = time.process_time()
            mesh = shape.mesh()
            seconds.append(time.process_time() - begin)
        first, *further = seconds
        count = len(mesh.triangles)
        print(
            f"{name:20} {count:7,} triangles  first {first:6.2f} s  further {min(further):6.3f} s"
        )


if __name__ == "__main__":
    main()
