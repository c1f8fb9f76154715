"""Numbers that differ from cell to cell, and from place to place of a material.

Oracle: the union of the copies, each made by itself with its own numbers.
"""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    Circle,
    Material,
    Scene,
    Sphere,
    cell,
    matte,
    place,
    random_by_cell,
    union,
)
from distal.lang import clamp, integer, select, slider
from distal.lang.parameters import Parameter

RANDOM = np.random.default_rng(5)
# Around the copies, and farther away.
POINTS = np.concatenate(
    [RANDOM.uniform((-2, -0.4, -2), (2, 0.4, 2), (3000, 3)), RANDOM.uniform(-3, 3, (2000, 3))]
)


def radius(index: float) -> float:
    return 0.2 + 0.05 * index


def turned(index: int, count: int) -> tuple[float, float]:
    angle = 2.0 * np.pi * index / count
    return float(np.cos(angle)), float(-np.sin(angle))


def at(x: float, y: float, z: float, index: int):
    return Sphere(radius(index)).translate(x, y, z)


BY_CELL = Sphere(0.2 + 0.05 * cell.x)
POLAR = [at(1.5 * turned(i, 6)[0], 0.0, 1.5 * turned(i, 6)[1], i) for i in range(6)]
PLACES = [(0.0, 0.0, 0.0), (1.0, 0.5, 0.0), (-1.0, 0.0, 0.7), (0.2, 1.5, -0.6)]
LINE = [at(-1.5 + i, 0.0, 0.0, i) for i in range(4)]

# The repetition, its copies, and whether all copies are asked for.
REPETITIONS = {
    "limited": (lambda: BY_CELL.repeat(1.0, count=(4, 1, 1)), LINE, False),
    "neighbors": (lambda: BY_CELL.repeat(1.0, count=(4, 1, 1), neighbors=1), LINE, True),
    "line": (lambda: BY_CELL.array(start=(-1.5, 0, 0), end=(1.5, 0, 0), count=4), LINE, False),
    "polar": (lambda: BY_CELL.translate(1.5, 0, 0).repeat_polar(6), POLAR, False),
    "polar neighbors": (
        lambda: BY_CELL.translate(1.5, 0, 0).repeat_polar(6, neighbors=2),
        POLAR,
        False,
    ),
    "polar all": (
        lambda: BY_CELL.translate(1.5, 0, 0).repeat_polar(6, neighbors="all"),
        POLAR,
        True,
    ),
    "at": (lambda: BY_CELL.array(PLACES), [at(*p, i) for i, p in enumerate(PLACES)], True),
}


@pytest.mark.parametrize("name", REPETITIONS)
def test_each_copy_has_the_numbers_of_its_cell(name):
    make, copies, every = REPETITIONS[name]
    made, oracle = make(), union(copies)
    found, true = made(POINTS), oracle(POINTS)
    inside = true < 0.0
    assert inside.sum() > 15
    assert np.array_equal(found < 0.0, inside)
    assert (found - true).max() < 1e-6, "the value exceeds the distance"
    if every:
        near = true < 0.2
        assert np.abs(found - true)[near].max() < 1e-6
    low, high = made.bounds()
    for copy in copies:
        own = copy.bounds()
        assert all(a <= b + 1e-6 for a, b in zip(low, own[0], strict=True))
        assert all(a >= b - 1e-6 for a, b in zip(high, own[1], strict=True))


@pytest.mark.parametrize("name", REPETITIONS)
def test_the_declared_slope_holds_between_points(name):
    make = REPETITIONS[name][0]
    made = make()
    steps = np.random.default_rng(6).normal(size=POINTS.shape) * 0.05
    change = np.abs(made(POINTS + steps) - made(POINTS))
    assert (change <= made.slope * np.linalg.norm(steps, axis=1) + 1e-6).all()


def test_copies_of_a_ring_have_the_numbers_of_their_cells():
    made = Sphere(0.2 + 0.05 * cell.x + 0.02 * cell.z).repeat_ring(1.0, 1.0, count=(4, 3))
    for x in range(4):
        for z in range(3):
            if x in (0, 3) or z != 1:
                d = made((x - 1.5, 0.0, z - 1.0))
                assert d == pytest.approx(-(0.2 + 0.05 * x + 0.02 * z), abs=1e-6)


def test_the_box_is_that_of_the_largest_copy():
    made = BY_CELL.repeat(1.0, count=(4, 1, 1))
    assert made.bounds()[1] == pytest.approx((1.85, 0.35, 0.35), abs=1e-6)


