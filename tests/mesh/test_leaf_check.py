"""Every leaf of a shape has triangles: what a coarse mesh loses is found, named and meshed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Mandelbulb,
    Octahedron,
    Sphere,
    Torus,
    union,
)
from distal.diagnostics import CompileError
from distal.mesh import leaf_check
from distal.mesh.extract import Extracted, extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_places import LeafSearch
from distal.mesh.meshing import DEFAULT_TOLERANCE, MeshRequest, extent_of
from distal.mesh.shells import shells_of

COARSE = 24.0  # cells along the largest side


def coarse_mesh(shape, cells=COARSE, tolerance=None):
    """A mesh of equal cells that are larger than what is thin in a shape; what made it."""
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    tolerance = tolerance or DEFAULT_TOLERANCE * extent.size
    step = extent.size / cells
    found = extracted(kernels, extent, step, tolerance, 10**5, lambda share: None, tolerance)
    assert isinstance(found, Extracted)
    return kernels, extent, found, tolerance


def lost(shape, cells=COARSE, tolerance=None):
    """The leaves that a coarse mesh does not show, and the places that are missing of each."""
    kernels, extent, found, tolerance = coarse_mesh(shape, cells, tolerance)
    search = LeafSearch(kernels, extent.low, extent.high, extent.slopes, tolerance)
    rows = search.places()
    away = leaf_check.distances(rows, found.made.points[found.made.triangles], 3.0 * tolerance)
    names = {}
    for number in rows.leaf[away > tolerance].tolist():
        leaf = search.leaves[number].leaf
        names[leaf.rule.name] = names.get(leaf.rule.name, 0) + 1
    return names


def topology(made):
    found = shells_of(made.points, made.triangles)
    return found.pieces, found.holes, found.voids


def completed(shape, cells=COARSE):
    """What a coarse mesh becomes when all leaves are looked for."""
    kernels, extent, found, tolerance = coarse_mesh(shape, cells)
    found, check = leaf_check.with_all_leaves(kernels, extent, found, tolerance, lambda share: None)
    assert not check.missing
    return found.made


PLATE = Box(200, 10, 200)
LOST = {
    "bore": (PLATE - Cylinder(1.7, 40), "Cylinder", (1, 1, 0)),
    "tilted bore": (
        PLATE - Cylinder(0.21, 40).rotate(x=0.3).translate(13.3, 0, -40.7),
        "Cylinder",
        (1, 1, 0),
    ),
    "slot": (PLATE - Box(60, 40, 1.2).translate(11.3, 0, 17.9), "Box", (1, 1, 0)),
    "pocket": (PLATE - Cylinder(1.5, 10).translate(31.0, 6.0, 12.0), "Cylinder", (1, 0, 0)),
    "void": (PLATE - Sphere(1.1).translate(10.3, 1.0, 20.4), "Sphere", (1, 0, 1)),
    "post": (PLATE | Cylinder(0.9, 12).translate(-7.7, 8.0, 3.1), "Cylinder", (1, 0, 0)),
    "apart": (PLATE | Sphere(0.8).translate(17.3, 30.0, 5.0), "Sphere", (2, 0, 0)),
    "wall": (
        PLATE - Box(30, 40, 30).translate(20.2, 0, 0) - Box(30, 40, 30).translate(-10.3, 0, 0),
        "Box",
        (1, 2, 0),
    ),
    "floor": (PLATE - Box(20, 10, 20).translate(33, 0.3, 11), "Box", (1, 0, 0)),
    "gap": (Box(40, 20, 40) | Box(30, 20, 30).translate(1.3, 20.2, 2.1), "Box", (2, 0, 0)),
}


@pytest.mark.parametrize("name", LOST)
def test_what_a_coarse_mesh_loses_is_named(name):
    shape, leaf, _ = LOST[name]
    assert lost(shape).get(leaf, 0) > 0


@pytest.mark.parametrize("name", LOST)
def test_cells_are_divided_until_it_is_there(name):
    shape, _, expected = LOST[name]
    assert topology(completed(shape)) == expected


def test_each_copy_of_an_array_is_looked_for():
    """Copies are in one cell of the mesh, and some of them are cut away: each counts."""
    bores = Cylinder(0.8, 40).repeat(6.0, 60.0, 6.0, count=(3, 1, 3))
    assert lost(Box(40, 10, 40) - bores, cells=6)
    assert topology(completed(Box(40, 10, 40) - bores, cells=6)) == (1, 9, 0)
    kept = bores & Box(200, 40, 200).translate(103.0, 0, 0)
    assert topology(completed(Box(40, 10, 40) - kept, cells=6)) == (1, 3, 0)


TURN = {"x": 0.3, "y": 0.5, "z": 0.7}
BORES = [Cylinder(1.0, 9.0).translate(4.0 * i, 0, 4.0 * j) for i in range(5) for j in range(4)]


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    "shape",
    [
        Box(40, 20, 10).round(2.0) - Cylinder(5.0, 30.0),
        Sphere(3.0),
        Torus(3.0, 0.8).rotate(**TURN),
        Cone(2.0, 3.0),
        Octahedron(2.0).rotate(**TURN),
        Box(10).union(Sphere(5).translate(4, 4, 0), smooth=2.0) - Cylinder(0.6, 40),
        Box(30, 5, 30).translate(8.0, 0, 6.0) - union(*BORES),
        Box(12, 2, 3).twist(0.1),
        Capsule(1.0, 5.0).translate(6.0, 0, 0).repeat_polar(7) | Cylinder(5.5, 1.0),
        Box(8).shell(0.7, where="center") - Box(20).translate(0, 12.0, 0),
    ],
)
def test_no_printable_shape_is_called_wrong(shape):
    """Meshes within their tolerance show all leaves, however many."""
    made = shape.mesh(colors=False)
    assert made.report["leaves"]["places"] > 50
    assert not [text for text in made.report["warnings"] if "compared" in text]


def test_faces_inside_a_solid_and_swallowed_leaves_have_no_places():
    shape = Box(10) | Sphere(4).translate(3, 0.5, 0) | Box(10).translate(10, 0, 0)
    shape = shape | Box(4).translate(0, 1, 1) | Cylinder(2, 9)
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    search = LeafSearch(kernels, extent.low, extent.high, extent.slopes, 0.03)
    rows = search.places()
    seen = {search.leaves[number].leaf.rule.name for number in np.unique(rows.leaf)}
    assert seen == {"Box"}
    # On the outside of both boxes, and not on the face between them.
    half = np.array((10.0, 5.0, 5.0))
    assert np.allclose(np.abs((rows.place - (5.0, 0.0, 0.0)) / half).max(axis=1), 1.0)
    assert len(np.unique(rows.leaf)) == 2


def test_a_leaf_that_stays_missing_is_an_error_at_its_line(monkeypatch):
    monkeypatch.setattr(leaf_check, "_MOST_CELLS", 0)
    shape = PLATE - Cylinder(0.4, 40).translate(33.3, 0, 44.7)
    kernels, extent, found, tolerance = coarse_mesh(shape)
    _, check = leaf_check.with_all_leaves(kernels, extent, found, tolerance, lambda share: None)
    with pytest.raises(CompileError) as raised:
        leaf_check.refuse_missing(check.missing, "mesh", "feature={width}")
    text = str(raised.value)
    assert "'Cylinder' (line " in text and "is missing in the mesh at (32." in text
    assert "feature=0." in text
    assert "Cylinder(0.4, 40)" in text  # the author's line


def test_estimates_are_not_checked_and_said():
    shape = Mandelbulb() | Sphere(0.3).translate(2.0, 0, 0)
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    search = LeafSearch(kernels, extent.low, extent.high, extent.slopes, 0.01)
    rows = search.places()
    found = leaf_check.result_of(search, rows, np.zeros(len(rows)), 1.0)
    assert {search.leaves[number].leaf.rule.name for number in rows.leaf} == {"Sphere"}
    (name,) = found.report()["unchecked"]
    assert name.startswith("'Mandelbulb' (line ")


def random_plate(rng):
    """A plate with bores, slots and pockets of a twentieth of a cell to two; how many holes."""
    cell, thickness = 200.0 / COARSE, float(rng.uniform(9, 14))
    shape, holes, places = Box(200, thickness, 200), 0, []
    for _ in range(int(rng.integers(1, 5))):
        width = cell * math.exp(rng.uniform(math.log(1 / 20), math.log(2)))
        tilt = float(rng.uniform(-0.6, 0.6)) if rng.random() < 0.5 else 0.0
        reach = width * 2.2 + thickness * abs(math.tan(tilt)) + 0.3
        place = rng.uniform(-90 + reach / 2, 90 - reach / 2, 2)
        if any(np.hypot(*(place - p)) <= reach + r for p, r in places):
            continue
        places.append((place, reach))
        x, z = place.tolist()
        kind = int(rng.integers(0, 4))
        if kind == 0:
            cut = Cylinder(width / 2, 60.0).rotate(x=tilt)
        elif kind == 1:
            cut = Box(2 * width, 60.0, width * 0.8).rotate(y=float(rng.uniform(0, 3)))
            cut = cut.rotate(x=tilt)
        elif kind == 2:
            cut = Cylinder(width / 2, thickness).translate(0, thickness * 0.5, 0)
        else:
            cut = Box(width, thickness, width).rotate(y=float(rng.uniform(0, 3)))
            cut = cut.translate(0, thickness * 0.45, 0)
        holes += kind < 2
        shape = shape - cut.translate(x, 0.0, z)
    return shape, holes


@pytest.mark.sample(4)
@pytest.mark.parametrize("seed", range(4))
def test_random_plates_have_all_their_holes(seed):
    rng = np.random.default_rng(seed)
    for _ in range(3):
        shape, holes = random_plate(rng)
        assert topology(completed(shape)) == (1, holes, 0)
