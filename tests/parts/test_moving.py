"""Parts that move are in a table: the same pictures as without, and boxes that hold them always."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from distal import (
    Box,
    Camera,
    Capsule,
    DistantLight,
    Plane,
    RoundBox,
    Scene,
    Shape,
    Sphere,
    Torus,
    checker,
    time,
    union,
)
from distal.lang import func, length, slider, vec3
from distal.scene.checks.probe import probe
from distal.scene.lowering.parts.flatten import members_of
from distal.scene.lowering.parts.kind_boxes import bounds_of, columns_of, swept_bounds_of
from distal.scene.lowering.parts.kinds import HEAD, kinds_of
from distal.scene.lowering.parts.moving_boxes import MovingBoxes
from distal.scene.lowering.parts.table import ENDLESS_MOTION, rolled

SIZE = (48, 36)
EYE = Camera((3.0, 2.5, 5.0), target=(0.0, 0.0, 0.0))
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.05)
SWING = slider("Swing", 0.4, low=-1.0, high=1.0)
TURN = slider("Turn", 1.0, low=0.0, high=6.0)
TIMES = [(0.0, {}), (1.7, {"Swing": -1.0, "Turn": 6.0}), (1234.5, {"Swing": 0.9, "Turn": 0.0})]


def kinds(*shapes):
    return kinds_of(members_of(union(shapes).node))


def numbers(rng, count=1):
    found = [float(n) for n in rng.uniform(-1.0, 1.0, count)]
    return found[0] if count == 1 else found


def motion(rng):
    """A number that moves between bounds."""
    a, b, c = numbers(rng, 3)
    return (
        lambda: 0.5 * a * np.sin(time * b + c),
        lambda: SWING * a + 0.3 * np.cos(2.0 * time + c),
        lambda: (time * b + c) % 1.0 - 0.5,
        lambda: 0.4 * abs(np.sin(time + c)) * SWING,
        lambda: a,
    )[rng.integers(5)]()


def part(rng, size=0.3):
    """A shape that moves, turns, grows, or stands still."""
    a, b = (float(n) for n in rng.uniform(0.3, 1.0, 2) * size)
    made = [
        lambda: Sphere(a * (1.0 + 0.3 * np.sin(time + b))),
        lambda: Box(a, b, a),
        lambda: Torus(a, 0.3 * a).rotate(x=time * a + 3.0 * b),
        lambda: Capsule(0.3 * b, a),
    ][rng.integers(4)]()
    if rng.random() < 0.6:
        made = made.rotate(y=TURN * a + time, z=float(rng.uniform(-3, 3)))
    if rng.random() < 0.3:
        made = made.scale(1.0 + 0.4 * SWING)
    x, y, z = (float(n) for n in rng.uniform(-1.5, 1.5, 3))
    made = made.translate(x + motion(rng), y + motion(rng), z)
    red, green = (float(n) for n in rng.uniform(0.1, 0.9, 2))
    return made.paint((red, green, 0.5 + 0.4 * np.sin(time + 6.0 * red)))


def many(seed, count=16):
    rng = np.random.default_rng(seed)
    return union([part(rng) for _ in range(count)])


def both(shape, seconds, params, **given):
    """Return the pictures with and without a table."""
    given = {"camera": EYE, "lights": SUN, "background": (0.1, 0.2, 0.4), **given}
    scenes = [Scene(shape, acceleration=a, **given) for a in (True, False)]
    assert rolled(scenes[0].shape.node).table is not None
    frame = {"size": SIZE, "samples": 1, "time": seconds, "params": params}
    return [s.render(**frame).array.astype(float)[..., :3] for s in scenes]


def far_off(a, b, limit=0.05):
    return float((np.abs(a - b).max(axis=-1) > limit).mean())


# Kinds


def test_expressions_that_differ_in_constants_are_one_kind():
    (kind,) = kinds(
        *(Sphere(0.1).translate(1.0 * i, 0.3 * np.sin(time + 0.1 * i), 0.0) for i in range(5))
    )
    assert kind.moving and kind.floats == 2 and kind.width == HEAD + 2
    x, phase = columns_of(kind)
    assert x.tolist() == [0, 1, 2, 3, 4] and phase == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])


@pytest.mark.parametrize(
    ("a", "b"),
    [
        (np.sin(time), np.cos(time)),
        (np.sin(time), 0.5 * np.sin(time)),
        (time % 1.0, 0.5),
        (SWING * 0.5, TURN * 0.5),
    ],
    ids=["function", "operator", "constant", "slider"],
)
def test_other_expressions_are_other_kinds(a, b):
    assert len(kinds(*(Sphere(0.1).translate(0.0, n, 0.0) for n in (a, b, a)))) == 2


def test_one_expression_of_all_parts_has_no_columns():
    turned = [Box(0.1).rotate(y=time * 0.5).translate(float(i), 0, 0) for i in range(3)]
    (kind,) = kinds(*turned)
    assert kind.moving and len(kind.columns) == 1


def test_a_long_expression_is_a_structure_of_its_own():
    def nested(phase):
        value = time + phase
        for _ in range(30):
            value = np.sin(value + phase) + value
        return Sphere(0.1).translate(0.1 * np.sin(value), 0.0, 0.0)

    assert len(kinds(nested(0.1), nested(0.2), nested(0.1))) == 2


def test_colors_that_change_with_time_have_columns_too():
    (kind,) = kinds(
        *(Sphere(0.1).paint((0.5 + 0.5 * np.sin(time + i), 0.2, 0.1)) for i in range(4))
    )
    assert not kind.moving and len(kind.columns) == 1


# Pictures


@settings(max_examples=2)
@given(st.integers(0, 10**6), st.sampled_from(TIMES))
def test_random_parts_that_move_have_the_same_picture(seed, when):
    a, b = both(many(seed) | Plane(y=-1.9), *when)
    assert a.std() > 0.01
    assert far_off(a, b) < 0.01


@pytest.mark.parametrize("when", TIMES)
def test_one_kind_of_many_parts_at_several_times(when):
    rng = np.random.default_rng(4)
    balls = [
        Sphere(0.1).translate(x, 0.5 * np.sin(TURN * time + y), z + 0.3 * SWING).paint(checker())
        for x, y, z in rng.uniform(-1.5, 1.5, (40, 3)).tolist()
    ]
    whole = union(balls) | Plane(y=-1.0)
    assert isinstance(rolled(whole.node).table.boxes, MovingBoxes)
    a, b = both(whole, *when, ambient_occlusion=0.3)
    assert far_off(a, b) < 0.01


@pytest.mark.parametrize("device", ["reference", "gpu", "gpu-fragment"])
def test_targets_agree(device):
    scene = Scene(many(9, 16) | Plane(y=-1.9), camera=EYE, lights=SUN, ambient_occlusion=0.4)
    frame = {"size": (24, 18), "samples": 1, "time": 2.3, "params": {"Swing": -0.5}}
    pictures = [scene.render(device=d, **frame).array for d in ("cpu", device)]
    a, b = (p.astype(float)[..., :3] for p in pictures)
    assert far_off(a, b, 0.02) < 0.01


def test_boxes_of_all_times_show_the_same_as_those_of_the_picture(monkeypatch):
    rng = np.random.default_rng(6)
    balls = [
        Box(0.3).rotate(y=time + x).translate(x, 0.5 * np.sin(time + y), z)
        for x, y, z in rng.uniform(-1.5, 1.5, (40, 3)).tolist()
    ]
    whole = union(balls) | Plane(y=-1.0)
    scene = Scene(whole, camera=EYE, lights=SUN)
    frame = {"size": SIZE, "samples": 1, "time": 2.3}
    a = scene.render(**frame).array.astype(float)
    monkeypatch.setattr(MovingBoxes, "at", lambda self, params, time: self.data)
    b = scene.render(**frame).array.astype(float)
    assert far_off(a, b, 0.02) < 0.01


def test_the_steps_view_and_the_probe_see_parts_where_they_are():
    # A ball without a chord, so that it is marched.
    dots = [
        RoundBox(0.2, 0.2, 0.2, rounding=0.1)
        .translate(0.3 * i - 2.3, np.sin(time * 0.5 + 1e-3 * i), 0.0)
        .named(f"dot {i}")
        .paint((0.05 * i, 0.2, 0.2 + 0.1 * np.sin(time)))
        for i in range(16)
    ]
    camera = Camera((0.1, 1.0, 5.0), target=(0.1, 1.0, 0.0))
    scene = Scene(union(dots), camera=camera, lights=SUN)
    assert len(rolled(scene.shape.node).table.kinds) == 1
    there = np.pi
    found = probe(scene, (50, 50), (101, 101), time=there)
    assert found.hit and found.path[-2].name == "dot 8"
    assert found.seen.surface.color.x == pytest.approx(0.4, abs=1e-5)
    assert not probe(scene, (50, 50), (101, 101), time=0.0).hit
    seen = scene.render(size=(41, 41), view="steps", time=there).array[..., :3].astype(float)
    still = scene.render(size=(41, 41), view="steps", time=0.0).array[..., :3].astype(float)
    assert np.abs(seen[20] - still[20]).max() > 0.03


def test_the_distance_is_that_of_the_parts_at_the_time():
    rng = np.random.default_rng(2)
    parts = [part(rng) for _ in range(16)]
    points = rng.uniform(-3, 3, (400, 3))
    for seconds, params in TIMES:
        expected = np.min([p(points, time=seconds, params=known(p, params)) for p in parts], axis=0)
        found = union(parts)(points, time=seconds, params=params)
        assert found == pytest.approx(expected, abs=2e-5)


def known(shape, params):
    names = {p.label for p in shape.parameters()} if hasattr(shape, "parameters") else set()
    return {name: value for name, value in params.items() if name in names}


# Boxes


def at_times(tree, seconds, params):
    """Return the corners of the boxes of a tree's parts, by part."""
    rows = np.asarray(tree.at(params, seconds)).reshape(-1, 2, 4)
    leaves = rows[rows[:, 1, 3] >= 0]
    order = np.argsort(leaves[:, 1, 3])
    return leaves[order, 0, :3], leaves[order, 1, :3]


