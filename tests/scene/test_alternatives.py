"""Shapes of which a parameter shows one, and counts by parameters: those of the scene written out.

Input: scenes with ``select``, ``choose``, ``shown`` and counts. Compared: distances, boxes, slopes
and pictures of one program at several values with those of the scene that has only what is shown.
"""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Box, Camera, Capsule, DistantLight, RoundBox, Scene, Sphere, Torus, choose, union
from distal.lang import choice, clamp, integer, select, toggle
from distal.scene.lowering.parts.table import rolled
from tests import egl, glsl, gpu

IS_ROUND = toggle("Is round")
COUNT = integer("Count", 3, 1, 8)
FORM = choice("Form", ["ball", "cube", "ring", "none"])
BALL, CUBE, RING = Sphere(0.5), Box(0.7), Torus(0.5, 0.1)
POINTS = np.random.default_rng(5).uniform(-2.0, 2.0, (60, 3))


def assert_same(live, written, **params):
    """The field, the box and the slope are those of the shape written out."""
    found = live(POINTS, params=params)
    np.testing.assert_allclose(found, written(POINTS), rtol=1e-12, atol=1e-12)
    assert live.bounds(params=params) == written.bounds()
    assert live._known_bounds(params, 0.0)[:2] == pytest.approx(
        written._known_bounds(None, 0.0)[:2]
    )


@pytest.mark.parametrize("value", [False, True])
def test_a_toggle_selects_a_shape(value):
    shown = BALL if value else CUBE
    assert_same(select(IS_ROUND, BALL, CUBE), shown, is_round=value)
    assert_same(select(~IS_ROUND, CUBE, BALL), shown, is_round=value)
    assert_same(
        select(IS_ROUND, BALL, CUBE).translate(1, 2, 3), shown.translate(1, 2, 3), is_round=value
    )
    # Neither the slope nor the box of what is not shown counts.
    steep = select(IS_ROUND, BALL, Box(1.0).twist(3.0))
    assert_same(steep, BALL if value else Box(1.0).twist(3.0), is_round=value)


def test_a_choice_chooses_by_name_and_a_number_by_order():
    named = choose(FORM, {"ring": RING, "ball": BALL, "none": None, "cube": CUBE})
    level = integer("Level", 0, 0, 2)
    for at, (name, shape) in enumerate([("ball", BALL), ("cube", CUBE), ("ring", RING)]):
        assert_same(named, shape, form=name)
        assert_same(choose(level, [BALL, CUBE, RING]), shape, level=at)
        assert choose(at, [BALL, CUBE, RING]) is shape
    assert named.bounds(params={"form": "none"}) == ((1e12,) * 3, (-1e12,) * 3)
    assert (named(POINTS, params={"form": "none"}) > 1e9).all()


@pytest.mark.parametrize("value", [False, True])
def test_what_is_not_shown_adds_nothing_and_takes_nothing(value):
    part = BALL.translate(1.5, 0, 0)
    live = part.shown(IS_ROUND)
    written = {
        "union": (CUBE | live, CUBE | part),
        "first": (live | CUBE, part | CUBE),
        "difference": (CUBE - live.scale(0.9), CUBE - part.scale(0.9)),
        "xor": (CUBE ^ live, CUBE ^ part),
        "rounded": (CUBE | live.round(0.1), CUBE | part.round(0.1)),
        "smooth": (CUBE.union(live, smooth=0.1), CUBE.union(part, smooth=0.1)),
        "repeated": (CUBE | live.repeat_polar(3), CUBE | part.repeat_polar(3)),
    }
    for name, (made, whole) in written.items():
        if value:
            assert_same(made, whole, is_round=True)
            continue
        np.testing.assert_allclose(
            made(POINTS, params={"is_round": False}), CUBE(POINTS), err_msg=name
        )
        low, high = made.bounds(params={"is_round": False})
        room = 0.1 if name == "smooth" else 0.0  # a blend's box has room for the blend
        assert max(high) <= 0.35 + 2 * room and min(low) >= -0.35 - 2 * room, name
    nothing = live & CUBE
    assert value or (nothing(POINTS, params={"is_round": False}) > 1e9).all()


