"""What a checkup finds: claims that hold, claims that do not, where slope comes from."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from distal import Box, Cylinder, Hexagon, Plane, Scene, Shape, Sphere, Torus, time, union
from distal.lang import func, length, max, sin, slider, vec3
from distal.scene.checks.bounds_report import bounds_of_nodes
from distal.scene.checks.measuring import measure
from distal.scene.checks.validation import Severity, check, described


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def wobbly(p: vec3, depth: float) -> float:
    return length(p) - 1.0 - depth * sin(9.0 * p.x) * sin(9.0 * p.y)


@func
def half_a_ball(p: vec3) -> float:
    return 0.5 * (length(p) - 1.0)


@func
def kinked(p: vec3) -> float:
    """Slope 2 only in a small part: 2 % of the box's width."""
    return length(p) - 1.0 + max(0.0, p.x - 0.95 - max(0.0, 2.0 * (p.x - 0.97)))


@func
def rooted(p: vec3) -> float:
    inside = max(p.x, 0.0)
    return length(p) * (inside / inside) - 1.0


BOX = ((-1.2,) * 3, (1.2,) * 3)


def codes(checkup, severity=Severity.ERROR):
    return [
        (f.diagnostic.code, checkup.shapes[f.shape].node.name)
        for f in checkup.findings
        if f.severity is severity
    ]


def test_library_shapes_hold_and_say_nothing():
    found = check(Box(2.0).translate(1.0, 0.0, 0.0))
    assert found.holds
    assert found.findings == ()
    assert found.slope_from == ()
    assert [row.node.name for row in found.shapes] == ["translate", "Box"]
    assert found.shapes[0].declared.low == (0.0, -1.0, -1.0)
    assert found.shapes[1].declared.high == (1.0, 1.0, 1.0)
    measured = found.shapes[0].measured
    assert measured.median == pytest.approx(1.0, abs=1e-6)
    assert measured.slope == pytest.approx(1.0, abs=1e-6)


def test_a_slope_that_is_too_small_is_an_error_at_the_shape_that_gives_it():
    own = Shape.from_function(wobbly, slope=1.2, bounds=BOX, depth=0.05)
    found = check(own.translate(1.0, 0.0, 0.0) | Box(0.5))
    assert not found.holds
    assert codes(found) == [("slope-exceeded", "wobbly")]
    (error,) = [f for f in found.findings if f.severity is Severity.ERROR]
    # The steepest is 1 + 0.05 * 9 * sqrt(1): where sin is 0 for one factor and 1 for the other.
    assert found.shapes[error.shape].measured.slope == pytest.approx(1.45, abs=0.02)
    assert error.diagnostic.hint == "slope=1.5"
    assert error.diagnostic.span.text.strip().startswith("own = Shape.from_function(")


def test_a_slope_that_is_large_enough_holds():
    own = Shape.from_function(wobbly, slope=1.46, bounds=BOX, depth=0.05)
    assert check(own).holds
    notes = [("slope-raised", "wobbly"), ("slope-not-proved", "wobbly")]
    assert codes(check(own), Severity.NOTE) == notes


def test_what_is_steep_only_in_a_small_part_is_found():
    found = check(Shape.from_function(kinked, slope=1.5, bounds=BOX))
    assert codes(found) == [("slope-exceeded", "kinked")]


def test_parameters_and_time_are_those_asked_for():
    depth = slider("Depth", 0.0, high=0.2)
    own = Shape.from_function(wobbly, slope=1.2, bounds=BOX, depth=depth)
    assert check(own).holds
    assert not check(own, {"depth": 0.1}).holds


@func
def steep_outside(p: vec3) -> float:
    """Slope 1 within 11 of the origin, 4 beyond."""
    away = length(p)
    return away - 3.0 + 3.0 * max(away - 11.0, 0.0)


@func
def steep_far_away(p: vec3) -> float:
    """Slope 3 only near (40, 0, 0)."""
    return 0.5 * p.y + 3.0 * max(0.0, 1.0 - length(p - vec3(40.0, 0.0, 0.0)))