@settings(max_examples=6)
@given(st.integers(0, 10**6))
def test_boxes_hold_their_parts_at_all_times(seed):
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.uniform(-1.0, 1.0, (4, 20)).tolist()
    parts = [
        Box(0.2, 0.1 + 0.05 * np.sin(time + a[i]), 0.3)
        .rotate(y=TURN + time * b[i], x=c[i])
        .translate(a[i] + 0.5 * np.sin(time * 3.0 + b[i]), SWING * c[i], (time + d[i]) % 1.0)
        for i in range(20)
    ]
    (kind,) = kinds(*parts)
    swept = swept_bounds_of(kind)
    table = rolled(union(parts).node).table
    for _ in range(4):
        seconds = float(rng.choice([rng.uniform(-10, 10), rng.uniform(0, 1e3)]))
        params = {"swing": float(rng.uniform(-1, 1)), "turn": float(rng.uniform(0, 6))}
        low, high = at_times(table.boxes, seconds, params)
        assert (swept.low <= low + 2e-3).all() and (swept.high >= high - 2e-3).all()
        for i in range(0, 20, 5):
            points = rng.uniform(low[i] - 0.3, high[i] + 0.3, (4000, 3))
            inside = points[parts[i](points, time=seconds, params=params) <= 0.0]
            assert len(inside) > 5
            assert (inside >= low[i]).all() and (inside <= high[i]).all()
            assert (inside >= swept.low[i]).all() and (inside <= swept.high[i]).all()


