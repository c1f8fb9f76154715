"""A tree of joined shapes has the same values with its bricks as without, at any place."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from distal import Box, Capsule, Cylinder, Ellipsoid, Plane, Sphere, Torus, cell, time, union
from distal.diagnostics import CompileError
from distal.fields.combine.blends import BLENDS
from distal.lang.runtime_access import executor
from distal.scene.checks.validation import check
from distal.scene.lowering.derived import DistanceOf
from distal.scene.lowering.parts.table import LEAST_PARTS, MOST_WITHOUT, BrickNode
from distal.scene.lowering.pieces import brick_table
from distal.scene.lowering.pieces.brick_table import bricked
from distal.scene.lowering.pieces.joins import MOVING_BLEND
from distal.scene.lowering.pieces.table import DENSE
from tests.pieces.random_trees import random_tree

MANY = LEAST_PARTS + 8
LOCAL = [name for name, blend in BLENDS.items() if blend.width is not None]


def called(function, points):
    return np.asarray(executor().call(function, (points,), {}, device="reference"))


def values(node, points):
    return called(DistanceOf(node), points)


def data_of(shape, *, exact=True):
    (node,) = bricked(shape.node, exact=exact).tables
    return node.table.programs.bricks


def places(bricks, rng, count=800):
    """Points in the grid, on the borders of bricks, near the grid, and far away."""
    low, high = np.array(bricks.low), np.array(bricks.high)
    inside = rng.uniform(low, high, (count, 3))
    per_unit = np.array(bricks.per_unit)
    borders = np.clip(low + np.round((inside - low) * per_unit) / per_unit, low, high)
    mixed = np.where(rng.random(inside.shape) < 0.5, inside, borders)
    side = (high - low).max()
    beside = rng.uniform(low - side, high + side, (count // 2, 3))
    beside = beside[((beside < low) | (beside > high)).any(axis=1)]
    return np.concatenate([inside, borders, mixed]), np.concatenate([beside, 100.0 * beside])


def agree(shape, seed=0, limit=1e-7):
    """Check the values inside of the grid, and those outside."""
    made = data_of(shape)
    inside, outside = places(made, np.random.default_rng(seed))
    size = np.abs([made.low, made.high]).max()
    for points, least in ((inside, size), (outside, np.abs(outside).max())):
        expected = values(shape.node, points)
        assert np.abs(called(shape, points) - expected).max() <= limit * max(least, 1.0)
    return made


def balls(rng, count=MANY, small=0.05, large=0.5):
    sizes = np.exp(rng.uniform(np.log(small), np.log(large), count))
    places = rng.uniform(-1, 1, (count, 3))
    return [Sphere(float(r)).translate(*p) for r, p in zip(sizes, places, strict=True)]


def solids(rng, count=MANY):
    """Members of several kinds, turned, scaled, rounded; one several times."""
    made = []
    for i in range(count):
        a, b = (float(x) for x in rng.uniform(0.05, 0.4, 2))
        part = [
            Sphere(a), Box(a, b, a), Torus(a, 0.3 * a), Capsule(b, a), Ellipsoid((a, b, a))
        ][i % 5]  # fmt: skip
        if rng.random() < 0.5:
            part = part.rotate(x=float(rng.uniform(-3, 3)), y=1.0).scale(float(rng.uniform(0.5, 2)))
        made.append(part.translate(*rng.uniform(-1, 1, 3)))
    return [*made[:-2], made[0], made[1]]


def plate(count=25):
    side = round(count**0.5)
    holes = [
        Cylinder(0.3, 4.0).translate(i - 0.5 * side, 0.0, j - 0.5 * side)
        for i in range(side)
        for j in range(side)
    ]
    return Box(side + 1.0, 0.5, side + 1.0) - union(holes)


@pytest.mark.parametrize("blend", LOCAL)
def test_every_local_blend(blend):
    rng = np.random.default_rng(3)
    more = {"count": 3} if BLENDS[blend].counted else {}
    agree(union(balls(rng), smooth=0.08, blend=blend, **more))


@settings(max_examples=5)
@example(0, 1e-9, 1e-3, 1.0)
@example(1, 3.0, 0.05, 0.5)
@example(2, 1e-6, 1e-4, 1e-3)
@given(
    st.integers(0, 10**6),
    st.floats(1e-4, 2.0),
    st.floats(1e-4, 0.1),
    st.floats(0.1, 3.0),
)
def test_random_balls_and_sizes(seed, smooth, small, large):
    made = balls(np.random.default_rng(seed), MANY, small, large)
    agree(union(made, smooth=smooth, blend="cubic"), seed)


@pytest.mark.parametrize("seed", range(12))
def test_random_trees(seed):
    rng = np.random.default_rng(seed)
    shape = random_tree(rng, 30, [] if seed % 3 == 0 else LOCAL)
    if not bricked(shape.node, exact=True).tables:
        pytest.skip("nothing is left of it")
    agree(shape, seed, 1e-6)


@settings(max_examples=2)
@given(st.integers(0, 10**6), st.sampled_from(LOCAL[:4]))
def test_members_of_many_kinds(seed, blend):
    rng = np.random.default_rng(seed)
    made = union(solids(rng), smooth=float(rng.uniform(0.01, 0.2)), blend=blend)
    agree(made, seed, 3e-6)


@pytest.mark.parametrize(
    "make",
    [
        plate,
        lambda: Box(2.0, 2.0, 2.0) - union(balls(np.random.default_rng(1), 40, 0.1, 0.3)),
        lambda: union(balls(np.random.default_rng(1))) & Ellipsoid(1.0, 0.7, 1.0),
        lambda: union(balls(np.random.default_rng(1))).shell(0.05) - Box(4).translate(2, 0, 0),
        lambda: Box(2.0, 2.0, 2.0) & union(balls(np.random.default_rng(1))).complement(),
        lambda: (plate() | Torus(2.0, 0.4)).round(0.05).scale(0.7).rotate(x=0.4),
        lambda: plate().difference(union(balls(np.random.default_rng(2))), smooth=0.1),
    ],
)
def test_differences_intersections_and_changes(make):
    agree(make())


def test_influence_along_a_chain_of_blends():
    # Each ball is out of reach of the next but one; all of them together move the last.
    row = [Sphere(0.3).translate(0.55 * i, 0.0, 0.0) for i in range(MANY)]
    agree(union(row, smooth=0.2))
    agree(union(row[::-1], smooth=0.2))
    shells = [Sphere(0.1 + 0.02 * i) for i in range(MANY)]
    agree(union(shells, smooth=0.1))
    agree(union(shells[::-1], smooth=0.1))


def test_a_chain_with_several_sizes_and_blends():
    rng = np.random.default_rng(8)
    made, *others = balls(rng)
    for i, ball in enumerate(others):
        if i % 7 == 3:
            made = made | ball
        else:
            blend = ("quadratic", "quartic", "circular")[i % 3]
            made = made.union(ball, smooth=float(rng.uniform(0.0, 0.2)), blend=blend)
    agree(made.union(Sphere(0.2).translate(0.0, 1.0, 0.0), smooth=0.1))


def test_surfaces_that_are_moved_far_out_are_exact():
    rng = np.random.default_rng(9)
    for whole in (
        union(balls(rng), smooth=0.05).offset(3.0),
        union(balls(rng), smooth=0.05).union(Sphere(0.5).translate(4.0, 0.0, 0.0), smooth=2.0),
        Sphere(4.0).clearance(union(balls(rng), smooth=0.05), 2.5),
        plate().twist(0.2).offset(1.0),
    ):
        points = rng.uniform(-8, 8, (1000, 3))
        node = bricked(whole.node, exact=True).node
        assert node is not whole.node
        assert values(node, points) == pytest.approx(values(whole.node, points), abs=2e-6)


def test_gradients_are_those_of_the_tree():
    rng = np.random.default_rng(3)
    shape = plate()
    points = rng.uniform(-3, 3, (500, 3))
    plain = plate()
    plain.node.derived("bricks True False", lambda: brick_table.BrickedTree(plain.node, (), ()))
    assert shape.gradient(points) == pytest.approx(plain.gradient(points), abs=1e-6)


def test_equal_balls_in_one_place_have_a_closed_form():
    # A value e below 0, joined with 0 by a quadratic blend, becomes e - k (1 + e / 4k)^2.
    k, d = 0.1, 0.0
    for _ in range(MANY - 1):
        d = d - k * (1.0 + d / (4.0 * k)) ** 2
    whole = union([Sphere(1.0).translate(0.5, 0.0, 0.0)] * MANY, smooth=k)
    agree(whole)
    assert whole(np.array([[0.5, 1.0, 0.0]])) == pytest.approx(d, abs=1e-6)


def test_two_balls_among_others_have_a_closed_form():
    # Between two balls at equal distances, the surface moves by k.
    pair = [Sphere(1.0).translate(x, 0.0, 0.0) for x in (-1.2, 1.2)]
    others = [Sphere(0.1).translate(0.3 * i, 0.0, 40.0) for i in range(MANY)]
    whole = union([*others[:20], *pair, *others[20:]], smooth=0.15)
    agree(whole)
    points = np.array([[0.0, 0.0, 0.0], [0.0, 1.6, 0.0], [-2.2, 0.0, 0.0], [-3.0, 0.0, 0.0]])
    assert whole(points) == pytest.approx([0.2 - 0.15, 1.0 - 0.15, 0.0, 0.8], abs=1e-6)


@settings(max_examples=4)
@given(st.integers(0, 10**6))
def test_bounds_outside_of_the_grid_are_bounds(seed):
    """A step by the value never passes a surface, and the value changes by the slope at most."""
    rng = np.random.default_rng(seed)
    shape = union(balls(rng, 80), smooth=float(rng.uniform(0.01, 0.3)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(brick_table, "LARGEST_SHARE", 1.0)
        found = bricked(shape.node, exact=False)
    (table,) = found.tables
    _, outside = places(table.table.programs.bricks, rng, 600)
    bounds = values(found.node, outside)
    assert (bounds > 0.0).all()
    directions = rng.normal(size=outside.shape)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    # Towards the middle: the surface is there.
    half = len(outside) // 2
    directions[:half] = -outside[:half] / np.linalg.norm(outside[:half], axis=1, keepdims=True)
    for part in (0.3, 0.999999):
        ends = outside + part * bounds[:, None] * directions
        assert (values(shape.node, ends) >= -1e-5 * np.abs(outside).max(axis=1)).all()
    steps = rng.uniform(0.0, 3.0, len(outside))
    moved = values(found.node, outside + steps[:, None] * directions)
    assert (np.abs(moved - bounds) <= steps + 1e-5 * np.abs(outside).max(axis=1)).all()


def test_the_box_contains_the_surface():
    rng = np.random.default_rng(4)
    shape = union(balls(rng), smooth=0.3)
    (node,) = bricked(shape.node, exact=True).tables
    low, high = np.array(node.table.low), np.array(node.table.high)
    points = rng.uniform(-4, 4, (40_000, 3))
    inside = points[values(shape.node, points) <= 0.0]
    assert (inside >= low).all() and (inside <= high).all()


def test_what_has_no_bricks_says_why():
    rng = np.random.default_rng(2)
    made = balls(rng)
    cases = {
        "the size of its blend has no largest": union(made, smooth=0.1 + abs(time)),
        "no finite box holds it at all times": Box(2.0) - union([Sphere(abs(time)), *made]),
        "no finite box": union([*made, Sphere(0.1).repeat(1.0)], smooth=0.1),
    }
    for reason, shape in cases.items():
        found = bricked(shape.node, exact=True)
        assert found.node is shape.node and not found.tables
        assert [w.reason for w in found.whole if reason in w.reason], (reason, found.whole)


def test_what_moves_is_joined_to_bricks_of_what_does_not():
    still = balls(np.random.default_rng(2))
    moving = [Sphere(0.2).translate(0.0, abs(time), 0.0), Box(0.3).translate(0.0, 1.0, 0.0)]
    whole = union([*still, *moving], smooth=0.1).named("blob").paint("red")
    found = bricked(whole.node, exact=True)
    (made,) = found.tables
    assert made.table.count == len(still) and found.node.label == "blob"
    assert len(found.node.children) == 3
    points = np.random.default_rng(1).uniform(-2, 2, (2000, 3))
    assert values(found.node, points) == pytest.approx(values(whole.node, points), abs=1e-6)


def test_still_shapes_in_a_moving_tree():
    lid = Box(0.5).translate(abs(time), 1.0, 0.0)
    whole = plate() | lid
    found = bricked(whole.node, exact=True)
    assert [isinstance(child, BrickNode) for child in found.node.children] == [True, False]
    points = np.random.default_rng(1).uniform(-3, 3, (500, 3))
    assert called(whole, points) == pytest.approx(values(whole.node, points), abs=1e-6)


def test_bricks_within_a_leaf_that_stays_whole():
    rng = np.random.default_rng(2)
    many = union(balls(rng, 40), smooth=0.1)
    twisted = many.twist(0.3)
    whole = Box(2.0) - union([*balls(rng, 20), twisted, twisted.translate(0.3, 0.2, 0.1)])
    assert len(bricked(whole.node, exact=True).tables) == 2
    points = rng.uniform(-2, 2, (500, 3))
    assert called(whole, points) == pytest.approx(values(whole.node, points), abs=1e-6)


def test_shapes_that_read_their_cell_stay_whole():
    rng = np.random.default_rng(2)
    places = rng.uniform(-1, 1, (MANY, 3))
    points = rng.uniform(-8, 8, (500, 3))
    for sizes, count in ((0.2 + 0.1 * cell.x, 0), (0.2, 1)):
        many = Box(2.0) - union([Sphere(sizes).translate(*p) for p in places])
        row = many.repeat(8.0, 0.0, 0.0, count=(2, 1, 1))
        assert len(bricked(row.node, exact=True).tables) == count
        assert called(row, points) == pytest.approx(values(row.node, points), abs=1e-6)


def test_dense_members_end_the_division(monkeypatch):
    monkeypatch.setattr(brick_table, "LIMITS", brick_table.BrickLimits(values=20_000))
    rng = np.random.default_rng(6)
    heap = [Sphere(0.3).translate(*rng.uniform(0, 1.5, 3)) for _ in range(60)]
    agree(union(heap, smooth=0.4))


def test_few_members_and_flat_ones_stay_as_they_are():
    few = union(balls(np.random.default_rng(1), LEAST_PARTS - 1), smooth=0.1)
    assert bricked(few.node, exact=True).node is few.node
    flat = union([ball.slice() for ball in balls(np.random.default_rng(1))], smooth=0.1)
    assert bricked(flat.node, exact=True).node is flat.node
    united = union(balls(np.random.default_rng(1)))
    assert bricked(united.node, exact=True).node is united.node


def test_a_plane_stays_beside():
    whole = plate() | Plane(y=-1.0)
    found = bricked(whole.node, exact=True)
    assert [isinstance(child, BrickNode) for child in found.node.children] == [True, False]
    points = np.random.default_rng(1).uniform(-3, 3, (500, 3))
    assert called(whole, points) == pytest.approx(values(whole.node, points), abs=1e-6)


def test_a_deep_chain_of_unions():
    made, *others = balls(np.random.default_rng(5), 1500, 0.02, 0.05)
    for ball in others:
        made = made.union(ball, smooth=0.02)
    (node,) = bricked(made.node, exact=True).tables
    assert node.table.count == 1500
    points = np.random.default_rng(1).uniform(-1, 1, (200, 3))
    wide = union(balls(np.random.default_rng(5), 1500, 0.02, 0.05), smooth=0.02)
    assert called(made, points) == pytest.approx(called(wide, points), abs=1e-6)


@pytest.mark.parametrize("name", LOCAL)
def test_widths_are_those_of_the_blends(name):
    blend = BLENDS[name]
    k = 0.25
    a = np.linspace(-3.0, 3.0, 41)[:, None]
    more = {"count": 3} if blend.counted else {}

    def at(difference):
        b = a + difference
        given = {"a": np.broadcast_to(a, b.shape).ravel(), "b": b.ravel(), "smooth": k, **more}
        found = executor().call(blend.union, (), given, device="reference")
        return np.asarray(found).reshape(b.shape), np.minimum(a, b)

    beyond = blend.width * k * np.linspace(1.0 + 1e-9, 6.0, 200)
    for side in (-1.0, 1.0):
        blended, least = at(side * beyond)
        assert np.abs(blended - least).max() < 1e-12
        blended, least = at(side * 0.9 * blend.width * k * np.ones(1))
        assert (blended <= least).all()
    # Closer together, the blend does differ from the minimum.
    blended, least = at(blend.width * k * np.linspace(0.0, 0.95, 50))
    assert (least - blended).max() > 0.1 * k


def test_pictures_have_no_bricks_that_have_most_shapes():
    wide = union(balls(np.random.default_rng(3), 80), smooth=0.3)
    assert len(bricked(wide.node, exact=True).tables) == 1
    found = bricked(wide.node, exact=False)
    assert found.node is wide.node and [w.reason for w in found.whole] == [DENSE]


@pytest.mark.usefixtures("always_pieces")
def test_a_check_says_what_bricks_are():
    moving = Box(0.3).translate(abs(time), 2.0, 0.0)
    found = check(union(balls(np.random.default_rng(3), 80), smooth=0.1) | moving)
    (report,) = found.bricks
    assert report.count == 80 and report.reason == "" and report.bricks > 0
    assert 1.0 <= report.mean <= report.longest <= 80
    many = balls(np.random.default_rng(3), 80)
    changing = check(union(many, smooth=abs(time)))
    assert changing.bricks[0].reason == MOVING_BLEND


def test_too_many_shapes_without_bricks_are_refused():
    many = [Sphere(0.1).translate(0.01 * i, 0.0, 0.0) for i in range(MOST_WITHOUT + 1)]
    shape = union(many, smooth=0.1, blend="exponential")
    with pytest.raises(CompileError) as caught:
        shape(np.zeros((1, 3)))
    assert "2,049 joined shapes need programs for boxes, but " in str(caught.value)
