"""Copies from columns: their places, colors and shapes; messages name the row that is wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    Circle,
    Scene,
    Sphere,
    by_cell,
    copies,
    glossy,
    intersection,
    matte,
    noise,
    time,
    union,
)
from distal.fields.combine.joins import INTERSECTION, UNION
from distal.fields.place import solid as placing
from distal.fields.repeat import along
from distal.lang import slider, vec3
from distal.scene.tree.errors import SceneTypeError, SceneValueError

FEW = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 3.0, 0.0)]


def structure(node):
    """What must be equal in all copies of a shape, so that they are one kind."""
    material = node.material and (node.material.call.func, tuple(node.material.call.values))
    own = (node.rule.name, tuple(node.numbers), tuple(node.constants), material)
    return own, tuple(map(structure, node.children))


def colors_of(shape):
    return [child.material.call.values["color"].value for child in shape.node.children]


# The tree


@pytest.mark.parametrize(
    ("columns", "rules"),
    [
        ({"scale": [1, 2, 3]}, ["translate", "scale"]),
        ({"scale": np.ones((3, 3))}, ["translate", "scale axes"]),
        ({"rotation": [0.1, 0.2, 0.3]}, ["translate", "rotate y"]),
        ({"rotation": np.zeros((3, 3))}, ["translate", "rotate euler"]),
        ({"rotation": [(0, 0, 0, 1)] * 3}, ["translate", "rotate quaternion"]),
        ({"align": np.eye(3)}, ["translate", "orient"]),
        ({"colors": ["red", "#00ff00", (0, 0, 1)]}, ["translate"]),
        (
            {"scale": [1, 2, 3], "rotation": np.zeros((3, 3)), "align": np.eye(3)},
            ["translate", "orient", "rotate euler", "scale"],
        ),
    ],
)
def test_copies_are_a_union_of_equal_structure(columns, rules):
    shape = Sphere(0.5)
    made = shape.array(FEW, **columns)
    assert made.node.rule is UNION
    assert [c.numbers["offset"].value for c in made.node.children] == FEW
    assert len(set(map(structure, made.node.children))) == 1
    node, found = made.node.children[1], []
    while node is not shape.node:
        found.append(node.rule.name)
        (node,) = node.children
    assert found == rules
    assert made.node.parts == 3


def test_positions_alone_are_a_repetition():
    assert Sphere().array(FEW).node.rule is along.REPEAT_AT


def test_one_copy_is_no_union():
    assert Sphere().array([(1, 2, 3)], scale=[2.0]).node.rule is placing.TRANSLATE


def test_a_number_for_all_is_applied_once():
    made = Sphere().array(FEW, scale=2.0, rotation=0.5)
    assert len({id(child.children[0]) for child in made.node.children}) == 1


def test_columns_may_be_arrays_lists_and_generators():
    rows = np.array(FEW)
    expected = Sphere().array(FEW, scale=[1.0, 2.0, 3.0])
    points = np.random.default_rng(0).uniform(-4, 4, (50, 3))
    for positions, scale in [
        (rows, np.array([1, 2, 3])),
        (rows.astype(np.float32), np.array([1, 2, 3], dtype=np.float32)),
        (rows.astype(int), iter([1, 2, 3])),
        (list(rows), (float(i) for i in (1, 2, 3))),
        ([vec3(*row) for row in FEW], range(1, 4)),
        (map(tuple, FEW), [np.float32(1), 2, np.int64(3)]),
    ]:
        made = Sphere().array(positions, scale=scale)
        np.testing.assert_array_equal(made(points), expected(points))


def test_positions_may_move():
    rise = slider("Rise", 1.0)
    made = Sphere(0.1).array([(0.0, rise, 0.0), (1.0, 2.0 * time, 0.0)], scale=[1.0, 1.0])
    at = np.array([[0.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.5, 0.0]])
    np.testing.assert_allclose(made(at, time=1.5), [-0.1, -0.1, 0.4], atol=1e-6)
    np.testing.assert_allclose(made(at, params={"Rise": 0.5})[2], -0.1, atol=1e-6)


# Several shapes


def test_which_chooses_the_shape():
    made = copies([Sphere(0.5), Box(1.0)], FEW, which=[1, 0, 1])
    names = [child.children[0].rule.name for child in made.node.children]
    assert names == ["Box", "Sphere", "Box"]
    corner = np.array(FEW) + 0.49
    np.testing.assert_array_equal(made(corner) < 0.0, [True, False, True])


def test_without_which_shapes_take_turns():
    made = copies([Sphere(0.5), Box(1.0)], FEW)
    names = [child.children[0].rule.name for child in made.node.children]
    assert names == ["Sphere", "Box", "Sphere"]


def test_a_copied_union_is_one_part():
    tree = Sphere(0.5).translate(0, 1, 0).paint("green") | Box(0.2, 1.0, 0.2).paint("brown")
    made = tree.array(FEW, scale=[1, 2, 3])
    assert len(made.node.children) == 3
    assert made.node.parts == 6


# Colors


def test_colors_are_linear_rows_codes_and_names():
    made = Sphere().array(FEW, colors=["#ffffff", "black", (0.25, 0.5, 2.0)])
    assert colors_of(made) == [(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (0.25, 0.5, 2.0)]
    made = Sphere().array(FEW, colors=np.array([[0.1, 0.2, 0.3]] * 3))
    assert colors_of(made) == [(0.1, 0.2, 0.3)] * 3


def test_the_other_numbers_of_the_material_stay():
    ball = Sphere().paint(glossy("red", roughness=0.4))
    made = ball.array(FEW, colors=["blue", "lime", "white"])
    for child in made.node.children:
        call = child.material.call
        assert call.what == "glossy"
        assert call.values["roughness"].value == 0.4
    assert ball.node.material.call.values["color"].value == (1.0, 0.0, 0.0)
    assert made.node.children[0].material.reflects is ball.node.material.reflects


@pytest.mark.parametrize("material", [None, matte(noise())])
def test_a_shape_without_a_plain_color_becomes_matte(material):
    ball = Sphere() if material is None else Sphere().paint(material)
    made = ball.array(FEW, colors=["red", "lime", "blue"])
    assert {child.material.call.what for child in made.node.children} == {"matte"}
    assert colors_of(made)[0] == (1.0, 0.0, 0.0)


def test_without_colors_each_copy_keeps_its_paint():
    made = copies([Sphere().paint("red"), Box()], FEW, scale=[1, 2, 3])
    assert [child.material for child in made.node.children] == [None] * 3


def test_colors_are_seen():
    line = [(-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]
    balls = Sphere(0.45).array(line, colors=[(1, 0, 0), (0, 1, 0), (0, 0, 1)])
    camera = Camera((0, 0, 4), fov_deg=45.0)
    scene = Scene(balls, lights=[AmbientLight(1.0)], camera=camera, background="black", floor=False)
    picture = scene.render((48, 16))
    row = picture.linear[8, :, :3]
    for at, channel in ((19, 0), (24, 1), (28, 2)):
        assert row[at].argmax() == channel
        assert row[at].max() > 3.0 * np.sort(row[at])[1]


def test_copies_stand_beside_shapes_that_are_marched():
    """A shape that moves is no part of the table of copies; both are seen, in its colors."""
    line = [(x, 0.0, 0.0) for x in np.linspace(-1.5, -0.1, 20)]
    balls = Sphere(0.1).array(line, colors=[(1, 0, 0)] * 20, scale=np.full(20, 4.0))
    moving = Sphere(0.8).translate(1.0 + 0.0 * time, 0.0, 0.0).paint((0, 0, 1))
    camera = Camera((0, 0, 5), fov_deg=30.0)
    lights = AmbientLight(1.0)
    scene = Scene(balls | moving, lights=lights, camera=camera, background="black", floor=False)
    row = scene.render((48, 24)).linear[12, :, :3]
    assert (row[14].argmax(), row[33].argmax()) == (0, 2)


# Free functions


def test_union_takes_lists_generators_and_shapes():
    parts = [Sphere(0.1 * i) for i in range(1, 4)]
    for made in (union(parts), union(s for s in parts), union(*parts), union(tuple(parts))):
        assert made.node.rule is UNION
        assert made.node.children == tuple(part.node for part in parts)
    assert union([parts[0]]) is parts[0]
    assert intersection(parts).node.rule is INTERSECTION
    assert union([Circle(1.0), Circle(2.0)]).flat
    p = np.array([[0.0, 0.25, 0.0]])
    smooth = union(parts, smooth=0.05, blend="cubic")
    assert smooth(p) == parts[0].union(parts[1:], smooth=0.05, blend="cubic")(p)
    assert intersection(parts, smooth=0.05)(p) == parts[0].intersection(parts[1:], smooth=0.05)(p)


# Warnings and errors


def test_degrees_are_noticed():
    with pytest.warns(UserWarning, match="for degrees write"):
        Sphere().array(FEW, rotation=[0, 90, 180])
    with pytest.warns(UserWarning, match="for degrees write"):
        Sphere().array(FEW, rotation=90)


@pytest.mark.filterwarnings("error")
def test_radians_are_no_degrees():
    Sphere().array(FEW, rotation=[0.0, 45.0, 1.0])
    Sphere().array(FEW, rotation=np.zeros((3, 3)))


ERRORS = {
    "no positions": (
        lambda: Sphere().array([], scale=2),
        "'positions of array' needs at least one row",
    ),
    "no list": (
        lambda: Sphere().array(3.0, scale=2),
        "'positions of array' takes a list or an array, not float 3.0",
    ),
    "a text": (
        lambda: Sphere().array(FEW, colors="red"),
        "'colors of array' takes a list or an array, not str 'red'",
    ),
    "fewer rows": (
        lambda: Sphere().array(FEW, scale=[1, 2]),
        "'scale of array' has 2 rows for 3 positions",
    ),
    "not finite": (
        lambda: Sphere().array([*FEW, (0.0, math.nan, 0.0)], scale=2),
        "'positions[3] of array' takes a finite 32-bit number, not nan",
    ),
    "too large": (
        lambda: Sphere().array(np.array([*FEW, (0.0, 1e40, 0.0)]), scale=2),
        "'positions[3] of array' takes a finite 32-bit number, not 1e+40",
    ),
    "two numbers": (
        lambda: Sphere().array([(0, 0, 0), (1, 2)], scale=2),
        "'positions[1] of array' takes three numbers, not 2",
    ),
    "text for a number": (
        lambda: Sphere().array([(0, 0, 0), (1, "2", 3)], scale=2),
        "'positions[1] of array' takes a number, not str '2'",
    ),
    "zero scale": (
        lambda: Sphere().array(FEW, scale=[1.0, 0.0, 1.0]),
        "'scale[1] of array' must be above 0, not 0",
    ),
    "zero scale of an axis": (
        lambda: Sphere().array(FEW, scale=[(1, 1, 1), (1, 1, 1), (1, 0, 1)]),
        "'scale[2] of array' must be above 0, not (1, 0, 1)",
    ),
    "zero scale of all": (
        lambda: Sphere().array(FEW, scale=0.0),
        "'scale of array' must be above 0, not 0",
    ),
    "rotation of two": (
        lambda: Sphere().array(FEW, rotation=[(0, 1)] * 3),
        "'rotation[0] of array' takes one, three or four numbers, not 2",
    ),
    "quaternion of length 2": (
        lambda: Sphere().array(FEW, rotation=[(0, 0, 0, 1), (0, 0, 0, 2), (0, 0, 0, 1)]),
        "'rotation[1] of array' must be a vector of length 1, not (0, 0, 0, 2)",
    ),
    "no direction": (
        lambda: Sphere().array(FEW, align=[(0, 1, 0), (0, 0, 0), (0, 1, 0)]),
        "'align[1] of array' has no direction: it is zero",
    ),
    "no axis": (
        lambda: Sphere().array(FEW, align=np.eye(3), axis=(0, 0, 0)),
        "'axis of array' has no direction: it is zero",
    ),
    "no color": (
        lambda: Sphere().array(FEW, colors=["red", "grean", "blue"]),
        "'colors[1] of array' takes a color like #rrggbb or tomato, not 'grean'",
    ),
    "negative color": (
        lambda: Sphere().array(FEW, colors=[(0, 0, 0), (0, -1, 0), (0, 0, 0)]),
        "'colors[1] of array' must be a color without negative parts, not (0, -1, 0)",
    ),
    "no index": (
        lambda: copies([Sphere(), Box()], FEW, which=[0, 2, 1]),
        "'which[1] of copies' is from 0 to 1, not 2",
    ),
    "negative index": (
        lambda: copies([Sphere(), Box()], FEW, which=[0, -1, 1]),
        "'which[1] of copies' is from 0 to 1, not -1",
    ),
    "half an index": (
        lambda: copies([Sphere(), Box()], FEW, which=[0, 0.5, 1]),
        "'which[1] of copies' takes a whole number, not float 0.5",
    ),
    "no shape": (lambda: copies([], FEW), "copies needs at least one shape"),
    "something else": (lambda: copies([Sphere(), 2], FEW), "copies takes shapes, not 2"),
    "a flat shape": (lambda: copies(Circle(), FEW), "copies takes solid shapes"),
    "columns of a line": (
        lambda: Sphere().array(start=(0, 0, 0), end=(1, 0, 0), count=3, scale=2),
        "colors, scale, rotation and align need positions",
    ),
    "a union of nothing": (lambda: union([]), "union needs at least one shape, and there is none"),
    "an intersection of nothing": (
        lambda: intersection(s for s in ()),
        "intersection needs at least one shape, and there is none",
    ),
    "a union of numbers": (lambda: union([1, 2]), "union joins shapes, not 1"),
    "a union with a number": (lambda: union([Sphere(), 2]), "a union joins shapes, not 2"),
    "flat and solid": (
        lambda: union([Sphere(), Circle()]),
        "a union joins a flat shape and a solid one",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_name_the_row_and_the_line(name):
    make, message = ERRORS[name]
    with pytest.raises((SceneTypeError, SceneValueError)) as caught:
        make()
    (found,) = caught.value.diagnostics
    assert found.message == message
    assert found.span is not None
    assert found.span.file == __file__


def test_cells_stay_with_positions_alone():
    """The index of a copy is its cell in a repetition; a copy of a union has none."""
    ball = Sphere().paint(by_cell())
    assert ball.array(FEW).node.rule is along.REPEAT_AT
    assert ball.array(FEW, scale=[1, 1, 1]).node.rule is UNION