def test_boxes_of_all_times_are_not_much_larger_than_they_must_be():
    (kind,) = kinds(
        *(Sphere(0.1).translate(float(i), 0.3 * np.sin(time + i), time % 2.0) for i in range(3))
    )
    swept = swept_bounds_of(kind)
    assert swept.low == pytest.approx(np.array([[i - 0.1, -0.4, -0.1] for i in range(3)]), abs=1e-4)
    assert swept.high == pytest.approx(np.array([[i + 0.1, 0.4, 2.1] for i in range(3)]), abs=1e-4)
    assert bounds_of(kind).high[:, 1] == pytest.approx([0.1 + 0.3 * np.sin(i) for i in range(3)])


ELEMENTARY = (
    *("sin", "cos", "tan", "arcsin", "arccos", "arctan", "sinh", "cosh", "tanh"),
    *("exp", "exp2", "log", "log2", "sqrt", "floor", "ceil", "abs", "trunc"),
)


@pytest.mark.sample(2, each="name")
@pytest.mark.parametrize("name", ELEMENTARY)
@pytest.mark.parametrize("reach", [(0.9, 0.0), (0.4, -0.3), (0.3, 0.5), (3.0, 2.0)])
def test_boxes_of_all_times_hold_what_moves_by_any_function(name, reach):
    wide, middle = reach
    function = getattr(np, name)
    (kind,) = kinds(*(Sphere(0.1).translate(y=function(SWING * wide + middle)) for _ in range(2)))
    swept = swept_bounds_of(kind)
    angles = np.linspace(-1.0, 1.0, 2001) * wide + middle
    with np.errstate(all="ignore"):
        y = function(angles)
    y = y[np.isfinite(y)]
    assert swept.low[0, 1] <= y.min() - 0.0999 and swept.high[0, 1] >= y.max() + 0.0999


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_part_that_turns_is_as_long_along_its_axis_as_ever(axis):
    (kind,) = kinds(*(Box(0.2, 0.4, 0.6).rotate(**{axis: time + i}) for i in range(2)))
    swept, i = swept_bounds_of(kind), "xyz".index(axis)
    half = (0.1, 0.2, 0.3)[i]
    assert swept.low[:, i] == pytest.approx(-half, abs=1e-4)
    assert swept.high[:, i] == pytest.approx(half, abs=1e-4)
    around = sum((0.1, 0.2, 0.3)) - half
    assert np.delete(swept.high, i, axis=1) == pytest.approx(around, abs=1e-3)