def test_points_lie_within_the_declared_bounds():
    own = Shape.from_function(steep_outside, bounds=((-3.0,) * 3, (3.0,) * 3))
    found = check(own)
    assert found.holds
    assert codes(found, Severity.WARNING) == []
    assert found.shapes[0].measured.slope == pytest.approx(1.0, abs=1e-6)
    # Around its bounds too, where rays come from; there it is only a warning.
    own = Shape.from_function(steep_outside, bounds=((-6.0,) * 3, (6.0,) * 3))
    found = check(own)
    assert found.holds
    assert codes(found, Severity.WARNING) == [("slope-outside-box", "steep_outside")]
    assert "outside its bounds, more than its declared slope 1" in str(found.findings[0])
    assert "slope=4.2 if rays come through there" in str(found.findings[0])
    # Within them, it is an error.
    large = Shape.from_function(steep_outside, bounds=((-9.0,) * 3, (9.0,) * 3))
    assert codes(check(large)) == [("slope-exceeded", "steep_outside")]


def test_a_function_without_bounds_is_measured_where_it_is_used():
    own = Shape.from_function(steep_far_away, slope=0.6)
    assert check(own).holds  # nothing tells where to look
    assert codes(check(own & Box(4.0).translate(40.0, 0.0, 0.0))) == [
        ("slope-exceeded", "steep_far_away")
    ]
    assert codes(check(own | Sphere().translate(40.0, 3.0, 0.0) | Box(1.0))) == [
        ("slope-exceeded", "steep_far_away")
    ]


def test_bounds_that_depend_on_parameters_are_measured(recwarn):
    reach = slider("Reach", 3.0, low=1.0, high=9.0)
    low, high = (-reach, -reach, -reach), (reach, reach, reach)
    own = Shape.from_function(steep_outside, bounds=(low, high))
    assert check(own).holds
    assert not check(own, {"Reach": 8.0}).holds
    Scene(own).render((4, 4))
    assert not recwarn.list
    own = Shape.from_function(steep_outside, bounds=(low, high))
    Scene(own).render((4, 4), params={"Reach": 8.0})
    assert "more than its declared slope 1" in str(recwarn.list[0].message)


def test_a_box_that_is_too_small_is_an_error():
    own = Shape.from_function(ball, bounds=((-1.0, -1.0, -1.0), (1.0, 1.0, 0.5)))
    assert codes(check(own)) == [("outside-box", "ball")]
    assert check(Shape.from_function(ball, bounds=((-1.0,) * 3, (1.0,) * 3))).holds


def test_what_is_called_exact_and_is_not_is_an_error():
    own = Shape.from_function(half_a_ball, bounds=BOX, exact=True)
    assert codes(check(own)) == [("not-exact", "half_a_ball")]
    assert check(Shape.from_function(ball, bounds=BOX, exact=True)).holds
    assert check(Shape.from_function(half_a_ball, bounds=BOX)).holds


def test_what_is_not_a_number_is_an_error():
    found = check(Shape.from_function(rooted, slope=9.0, bounds=BOX))
    assert ("undefined", "rooted") in codes(found)
    (error,) = [f for f in found.findings if f.diagnostic.code == "undefined"]
    assert error.diagnostic.message.startswith("'rooted' is not a number at (-")


def test_a_twist_tells_how_much_it_raises_the_slope_and_what_it_loses():
    shape = Box(1.0, 2.0, 1.0).twist(3.0) | Sphere(0.5)
    found = check(shape)
    (twist,) = found.slope_from
    row = found.shapes[twist]
    assert row.node.rule.name == "twist"
    assert row.raised == 1.0
    assert row.declared.slope == pytest.approx(shape.slope)
    notes = [f.diagnostic.message for f in found.findings if f.shape == twist]
    assert notes == [
        f"twist(rate=3) raises the slope from 1 to {shape.slope:.3g}",
        "twist(rate=3) is no longer exact outside, exact inside, a lower bound",
    ]
    assert all("Box(1.0, 2.0, 1.0).twist(3.0)" in f.diagnostic.span.text for f in found.findings)


