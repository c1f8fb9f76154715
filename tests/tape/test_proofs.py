"""Slopes and boxes that are proved in a region hold at every point, and are near the best ones."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from distal import Shape
from distal.lang import atan2, exp, floor, func, length, log, max, sin, slider, tanh, vec2, vec3
from distal.scene.tree.errors import SceneValueError
from distal.tape.derivative_bounds import JUMPS, NO_RULE, _cosine
from distal.tape.operations import OPERATIONS
from distal.tape.proofs import prove, refute
from distal.tape.runtime import TapeProgram
from distal.tape.tape import Tape, TapeBuilder, TapeError

CUBE = (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0)
SQUARE = (-2.0, -2.0), (2.0, 2.0)
_SMOOTH = [row for row in OPERATIONS if row.operands and row.name not in (*JUMPS, *NO_RULE, "exp2")]


@st.composite
def smooth_tapes(draw: st.DrawFn) -> Tape:
    builder = TapeBuilder()
    values = [builder.operation("x"), builder.operation("y")]
    values += [builder.constant(n) for n in (0.5, -1.25)]
    for _ in range(draw(st.integers(1, 12))):
        row = draw(st.sampled_from(_SMOOTH))
        back = st.integers(1, min(len(values), 6))
        values.append(
            builder.operation(row.name, *(values[-draw(back)] for _ in range(row.operands)))
        )
    return builder.tape(values[-1])


@settings(max_examples=80)
@given(tape=smooth_tapes(), seed=st.integers(0, 2**32 - 1))
def test_no_two_points_differ_by_more_than_the_slope(tape, seed):
    try:
        proof = prove(tape, (-1.0, -1.0), (1.0, 1.0))
    except TapeError:
        return
    rng = np.random.default_rng(seed)
    first = rng.uniform(-1, 1, (2000, 2)).astype(np.float32)
    step = rng.normal(size=(2000, 2)) * 10.0 ** rng.uniform(-3, 0, (2000, 1))
    second = np.clip(first + step, -1, 1).astype(np.float32)
    program = TapeProgram(tape)
    a, b = (program.values(p).astype(np.float64) for p in (first, second))
    distance = np.linalg.norm(first.astype(np.float64) - second, axis=1)
    rounding = 1e-5 * (1.0 + np.abs(a) + np.abs(b)) * (1.0 + proof.slope)
    assert (np.abs(a - b) <= proof.slope * distance + rounding).all()
    inside = first[a <= 0]
    if len(inside):
        assert proof.low is not None and proof.high is not None
        assert (inside >= proof.low).all() and (inside <= proof.high).all()


def ball_tape(size: int) -> Tape:
    builder = TapeBuilder()
    squares = [builder.operation("square", builder.operation(axis)) for axis in "xyz"[:size]]
    total = squares[0]
    for square in squares[1:]:
        total = builder.operation("add", total, square)
    distance = builder.operation("sqrt", total)
    return builder.tape(builder.operation("sub", distance, builder.constant(1.0)))


@pytest.mark.parametrize("size", [2, 3])
def test_the_slope_of_a_distance_is_one_also_at_its_center(size):
    proof = prove(ball_tape(size), (-2.0,) * size, (2.0,) * size)
    assert 1.0 <= proof.slope < 1.0001
    assert np.allclose(proof.low, -1.0, atol=0.02) and np.allclose(proof.high, 1.0, atol=0.02)
    assert (np.array(proof.low) <= -1.0).all() and (np.array(proof.high) >= 1.0).all()


def test_both_operands_count_where_neither_is_certain():
    """max(x, x + 0.001 sin(1000 x)): the operands are too close to decide in a cell."""
    builder = TapeBuilder()
    x = builder.operation("x")
    wave = builder.operation("sin", builder.operation("mul", x, builder.constant(1000.0)))
    ripple = builder.operation("mul", wave, builder.constant(0.001))
    rippled = builder.operation("add", x, ripple)
    for operands in ((x, rippled), (rippled, x)):
        proof = prove(builder.tape(builder.operation("max", *operands)), (-1.0, -1.0), (1.0, 1.0))
        assert 2.0 <= proof.slope < 2.001


def test_an_operand_that_is_not_known_is_not_decided():
    """min(y - 1e5, 1 / x): the ends of 1 / x around 0 are above -1e5, but 1 / x is not."""
    builder = TapeBuilder()
    low = builder.operation("sub", builder.operation("y"), builder.constant(1e5))
    pole = builder.operation("div", builder.constant(1.0), builder.operation("x"))
    tape = builder.tape(builder.operation("min", low, pole))
    with pytest.raises(TapeError, match="endlessly steep"):
        prove(tape, (-1.0, -1.0), (1.1, 1.0))


@func
def wobbly(p: vec3, depth: float) -> float:
    return length(p) - 1.0 - depth * sin(9.0 * p.x) * sin(9.0 * p.y)


def test_a_function_gets_its_slope_and_its_box():
    shape = Shape.from_function(wobbly, depth=0.05, region=CUBE)
    # 1 and the largest gradient of the waves, 0.45, at most; both at once at some places.
    assert 1.45 <= shape.slope <= 1.0 + 0.45 * math.sqrt(2.0) + 0.01
    low, high = shape.bounds()
    assert all(-1.1 < a <= -1.0 for a in low) and all(1.0 <= b < 1.1 for b in high)


def test_a_flat_function_too():
    @func
    def bumpy(p: vec2) -> float:
        return max(length(p) - 0.8, sin(4.0 * p.x))

    shape = Shape.from_function(bumpy, region=SQUARE)
    assert shape.flat
    assert 4.0 <= shape.slope < 4.2


def test_declared_values_are_kept():
    box = (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5)
    shape = Shape.from_function(wobbly, depth=0.05, region=CUBE, bounds=box, slope=1.7)
    assert (shape.slope, shape.bounds()) == (pytest.approx(1.7), box)


def test_a_declared_slope_that_is_refuted():
    with pytest.raises(SceneValueError) as error:
        Shape.from_function(wobbly, depth=0.05, slope=1.2, region=CUBE)
    text = str(error.value)
    assert "'wobbly' changes by 1." in text
    assert "more than its declared slope 1.2" in text
    assert "test_proofs.py" in text


def test_what_is_constant_beyond_a_limit_refutes_nothing():
    """asin beyond 1 and x^2.5 below 0 do not change, whatever their rules say."""
    builder = TapeBuilder()
    x = builder.operation("x")
    for name, operands in (("asin", (x,)), ("pow", (x, builder.constant(1.0))), ("exp", (x,))):
        tape = builder.tape(builder.operation(name, *operands))
        ends = (100.0, 120.0) if name == "exp" else (-3.0, -1.001)
        slope = 1e-3 if name == "pow" else 0.5
        assert refute(tape, slope, (ends[0], -1.0), (ends[1], 1.0)) is None, name


def test_powers_and_angles():
    """x^y with 2 <= y <= 3 in [0.5, 1.5]: along x y x^(y - 1); and the angle: 1 / r."""
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    power = builder.tape(builder.operation("pow", x, builder.constant(2.5)))
    for low in (0.0, 0.5):
        proof = prove(power, (low, -1.0), (1.5, 1.0))
        assert 2.5 * 1.5**1.5 <= proof.slope < 2.5 * 1.5**1.5 * 1.001
    root = builder.tape(builder.operation("pow", x, builder.constant(0.5)))
    assert prove(root, (0.25, -1.0), (1.5, 1.0)).slope == pytest.approx(1.0, rel=1e-3)
    with pytest.raises(TapeError, match="endlessly steep near \\(0"):
        prove(root, (0.0, -1.0), (1.5, 1.0))
    exponential = builder.tape(builder.operation("pow", builder.constant(2.0), y))
    proof = prove(exponential, (0.0, -1.0), (1.0, 2.0))
    assert proof.slope == pytest.approx(4.0 * math.log(2.0), rel=1e-3)
    angle = builder.tape(builder.operation("atan2", y, x))
    assert 2.0 <= prove(angle, (0.5, -1.0), (2.0, 1.0)).slope < 2.3
    assert 2.0 <= prove(angle, (-1.0, 0.5), (1.0, 2.0)).slope < 2.3
    with pytest.raises(TapeError, match="endlessly steep near \\(-"):
        prove(angle, (-1.0, -1.0), (1.0, 1.0))


@func
def twisted(p: vec3) -> float:
    """A cone of eight waves around z, away from the axis."""
    angle = atan2(p.y, p.x)
    return length(p - vec3(3.0, 0.0, 0.0)) - 1.0 - 0.02 * sin(8.0 * angle)


def test_an_angle_is_proved_where_it_does_not_jump():
    shape = Shape.from_function(twisted, region=((1.0, -2.0, -2.0), (5.0, 2.0, 2.0)))
    # 1 and 0.02 * 8 / r, with r at least 1 in the region.
    assert 1.0 <= shape.slope <= 1.17


def test_a_logarithm_of_exponentials_has_a_slope():
    """A smooth union far from both shapes, where both exponentials are small."""

    @func
    def blended(p: vec3) -> float:
        a = length(p - vec3(0.5, 0.0, 0.0)) - 0.5
        b = length(p + vec3(0.5, 0.0, 0.0)) - 0.5
        return -log(exp(-16.0 * a) + exp(-16.0 * b)) / 16.0

    shape = Shape.from_function(blended, region=CUBE)
    assert 1.0 <= shape.slope < 1.001


def test_intervals_of_the_cosine():
    rng = np.random.default_rng(4)
    low = np.concatenate([rng.uniform(-20, 20, 4000), [-0.5, -math.pi, 0.0, math.pi, -7.0]])
    width = np.concatenate([rng.uniform(0, 4, 4000), [1.0, 2 * math.pi, 0.0, 0.1, 14.0]])
    bottom, top = _cosine(np.stack([low, low + width]))
    values = np.cos(low + width * np.linspace(0.0, 1.0, 400)[:, None])
    assert (values >= bottom).all() and (values <= top).all()
    # And narrow: at most what 400 points miss of a maximum.
    assert (top - values.max(axis=0) < 1e-3).all() and (values.min(axis=0) - bottom < 1e-3).all()


@func
def ridged(p: vec3) -> float:
    """A ball with a step of width 0.004 at x = 0.013, where its slope is 5."""
    return length(p) - 1.0 + 0.01 * tanh(500.0 * (p.x - 0.013))


def test_a_declared_slope_that_is_refuted_between_the_points():
    """No point of a grid is on the step; the interval of the derivative in a cell is above 2."""
    for slope in (1.2, 3.0):
        with pytest.raises(SceneValueError) as error:
            Shape.from_function(ridged, slope=slope, region=CUBE)
        (found,) = error.value.diagnostics
        assert found.message.startswith("'ridged' changes by at least ")
        near = re.search(r"per unit near \(([0-9.]+), ", found.message)
        assert near is not None and abs(float(near[1]) - 0.013) < 0.002
        assert found.message.endswith(f"more than its declared slope {slope:g}")
        assert found.hint == "leave out slope=, and it is proved"
    kept = Shape.from_function(ridged, slope=6.1, region=CUBE)
    assert kept.slope == pytest.approx(6.1)


@settings(max_examples=60)
@given(tape=smooth_tapes(), share=st.floats(0.05, 2.0), seed=st.integers(0, 2**32 - 1))
def test_what_is_refuted_is_steeper(tape, share, seed):
    """At the place that is named, and never above the slope that is proved."""
    try:
        proof = prove(tape, (-1.0, -1.0), (1.0, 1.0))
    except TapeError:
        return
    found = refute(tape, share * proof.slope, (-1.0, -1.0), (1.0, 1.0))
    if found is None:
        return
    assert share * proof.slope < found.slope <= proof.slope
    slope = TapeProgram(tape).gradients(np.array([(*found.place, 0.0)], np.float32))[0, 1:3]
    assert np.linalg.norm(slope.astype(np.float64)) >= 0.999 * found.slope


def test_the_rules_of_elementary_functions_are_narrow():
    """The slope of f(a x) on [low, high], against its largest derivative at 2001 points."""
    t = np.linspace(0.2, 0.9, 2001)
    slopes = {
        "sin": np.cos(t),
        "cos": np.sin(t),
        "exp": np.exp(t),
        "exp2": math.log(2.0) * 2.0**t,
        "log": 1.0 / t,
        "log2": 1.0 / (t * math.log(2.0)),
        "asin": 1.0 / np.sqrt(1.0 - t * t),
        "acos": 1.0 / np.sqrt(1.0 - t * t),
        "atan": 1.0 / (1.0 + t * t),
        "tanh": 1.0 - np.tanh(t) ** 2,
        "tan": 1.0 + np.tan(t) ** 2,
        "sinh": np.cosh(t),
        "cosh": np.sinh(t),
    }
    for name, expected in slopes.items():
        builder = TapeBuilder()
        tape = builder.tape(builder.operation(name, builder.operation("x")))
        proof = prove(tape, (0.2, -1.0), (0.9, 1.0))
        assert expected.max() <= proof.slope < 1.001 * expected.max() + 1e-5, name
        found = refute(tape, 0.99 * expected.max(), (0.2, -1.0), (0.9, 1.0))
        assert found is not None and found.slope <= expected.max() * 1.0001, name
        assert refute(tape, 1.01 * expected.max(), (0.2, -1.0), (0.9, 1.0)) is None, name


@func
def jumps(p: vec3) -> float:
    return floor(p.x) + p.y


@func
def turns(p: vec3) -> float:
    return atan2(p.y, p.x)


@func
def steep(p: vec3) -> float:
    return 1.0 / (p.x - 0.3)


@func
def far(p: vec3) -> float:
    return length(p) + 1.0


@func
def wide(p: vec3) -> float:
    return length(p) - 2.5


_size = slider("Size", 0.5, low=0.1, high=1.0)


@func
def sized(p: vec3) -> float:
    return length(p) - _size


WRONG = [
    (jumps, "nothing can be proved of 'jumps': it may jump: it uses floor"),
    (turns, "nothing can be proved of 'turns': it may be endlessly steep near (-"),
    (steep, "nothing can be proved of 'steep': it may be endlessly steep near (0.3"),
    (far, "'far' is positive in the whole region"),
    (wide, "the shape of 'wide' may leave the region"),
    (sized, "nothing can be proved of 'sized': it depends on parameters or the time"),
]


@pytest.mark.parametrize("function, message", WRONG, ids=lambda x: getattr(x, "name", ""))
def test_what_cannot_be_proved_is_refused(function, message):
    with pytest.raises(SceneValueError) as error:
        Shape.from_function(function, region=CUBE)
    (found,) = error.value.diagnostics
    assert found.message.startswith(message)
