"""Each declared width finds its shape: cells of this side have the topology of much finer ones."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

from distal import Box
from distal.fields.guarantees import OPERATORS, PRIMITIVES
from distal.mesh.bricks import surface_bricks
from distal.mesh.extract import Extent
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import Lattice, keys_of
from distal.mesh.leaf_fields import LeafFields
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.topology import topology_of
from tests.selection import all_cases
from tools.catalogue_cells import cells

SHAPES = {cell.title: cell for cell in cells(["solids", "flats"])}
KNOWN = [name for name, row in PRIMITIVES.items() if row.width is not None]
# Shapes without an end are cut by a box, whose edges cut them into pieces of any width.
FINER = 2.3
TURNS = 12 if all_cases() else 1


def solid(name: str) -> Any:
    """A shape of the catalogue as a solid."""
    shape = SHAPES[name].make()
    return shape.extrude(1.5) if shape.flat else shape


def width_of(shape: Any) -> float:
    return float(LeafFields(FieldKernels(shape.node, {}, 0.0)).numbers.width.min())


def counted(shape: Any, step: float) -> tuple[int, int]:
    """How many closed surfaces equal cells of a side see, and the Euler number of all."""
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    lattice = Lattice.over(extent.low, extent.high, step)
    found = surface_bricks(kernels, lattice, extent.slopes, 100_000, lambda share: None)
    seen = topology_of(kernels, lattice, found)
    label = np.arange(len(seen.points.size))
    lower, upper = seen.segments.lower, seen.segments.upper
    while True:
        least = np.minimum(label[lower], label[upper])
        following = label.copy()
        np.minimum.at(following, lower, least)
        np.minimum.at(following, upper, least)
        following = following[following]
        if (following == label).all():
            break
        label = following
    euler = len(label) - len(seen.segments.axis) + len(seen.edges.axis)
    return len(np.unique(label)), euler


def turned(shape: Any, rng: np.random.Generator) -> Any:
    x, y, z, *place = (float(number) for number in rng.uniform(-1.0, 1.0, 6))
    return shape.rotate(x=x).rotate(y=y).rotate(z=z).translate(*place)


def is_finite(shape: Any) -> bool:
    low, high = shape.bounds()
    return bool(np.isfinite(np.subtract(high, low)).all())


FINITE = [name for name in KNOWN if is_finite(solid(name))]


@pytest.mark.sample(8)
@pytest.mark.parametrize("name", FINITE)
def test_a_declared_width_finds_its_shape(name: str) -> None:
    rng = np.random.default_rng(KNOWN.index(name))
    shape = solid(name)
    width = width_of(shape)
    assert 0.0 < width < np.inf
    for _ in range(TURNS):
        placed = turned(shape, rng)
        assert counted(placed, width) == counted(placed, width / FINER), (name, width)


def surface_cells(kernels: FieldKernels, extent: Extent, step: float) -> tuple[Lattice, Any]:
    """Return a lattice, and which of its cells have corners on both sides of the surface."""
    lattice = Lattice.over(extent.low, extent.high, step)
    found = surface_bricks(kernels, lattice, extent.slopes, 100_000, lambda share: None)
    brick, *local = np.nonzero((found.masks != 0) & (found.masks != 255))
    return lattice, found.bricks[brick] * 8 + np.stack(local, axis=1)


@pytest.mark.parametrize("name", ["Slab", "Gyroid", "CubicLattice", "Honeycomb", "VoronoiWalls"])
def test_endless_shapes_are_nowhere_lost(name: str) -> None:
    """Wherever the surface passes through cells of half the width, those of the width see it."""
    rng = np.random.default_rng(1)
    shape = turned(solid(name), rng) & Box(1.6)
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    width = width_of(shape)
    coarse, cells = surface_cells(kernels, extent, width)
    fine, others = surface_cells(kernels, extent, width / FINER)
    places = fine.places(others + 0.5)
    # The edges of the box cut slivers off.
    inner = places[np.abs(places).max(axis=1) < 0.8 - 1.5 * width]
    home = np.floor((inner - coarse.origin) / coarse.step).astype(np.int64)
    seen = np.zeros(len(inner), np.bool_)
    for offset in product((-1, 0, 1), repeat=3):
        seen |= np.isin(keys_of(home + np.array(offset)), keys_of(cells))
    assert len(inner) and seen.all()


def test_widths_are_declared() -> None:
    unknown = {name for name, row in PRIMITIVES.items() if row.width is None}
    # Outlines and solids from data, noise, fractals: no closed form.
    assert unknown == {
        "Polygon",
        "RoundedPolygon",
        "ImageField",
        "ValueNoiseSolid",
        "GradientNoiseSolid",
        "SimplexNoiseSolid",
        "FbmSolid",
        "BrickField",
        "Mandelbulb",
        "QuaternionJulia",
        "Mandelbox",
        "Heightfield",
        "Metaballs",
        "ConvexPolyhedron",
        "VolumeField",
    }
    assert sum(row.width is not None for row in OPERATORS.values()) > 30