def test_shapes_are_called_what_their_author_calls_them():
    own = Shape.from_function(wobbly, slope=1.5, bounds=BOX, depth=0.05)
    assert described(own.node) == "wobbly(depth=0.05)"
    die = (Box(2.0) - Sphere(1.2)).named("die")
    assert described(die.node) == "'die' (difference)"
    assert described(Sphere(0.5).named("eye").node) == "'eye' (Sphere(radius=0.5))"
    grid = Sphere(0.2).repeat(1.0, count=(2, 1, 2))
    assert described(grid.node) == (
        "repeat limited(spacing=(1, 1, 1), count_x=2, count_y=1, count_z=2)"
    )


def test_what_makes_boxes_endless_is_named():
    found = check(Box(0.2) | Plane())
    assert codes(found, Severity.NOTE) == [("claim-lost", "union"), ("no-box", "Plane")]
    own = check(Shape.from_function(ball))
    assert codes(own, Severity.WARNING) == [("no-box", "ball")]
    assert own.holds
    moved = check(Shape.from_function(ball, bounds=BOX).round(0.1))
    assert codes(moved, Severity.WARNING) == [("no-growth", "round")]
    assert "growth=1 for 'ball'" in str(moved.findings[0])
    assert not codes(check(Shape.from_function(ball, bounds=BOX, growth=1.0)), Severity.WARNING)


def test_blends_that_change_everything_are_warned_of():
    for blend in ("exponential", "root", "sigmoid"):
        found = check(Sphere().union(Box(), smooth=0.1, blend=blend))
        assert ("blend-everywhere", f"union {blend}") in codes(found, Severity.WARNING), blend
    found = check(Sphere().union(Box(), smooth=0.1, blend="cubic"))
    assert codes(found, Severity.WARNING) == []


def test_flat_shapes_have_boxes_of_two_numbers():
    found = check(Hexagon(1.0).extrude(0.5))
    assert found.holds
    flat = found.as_json()["shapes"][1]
    assert flat["flat"]
    assert len(flat["bounds"]["low"]) == 2


def test_promises_are_those_of_the_shapes_themselves():
    shape = (Box(1.0).twist(1.0) - Sphere(0.5).translate(0.2, 0.0, 0.0)).scale(2.0)
    found = bounds_of_nodes(shape.node, {}, 0.0)[id(shape.node)]
    assert found.slope == pytest.approx(shape.slope)
    assert found.divisor == pytest.approx(shape.divisor)
    low, high = shape.bounds()
    assert found.low == pytest.approx(low)
    assert found.high == pytest.approx(high)
    plane = Plane()
    assert not bounds_of_nodes(plane.node, {}, 0.0)[id(plane.node)].finite


def test_a_shape_in_several_places_has_one_row():
    one = Sphere(0.5)
    found = check(one.translate(1.0, 0.0, 0.0) | one.translate(-1.0, 0.0, 0.0))
    assert [row.node.name for row in found.shapes] == ["union", "translate", "Sphere", "translate"]
    assert found.shapes[1].children == found.shapes[3].children == (2,)


def test_a_large_tree_is_measured_where_it_matters():
    shape = Shape.from_function(wobbly, slope=1.2, bounds=BOX, depth=0.05)
    for i in range(40):
        shape = shape & Sphere(3.0 + 0.001 * i).translate(0.01 * i, 0.0, 0.0)
    found = check(shape)
    measured = {row.node.name for row in found.shapes if row.measured is not None}
    assert measured == {"intersection", "wobbly"}
    assert codes(found) == [("slope-exceeded", "wobbly")]


