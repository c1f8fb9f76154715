"""Joined shapes that move, and blends that change, in pieces and bricks: right at all times."""

from __future__ import annotations

import numpy as np
import pytest

from distal import Box, Camera, Capsule, Cylinder, DistantLight, Scene, Sphere, Torus, time, union
from distal.lang import slider
from distal.lang.expressions import Expression
from distal.lang.runtime_access import executor
from distal.scene.checks.validation import check
from distal.scene.lowering.derived import DistanceOf
from distal.scene.lowering.parts.table import BrickNode
from distal.scene.lowering.pieces.brick_table import bricked
from distal.scene.lowering.pieces.programs import program_of
from distal.scene.lowering.pieces.table import FAR, MOVED, leaves_of, pieced

RADIUS = slider("Radius", 0.12, low=0.04, high=0.18)
SHIFT = slider("Shift", 0.0, low=-1.0, high=1.0)
SOFT = slider("Soft", 0.01, low=0.0, high=0.06)
CASES = [
    (0.0, {}),
    (1.7, {"Radius": 0.04, "Shift": -1.0, "Soft": 0.0}),
    (4.1, {"Radius": 0.18, "Shift": 0.97, "Soft": 0.06}),
    (1234.5, {"Radius": 0.1, "Shift": 0.3, "Soft": 0.001}),
]
pytestmark = pytest.mark.usefixtures("always_pieces")
SIZE = (64, 48)
EYE = Camera((3.0, 2.5, 5.0), target=(0.0, 0.0, 0.0))
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.05)


def holes(radius, side=6):
    return [
        Cylinder(radius, 1).translate(0.4 * i - 1, 0, 0.4 * j - 1)
        for i in range(side)
        for j in range(side)
    ]


def balls(count, seed=0, radius=0.25):
    rng = np.random.default_rng(seed)
    return [Sphere(radius).translate(*p) for p in rng.uniform(-1, 1, (count, 3)).tolist()]


def swinging(count, seed=0):
    rng = np.random.default_rng(seed)
    made = []
    for x, y, z, a, b in rng.uniform(-1, 1, (count, 5)).tolist():
        part = [Box(0.3, 0.2, 0.4), Torus(0.2, 0.06), Capsule(0.1, 0.3)][len(made) % 3]
        part = part.rotate(y=time * a + b)
        made.append(part.translate(x, y + 0.1 * np.sin(time + 3.0 * a), z + 0.1 * SHIFT))
    return made


TREES = {
    "holes": lambda: Box(2.6, 0.3, 2.6) - union(holes(RADIUS)),
    "one cutter": lambda: Box(2.6, 0.3, 2.6) - union(
        [*holes(0.1), Box(0.5, 2.0, 0.5).translate(SHIFT, 0.0, 0.2)]
    ),
    "painted cutters": lambda: (
        Box(2, 2, 2).paint("gray") - union(holes(RADIUS)).cut_material("gold")
    ),
    "soft": lambda: union([*balls(24, radius=0.2), *swinging(8)], smooth=0.01),
    "size of a blend": lambda: union(balls(30, radius=0.2), smooth=SOFT) - Box(1, 4, 1),
    "scaled blend": lambda: (union(balls(30, radius=0.2), smooth=SOFT) - Box(1, 4, 1)).scale(0.8),
    "shell": lambda: (union(balls(20, radius=0.4)).shell(0.1) - union(swinging(6, 1))),
    "shared": lambda: union(swinging(24)) & Sphere(1.0 + 0.2 * SHIFT),
}  # fmt: skip


def values(function, points, seconds, params):
    found = executor().call(
        function, (points,), {}, params=params, time=seconds, device="reference"
    )
    return np.asarray(found)


def known(viewable, params):
    """Those of some values that a shape or scene has parameters for."""
    names = {p.label for p in viewable.parameters()}
    return {name: value for name, value in params.items() if name in names}


