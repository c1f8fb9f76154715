"""Expressions of parameters and time: Python's operators mean what scene code's do."""

from __future__ import annotations

import copy
import math

import numpy as np
import pytest

from distal import lang
from distal.lang import (
    atan2,
    clamp,
    color,
    func,
    integer,
    length,
    mat2,
    max,
    mix,
    normalize,
    point,
    select,
    slider,
    toggle,
    vec2,
    vec3,
)
from distal.lang.expressions import UFUNCS, Expression, time
from distal.lang.places import cell

size = slider("Size", 0.25, 0.0, 2.0)
tint = color("Tint", (1.0, 0.5, 0.25))
count = integer("Count", 7, 1, 9)
where = point("Where", (1.0, 2.0))
switch = toggle("Switch")


def value(expression: object, at: float = 2.0, **params: object) -> object:
    assert isinstance(expression, Expression)
    return expression.value(params, at)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (size * 2, 0.5),
        (2 - size, 1.75),
        (1 / (size * 2), 2.0),
        (time // 0.75, 2.0),
        (time % 0.75, 0.5),
        (-7.5 % time, 0.5),
        (time**3, 8.0),
        (time**-1, 0.5),
        (3**time, 9.0),
        (time**0.5, math.sqrt(2.0)),
        (-time + abs(-time), 0.0),
        (round(time * 0.75), 2.0),  # half to even
        (math.floor(time * 0.75), 1.0),
        (count // 2, 3),
        (-count // 2, -4),
        (count % 4, 3),
        (count / 2, 3.5),
        (tint * 2, vec3(2.0, 1.0, 0.5)),
        (tint.b, 0.25),
        (tint.zx, vec2(0.25, 1.0)),
        (where + vec2(1, 1), vec2(2.0, 3.0)),
        (vec3(1, 2, 3) * time, vec3(2.0, 4.0, 6.0)),
        (np.array([1.0, 2.0]) * where, vec2(1.0, 4.0)),
        ((time, 0, 1) - tint, vec3(1.0, -0.5, 0.75)),
        (vec3(time, size, 1), vec3(2.0, 0.25, 1.0)),
        (vec3(where, time), vec3(1.0, 2.0, 2.0)),
        (mat2(time, 0, 0, 1) @ where, vec2(2.0, 2.0)),
        (max(time, 5), 5.0),
        (clamp(time, 0, 1), 1.0),
        (mix(1.0, 3.0, size), 1.5),
        (length(vec2(3 * size * 4, 4)), 5.0),
        (normalize(vec2(time, 0)), vec2(1.0, 0.0)),
    ],
    ids=repr,
)
def test_values(expression: Expression, expected: object) -> None:
    found = value(expression)
    assert type(found) is type(expected)
    assert np.allclose(
        tuple(found) if hasattr(found, "__len__") else found,  # type: ignore[arg-type]
        tuple(expected) if hasattr(expected, "__len__") else expected,  # type: ignore[arg-type]
        rtol=1e-12,
    )


@pytest.mark.parametrize("name", [n for n in UFUNCS if hasattr(np, n) and n != "matmul"])
def test_numpy_means_what_it_says(name: str) -> None:
    ufunc = getattr(np, name)
    given = 0.625
    args = (given, 0.3) if ufunc.nin == 2 else (given,)
    found = ufunc(time, *args[1:]).value(time=given)
    assert math.isclose(found, ufunc(*args), rel_tol=2e-6)


def test_numpy_numbers_join() -> None:
    assert value(np.float64(2) * time) == 4.0
    assert value(time + np.float32(0.5)) == 2.5
    assert value(np.int64(3) * count) == 21


def test_parameters_are_given_by_name_or_label_and_checked() -> None:
    expression = count / 1 * size + time
    assert [p.label for p in expression.parameters] == ["Count", "Size"]
    assert expression.value({"size": 1.0, "Count": 2}, 3.0) == 5.0
    with pytest.raises(ValueError, match="no parameter 'tint'"):
        expression.value({"tint": 1.0})
    with pytest.raises(ValueError, match="'Size' lies between 0 and 2"):
        expression.value({"size": 3.0})
    with pytest.raises(ValueError, match="time is finite"):
        expression.value({}, math.inf)


def test_parts_are_shared() -> None:
    total = time
    for _ in range(40):
        total = total + total  # 2 ** 40 leaves, were they written out
    assert value(total) == 2.0**41


def test_long_sums_work_and_endless_ones_are_refused() -> None:
    total = time
    for n in range(90):
        total = total + size * n

    @func
    def scaled(x: float) -> float:
        return x * total

    assert math.isclose(scaled(2.0), 2.0 * 0.25 * 4005, rel_tol=1e-6)
    assert math.isclose(total.value(time=1.0), 1.0 + 0.25 * 4005)
    with pytest.raises(TypeError, match="more than 100 operations inside one another"):
        for n in range(90):
            total = total + n


@pytest.mark.parametrize(
    ("make", "kind", "message"),
    [
        (lambda: time == 1, TypeError, "'==' gives is not known here; choose"),
        (lambda: size == 1, TypeError, "'==' gives"),
        (lambda: switch < switch, TypeError, "'<' must be a number or a vector of numbers"),
        (lambda: time == 0, TypeError, "'==' gives"),
        (lambda: np.float64(1) == time, TypeError, "not known here"),
        (lambda: bool(switch), TypeError, "whether it is true is not known here"),
        (lambda: math.cos(time), TypeError, "np.sin\\(time\\), or sin of distal.lang"),
        (lambda: range(count), TypeError, "range takes a plain int"),
        (lambda: int(count), TypeError, "its number is not known here"),
        (lambda: time / 0, TypeError, "division by zero"),
        (lambda: count * 0.5, TypeError, "an int divided by 1 is a float"),
        (lambda: switch + 1, TypeError, "bool"),
        (lambda: tint + where, TypeError, "must be of one type, but these are vec3 and vec2"),
        (lambda: time * math.nan, ValueError, "NaN"),
        (lambda: time + 1e39, ValueError, "larger than a 32-bit float"),
        (lambda: time + "1", TypeError, "unsupported operand"),
        (lambda: np.cbrt(time), TypeError, "np.cbrt has no counterpart"),
        (lambda: np.add.reduce(time), TypeError, r"np.add.reduce has no counterpart"),
        (lambda: np.sin(time, dtype=float), TypeError, "np.sin with dtype"),
        (lambda: np.ones(6) * time, TypeError, "array"),
        (lambda: vec3(time, 1), TypeError, "vec3 has 3 components, not 2"),
        (lambda: clamp(time, low=0), TypeError, "no keyword arguments"),
        (lambda: length(switch), TypeError, "must be vec2, vec3 or vec4, but this is bool"),
        (lambda: time.x, AttributeError, "a float has no component 'x'"),
        (lambda: where.z, AttributeError, "a vec2 has no component 'z'"),
        (lambda: time.speed, AttributeError, "no attribute 'speed'"),
        (lambda: list(time), TypeError, "no components"),
    ],
)
def test_mistakes_are_named(make: object, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        make()  # type: ignore[operator]


def test_equality_is_of_the_expression() -> None:
    assert size * 2 == size * 2
    assert hash(size * 2) == hash(size * 2)
    assert size * 2 != size * 3
    assert size * 2 != slider("Size", 0.25, 0.0, 3.0) * 2
    assert copy.deepcopy(time) is time
    assert time not in ("a", None)


def test_scene_code_captures_expressions() -> None:
    bounce = 0.5 * np.sin(time * math.pi) + size

    @func
    def height(x: float) -> float:
        return x * bounce

    assert height.parameters() == [size]
    assert math.isclose(height(2.0), 0.5, rel_tol=1e-6)


def test_it_tells_what_it_is() -> None:
    assert repr(np.cos(time) * 2) == "cos(time) * 2.0"


SIZE = slider("Size", 1.0, 0.5, 2.0)
COUNT = integer("Count", 3, 1, 8)
COLOR = color("Color")
PLACE = point("Place", (0.0, 0.0, 0.0))
LID = toggle("Lid")
MADE = [
    time,
    1.0 - 2.0 * SIZE,
    (SIZE + 1.0) * (SIZE - 1.0) / (2.0 - time),
    SIZE**3 - SIZE**0.5,
    -(SIZE * -1.0) % 0.75,
    SIZE - (-1.5e-7),
    COUNT / 2,
    (COUNT + 1) // 2,
    np.sin(time) * max(SIZE, 0.5),
    vec3(SIZE, 0.0, 1.0) * COLOR.rgb,
    vec3(SIZE),
    0.5 * COLOR,
    (PLACE.xy * 2.0).x,
    length(PLACE - vec3(SIZE)),
    normalize(PLACE + vec3(1.0)),
    select(LID & (SIZE < 1.0), 1.0, SIZE),
    select(LID, vec3(SIZE), COLOR),
    ~LID | (COUNT >= 3),
    atan2(SIZE, time),
]


@pytest.mark.parametrize("expression", MADE, ids=repr)
def test_its_text_is_code_that_makes_it(expression) -> None:
    again = eval(repr(expression), {}, {**vars(lang), "time": time})
    assert again == expression and hash(again) == hash(expression)


def test_what_is_too_long_says_what_it_computes() -> None:
    total = SIZE
    for step in range(40):
        total = total * (SIZE + float(step))
    assert repr(total).startswith("<expression float: ")
    assert repr(cell.x + SIZE).startswith("<expression float: ")