def test_a_comparison_shows_as_many_as_a_number_says():
    balls = [BALL.translate(i, 0, 0) for i in range(8)]
    row = union(ball.shown(i < COUNT) for i, ball in enumerate(balls))
    for count in (1, 2, 5, 8):
        assert_same(row, union(balls[:count]), count=count)
    late = BALL.shown(distal.time > 2.0)
    assert (late(POINTS, time=1.0) > 1e9).all()
    np.testing.assert_allclose(late(POINTS, time=3.0), BALL(POINTS))


COUNTED = {
    "polar": lambda n: BALL.scale(0.3).translate(1, 0, 0).repeat_polar(n),
    "polar neighbors": lambda n: BALL.scale(0.5).translate(1, 0, 0).repeat_polar(n, neighbors=1),
    "polar all": lambda n: BALL.translate(0.2, 0, 0).repeat_polar(n, neighbors="all"),
    "grid": lambda n: CUBE.repeat((1.0, 0.0, 1.5), count=(n, 1, n + 1)),
    "grid by one number": lambda n: CUBE.repeat(1.0, count=n),
    "neighbors": lambda n: CUBE.repeat((1.0, 0, 0), count=(n, 1, 1), neighbors=1),
    "line": lambda n: BALL.scale(0.1).array(start=(0, 0, 0), end=(3, 1, 0), count=n),
    "ring": lambda n: BALL.scale(0.3).repeat_ring(1.0, count=(n, 4)),
    "kaleidoscope": lambda n: CUBE.translate(1.0, 0, 0).kaleidoscope(n),
    "stairs": lambda n: CUBE.union(BALL.translate(0.4, 0, 0), smooth=0.2, blend="stairs", count=n),
    "polygon": lambda n: distal.RegularPolygon(1.0, count=n + 1).extrude(0.3),
    "flat polar": lambda n: distal.Circle(0.1).translate(1, 0).repeat_polar(n).extrude(0.3),
    "gear": lambda n: distal.GearProfile(n + 8).extrude(0.3),
}


@pytest.mark.parametrize("name", COUNTED)
def test_counts_follow_an_integer(name):
    number = integer("Count", 3, 2, 8)
    live = COUNTED[name](number)
    for count in (2, 3, 8):
        assert_same(live, COUNTED[name](count), count=count)


def test_expressions_of_numbers_have_limits_too():
    live = BALL.scale(0.1).translate(1, 0, 0).repeat_polar(clamp(2 * COUNT - 1, 1, 9))
    assert_same(live, BALL.scale(0.1).translate(1, 0, 0).repeat_polar(9), count=8)
    assert_same(live, BALL.scale(0.1).translate(1, 0, 0).repeat_polar(3), count=2)


# Many parts