def test_one_part_of_each_kind_is_checked():
    wrong = Shape.from_function(wobbly, slope=1.2, bounds=BOX, depth=0.05)
    dots = [Sphere(0.1 + 0.001 * i).translate(0.1 * i, 2.0, 0.0) for i in range(400)]
    pegs = [Box(0.1).translate(0.1 * i, -2.0, 0.0).named("peg") for i in range(30)]
    found = check(dots[0].union([*dots[1:], *pegs, wrong, Plane()]))
    names = [row.node.name for row in found.shapes]
    assert names == ["union", "translate", "Sphere", "peg", "Box", "wobbly", "Plane"]
    assert codes(found) == [("slope-exceeded", "wobbly")]
    assert found.table is not None and found.table.count == 431
    assert [(k.name, k.count, k.columns) for k in found.table.kinds] == [
        ("Sphere", 400, 4),
        ("peg", 30, 3),
        ("wobbly", 1, 0),
    ]
    beside = [(b.name, b.reason) for b in found.table.beside]
    assert beside == [("Plane", "it has no finite box")]
    assert found.table.kinds[0].place.line == found.shapes[1].node.place.line
    assert json.loads(json.dumps(found.as_json()))["table"]["parts"] == 431


def test_parts_that_move_are_in_the_table_if_a_box_holds_them():
    waves = [Sphere(0.1).translate(0.3 * i, 0.1 * sin(time + 0.1 * i), 0.0) for i in range(20)]
    falling = Sphere(0.1).translate(0.0, -2.0 * time, 0.0).named("drop")
    speed = Shape.from_function(half_a_ball, slope=2.0 + time, bounds=BOX)
    found = check(waves[0].union([*waves[1:], falling, speed]))
    assert found.table is not None
    assert [(k.name, k.count, k.columns) for k in found.table.kinds] == [("Sphere", 20, 2)]
    assert [(b.name, b.reason) for b in found.table.beside] == [
        ("drop", "no finite box holds it at all times and for all values of its parameters"),
        (
            "half_a_ball",
            "no divisor of its values is known for all times and values of its parameters",
        ),
    ]


def test_plain_values_are_json_without_infinity():
    found = check(Shape.from_function(wobbly, slope=1.2, depth=0.05) | Plane())
    text = json.dumps(found.as_json(), allow_nan=False)
    made = json.loads(text)
    assert set(made) == {
        *("version", "holds", "slope_from", "table", "pieces", "bricks", "shapes", "findings")
    }
    assert made["shapes"][0]["bounds"] == {"low": [None] * 3, "high": [None] * 3}
    own = next(row for row in made["shapes"] if row["name"] == "wobbly")
    assert set(own) == {
        *("id", "name", "kind", "own_function", "flat", "children", "place", "claims", "slope"),
        *("slope_before", "estimate", "bounds", "measured"),
    }
    assert own["own_function"]
    assert own["place"]["file"] == __file__
    # Lines and columns as editors count them: the shape is made where this test calls for it.
    first = test_plain_values_are_json_without_infinity.__code__.co_firstlineno
    lines = Path(__file__).read_text("utf-8").splitlines()
    text = lines[own["place"]["line"] - 1][
        own["place"]["column"] - 1 : own["place"]["end_column"] - 1
    ]
    assert own["place"]["line"] == own["place"]["end_line"] == first + 1
    assert text == "Shape.from_function(wobbly, slope=1.2, depth=0.05)"
    assert made["version"] == 1  # the schema of docs/guide/checking.md
    assert set(made["findings"][0]) == {
        *("severity", "code", "shape", "message", "hint", "place", "file", "line", "column"),
        *("end_line", "end_column", "excerpt", "labels"),
    }


