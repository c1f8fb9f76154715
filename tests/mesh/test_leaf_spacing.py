"""Nothing narrow is lost at the default spacing: bores, slots, walls, ribs, floors, gaps, tubes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import (
    Box,
    Circle,
    Cylinder,
    Quad,
    Rectangle,
    Shape,
    Sphere,
    union,
)
from distal.lang import abs, func, max, slider, vec3
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_fields import LeafFields
from distal.mesh.leaf_spacing import WALL_SHARE
from distal.scene.lowering.placed_leaves import placed_leaves
from tests.mesh.narrow_solids import KINDS, narrow_solid, topology_of

ROD = 2.0 / math.sqrt(3.0)


def widths(shape, **params):
    """The widths of a shape's leaves."""
    fields = fields_of(shape, **params)
    order = [leaf.leaf for leaf in placed_leaves(shape.node)]
    rows = {id(leaf.leaf): i for i, leaf in enumerate(fields.leaves)}
    return fields.numbers.width[[rows[id(leaf)] for leaf in order]]


def fields_of(shape, **params):
    """The fields of a shape's leaves."""
    return LeafFields(FieldKernels(shape.node, params, 0.0))


def test_a_bore_in_a_plate_is_found():
    made = (Box(200, 10, 200) - Cylinder(1.7, 40)).mesh(check=True)
    assert topology_of(made) == (1, 1)
    assert made.report["warnings"] == [] and set(made.report["check"].values()) == {0}
    # Only cells near the bore are small.
    assert made.report["triangles"] < 3_000
    bore = made.points[np.hypot(made.points[:, 0], made.points[:, 2]) < 3.0]
    radii = np.hypot(bore[:, 0], bore[:, 2])
    assert len(bore) > 8 and np.abs(radii - 1.7).max() <= made.report["tolerance"]


# Solids of these kinds and seeds need 5e4 to 6e5 cells; they are a part of `make sweep-narrow`.
SLOW = {("array", 2), ("walls", 1), ("ribs", 2), ("tube", 2), ("void", 2)}


@pytest.mark.parametrize(
    ("kind", "seed"),
    [(kind, seed) for kind in KINDS for seed in (1, 2) if (kind, seed) not in SLOW],
)
def test_random_solids_have_their_topology(kind, seed):
    solid = narrow_solid(kind, seed)
    made = solid.shape.mesh(colors=False)
    assert topology_of(made) == (solid.surfaces, solid.handles)


def test_hundreds_of_leaves_are_one_kind():
    bores = [Cylinder(1.7, 40).translate(6.0 * i, 0, 6.0 * j) for i in range(20) for j in range(20)]
    cut = union(*bores)
    fields = fields_of(Box(200, 10, 200) - cut)
    assert len(fields.leaves) == 401 and fields.kinds == 2


def test_leaves_have_the_values_of_their_trees():
    bores = [Cylinder(1.0 + i, 40).rotate(x=0.1 * i).translate(7.0 * i, 0, 2) for i in range(5)]
    shape = (Box(9, 8, 7) - union(*bores)).rotate(z=0.4).round(0.3).scale(2.0)
    fields = fields_of(shape)
    rng = np.random.default_rng(0)
    places = rng.uniform(-20, 20, (500, 3))
    leaf = rng.integers(0, len(fields.leaves), 500)
    value = fields.values(leaf, places)
    away, normals = fields.distances(leaf, places, 1.0)
    most = np.full((len(fields.leaves), len(places)), -np.inf)
    for number in range(len(fields.leaves)):
        most[number] = fields.values(np.full(len(places), number), places)
    assert (most[leaf, np.arange(500)] == value).all()
    # All operators above the boolean pass it: the largest value is that of the solid.
    assert np.allclose(most.max(axis=0), shape(places), atol=1e-9)
    assert np.allclose(away, value, atol=1e-6)  # none of them is steeper or flatter than 1
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)