def test_a_rotation_by_cell_keeps_all_boxes():
    """The box of the copies between those of the least and the largest angle is larger."""
    made = Box(2.0, 0.2, 0.2).rotate(z=np.pi / 4 * cell.x).repeat(0.0, 0.0, 2.5, count=(1, 1, 5))
    assert made.bounds()[1][:2] == pytest.approx((1.0, 0.1), abs=1e-4)  # along z all have cell.x 0
    made = Box(2.0, 0.2, 0.2).rotate(z=random_by_cell(-0.8, 0.8)).repeat(2.6)
    points = np.random.default_rng(1).uniform(-6.0, 6.0, (20000, 3))
    assert made(points).min() == pytest.approx(-0.1, abs=0.01)


def test_random_numbers_are_the_same_for_each_cell_and_differ_by_seed():
    def radii(**seed):
        made = Sphere(random_by_cell(0.1, 0.3, **seed)).repeat(1.0, 0.0, 0.0)
        return -made(np.array([(float(i), 0.0, 0.0) for i in range(-20, 20)]))

    first = radii()
    assert first.min() >= 0.1 and first.max() <= 0.3 + 1e-6
    assert first.std() > 0.03
    assert np.array_equal(first, radii())
    assert np.abs(np.corrcoef(first, radii(seed=1))[0, 1]) < 0.5


def test_an_infinite_repetition_takes_numbers_with_known_limits():
    for number, values in (
        (0.1 + 0.1 * (cell.x % 3.0), [0.1, 0.2, 0.3]),
        (0.2 + 0.1 * np.sin(cell.x), [0.2, 0.2 + 0.1 * np.sin(1.0), 0.2 + 0.1 * np.sin(2.0)]),
        (clamp(0.1 * cell.x, 0.05, 0.4), [0.05, 0.1, 0.2]),
    ):
        made = Sphere(number).repeat(1.0, 0.0, 0.0)
        found = [-made((float(i), 0.0, 0.0)) for i in range(3)]
        assert found == pytest.approx(values, abs=1e-6)


def test_a_condition_of_the_cell_selects_shapes():
    both = select(cell.x % 2.0 < 0.5, Sphere(0.3), Box(0.5)).repeat(1.0, count=(4, 1, 1))
    found = [both((x - 1.5, 0.0, 0.0)) for x in range(4)]
    assert found == pytest.approx([-0.3, -0.25, -0.3, -0.25], abs=1e-6)
    some = select(cell.x < 1.5, Sphere(0.3), None).repeat(1.0, count=(4, 1, 1))
    assert some((1.5, 0.0, 0.0)) > 0.5


def test_flat_shapes_too():
    made = Circle(0.2 + 0.05 * cell.x).repeat(1.0, count=(4, 1))
    assert made((1.5, 0.0)) == pytest.approx(-0.35, abs=1e-6)
    near = Circle(0.2 + 0.05 * cell.x).repeat(0.6, count=(4, 1), neighbors=1)
    assert near((0.9, 0.0)) == pytest.approx(-0.35, abs=1e-6)
    ring = Circle(0.1 + 0.02 * cell.x).translate(1.0, 0.0).repeat_polar(5, neighbors="all")
    x, y = np.cos(2.0 * np.pi / 5), np.sin(2.0 * np.pi / 5)
    assert ring((x, y)) == pytest.approx(-0.12, abs=1e-6)


def test_a_nested_repetition_has_its_own_cells():
    inner = Sphere(0.05 + 0.05 * cell.x).repeat(0.5, count=(2, 1, 1))
    made = inner.repeat(0.0, 1.0, 0.0, count=(1, 3, 1))
    assert made((0.25, 1.0, 0.0)) == pytest.approx(-0.1, abs=1e-6)
    assert made((-0.25, -1.0, 0.0)) == pytest.approx(-0.05, abs=1e-6)


def test_parameters_stay_live_and_their_limits_count():
    size = slider("Size", 0.1, low=0.05, high=0.2)
    made = Sphere(size * (1.0 + cell.x)).repeat(1.5, count=(3, 1, 1))
    assert made((1.5, 0.0, 0.0)) == pytest.approx(-0.3, abs=1e-6)
    assert made((1.5, 0.0, 0.0), params={"Size": 0.05}) == pytest.approx(-0.15, abs=1e-6)
    assert made.bounds()[1] == pytest.approx((2.1, 0.6, 0.6), abs=1e-6)


