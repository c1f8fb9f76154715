"""Parts of equal structure are one kind; the numbers that differ are its columns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from distal import (
    Box,
    DistantLight,
    Material,
    Plane,
    Scene,
    Shape,
    Sphere,
    Torus,
    by_cell,
    stripes,
    time,
)
from distal.lang import func, length, slider, vec3
from distal.scene.lowering.parts.flatten import members_of
from distal.scene.lowering.parts.kind_boxes import bounds_of, columns_of
from distal.scene.lowering.parts.kinds import HEAD, kinds_of
from distal.scene.lowering.parts.table import (
    ENDLESS_MOTION,
    INFINITE,
    LEAST_PARTS,
    RARE,
    _rolled,
    keep_table,
    rolled,
)


def kinds(*shapes):
    return kinds_of(members_of(shapes[0].union(shapes[1:]).node))


def test_shapes_that_differ_in_numbers_are_one_kind():
    (kind,) = kinds(*(Sphere(0.1 + 0.1 * i).translate(float(i), 0, 0) for i in range(5)))
    assert len(kind.members) == 5
    offset, radius = columns_of(kind)
    assert offset.tolist() == [[i, 0, 0] for i in range(5)]
    assert radius == pytest.approx([0.1 + 0.1 * i for i in range(5)])


def test_a_number_that_all_parts_share_is_no_column():
    (kind,) = kinds(*(Torus(0.5, 0.1).translate(float(i), 0, 0) for i in range(4)))
    assert kind.width == HEAD + 2 + 3  # the vector of the offset begins at a new vec4
    assert len(columns_of(kind)) == 1


@pytest.mark.parametrize(
    ("a", "b"),
    [
        (Sphere(1.0), Box(1.0, 1.0, 1.0)),
        (Sphere(1.0), Sphere(1.0).translate(1, 0, 0)),
        (Sphere(1.0).paint("red"), Sphere(1.0)),
        (Sphere(1.0).paint("red"), Sphere(1.0).paint(stripes("red", "blue"))),
        (Sphere(1.0).rotate(x=0.5), Sphere(1.0).rotate(y=0.5)),
        (Sphere(1.0).repeat(3.0, count=(2, 1, 1)), Sphere(1.0).repeat(3.0, count=(3, 1, 1))),
        (Sphere(slider("r", 1.0, low=0.1)), Sphere(slider("s", 1.0, low=0.1))),
    ],
)
def test_other_structures_are_other_kinds(a, b):
    assert len(kinds(a, b, a)) == 2


def test_materials_that_differ_in_numbers_are_one_kind():
    (kind,) = kinds(
        Sphere(1.0).paint("red"), Sphere(1.0).paint("#123456"), Sphere(1.0).paint((0.1, 0.2, 0.3))
    )
    (colors,) = columns_of(kind)
    assert colors[0].tolist() == [1.0, 0.0, 0.0] and colors[2].tolist() == [0.1, 0.2, 0.3]


def test_own_functions_are_one_kind():
    @func
    def ball(p: vec3, radius: float) -> float:
        return length(p) - radius

    box = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    (kind,) = kinds(
        *(Shape.from_function(ball, bounds=box, radius=0.1 * i + 0.1) for i in range(3))
    )
    assert len(kind.members) == 3


def test_moves_and_materials_of_a_union_are_those_of_its_members():
    pair = Sphere(1.0).paint("red") | Box(1.0, 1.0, 1.0)
    whole = (pair.translate(1, 2, 3).paint("blue") | Torus(1.0, 0.1)).scale(2.0).rotate(y=0.3)
    members = members_of(whole.node)
    assert [m.source.rule.name for m in members] == ["Sphere", "Box", "Torus"]
    assert [m.part.rule.name for m in members] == ["rotate y"] * 3
    moved = members[0].part.children[0].children[0]
    assert moved.rule.name == "translate" and moved.material is not None
    points = np.random.default_rng(1).uniform(-6, 6, (50, 3))
    alone = [type(whole)._of(m.part)(points) for m in members]
    assert np.min(alone, axis=0) == pytest.approx(whole(points), abs=1e-5)


def row(count=LEAST_PARTS):
    return [Sphere(0.1).translate(0.3 * i, 0, 0) for i in range(count)]


def test_fewer_parts_have_no_table():
    assert rolled(row()[0].union(row()[1:]).node).table is not None
    found = rolled(row()[0].union(row()[2:]).node)
    assert found.table is None and found.beside == ()


def test_what_cannot_be_in_a_table_stays_beside_it_in_order():
    others = [Plane(y=-1), Sphere(0.2 + 0.1 * time), Sphere(0.1).translate(y=-3.0 * time)]
    found = rolled(row()[0].union([*row()[1:8], *others, *row()[8:]]).node)
    assert found.table is not None and found.table.count == LEAST_PARTS
    names = [(m.source.rule.name, why) for m, why in found.beside]
    assert names == [("Plane", INFINITE), ("Sphere", ENDLESS_MOTION), ("translate", ENDLESS_MOTION)]
    assert [c.rule.name for c in found.node.children] == ["parts", *(name for name, _ in names)]


def test_of_many_kinds_the_most_frequent_are_in_the_table():
    # A chain of rotations and scales is a kind of its own.
    def turned(n):
        shape = Box(0.1, 0.1, 0.1)
        for bit in f"{n:07b}":
            shape = shape.rotate(x=0.1) if bit == "1" else shape.scale(0.9)
        return shape

    found = rolled(row()[0].union([*row()[1:], *(turned(n) for n in range(70))]).node)
    assert found.table is not None and len(found.table.kinds) == 64
    assert found.table.count == LEAST_PARTS + 63
    assert {why for _, why in found.beside} == {RARE} and len(found.beside) == 7


def test_boxes_hold_their_parts():
    rng = np.random.default_rng(3)
    shapes = [
        Box(*rng.uniform(0.1, 1.0, 3)).rotate(x=float(a), z=float(b)).translate(*rng.normal(size=3))
        for a, b in rng.uniform(-3, 3, (20, 2))
    ]
    (kind,) = kinds(*shapes)
    found = bounds_of(kind)
    low, high = found.low, found.high
    assert (found.slope == 1.0).all() and (found.divisor == 1.0).all()
    points = rng.uniform(-3, 3, (20000, 3))
    for shape, a, b in zip(shapes, low, high, strict=True):
        inside = points[shape(points) <= 0.0]
        assert len(inside) > 0 and (inside >= a).all() and (inside <= b).all()


def test_a_material_is_not_shared_with_another_kind():
    red = Material((1.0, 0.0, 0.0))
    found = kinds(Sphere(1.0).paint(red), Sphere(2.0).paint(red), Box(1.0, 1.0, 1.0).paint(red))
    assert [len(k.columns) for k in found] == [1, 0]


PLACES = [(0.3 * i, 0.1 * i, 0.0) for i in range(20)]


def test_copies_at_positions_are_parts():
    balls = (Sphere(0.1).paint("red").array(PLACES) | Plane(y=-1)).rotate(y=0.3).scale(2.0)
    found = rolled(balls.node)
    (kind,) = found.table.kinds
    assert len(kind.members) == 20 and [why for _, why in found.beside] == [INFINITE]
    (offset,) = columns_of(kind)
    assert offset == pytest.approx(np.array(PLACES))
    points = np.random.default_rng(1).uniform(-3, 3, (200, 3))
    expected = Sphere(0.1).array(PLACES).rotate(y=0.3).scale(2.0)
    alone = type(balls)._of(found.node.children[0])(points)
    centers = np.array(PLACES) @ np.array(
        [[np.cos(0.3), 0, -np.sin(0.3)], [0, 1, 0], [np.sin(0.3), 0, np.cos(0.3)]]
    )
    least = np.linalg.norm(points[:, None] - 2.0 * centers, axis=-1).min(axis=1) - 0.2
    assert alone == pytest.approx(least, abs=1e-5)
    assert expected(points) == pytest.approx(least, abs=1e-5)


def test_copies_that_know_their_index_and_a_few_copies_are_no_parts():
    ball = Sphere(0.1)
    assert len(members_of(ball.array(PLACES).node)) == 20
    assert len(members_of(ball.array(PLACES[:15]).node)) == 1
    assert len(members_of(ball.paint(by_cell()).array(PLACES).node)) == 1


def test_copies_without_a_box_stay_one_repetition():
    slabs = Plane(y=-1).array(PLACES)
    found = rolled(row()[0].union([*row()[1:], slabs]).node)
    assert found.table.count == LEAST_PARTS
    assert [(m.part.rule.name, why) for m, why in found.beside] == [("repeat at", INFINITE)]


def test_a_ground_in_the_looks_material_keeps_the_table():
    parts = [Sphere(0.3 + 0.01 * i).translate(float(i), 0, 0) for i in range(2 * LEAST_PARTS)]
    whole = parts[0].union(parts[1:]) | Plane() | Plane(y=-2.0).paint("red")
    before = rolled(whole.node)
    scene = Scene(whole, lights=DistantLight((1, 2, 1)))
    kept, fresh = rolled(scene.shape.node), _rolled(scene.shape.node)
    assert kept.table is not None
    assert kept.table is before.table
    # It is what rolling the tree would give.
    assert [m.part for m, _ in kept.beside] == [m.part for m, _ in fresh.beside]
    assert [reason for _, reason in kept.beside] == [INFINITE, INFINITE]
    assert [n.rule for n in kept.node.children] == [n.rule for n in fresh.node.children]
    first, second = (m.part for m, _ in kept.beside)
    assert first.material is not None and first is not whole.node.children[-2]
    assert second is whole.node.children[-1]


def test_a_changed_part_of_the_table_is_rolled_again():
    parts = [Sphere(0.3 + 0.01 * i).translate(float(i), 0, 0) for i in range(2 * LEAST_PARTS)]
    whole = parts[0].union(parts[1:]).node
    changed = replace(whole, children=(parts[0].paint("red").node, *whole.children[1:]))
    before = rolled(whole)
    keep_table(whole, changed)
    assert rolled(changed).table is not before.table
    assert len(rolled(changed).table.kinds) == 2
