"""The pieces of a tree: their union is the solid, and their programs are short."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Cylinder, Ellipsoid, Plane, Sphere, Torus, union
from distal.scene.lowering.pieces.emission import StepMode
from distal.scene.lowering.pieces.joins import JoinCode
from distal.scene.lowering.pieces.table import DENSE, Pieced, pieced
from tests.pieces.pieces_oracle import built, check_looks, check_order, check_values
from tests.pieces.random_trees import WIDE, random_tree

# Boxes that cost less than nothing are never put together again.
FREE = {"box": -1000.0, "visit": 0.0, "leaf": 1.0}
FINE = {"leaves": 1, "smallest": 1 / 6, **FREE}
FINEST = {"leaves": 0, "smallest": 1 / 6, **FREE}


def leaf_counts(pieces):
    """How many leaves each piece has."""
    steps = [pieces.steps_of(i) for i in range(len(pieces.box))]
    return np.array([(own[:, 0] < StepMode.POP).sum() for own in steps])


def balls(count, radius, seed=0):
    rng = np.random.default_rng(seed)
    return [Sphere(radius).translate(*p) for p in rng.uniform(-1, 1, (count, 3)).tolist()]


def plate(rows, columns):
    """A plate with holes."""
    holes = [
        Cylinder(0.08, 1.0).translate(0.25 * (i + 0.5), 0, 0.25 * (j + 0.5))
        for i in range(columns)
        for j in range(rows)
    ]
    body = Box(0.25 * columns, 0.1, 0.25 * rows)
    return body.translate(0.125 * columns, 0, 0.125 * rows) - union(holes)


@pytest.mark.parametrize("seed", range(24))
def test_pieces_are_the_solid_of_random_trees(seed):
    rng = np.random.default_rng(seed)
    shape = random_tree(rng, 10, [] if seed % 3 == 0 else WIDE)
    limits = FINE if seed % 2 else {"leaves": 3, "smallest": 1 / 16, "interior": True}
    made = built(shape, **limits)
    if len(made.pieces.box):
        check_values(made, rng)
        check_order(made.pieces)


@pytest.mark.parametrize(
    "shape",
    [
        # Faces in one plane, with and without a gap.
        Box(1, 1, 1) - Box(0.5, 0.5, 0.5).translate(0, 0.25, 0),
        Box(1, 1, 1) | Box(1, 1, 1).translate(1, 0, 0) | Box(1, 1, 1).translate(0.5, 1, 0),
        union([Box(1, 1, 1), Box(1, 1, 1).translate(1, 0, 0), Sphere(0.7)], smooth=0.03),
        # Thin parts, and none.
        (Box(1, 1, 0.001) - Sphere(0.3) - Sphere(0.2).translate(0.4, 0, 0)) | Torus(0.6, 0.002),
        Sphere(0.5).shell(0.002) - Box(1, 1, 1).translate(0.5, 0, 0) - Cylinder(0.1, 2),
        Sphere(0.3) & Sphere(0.3).translate(2, 0, 0) & Box(1, 1, 1),
        # Tiny parts, far away from each other.
        union(
            [
                Sphere(0.01).translate(5 * i, 0, 0) - Box(0.01, 1, 1).translate(5 * i, 0, 0)
                for i in range(4)
            ]
        )
        | Box(1, 1, 1),
        # Half spaces that cut.
        (Sphere(0.5) | Sphere(0.4).translate(0.6, 0, 0)) - Plane(0.1) - Box(0.1, 2, 2),
        ((Box(1, 1, 1) & Plane(0.2)) | Sphere(0.3)).split((0.6, 0.0, 0.8), 0.2)[0],
        # Everything else but two balls, within a box.
        (Sphere(0.3) | Sphere(0.3).translate(0.5, 0, 0)).complement() & Box(1, 1, 1),
        (Box(1, 1, 1) | Ellipsoid(0.9, 0.2, 0.3)).shell(0.1, where="outer") - Sphere(0.7),
        # Stairs are joined two by two.
        union(balls(6, 0.5), smooth=0.1, blend="stairs", count=3) - Box(0.4, 3, 0.4),
    ],
)
def test_pieces_of_special_shapes(shape):
    made = built(shape, **FINEST)
    if len(made.pieces.box):
        check_values(made, np.random.default_rng(0))
        check_order(made.pieces)


@pytest.mark.parametrize(
    "shape",
    [
        # Moved surfaces: values far from 0 matter below.
        union(balls(9, 0.5)).shell(0.2),
        union(balls(9, 0.5)).shell(0.2, where="outer") - Box(0.6, 3, 0.6),
        (Box(2, 2, 2) - union(balls(9, 0.5)).round(0.15)).round(0.1),
        (Box(2, 2, 2) - union(balls(9, 0.5)).offset(-0.15)) & union(balls(5, 0.9)).round(0.2),
        (Box(2, 2, 2) - (union(balls(9, 0.6)) - union(balls(9, 0.4, seed=1))).shell(0.1)),
        (Box(2, 2, 2).clearance(union(balls(9, 0.3)), gap=0.2)).shell(0.1, where="center"),
    ],
)
def test_pieces_below_moved_surfaces(shape):
    made = built(shape, **FINEST)
    check_values(made, np.random.default_rng(0))


@pytest.mark.parametrize("name", WIDE)
@pytest.mark.parametrize("kind", ["union", "intersection", "difference"])
def test_pieces_of_two_blended_operands_are_exact(kind, name):
    numbers = {"count": 4} if name == "stairs" else {}
    one, other = union(balls(5, 0.6)), union(balls(5, 0.6, seed=1))
    shape = getattr(one, kind)(other, smooth=0.06, blend=name, **numbers)
    shape = Box(1.9, 1.9, 1.9).difference(shape, smooth=0.03, blend=name, **numbers)
    made = built(shape, **FINEST, margin=0.02)
    assert made.error == 0.0
    check_values(made, np.random.default_rng(0))


@pytest.mark.parametrize("name", WIDE)
def test_pieces_of_dense_blends(name):
    numbers = {"count": 4} if name == "stairs" else {}
    soft = union(balls(24, 0.3), smooth=0.05, blend=name, **numbers)
    inner = union(balls(24, 0.2, seed=1), smooth=0.02, blend=name, **numbers)
    made = built(soft - inner, leaves=3, smallest=1 / 16, margin=0.01)
    assert leaf_counts(made.pieces).mean() < 24
    check_values(made, np.random.default_rng(0))


def test_a_blend_far_from_its_operands_is_in_boxes():
    shape = union([Sphere(0.3).translate(0.7 * i, 0.1 * i * i, 0) for i in range(3)], smooth=0.2)
    made = built(shape, leaves=0, smallest=1 / 20, **FREE, margin=0.01)
    check_values(made, np.random.default_rng(0))


def test_a_plate_has_about_one_piece_for_each_hole():
    made = built(plate(8, 10))
    count = len(made.pieces.box)
    assert 50 <= count <= 120
    assert leaf_counts(made.pieces).max() <= 5
    check_values(made, np.random.default_rng(0))


def test_equal_programs_are_stored_once():
    hull = Box(4, 4, 4) - Sphere(0.1) - Sphere(0.1).translate(1, 0, 0)
    made = built(hull, **FINEST)
    pieces = made.pieces
    assert len(pieces.programs.count) < len(pieces.box)
    steps = {tuple(map(tuple, pieces.steps_of(i).tolist())) for i in range(len(pieces.box))}
    assert len(steps) + 1 == len(pieces.programs.count)  # and that of the whole tree


def test_the_parts_of_a_union_are_whole_pieces():
    made = built(union(balls(100, 0.05)))
    pieces = made.pieces
    assert len(pieces.box) == 100 and not pieces.is_cut.any()
    assert sorted(pieces.steps_of(i)[0, 1] for i in range(100)) == list(range(100))
    check_order(pieces)
    check_values(made, np.random.default_rng(0))


def test_members_that_join_shapes_are_divided_by_members():
    member = (Box(1, 1, 1) - Sphere(0.6)).round(0.05)
    shape = union([member.translate(2.0 * i, 0, 0) for i in range(6)] + [Sphere(0.2)])
    made = built(shape)
    assert not made.pieces.is_cut.all()
    check_values(made, np.random.default_rng(0))
    check_order(made.pieces)


def test_an_infinite_solid_has_no_pieces():
    with pytest.raises(ValueError, match="no finite box"):
        built(Plane(0.0) - Sphere(1.0))
    with pytest.raises(ValueError, match="no finite box"):
        built(Plane(0.0) | Sphere(1.0))


def test_the_number_of_distances_ends_the_division():
    shape = union(balls(60, 0.3), smooth=0.05)
    made = built(shape, **FINE, values=1000)
    assert 0 < len(made.pieces.box) < len(built(shape, **FINE).pieces.box)
    check_values(made, np.random.default_rng(0))


def test_nothing_has_no_boxes():
    made = built(Sphere(0.3) & Sphere(0.3).translate(2, 0, 0))
    assert len(made.pieces.box) == 0 and len(made.pieces.low) == 0


# Materials

RED, BLUE, GOLD = "red", "blue", "gold"


@pytest.mark.parametrize(
    "shape",
    [
        # A hole across the border of two materials, deep below the surface of both.
        (Box(2, 2, 2).paint(RED) | Box(2, 2, 2).paint(BLUE).translate(1, 0, 0)) - Cylinder(0.2, 5),
        (Box(2, 2, 2).paint(RED) | Box(2, 2, 2).paint(BLUE).translate(0, 1, 0))
        - union([Cylinder(0.2, 5).translate(0.5 * i - 1, 0, 0) for i in range(5)]),
        Box(2, 2, 2).paint(RED) - Sphere(0.9).cut_material(GOLD) - Cylinder(0.3, 5),
        # The second hole shows the material of all before it: near the first hole that of this.
        Box(4, 4, 4).paint(RED)
        - Sphere(0.4).translate(1, 1, 1).cut_material(GOLD)
        - Cylinder(0.3, 9),
        Box(2, 2, 2).paint(RED)
        - (Sphere(0.5) - Box(0.2, 2, 2).cut_material(BLUE)).cut_material(GOLD)
        - Sphere(0.2).translate(0.6, 0.6, 0.6).cut_material(BLUE),
        (Box(2, 2, 2).paint(RED) | Box(2, 2, 2).translate(1, 0, 0)).clearance(
            Cylinder(0.2, 5), gap=0.1
        ),
        (Box(2, 2, 2).paint(RED) | Box(2, 2, 2).translate(1, 0, 0)).split((0, 1, 0), 0.1)[0]
        - Cylinder(0.2, 5),
        ((Box(2, 2, 2).paint(RED) - Sphere(0.5)) | Sphere(1.1).paint(BLUE)).paint(GOLD)
        - Cylinder(0.2, 5)
        - Sphere(0.3).translate(1, 1, 1).paint(RED),
        (Box(2, 2, 2).paint(RED) & Sphere(1.3).paint(BLUE)) - Cylinder(0.3, 5),
    ],
)
def test_pieces_show_the_materials_of_the_tree(shape):
    rng = np.random.default_rng(0)
    made = built(shape, **FINEST, margin=0.01)
    assert check_looks(made, rng) > 100
    check_values(made, rng)


@pytest.mark.parametrize("seed", range(12))
def test_pieces_show_the_materials_of_random_trees(seed):
    rng = np.random.default_rng(2000 + seed)
    made = built(random_tree(rng, 8, blends=[]), **FINE, margin=0.01)
    if len(made.pieces.box):
        check_looks(made, rng)


def test_a_hole_alone_names_what_it_is_cut_from():
    made = built(Box(4, 4, 4).paint(RED) - Sphere(0.5).paint(BLUE), **FINEST)
    ones = [
        s
        for i in range(len(made.pieces.box))
        for s in made.pieces.steps_of(i).tolist()
        if s[0] == StepMode.ONE
    ]
    assert ones
    for _, leaf, join in ones:
        assert made.pieces.joins[join].code is JoinCode.COMPLEMENT
        assert made.program.leaves[leaf].source.name == "Box"


def test_few_shapes_and_shapes_that_are_everywhere_have_no_pieces():
    few, many = (Box(2, 2, 2) - union(balls(n, 0.2)) for n in (24, 40))
    assert pieced(few.node) == Pieced(few.node)
    assert pieced(many.node).table is not None
    assert pieced(union(balls(24, 0.2), smooth=0.01).node).table is not None
    wide = pieced(union(balls(60, 0.2), smooth=0.1).node)
    assert wide.table is None and wide.reason == DENSE