def test_time_moves_each_copy_in_its_own_way():
    made = (
        Sphere(0.2)
        .translate(0, 0.3 * np.sin(distal.time + cell.x), 0)
        .repeat(1.0, 0.0, 0.0, count=(3, 1, 1))
    )
    for i in range(3):
        y = 0.3 * np.sin(2.0 + i)
        assert made((i - 1.0, y, 0.0), time=2.0) == pytest.approx(-0.2, abs=1e-5)
    assert made.bounds()[1][1] == pytest.approx(0.5, abs=1e-4)


def test_many_parts_of_a_table_keep_their_cells():
    row = Sphere(0.1 + 0.05 * cell.x).repeat(0.6, 0.0, 0.0, count=(3, 1, 1))
    rows = [row.translate(0.0, 0.6 * i, 0.0) for i in range(20)]
    scene = Scene(union(rows), camera=Camera((0, 5.7, 16), (0, 5.7, 0)))
    plain = Scene(
        union(
            Sphere(0.1 + 0.05 * j).translate(0.6 * (j - 1), 0.6 * i, 0.0)
            for i in range(20)
            for j in range(3)
        ),
        camera=Camera((0, 5.7, 16), (0, 5.7, 0)),
    )
    a, b = (s.render((48, 64), samples=1).array for s in (scene, plain))
    assert np.abs(a - b).mean() < 2e-3
    assert (np.abs(a - b).max(axis=2) > 0.05).mean() < 0.01
    placed = Sphere(0.1 + 0.02 * (cell.x % 4.0)).array([(i, 0, 0) for i in range(20)])
    assert Scene(placed) is not None
    assert placed((3.0, 0.0, 0.0)) == pytest.approx(-0.16, abs=1e-6)


def test_materials_take_numbers_by_cell_and_by_place():
    lit = Material(color=(0, 0, 0), emission=(0.25 * cell.x, 0.5 + 0.25 * place.y, 0.0))
    made = Box(0.9, 0.9, 0.2).paint(lit).repeat(1.0, 0.0, 0.0, count=(4, 1, 1))
    scene = Scene(
        made | Sphere(0.1).translate(0, 9, 0),
        background=(0, 0, 0),
        camera=Camera((0, 0, 6), (0, 0, 0)),
    )
    found = scene.render((81, 61), samples=1).linear
    middle = found[30]
    # The four boxes glow red in the ratio 0 : 1 : 2 : 3, and green by their height.
    columns = [23, 34, 46, 57]
    reds = [float(middle[x, 0]) for x in columns]
    assert reds[0] < 1e-3 and reds[1] < reds[2] < reds[3]
    assert float(found[27, 46, 1]) > float(found[33, 46, 1]) + 0.02


@pytest.mark.parametrize("target", ["glsl-es300", "glsl-330", "wgsl", "wgsl-compute", "shadertoy"])
def test_texts_of_all_languages(target):
    size = slider("Size", 0.1, low=0.05, high=0.2)
    made = (
        Sphere(size + 0.1 * random_by_cell(seed=3))
        .paint(matte((0.2 + 0.1 * (cell.x % 3.0), 0.3, 0.4)))
        .repeat(1.0, 0.0, 1.0, neighbors=1)
    )
    text = distal.compile(Scene(made), target=target).text
    assert "cell" in text


def test_a_target_without_whole_numbers_of_that_kind_says_so():
    random = Sphere(0.1 + 0.1 * random_by_cell(seed=3)).repeat(1.0, 0.0, 1.0, count=(3, 1, 3))
    with pytest.raises(distal.CompileError) as found:
        distal.compile(Scene(random), target="glsl-es100")
    (diagnostic,) = found.value.diagnostics
    assert diagnostic.message == "glsl-es100 has no unsigned integers, which the library needs here"
    assert diagnostic.hint == "compile for another target, such as glsl-es300"
    assert "random_by_cell(seed=3)" in diagnostic.span.text
    by_cell = Sphere(0.1 + 0.05 * cell.x).repeat(1.0, 0.0, 1.0, count=(3, 1, 3))
    assert "cell" in distal.compile(Scene(by_cell), target="glsl-es100").text


BESIDE = Sphere(0.2).translate(1.0, 0.0, 0.0)

