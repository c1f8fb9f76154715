"""What shapes, lights and materials take for numbers, and what they say when they don't."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from distal import PolylineTube
from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.lang import (
    Buffer,
    Texture2D,
    abs,
    color,
    func,
    integer,
    length,
    max,
    point,
    slider,
    vec2,
    vec3,
)
from distal.lang.expressions import Expression, time
from distal.lang.source_places import author_place
from distal.scene.tree.arguments import Number, arguments
from distal.scene.tree.conversion import Asked, number, plain_number
from distal.scene.tree.errors import SceneTypeError, SceneValueError

ONE = vec3(1.0)


@func
def rounded(p: vec3, size: vec3 = ONE, radius: float = 0.1, count: int = 3) -> float:
    return length(max(abs(p) - size, 0.0)) - radius * count


@func
def moved(p: vec3, offset: vec3) -> vec3:
    return p - offset


@func
def turned(p: vec3, axis: vec3, angle: float, inward: bool = False) -> vec3:
    return p


@func
def lit(p: vec3, color: vec3 = ONE, intensity: float = 1.0) -> vec3:
    return color * intensity


@func
def outline(p: vec2, points: Buffer[vec2], picture: Texture2D) -> float:
    return points[0].x


LIMITS = {"size": Limit.POSITIVE, "radius": Limit.POSITIVE, "count": Limit.POSITIVE}


def box(*args, **kwargs):
    return arguments(rounded, args, kwargs, what="RoundBox", limits=LIMITS, place=author_place())


def move(*args, **kwargs):
    return arguments(moved, args, kwargs, what="translate")


def turn(*args, **kwargs):
    return arguments(turned, args, kwargs, what="rotate", limits={"axis": Limit.UNIT})


def light(*args, **kwargs):
    return arguments(lit, args, kwargs, what="Light")


def test_defaults_are_the_functions_own():
    assert box() == {
        "size": Number(VEC3, (1.0, 1.0, 1.0)),
        "radius": Number(FLOAT, 0.1),
        "count": 3,
    }


@pytest.mark.parametrize(
    ("args", "kwargs"),
    [
        ((1, 2, 3), {}),
        (((1, 2, 3),), {}),
        (([1, 2.0, np.float32(3)],), {}),
        ((np.array([1.0, 2.0, 3.0]),), {}),
        ((np.array([1, 2, 3]),), {}),
        ((vec3(1, 2, 3),), {}),
        ((), {"size": (1, 2, 3)}),
        ((), {"y": 2, "z": 3}),
        ((), {"x": 1, "y": np.int64(2), "z": 3}),
    ],
)
def test_a_vector_is_given_in_many_ways(args, kwargs):
    assert box(*args, **kwargs)["size"] == Number(VEC3, (1.0, 2.0, 3.0))


def test_scalars_in_a_row_are_a_vector_and_what_follows_it():
    values = box(1, 2, 3, 0.5, 7)
    assert values["size"].value == (1.0, 2.0, 3.0)
    assert values["radius"].value == 0.5
    assert values["count"] == 7


def test_one_size_is_all_sizes():
    values = box(2, 0.5)
    assert values["size"].value == (2.0, 2.0, 2.0)
    assert values["radius"].value == 0.5


def test_parts_that_nobody_gives_change_nothing():
    assert move(y=1)["offset"].value == (0.0, 1.0, 0.0)


def test_several_functions_are_asked_as_one():
    values = arguments((moved, turned), (), {"offset": (1, 2, 3), "axis": (0, 1, 0), "angle": 1},
                       what="both")  # fmt: skip
    assert list(values) == ["offset", "axis", "angle", "inward"]


def test_colours():
    assert light("#ff0000")["color"].value == (1.0, 0.0, 0.0)
    assert light("#808080")["color"].value == pytest.approx((0.21586,) * 3, abs=1e-5)
    assert light(0.5)["color"].value == (0.5, 0.5, 0.5)
    assert light((2.0, 1.0, 0.0))["color"].value == (2.0, 1.0, 0.0), "lights go beyond white"
    tint = color("Tint", "#f00")
    assert light(tint)["color"].value.parameters == (tint,)


def test_sliders_and_time_become_expressions():
    width = slider("Width", 0.5, 0.1, 2.0)
    made = box(width, radius=np.cos(time) + 2)
    assert isinstance(made["size"].value, Expression)
    assert made["size"].value.type is VEC3
    assert made["size"].value.parameters == (width,)
    assert made["radius"].value.type is FLOAT
    mixed = move(1, width * 2, time)["offset"].value
    assert mixed.type is VEC3
    assert mixed.parameters == (width,)
    place = point("Place", (1.0, 2.0, 3.0))
    assert move(place)["offset"].value.type is VEC3
    steps = integer("Steps", 3, 1, 5)
    assert box(radius=steps)["radius"].value.type is FLOAT


def test_data_is_bound_as_buffers_and_textures(tmp_path):
    picture = Texture2D([[[0.0, 0.0, 0.0, 1.0]]])
    values = arguments(outline, ([(0, 0), (1, 0), (0.5, 1)], picture), {}, what="Polygon")
    assert values["points"].element is VEC2
    assert values["points"].data == [(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)]
    assert values["picture"] is picture
    array = arguments(outline, (np.eye(2), "bricks.png"), {}, what="Polygon")
    assert array["points"].data == [(1.0, 0.0), (0.0, 1.0)]
    assert array["picture"].data == "bricks.png"
    ready = Buffer([(0.0, 1.0)])
    assert arguments(outline, (ready, picture), {}, what="Polygon")["points"] is ready


VALUE, KIND = SceneValueError, SceneTypeError
WIDE = slider("Wide", 0.5, -1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "error", "message", "hint"),
    [
        (lambda: box(radios=1), KIND, "RoundBox has no 'radios'", "did you mean 'radius'?"),
        (
            lambda: move(w=1),
            KIND,
            "translate has no 'w'",
            "it takes offset; x, y, z are parts of 'offset'",
        ),
        (lambda: move(), KIND, "translate needs 'offset'", "it takes offset"),
        (
            lambda: box((1, 2, 3), 1, 2, 3),
            KIND,
            "RoundBox takes nothing after 'count'",
            "it takes size, radius, count",
        ),
        (
            lambda: box(1, size=1),
            KIND,
            "RoundBox got 'size' twice, by its name and by its position",
            "give what follows it by name too",
        ),
        (
            lambda: box(size=(1, 2, 3), x=1),
            KIND,
            "RoundBox got 'size' and its part 'x' too",
            None,
        ),
        (lambda: box("a"), KIND, "'size of RoundBox' takes three numbers, not str 'a'", None),
        (lambda: box((1, 2)), KIND, "'size of RoundBox' takes three numbers, not 2", None),
        (lambda: box(None), KIND, "'size of RoundBox' takes three numbers, not None", None),
        (
            lambda: box(radius="1"),
            KIND,
            "'radius of RoundBox' takes a number, not str '1'",
            None,
        ),
        (
            lambda: box(radius=True),
            KIND,
            "'radius of RoundBox' takes a number, not bool True",
            None,
        ),
        (
            lambda: move(1, 2),
            KIND,
            "'offset of translate' takes x, y, z, not 2 numbers",
            "give x, y, z, one vector, or parts by name: x=…",
        ),
        (
            lambda: move(1),
            KIND,
            "'offset of translate' takes x, y, z, not one number",
            "give x, y, z, one vector, or parts by name: x=…",
        ),
        (
            lambda: box(count=2.0),
            KIND,
            "'count of RoundBox' takes a whole number, not float 2.0",
            None,
        ),
        (
            lambda: box(count=integer("Count", 3)),
            KIND,
            "'count of RoundBox' is fixed when the scene is compiled; the integer 'Count' is not",
            "give a plain whole number",
        ),
        (
            lambda: box(radius=point("Where")),
            KIND,
            "'radius of RoundBox' takes a number; the point 'Where' is a vec3",
            None,
        ),
        (
            lambda: light("redd"),
            VALUE,
            "'color of Light' takes a color like #rrggbb or tomato, not 'redd'",
            "did you mean 'red'?",
        ),
        (
            lambda: light((0, -1, 0)),
            VALUE,
            "'color of Light' must be a color without negative parts, not (0, -1, 0)",
            None,
        ),
        (
            lambda: box(radius=float("nan")),
            VALUE,
            "'radius of RoundBox' takes a finite 32-bit number, not nan",
            None,
        ),
        (
            lambda: box(1, 2, float("inf")),
            VALUE,
            "'size of RoundBox' takes a finite 32-bit number, not inf",
            None,
        ),
        (
            lambda: box(radius=-1),
            VALUE,
            "'radius of RoundBox' must be above 0, not -1",
            None,
        ),
        (
            lambda: box(1, 0, 1),
            VALUE,
            "'size of RoundBox' must be above 0, not (1, 0, 1)",
            None,
        ),
        (lambda: box(count=0), VALUE, "'count of RoundBox' must be above 0, not 0", None),
        (
            lambda: turn((0, 2, 0), 1),
            VALUE,
            "'axis of rotate' must be a vector of length 1, not (0, 2, 0)",
            "write (0, 1, 0)",
        ),
        (
            lambda: turn((0, 0, 0), 1),
            VALUE,
            "'axis of rotate' must be a vector of length 1, not (0, 0, 0)",
            "a vector of zeros has no direction",
        ),
        (
            lambda: box(radius=WIDE),
            VALUE,
            "'radius of RoundBox' must be above 0; the slider 'Wide' goes down to -1",
            "give it low=0.01",
        ),
        (
            lambda: box(radius=slider("Low", 0.0)),
            VALUE,
            "'radius of RoundBox' must be above 0; the slider 'Low' has 0 at first",
            None,
        ),
        (
            lambda: arguments(outline, ([], "a.png"), {}, what="Polygon"),
            VALUE,
            "'points of Polygon' needs at least one vec2",
            None,
        ),
        (
            lambda: arguments(outline, ([(0, 1), (0, time)], "a.png"), {}, what="Polygon"),
            KIND,
            "'points[1] of Polygon' is data: plain numbers, no parameters or time",
            None,
        ),
        (
            lambda: arguments(outline, ([(0, 1)], 3), {}, what="Polygon"),
            KIND,
            "'picture of Polygon' takes a Texture2D, not int 3",
            "or an array, or the name of a picture's file",
        ),
    ],
)
def test_mistakes_say_what_is_wrong_and_what_mends_it(make, error, message, hint):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.message, diagnostic.hint) == (message, hint)


def test_numbers_that_do_not_go_together():
    def requires(size: tuple[float, ...], radius: float) -> str | None:
        return "radius must be below half the size" if radius * 2 >= min(size) else None

    def make(**given: object) -> object:
        return arguments(rounded, (), given, what="RoundBox", requires=requires)

    make(radius=0.4)
    with pytest.raises(SceneValueError, match="RoundBox: radius must be below half the size"):
        make(radius=0.5)
    with pytest.raises(SceneValueError, match="RoundBox: radius must be below"):
        make(radius=slider("R", 0.7))
    make(radius=slider("R", 0.3))
    make(radius=time + 2)


@pytest.mark.parametrize(
    ("points", "error", "message"),
    [
        (5, SceneTypeError, "takes a list of vec3, not int 5"),
        ("ab", SceneTypeError, "takes a list of vec3, not str 'ab'"),
        ([], SceneValueError, "needs at least one vec3"),
        (
            [(0.0, 0.0, 0.0), (1.0, time, 0.0)],
            SceneTypeError,
            "'points[1] of PolylineTube' is data",
        ),
    ],
    ids=["number", "text", "nothing", "changing"],
)
def test_a_list_of_points_is_a_list_of_plain_numbers(points, error, message):
    with pytest.raises(error, match=re.escape(message)):
        PolylineTube(points)


ODD = (
    *(0.0, -0.0, 1.0, 0.5, -1.0, 2, True, 1e39, -1e300, 10**400, math.nan, math.inf, "red", None),
    *(np.float64(0.5), np.float32(0.5), np.int64(2), np.float64(math.nan), time, ONE),
    *((1.0, 0.0, 0.0), [0.6, 0, 0.8], (1.0, math.nan, 0.0), (0.0, 1.0), (1, 2, 10**400)),
    *((True, 0.0, 1.0), (0.1, -0.2, 0.3), (np.float64(0.5),) * 3, np.ones(3), (time, 0.0, 1.0)),
)


@pytest.mark.parametrize("limit", Limit)
@pytest.mark.parametrize("type_", [FLOAT, VEC3])
@pytest.mark.parametrize("is_color", [False, True])
def test_quickly_converted_numbers_are_those_of_the_whole_conversion(limit, type_, is_color):
    quick = 0
    for value in ODD:
        found = plain_number(value, type_, limit, is_color=is_color)
        if found is None:
            continue  # the whole conversion decides
        quick += 1
        assert found == number(value, Asked("n", "Thing", type_, limit, is_color))
        assert type(found.value) is (float if type_ is FLOAT else tuple)
    assert quick >= 1
