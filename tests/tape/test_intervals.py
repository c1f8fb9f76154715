"""Intervals contain the values at the points of their boxes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from distal.ir.intrinsics import Trend
from distal.tape.operations import OPERATIONS
from distal.tape.runtime import TapeProgram
from distal.tape.tape import Tape, TapeBuilder
from tests.tape.random_tapes import LANES, Case, cases

_EVERYWHERE = (Trend.RISING, Trend.FALLING, Trend.WAVE, Trend.EVEN)
_ELEMENTARY = [r.name for r in OPERATIONS if r.trend in _EVERYWHERE]


@settings(max_examples=80)
@given(case=cases())
def test_values_are_inside(case: Case):
    program = TapeProgram(case.tape)
    values = program.values(case.points.reshape(-1, 3)).reshape(LANES, LANES)
    low, high = program.intervals(case.low, case.high)
    known = np.isfinite(low) & np.isfinite(high)
    inside = (low[:, None] <= values) & (values <= high[:, None])
    assert inside[known].all()


def _unary(name: str) -> Tape:
    builder = TapeBuilder()
    return builder.tape(builder.operation(name, builder.operation("x")))


@pytest.mark.parametrize("name", _ELEMENTARY)
def test_elementary_functions_stay_within_their_known_error(name):
    """Boxes of all sizes: many are so small that the function's own error decides."""
    program = TapeProgram(_unary(name))
    rng = np.random.default_rng(5)
    count = 64_000
    center = rng.normal(size=count) * 10.0 ** rng.uniform(-6, 5, count)
    size = np.abs(center) * 10.0 ** rng.uniform(-8, 1, count)
    low = (center - size).astype(np.float32)
    high = (center + size).astype(np.float32)
    boxes = [np.repeat(end[:, None], 3, axis=1) for end in (low, high)]
    bottom, top = program.intervals(*boxes)
    assert np.isfinite(bottom).all()
    for t in (0.0, 0.25, 0.5, 0.9, 1.0):
        at = np.clip((low + t * (high - low)).astype(np.float32), low, high)
        values = program.values(np.repeat(at[:, None], 3, axis=1))
        assert (bottom <= values).all()
        assert (values <= top).all()


@pytest.mark.parametrize("name", _ELEMENTARY)
def test_intervals_of_elementary_functions_are_narrow(name):
    """Of a box of width 1e-3, at most three times the range that the function really has."""
    program = TapeProgram(_unary(name))
    low = np.linspace(-0.9, 0.9, 64, dtype=np.float32) if name[0] == "a" else None
    if low is None:
        low = np.linspace(0.1, 3.0, 64, dtype=np.float32)
    high = low + np.float32(1e-3)
    bottom, top = program.intervals(*(np.repeat(e[:, None], 3, axis=1) for e in (low, high)))
    steepest = {"exp": 21.0, "exp2": 6.0, "log": 11.0, "log2": 15.0, "asin": 2.4, "acos": 2.4}
    assert (top - bottom <= 1e-3 * steepest.get(name, 11.0) + 1e-4).all()


def test_division_by_an_interval_around_zero_says_nothing():
    builder = TapeBuilder()
    one = builder.constant(1.0)
    program = TapeProgram(builder.tape(builder.operation("div", one, builder.operation("x"))))
    low = np.array([(-1, 0, 0), (0, 0, 0), (1, 0, 0), (-2, 0, 0)], np.float32)
    high = np.array([(1, 0, 0), (2, 0, 0), (2, 0, 0), (-1, 0, 0)], np.float32)
    bottom, top = program.intervals(low, high)
    known = np.isfinite(bottom) & np.isfinite(top)
    assert known.tolist() == [False, False, True, True]
    assert bottom[2:].tolist() == [0.5, -1.0]
    assert top[2:].tolist() == [1.0, -0.5]


def _boxes(rng, count, centers, sizes):
    """Random boxes of very different sizes, and points in them, corners included."""
    center = rng.uniform(*centers, (count, 3))
    size = rng.uniform(size=(count, 3)) * 10.0 ** rng.uniform(*sizes, (count, 1))
    low, high = (center - size).astype(np.float32), (center + size).astype(np.float32)
    points = []
    for _ in range(12):
        t = rng.choice([0.0, 1.0, 0.5, rng.uniform()], (count, 3))
        points.append(np.clip((low + t * (high - low)).astype(np.float32), low, high))
    return low, high, points