@pytest.mark.parametrize(
    "make",
    [
        lambda i: Sphere(0.1).translate(0.1 * i, time * (1.0 + i), 0.0),
        lambda i: Sphere(0.1 + 0.01 * (i + 1) * time),
        lambda i: Sphere(0.1).scale(2.0 + np.tan(time + 0.1 * i)),
    ],
    ids=["falls", "grows", "tangent"],
)
def test_what_no_box_holds_is_beside_the_table(make):
    still = [Sphere(0.1).translate(0.3 * i, 0.0, 0.0) for i in range(16)]
    found = rolled(union([*still, *(make(i) for i in range(3))]).node)
    assert found.table.count == 16
    assert [why for _, why in found.beside] == [ENDLESS_MOTION] * 3


@pytest.mark.parametrize("speed", [1e-30, 1e30])
@pytest.mark.parametrize("radius", [1e-20, 1e-6, 2.0])
def test_extreme_numbers_give_pictures_without_nan(speed, radius):
    dots = [
        Sphere(radius * np.sin(time * speed) ** 2).translate(0.3 * i - 2.0, time * 1e-30 % 1.0, 0.0)
        for i in range(17)
    ]
    scene = Scene(union(dots), camera=EYE, lights=SUN)
    for seconds in (0.0, 1e3, 1e6):
        found = scene.render(size=(8, 6), samples=1, time=seconds, device="reference").array
        assert np.isfinite(found).all()


def test_parts_that_stand_still_have_boxes_that_are_computed_once():
    still = [Sphere(0.1).translate(0.3 * i, 0.0, 0.0) for i in range(20)]
    few = [Box(0.1).translate(0.0, np.sin(time + i), 0.0) for i in range(4)]
    assert not isinstance(rolled(union([*still, *few]).node).table.boxes, MovingBoxes)


# Parts whose values need a divisor


@func
def ripples(p: vec3, steep: float) -> float:
    return steep * (length(p) - 0.2)


def steep_parts(count=18):
    box = ((-0.2,) * 3, (0.2,) * 3)
    return [
        Shape.from_function(ripples, slope=1.0 + i, bounds=box, growth=1.0, steep=1.0 + i)
        .translate(0.45 * (i % 6) - 1.2, 0.45 * (i // 6) - 0.5, 0.0)
        .paint((0.05 * i, 0.4, 0.3))
        for i in range(count)
    ]


def test_parts_that_need_a_divisor_are_in_the_table():
    parts = steep_parts()
    table = rolled(union(parts).node).table
    (kind,) = table.kinds
    assert kind.factor is not None and table.count == 18 and table.divisor == 18.0
    row = np.asarray(table.rows.data).reshape(18, -1)
    assert row[:, kind.factor] == pytest.approx([1.0 / (1.0 + i) for i in range(18)])
    a, b = both(union(parts) | Plane(y=-0.9), 0.0, {}, ambient_occlusion=0.3)
    assert far_off(a, b) < 0.01


def test_the_field_of_a_part_is_not_divided():
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (300, 3))
    parts = steep_parts()
    values = np.array([p(points) for p in parts])
    distances = values / np.arange(1.0, 19.0)[:, None]
    expected = np.take_along_axis(values, distances.argmin(axis=0)[None], axis=0)[0]
    assert union(parts)(points) == pytest.approx(expected, abs=1e-4)