WRONG = [
    (
        lambda: Sphere(0.1 + 0.1 * cell.x).array([(0, 0, 0), (1, 0, 0)], scale=[1, 2]),
        "'radius of Sphere' depends on the cell, and copies with columns have none",
        "array(positions) alone has cells; or give each copy its number in a column",
    ),
    (
        lambda: Sphere(0.3 + 0.1 * cell.x).repeat(1.0),
        "'radius of Sphere' has no known limit in the cells of repeat",
        "limit it: clamp(…, low, high) of distal.lang, or % for a pattern that returns; a parameter"
        " needs low= and high=",
    ),
    (
        lambda: Sphere(0.3 - 0.2 * cell.x).repeat(1.0, count=(4, 1, 1)),
        "'radius of Sphere' must be above 0; in the cells of repeat limited it goes down to -0.3",
        None,
    ),
    (
        lambda: Sphere(0.2 + 0.01 * cell.x).repeat(1.0, mirrored=True),
        "mirrored copies match only if all are alike; 'radius of Sphere' depends on the cell",
        "leave out mirrored=True; neighbors=1 for a shape that is larger than its cell",
    ),
    (
        lambda: BESIDE.repeat_polar(3 + cell.x, neighbors="all").repeat(9.0, count=(3, 1, 1)),
        "'count of repeat polar all' is the same in all cells",
        "choose between shapes: select(cell.x < 1.5, a, b)",
    ),
    (
        lambda: Camera(fov=cell.x),
        "'fov of Camera' cannot depend on the cell",
        "numbers of shapes that are repeated, and of their materials, may",
    ),
    (
        lambda: Camera(fov=1.0 + 0.1 * place.x),
        "'fov of Camera' cannot depend on the place",
        "numbers of shapes, of operators and of materials may",
    ),
    (
        lambda: Scene(Box(0.4).repeat(1.0).rotate(y=cell.x)),
        "'angle of rotate y' depends on the cell, but stands after the repetition",
        "first change the shape, then repeat: shape.rotate(y=cell.x).repeat(2.0)",
    ),
]


@pytest.mark.parametrize(("make", "message", "hint"), WRONG)
def test_what_is_wrong_is_said_at_its_line(make, message, hint):
    with pytest.raises(distal.CompileError) as found:
        make()
    (diagnostic,) = found.value.diagnostics
    assert (diagnostic.message, diagnostic.hint) == (message, hint)
    assert diagnostic.span is not None and diagnostic.span.file == __file__


def test_values_that_are_not_known_in_python():
    with pytest.raises(TypeError, match="known only where a shape is evaluated"):
        cell.value()
    with pytest.raises(TypeError, match=r"a seed is a whole number, not 1\.5"):
        random_by_cell(seed=1.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="from 0 to 1000000, not -1"):
        random_by_cell(seed=-1)
    assert not isinstance(cell, Parameter)
    assert "<expression float: " in repr(Sphere(0.3 + 0.1 * cell.x).repeat(2.0, count=(2, 1, 1)))


def test_blends_edges_and_counts_of_cells():
    count = integer("Count", 6, 3, 8)
    ring = Sphere(0.05 + 0.01 * cell.x).translate(1.0, 0.0, 0.0).repeat_polar(count)
    x, z = turned(7, 8)
    assert ring((x, 0.0, z), params={"Count": 8}) == pytest.approx(-0.12, abs=1e-6)
    pair = Sphere(0.2).union(Box(0.3).translate(0.2, 0.0, 0.0), smooth=0.02 + 0.02 * cell.x)
    row = pair.repeat(1.5, 0.0, 0.0, count=(3, 1, 1))
    alone = Sphere(0.2).union(Box(0.3).translate(0.2, 0.0, 0.0), smooth=0.06)
    at = (0.1, 0.17, 0.0)
    assert row((1.6, 0.17, 0.0)) == pytest.approx(alone(at), abs=1e-6)
    coin = Circle(0.3).extrude(0.2 + 0.1 * cell.z).fillet(0.05).repeat(0.0, 0.0, 1.0, count=2)
    assert coin((0.0, 0.0, 0.5)) == pytest.approx(-0.15, abs=1e-6)


def test_a_smooth_union_of_many_moves_with_the_time():
    """Members that move are in no bricks, although all bounds are constant."""
    bead = Sphere(0.1).translate(0.0, 0.2 * np.sin(distal.time + cell.x), 0.0)
    rows = [bead.repeat(0.5, count=(2, 1, 1)).translate(0.0, 0.0, 0.7 * i) for i in range(60)]
    whole = rows[0].union(*rows[1:], smooth=0.01)
    for time in (0.0, 1.0):
        y = 0.2 * np.sin(time + 1.0)
        assert whole((0.25, y, 0.7), time=time) == pytest.approx(-0.1, abs=2e-2)
    scene = Scene(whole, camera=Camera((0, 0, -3), (0, 0, 0)))
    first, second = (scene.render((40, 30), time=t, samples=1).array for t in (0.0, 1.5))
    assert np.abs(first - second).max() > 0.1
