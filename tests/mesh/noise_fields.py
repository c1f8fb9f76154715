"""Fields for meshing that are as bad as fields can be, and lattices over them."""

from __future__ import annotations

from typing import Any

import numpy as np

from distal import Shape
from distal.lang import floor, fract, func, max, mix, sin, vec3
from distal.mesh.bricks import Slopes
from distal.mesh.extract import Extent, Extracted, extracted
from distal.mesh.kernels import FieldKernels


@func
def random_value(cell: vec3, seed: float) -> float:
    """A number between -1 and 1 for a lattice point."""
    mixed = cell.x * 127.1 + cell.y * 311.7 + cell.z * 74.7 + seed * 53.3
    return 2.0 * fract(sin(mixed) * 43758.5453) - 1.0


@func
def lattice_noise(p: vec3, seed: float = 1.0, size: float = 0.07, level: float = 0.0) -> float:
    """Trilinear noise whose cells are about as large as those of the mesh, within a ball."""
    q = p / size
    cell = floor(q)
    t = q - cell
    total = 0.0
    for i in range(8):
        bit = vec3(float(i % 2), float(i // 2 % 2), float(i // 4))
        weight = mix(1.0 - t.x, t.x, bit.x) * mix(1.0 - t.y, t.y, bit.y)
        total += random_value(cell + bit, seed) * weight * mix(1.0 - t.z, t.z, bit.z)
    ball = (p.x * p.x + p.y * p.y + p.z * p.z) / 0.16 - 1.0
    return total + level if ball < 0.0 else max(total + level, ball)


@func
def all_or_nothing(p: vec3, seed: float = 1.0, size: float = 0.07) -> float:
    """Values without a slope: each small cube is inside or outside."""
    value = random_value(floor(p / size), seed)
    ball = (p.x * p.x + p.y * p.y + p.z * p.z) / 0.16 - 1.0
    return max(value, ball)


def noise(kind: str, seed: int, size: float, slope: float) -> Any:
    box = ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    made = {"linear": lattice_noise, "cubes": all_or_nothing}[kind]
    return Shape.from_function(made, seed=float(seed), size=size, slope=slope, bounds=box)


def at_spacing(shape: Any, step: float, tolerance: float = 1.0) -> Extracted:
    """The mesh of a shape at one spacing."""
    low, high = (np.array(corner) for corner in shape.bounds())
    extent = Extent(low, high, Slopes(shape.slope, shape.divisor))
    kernels = FieldKernels(shape.node, {}, 0.0)
    found = extracted(kernels, extent, step, tolerance, 100_000, lambda share: None)
    assert isinstance(found, Extracted)
    return found