def test_parts_of_a_group_are_in_a_table_whether_it_is_shown_or_not():
    parts = [CUBE.scale(0.2).translate(i % 6, i // 6, 0) for i in range(24)]
    others = [BALL.scale(0.2).translate(i % 6, i // 6, 2) for i in range(18)]
    group, either = union(parts).shown(IS_ROUND), select(IS_ROUND, union(parts), union(others))
    found = rolled((group | BALL.translate(0, 0, -1)).node)
    assert (found.table.count, len(found.beside)) == (25, 0)
    assert rolled(either.node).table.count == 42
    assert_same(either, union(parts), is_round=True)
    assert_same(either, union(others), is_round=False)
    counted = union(part.shown(i < COUNT) for i, part in enumerate(parts))
    assert rolled(counted.node).table.count == 24
    assert_same(counted, union(parts[:5]), count=5)


# Pictures. Rays meet shapes in closed form whether they are selected or not: pictures are equal. A
# march ends within its threshold of a surface, and begins where a part's box does: pictures of
# tables of parts are equal, others differ at silhouettes.

PLACES = np.random.default_rng(3).uniform(-1.0, 1.0, (24, 3)).tolist()
MET = {
    "ball": lambda i: Sphere(0.22),
    "box": lambda i: Box(0.3).rotate(x=0.3 * i, y=0.2 * i),
}
MARCHED = {
    "torus": lambda i: Torus(0.2, 0.06).rotate(x=0.4 * i),
    "round box": lambda i: RoundBox((0.3, 0.3, 0.3), 0.05).rotate(x=0.3 * i),
}


def parts_of(make):
    colors = ("tomato", "teal", "gold")
    return [make(i).paint(colors[i % 3]).translate(*p) for i, p in enumerate(PLACES)]


def farthest_apart(live, written, **params):
    """The largest difference of two pictures, and of the first one at other values."""
    scenes = [Scene(shape, floor=False, ambient_occlusion=0.0, **LOOK) for shape in (live, written)]
    pictures = [
        scene.render((80, 60), samples=1, params=values).array[..., :3]
        for scene, values in zip(scenes, (params, {}), strict=True)
    ]
    assert pictures[0].std() > 0.02
    return float(np.abs(pictures[0] - pictures[1]).max())


@pytest.mark.parametrize(
    ("name", "count"),
    [*((name, count) for name in MET for count in (24, 7)), *((name, 20) for name in MARCHED)],
)
def test_pictures_of_a_count_are_those_of_the_parts_written_out(name, count):
    parts = parts_of((MET | MARCHED)[name])
    count_of = integer("parts", 24, low=0, high=24)
    live = union(part.shown(i < count_of) for i, part in enumerate(parts))
    # Sums of 32 bits in another order: 2e-5 was measured.
    assert farthest_apart(live, union(parts[:count]), parts=count) < 1e-4


@pytest.mark.parametrize("is_round", [False, True])
def test_a_selected_shape_is_met_in_closed_form(is_round):
    ball, cube = Sphere(0.7).paint("tomato"), Box(1.0).rotate(y=0.4).paint("teal")
    beside = Box(0.3).translate(1.2, 0, 0)
    live = select(IS_ROUND, ball, cube) | beside
    apart = farthest_apart(live, (ball if is_round else cube) | beside, is_round=is_round)
    assert apart < 1e-5
    assert farthest_apart(beside | ball.shown(IS_ROUND), beside, is_round=False) < 1e-5


BLOCK = RoundBox((0.9, 0.7, 0.5), 0.1).paint("tomato")
TWISTED = RoundBox((0.4, 1.2, 0.4), 0.1).twist(1.0).paint("gold")
PEG = Capsule(0.8, 0.15).translate(0.9, 0, 0).paint("seagreen")
NUT = Torus(0.15, 0.05).translate(0.9, 0, 0).paint("navy")
LOOK = {
    "camera": Camera((2.0, 1.5, 3.0), (0, 0, 0)),
    "lights": [DistantLight((1, 2, 3), intensity=2.0)],
    "background": (0.2, 0.3, 0.4),
}
LIVE = Scene(
    select(IS_ROUND, TWISTED, BLOCK)
    | PEG.shown(~IS_ROUND)
    | NUT.repeat_polar(COUNT).translate(0, -0.8, 0),
    **LOOK,
)
SIZE = (48, 36)
VALUES = [{"is_round": False, "count": 3}, {"is_round": True, "count": 5}]


def written_out(is_round, count):
    around = NUT.repeat_polar(count).translate(0, -0.8, 0)
    return Scene(TWISTED | around if is_round else union(BLOCK, PEG, around), **LOOK)


def assert_alike(found, wanted):
    """Equal but for a few pixels at edges, where a ray may end a step sooner."""
    apart = np.abs(np.asarray(found)[..., :3] - np.asarray(wanted)[..., :3]).max(-1)
    assert (apart > 0.02).mean() < 0.01, apart.max()


@pytest.mark.parametrize("params", VALUES)
def test_a_picture_is_that_of_the_scene_written_out(params):
    found = LIVE.render(SIZE, params=params, samples=1)
    assert_alike(found.linear, written_out(**params).render(SIZE, samples=1).linear)
    others = LIVE.render(SIZE, params=VALUES[params is VALUES[0]], samples=1)
    assert (np.abs(found.linear - others.linear).max(-1) > 0.02).mean() > 0.03


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl"])
def test_one_text_holds_all_and_is_not_compiled_again(target):
    program = distal.compile(LIVE, target=target)
    names = {u["name"]: u["type"] for u in program.interface["uniforms"]}
    assert (names["is_round"], names["count"]) == ("bool", "int")
    run = glsl.run_glsl if target == "glsl-es300" else gpu.run_wgsl
    for params in VALUES:
        try:
            found = run(program, SIZE, params)
        except (egl.EglUnavailableError, gpu.GpuUnavailableError) as error:
            pytest.skip(f"no driver: {error}")
        wanted = written_out(**params).render(SIZE, samples=1).array
        assert_alike(found, wanted)
