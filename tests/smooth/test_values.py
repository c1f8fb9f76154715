"""A large smooth union has the same values with its grid of cells as without."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from distal import Box, Capsule, Ellipsoid, Sphere, Torus, union
from distal.fields.combine.blends import BLENDS
from distal.lang import slider
from distal.lang.runtime_access import executor
from distal.scene.lowering.derived import DistanceOf
from distal.scene.lowering.smooth import grid
from distal.scene.lowering.smooth.cells import LEAST_MEMBERS, CellNode, celled
from distal.scene.lowering.smooth.chain import chain_of, first_linear, width_of

# Long enough for a grid; cells are few, so that tests are fast.
MANY = LEAST_MEMBERS + 4
LOCAL = [name for name, blend in BLENDS.items() if blend.width is not None]


@pytest.fixture(autouse=True)
def few_cells(monkeypatch):
    monkeypatch.setattr(grid, "CELLS_PER_ROOT", 500)


def called(function, points):
    return np.asarray(executor().call(function, (points,), {}, device="reference"))


def values(node, points):
    return called(DistanceOf(node), points)


def grid_of(shape):
    (made,) = celled(shape.node).grids
    return made.grid


def places(cells, rng, count=1000):
    """Points in the grid, on the borders of cells, near the grid, and far away."""
    low, high = np.array(cells.low), np.array(cells.high)
    inside = rng.uniform(low, high, (count, 3))
    borders = low + np.round((inside - low) * cells.per_unit) / cells.per_unit
    mixed = np.where(rng.random(inside.shape) < 0.5, inside, borders)
    side = (high - low).max()
    beside = rng.uniform(low - side, high + side, (count // 2, 3))
    beside = beside[((beside < low) | (beside > high)).any(axis=1)]
    return np.concatenate([inside, borders, mixed]), np.concatenate([beside, 100.0 * beside])


def agree(shape, seed=0, limit=1e-6):
    """Check the values inside of the grid, and those outside."""
    made = grid_of(shape)
    inside, outside = places(made, np.random.default_rng(seed))
    size = np.abs([made.low, made.high]).max()
    for points, least in ((inside, size), (outside, np.abs(outside).max())):
        expected = values(shape.node, points)
        assert np.abs(called(shape, points) - expected).max() <= limit * max(least, 1.0)
    bounded = values(celled(shape.node).node, inside)
    assert np.abs(bounded - values(shape.node, inside)).max() <= limit * max(size, 1.0)
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


@pytest.mark.parametrize("blend", LOCAL)
def test_every_local_blend(blend):
    rng = np.random.default_rng(3)
    more = {"count": 3} if BLENDS[blend].counted else {}
    agree(union(balls(rng), smooth=0.08, blend=blend, **more))


@settings(max_examples=5)
@example(0, 0.0, 1e-3, 1.0)
@example(1, 3.0, 0.05, 0.5)
@example(2, 1e-6, 1e-4, 1e-3)
@given(
    st.integers(0, 10**6),
    st.floats(0.0, 2.0),
    st.floats(1e-4, 0.1),
    st.floats(0.1, 3.0),
)
def test_random_balls_and_sizes(seed, smooth, small, large):
    agree(
        union(balls(np.random.default_rng(seed), MANY, small, large), smooth=smooth, blend="cubic"),
        seed,
    )


@settings(max_examples=2)
@given(st.integers(0, 10**6), st.sampled_from(LOCAL[:4]))
def test_members_of_many_kinds(seed, blend):
    rng = np.random.default_rng(seed)
    agree(union(solids(rng), smooth=float(rng.uniform(0.01, 0.2)), blend=blend), seed, 3e-6)


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
    made = made.union(Sphere(0.2).translate(0.0, 1.0, 0.0), smooth=0.1)
    assert agree(made).count == MANY + 1


def test_nested_smooth_unions():
    rng = np.random.default_rng(9)
    a = union(balls(rng), smooth=0.05)
    b = union(balls(rng), smooth=0.2, blend="cubic").translate(0.5, 0.0, 0.0).rotate(z=0.5)
    whole = a.union(b, smooth=0.1).round(0.02).scale(1.5)
    found = celled(whole.node)
    assert sorted(g.grid.count for g in found.grids) == [MANY, MANY + 1]
    points = rng.uniform(-3, 3, (3000, 3))
    assert called(whole, points) == pytest.approx(values(whole.node, points), abs=2e-6)


def test_surfaces_that_are_moved_far_out_are_exact():
    rng = np.random.default_rng(9)
    for whole in (
        union(balls(rng), smooth=0.05).offset(3.0),
        union(balls(rng), smooth=0.05).union(Sphere(0.5).translate(4.0, 0.0, 0.0), smooth=2.0),
        Sphere(4.0).clearance(union(balls(rng), smooth=0.05), 2.5),
    ):
        points = rng.uniform(-8, 8, (1000, 3))
        node = celled(whole.node).node
        assert node is not whole.node
        assert values(node, points) == pytest.approx(values(whole.node, points), abs=2e-6)


def test_equal_balls_in_one_place_have_a_closed_form():
    # A value e below 0, joined with 0 by a quadratic blend, becomes e - k (1 + e / 4k)^2.
    k, d = 0.1, 0.0
    for _ in range(MANY - 1):
        d = d - k * (1.0 + d / (4.0 * k)) ** 2
    whole = union([Sphere(1.0).translate(0.5, 0.0, 0.0)] * MANY, smooth=k)
    assert agree(whole).longest == MANY
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
    shape = union(balls(rng), smooth=float(rng.uniform(0.0, 0.3)))
    node = celled(shape.node).node
    _, outside = places(grid_of(shape), rng, 600)
    bounds = values(node, outside)
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
    moved = values(node, outside + steps[:, None] * directions)
    assert (np.abs(moved - bounds) <= steps + 1e-5 * np.abs(outside).max(axis=1)).all()


def test_the_box_contains_the_surface():
    rng = np.random.default_rng(4)
    shape = union(balls(rng), smooth=0.3)
    low, high = (np.array(c) for c in grid_of(shape).box)
    points = rng.uniform(-4, 4, (40_000, 3))
    inside = points[values(shape.node, points) <= 0.0]
    assert (inside >= low).all() and (inside <= high).all()
    # Grown by a value, it contains the points with at most this value.
    grown = shape.offset(0.2)
    low, high = grown.bounds()
    inside = points[values(shape.node, points) <= 0.2]
    assert (inside >= np.array(low) - 1e-6).all() and (inside <= np.array(high) + 1e-6).all()


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


def test_what_has_no_grid_says_why():
    rng = np.random.default_rng(2)
    made = balls(rng)
    size = slider("size", 0.1, 0.01, 1.0)
    cases = {
        "differs from the minimum everywhere": union(made, smooth=0.1, blend="exponential"),
        "more than the difference": union(made, smooth=0.1, blend="round"),
        "the size of its blend depends": union(made, smooth=size),
        "its shape depends": union([Sphere(size), *made], smooth=0.1),
        "no finite box": union([*made, Sphere(0.1).repeat(1.0)], smooth=0.1),
    }
    for reason, shape in cases.items():
        found = celled(shape.node)
        assert found.node is shape.node and not found.grids
        ((node, count, why),) = found.linear
        assert node is shape.node and count >= MANY and reason in why


def test_what_moves_is_joined_to_a_grid_of_what_does_not():
    still = balls(np.random.default_rng(2))
    moving = [Sphere(slider("size", 0.3, 0.01, 1.0)), Box(0.3).translate(0.0, 1.0, 0.0)]
    whole = union([*still, *moving], smooth=0.1).named("blob").paint("red")
    found = celled(whole.node)
    (made,) = found.grids
    assert made.grid.count == len(still) and made.exact and found.node.label == "blob"
    assert [(count, why) for _, count, why in found.linear] == [
        (2, "its shape depends on parameters or time")
    ]
    points = np.random.default_rng(1).uniform(-2, 2, (2000, 3))
    assert values(found.node, points) == pytest.approx(values(whole.node, points), abs=1e-6)


def test_dense_members_leave_blocks_undivided(monkeypatch):
    rng = np.random.default_rng(6)
    row = [Sphere(0.3).translate(0.01 * i, *rng.uniform(0, 0.01, 2)) for i in range(MANY)]
    row += [Sphere(0.1).translate(3.0, 0.5 * i, 0.0) for i in range(8)]
    whole = agree(union(row, smooth=0.1))
    monkeypatch.setattr(grid, "MOST_PAIRS", 10_000)
    part = agree(union(row, smooth=0.1))
    assert whole.cell_count > part.cell_count > np.prod(part.blocks)


def test_members_that_are_dense_everywhere_have_larger_blocks(monkeypatch):
    monkeypatch.setattr(grid, "CELLS_PER_ROOT", 8000)
    rng = np.random.default_rng(7)
    heap = [Sphere(0.3).translate(*rng.uniform(0, 1.5, 3)) for _ in range(MANY)]
    made = []
    for most in (10**9, 20_000, 1):  # with 1 the first, large cells are the blocks
        monkeypatch.setattr(grid, "MOST_BLOCK_PAIRS", most)
        monkeypatch.setattr(grid, "MOST_PAIRS", 1)
        made.append(np.prod(agree(union(heap, smooth=0.4)).blocks))
    assert made[0] > made[1] > made[2]


def test_few_members_and_flat_ones_stay_as_they_are():
    few = union(balls(np.random.default_rng(1), LEAST_MEMBERS - 1), smooth=0.1)
    assert celled(few.node).node is few.node and celled(few.node).linear == []
    flat = union([ball.slice() for ball in balls(np.random.default_rng(1))], smooth=0.1)
    assert celled(flat.node).node is flat.node


def test_members_keep_their_order():
    a, b, c, d = balls(np.random.default_rng(1), 4)
    whole = (a.union(b, smooth=0.1) | c).union(d, smooth=0.2)
    links = chain_of(whole.node)
    assert [link.node for link in links] == [s.node for s in (a, b, c, d)]
    assert [width_of(link) for link in links] == pytest.approx([0.4, 0.4, 0.0, 0.8])
    assert first_linear(links) == (4, "")
    painted = a.union(b, smooth=0.1).paint("red").union(c, smooth=0.1)
    assert len(chain_of(painted.node)) == 2


def test_a_deep_chain_of_unions():
    made, *others = balls(np.random.default_rng(5), 1500, 0.02, 0.05)
    for ball in others:
        made = made.union(ball, smooth=0.02)
    node = celled(made.node).node
    assert isinstance(node, CellNode) and node.grid.count == 1500
    points = np.random.default_rng(1).uniform(-1, 1, (200, 3))
    wide = union(balls(np.random.default_rng(5), 1500, 0.02, 0.05), smooth=0.02)
    assert called(made, points) == pytest.approx(called(wide, points), abs=1e-6)