def test_measurements_are_the_same_for_the_same_seed():
    shape = Box(1.0).twist(2.0)
    declared = bounds_of_nodes(shape.node, {}, 0.0)[id(shape.node)]
    first, again, other = (measure(shape, declared, {}, 0.0, seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert math.isclose(first.median, other.median, rel_tol=0.05)


def test_the_bounds_of_each_of_many_parts_are_its_own():
    # Sliders keep the parts out of a table; parts are shared, and more than one function holds.
    height = slider("Height", 0.5, 0.1, 1.0)
    part = Torus(0.4, 0.1).rotate(x=height)
    parts = [part.translate(x=3.0 * i) for i in range(40)]
    found = bounds_of_nodes(union(parts).node, {}, 0.0)
    for i, one in enumerate(parts):
        low, high = found[id(one.node)].low, found[id(one.node)].high
        wanted = one.bounds()
        np.testing.assert_allclose((low, high), wanted, atol=1e-5)
        assert low[0] < 3.0 * i < high[0]


def moved_faces(shape):
    found = check(shape)
    return [f for f in found.findings if f.diagnostic.code == "flush-faces"]


def test_a_blend_that_moves_no_face_is_not_named():
    base, leg = Box(60, 14, 30).translate(0, 7, 0), Box(14, 50, 30).translate(-23, 25, 0)
    turned = (base.rotate(x=0.4, z=1.0) | leg.rotate(x=0.4, z=1.0)).fillet(8)
    for shape in (
        (base | leg).fillet(8),
        turned,
        (Box(40, 6, 30) | Cylinder(8, 30).translate(y=12)).fillet(4),
        (Box(60, 30, 30) & Box(40, 30, 50)).fillet(4),
        (Box(60, 30, 30) - Cylinder(5, 80)).chamfer(1),
        (Sphere(1.0) | Sphere(1.0).translate(1.2, 0, 0)).fillet(0.2),
    ):
        assert not moved_faces(shape)


def test_a_face_that_a_blend_moves_is_named_with_the_amount():
    # Two equal cylinders on one axis: their mantles are one face. By a circle through the points
    # (k, 0) and (0, k) about (k, k), it moves by k (1 - sqrt(1/2)).
    pins = Cylinder(10, 30) | Cylinder(10, 30).translate(y=10)
    (found,) = moved_faces(pins.fillet(2))
    assert found.severity is Severity.WARNING
    amount = float(found.diagnostic.message.split("by up to ")[1].split(",")[0])
    assert amount == pytest.approx(2.0 * (1.0 - math.sqrt(0.5)), rel=0.03)
    assert "outwards" in found.diagnostic.message
    # A smooth union bulges by its size, an intersection of other shapes shrinks.
    (found,) = moved_faces(Box(60, 14, 30).union(Box(14, 14, 50), smooth=1.5))
    assert found.severity is Severity.NOTE
    assert "outwards by up to 1.5, at (" in found.diagnostic.message
    assert "fillet(radius)" in found.diagnostic.hint
    hollow = Box(60, 30, 30) - Box(70, 1, 1)
    (found,) = moved_faces((hollow & Box(40, 30, 50)).fillet(4))
    assert f"inwards by up to {4.0 * (1.0 - math.sqrt(0.5)):.3g}, at (" in found.diagnostic.message
    assert found.diagnostic.hint == "let one of the two reach beyond the face, by 4 or more"
    assert found.diagnostic.span.text.strip().startswith("(found,) = moved_faces((hollow")


def test_a_profile_that_is_too_large_for_a_prism_is_named():
    """In the middle of a plate of 6, both distances are at most 3."""
    thin = (Box(60, 6, 30) & Box(40, 6, 50)).fillet(8)
    (found,) = moved_faces(thin)
    amount = 8.0 - math.sqrt(64.0 - 25.0)
    assert f"inwards by up to {amount:.3g}: both shapes end in the same" in found.diagnostic.message
    assert found.diagnostic.hint == "a size of at most 3, half of that"
    x = np.array([20.0 - amount - 1e-6, 20.0 - amount + 1e-6])
    assert (thin(np.stack([x, 0.0 * x, 0.0 * x], axis=1)) <= 0.0).tolist() == [True, False]
    chamfered = (Box(60, 6, 30) & Box(40, 6, 50)).chamfer(5)
    x = np.array([20.0 - 2.0 - 1e-6, 20.0 - 2.0 + 1e-6])
    assert (chamfered(np.stack([x, 0.0 * x, 0.0 * x], axis=1)) <= 0.0).tolist() == [True, False]
    assert "inwards by up to 2: " in moved_faces(chamfered)[0].diagnostic.message
    (found,) = moved_faces((Box(60, 6, 30) & Box(40, 6, 50)).chamfer(8))
    assert "leaves nothing: both shapes end in the same planes, 6 apart" in found.diagnostic.message