@pytest.mark.parametrize(
    "name, centers, known_share",
    [("tan", (-9.0, 9.0), 0.4), ("atan2", (-3.0, 3.0), 1.0), ("pow", (-2.0, 9.0), 0.9)],
)
def test_functions_of_two_numbers_and_of_branches(name, centers, known_share):
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    operands = (x,) if name == "tan" else (x, y)
    program = TapeProgram(builder.tape(builder.operation(name, *operands)))
    low, high, points = _boxes(np.random.default_rng(8), 20_000, centers, (-6.0, 0.5))
    bottom, top = program.intervals(low, high)
    known = np.isfinite(bottom) & np.isfinite(top)
    assert known_share <= known.mean()
    for p in points:
        values = program.values(p)
        assert ((bottom <= values) & (values <= top))[known].all()
    # Narrow: of small boxes, no wider than what the ends can explain.
    small = known & ((high - low).max(axis=1) < 1e-4) & (np.abs(top) < 3.0)
    if name == "atan2":
        small &= (np.abs(low[:, :2]).min(axis=1) > 0.1) & (low[:, :2].min(axis=1) > 0.0)
    width = {"tan": 3e-3, "atan2": 2.1e-3, "pow": 2e-2}[name]
    assert small.any() and (top - bottom)[small].max() < width


def test_a_pole_of_the_tangent_says_nothing():
    program = TapeProgram(_unary("tan"))
    low = np.array([(1.5, 0, 0), (1.5, 0, 0), (-4.0, 0, 0), (0.1, 0, 0)], np.float32)
    high = np.array([(1.6, 0, 0), (4.5, 0, 0), (4.0, 0, 0), (1.2, 0, 0)], np.float32)
    bottom, top = program.intervals(low, high)
    assert (np.isfinite(bottom) & np.isfinite(top)).tolist() == [False, False, False, True]
    assert abs(bottom[3] - np.tan(0.1)) < 1e-4 and abs(top[3] - np.tan(1.2)) < 1e-4


def test_an_angle_around_its_jump_is_anything():
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    program = TapeProgram(builder.tape(builder.operation("atan2", y, x)))
    low = np.array([(-1, -1, 0), (-2, 0.5, 0), (0.5, -1, 0)], np.float32)
    high = np.array([(1, 1, 0), (-1, 1, 0), (1, 1, 0)], np.float32)
    bottom, top = program.intervals(low, high)
    assert bottom[0] < -np.pi < np.pi < top[0] < 3.15
    assert np.allclose(bottom[1:], [np.arctan2(1, -1), np.arctan2(-1, 0.5)], atol=1e-3)
    assert np.allclose(top[1:], [np.arctan2(0.5, -2), np.arctan2(1, 0.5)], atol=1e-3)


def test_small_exponentials_are_positive():
    """So that the logarithm of a sum of them, a smooth union, has a known slope."""
    program = TapeProgram(_unary("exp"))
    low = np.array([(-60, 0, 0), (-30, 0, 0)], np.float32)
    bottom, top = program.intervals(low, low + np.float32(0.5))
    assert np.allclose(bottom, np.exp([-60.0, -30.0]), rtol=1e-4)
    assert np.allclose(top, np.exp([-59.5, -29.5]), rtol=1e-4)


def test_what_may_be_nan_is_not_known_to_be_anything():
    """The infinity of an overflow times 0 is NaN; the minimum with 1 must not look known."""
    builder = TapeBuilder()
    x = builder.operation("x")
    huge = builder.operation("mul", builder.operation("mul", x, x), x)
    nan = builder.operation("mul", huge, builder.constant(0.0))
    program = TapeProgram(builder.tape(builder.operation("min", nan, builder.constant(1.0))))
    box = np.full((1, 3), 1e30, np.float32)
    assert np.isnan(program.values(box)).all()
    bottom, top = program.intervals(box, box)
    assert not (np.isfinite(bottom) & np.isfinite(top)).any()