def test_widths_of_operators():
    assert widths(Sphere(3.0)) == pytest.approx([ROD * 3.0], rel=1e-4)
    assert widths(Sphere(3.0).scale(0.5)) == pytest.approx([ROD * 1.5], rel=1e-4)
    assert widths(Sphere(3.0).shell(0.2, where="center")) == pytest.approx([0.19])
    assert widths(Rectangle(9, 8).extrude(0.5)) == pytest.approx([0.475])
    assert widths(Box(9, 9, 9).apply("erode", 1.0)) == pytest.approx(
        [9 / math.sqrt(3.0) - 1.9], rel=1e-4
    )
    # What is cut out becomes narrower where the solid is rounded.
    plate, bore = widths((Box(9, 5, 9) - Cylinder(1.0, 20)).apply("dilate", 0.3))
    assert plate == pytest.approx(4.75) and bore == pytest.approx(ROD - 0.57, rel=1e-4)
    # A sheet without a thickness is as thick as it is rounded.
    assert widths(Quad().apply("dilate", 0.1)) == pytest.approx([0.1 * ROD], rel=1e-4)
    # The gap between copies.
    assert widths(Box(5, 5, 5).repeat(5.2, 0, 0, count=(3, 1, 1))) == pytest.approx([0.19])
    # What is no boolean is one leaf: the least of its children.
    blend = Box(9, 9, 9).union(Sphere(1.0), smooth=0.5)
    assert widths(blend) == pytest.approx([ROD], rel=1e-4)


def test_widths_follow_parameters():
    radius = slider("radius", 2.0, low=0.1, high=5.0)
    shape = Box(9, 9, 9) - Cylinder(radius, 20)
    assert widths(shape)[1] == pytest.approx(2.0 * ROD, rel=1e-4)
    assert widths(shape, radius=0.5)[1] == pytest.approx(0.5 * ROD, rel=1e-4)


def test_a_wall_between_leaves_is_found_whatever_their_widths():
    # Neither box is narrow; what is between them is.
    shape = Box(100, 8, 100) - union(
        Box(20, 40, 30).translate(-10.15, 0, 0), Box(20, 40, 30).translate(10.15, 0, 0)
    )
    made = shape.mesh(colors=False)
    assert topology_of(made) == (1, 2)
    wall = made.points[np.abs(made.points[:, 0]) < 1.0]
    assert np.abs(np.abs(wall[:, 0]) - 0.15).min() < 1e-6
    assert made.report["sure_to"] < 0.3 * WALL_SHARE


def test_faces_that_coincide_are_no_wall():
    made = (Box(10, 2, 10) | Box(4, 6, 4).translate(y=4.0)).mesh(colors=False)
    assert topology_of(made) == (1, 0)
    assert len(made.report["levels"]) == 1


@func
def own(p: vec3) -> float:
    return max(abs(p.x) - 10.0, max(abs(p.y) - 10.0, abs(p.z) - 10.0))


def test_the_report_says_to_what_width_it_is_sure():
    known = (Box(20, 20, 20) - Cylinder(1.0, 40)).mesh(colors=False).report
    assert known["unknown_widths"] == [] and known["sure_to"] < 0.01
    shape = Shape.from_function(own, bounds=((-10, -10, -10), (10, 10, 10)), slope=1.0) - Cylinder(
        1.0, 40
    )
    unknown = shape.mesh(colors=False).report
    assert unknown["sure_to"] == unknown["feature"]
    assert len(unknown["unknown_widths"]) == 1 and "own" in unknown["unknown_widths"][0]


def test_what_is_thinner_than_possible_cells_is_named():
    shape = Box(200, 10, 200) | Box(200, 0.002, 200).translate(y=20)
    warnings = shape.mesh(colors=False).report["warnings"]
    assert any("Box" in text and "thinner" in text for text in warnings)


def test_flat_circle_extruded():
    plate = (Rectangle(200, 200) - Circle(1.1)).extrude(6.0)
    assert topology_of(plate.mesh(colors=False)) == (1, 1)