def read_by(node, params):
    """Those of some values that a tree has parameters for."""
    numbers = [n.value for inner in node.walk() for n in inner.numbers.values()]
    read = {p.label for n in numbers if isinstance(n, Expression) for p in n.parameters}
    return {name: value for name, value in params.items() if name in read}


def far_off(a, b, limit=0.05):
    """The share of pixels that differ."""
    return float((np.abs(a - b).max(axis=-1) > limit).mean())


@pytest.mark.parametrize("name", TREES)
def test_pictures_are_those_of_the_tree(name):
    shape = TREES[name]()
    assert pieced(shape.node).table is not None
    given = {"camera": EYE, "lights": SUN, "background": (0.1, 0.2, 0.4)}
    scenes = [Scene(shape, acceleration=a, **given) for a in (True, False)]
    for seconds, params in CASES:
        params = known(scenes[0], params)
        frame = {"size": SIZE, "samples": 1, "time": seconds, "params": params}
        a, b = (s.render(**frame).array.astype(float)[..., :3] for s in scenes)
        assert far_off(a, b) < 0.02, (seconds, params)


@pytest.mark.parametrize("name", TREES)
def test_values_are_those_of_the_tree_at_all_times(name):
    shape = TREES[name]()
    rng = np.random.default_rng(3)
    found = bricked(shape.node, exact=True)
    assert found.tables
    low, high = np.array(found.tables[0].table.low), np.array(found.tables[0].table.high)
    for seconds, params in CASES:
        params = known(shape, params)
        points = rng.uniform(1.2 * low, 1.2 * high, (1500, 3))
        expected = values(DistanceOf(shape.node), points, seconds, params)
        got = values(shape, points, seconds, params)
        assert np.abs(got - expected).max() < 1e-6, (seconds, params)


def test_ends_of_moving_leaves_hold():
    program = program_of(TREES["shared"]().node)
    leaves = leaves_of(program)
    rng = np.random.default_rng(5)
    number = rng.integers(0, len(program.leaves), 300)
    points = rng.uniform(-3, 3, (300, 3))
    low, high = leaves.distances(points, number)
    assert np.isfinite(low).all() and (low < high).sum() > 200
    for seconds, params in CASES:
        for leaf in range(len(program.leaves)):
            mine = number == leaf
            part = program.leaves[leaf].part
            at = values(DistanceOf(part), points[mine], seconds, read_by(part, params))
            assert (at >= low[mine] - 1e-6).all() and (at <= high[mine] + 1e-6).all()


def test_the_box_of_a_moving_shape_is_that_of_its_time():
    made = Box(2.6, 0.3, 2.6) - union(holes(RADIUS))
    lid = Box(0.4).translate(3.0 * SHIFT, 0.0, 0.0)
    whole = union([made, lid, *balls(20)]) - union(balls(20, 1))
    for shift in (0.0, 1.0):
        _, high = whole.bounds(params={"Shift": shift})
        assert high[0] < (1.5 if shift == 0.0 else 3.3)


def test_what_moves_as_a_whole_has_bricks_below():
    plate = Box(2.6, 0.3, 2.6) - union(holes(0.1))
    for moved in (plate.rotate(y=time), plate.translate(SHIFT, 0, 0)):
        assert pieced(moved.node).table is None
        found = bricked(moved.node, exact=True)
        assert isinstance(found.node.children[0], BrickNode)
    two = plate.rotate(y=time) - plate.translate(0, 0.2, 0)
    assert pieced(two.node).reason == MOVED


def test_shapes_that_travel_through_each_other_have_no_pieces():
    orbits = [
        Sphere(0.2).translate(np.sin(time + i), np.cos(time + i), 0.1 * np.sin(3 * time + i))
        for i in range(30)
    ]
    tree = union(orbits) & Box(3.0)
    assert pieced(tree.node).reason == FAR
    report = check(tree)
    assert report.pieces is not None and report.pieces.whole[0].reason == FAR
