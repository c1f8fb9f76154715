"""Intervals of 64 bits contain exact values: by fractions, by many points, and where they end."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings

from distal.ir.intrinsics import INTRINSICS
from distal.tape.box_tape import BoxTape
from distal.tape.operations import OPERATIONS
from distal.tape.tape import Tape, TapeBuilder
from tests.tape.random_tapes import LANES, Case, cases

# What each operation computes, for arrays of points: the definition that intervals are held to.
_AT_POINTS = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "min": lambda a, b: np.where(b < a, b, a),
    "max": lambda a, b: np.where(a < b, b, a),
    "neg": np.negative,
    "abs": np.abs,
    "square": np.square,
    "sqrt": lambda a: np.sqrt(np.where(a > 0.0, a, 0.0)),
    "floor": np.floor,
    "ceil": np.ceil,
    "round": np.rint,
    "trunc": np.trunc,
    "less": lambda a, b: (a < b) * 1.0,
    "less_equal": lambda a, b: (a <= b) * 1.0,
    "equal": lambda a, b: (a == b) * 1.0,
    "select": lambda a, b, c: np.where(a != 0.0, b, c),
}


def _elementary(name, *operands):
    row = INTRINSICS[name]
    if row.held is not None:
        operands = [np.clip(a, *row.held.limits(64)) for a in operands]
    return row.meaning(np, *(np.asarray(a) for a in operands))


def _at(tape: Tape, points):
    values = []
    with np.errstate(all="ignore"):
        for number, _, a, b, c, _ in tape.operations.tolist():
            row = OPERATIONS[number]
            if row.name == "const":
                values.append(np.full(len(points), tape.numbers[a]))
            elif row.name in ("x", "y", "z"):
                values.append(points[:, "xyz".index(row.name)])
            else:
                operands = [values[i] for i in (a, b, c)[: row.operands]]
                rule = _AT_POINTS.get(row.name)
                values.append(rule(*operands) if rule else _elementary(row.name, *operands))
    return np.asarray(values[-1], np.float64)


def _contains(low, high, values):
    """Where something is known, the value is a number, and between the ends."""
    known = ~np.isnan(low)
    with np.errstate(invalid="ignore"):
        return ((low <= values) & (values <= high))[known].all()


@settings(max_examples=60)
@given(case=cases())
def test_random_expressions_contain_a_hundred_thousand_points(case: Case):
    """64 boxes with 1,600 points each: the corners, and points between."""
    box = BoxTape.of(case.tape)
    low, high = case.low.astype(np.float64), case.high.astype(np.float64)
    least, most, shorter = box.values(low, high)
    again, once_more, _ = shorter.values(low, high)
    assert np.array_equal(least, again, equal_nan=True)
    assert np.array_equal(most, once_more, equal_nan=True)
    t = np.concatenate([case.points * 0.0, np.random.default_rng(3).random((LANES, 1536, 3))], 1)
    t[:, :LANES] = np.random.default_rng(4).integers(0, 2, (LANES, LANES, 3))
    points = np.clip(low[:, None] * (1.0 - t) + high[:, None] * t, low[:, None], high[:, None])
    values = _at(case.tape, points.reshape(-1, 3)).reshape(LANES, -1)
    count = values.shape[1]
    assert _contains(np.repeat(least, count), np.repeat(most, count), values.reshape(-1))


@pytest.mark.parametrize("seed", range(4))
def test_sums_and_products_contain_the_exact_fraction(seed):
    """At points, where only the rounding outwards makes room: sums of 30 terms, in fractions."""
    rng = np.random.default_rng(seed)
    numbers = rng.normal(size=90) * 10.0 ** rng.uniform(-8, 8, 90)
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    value, exact = x, lambda a, b: a
    for name, number in zip(rng.choice(["add", "sub", "mul"], 90), numbers, strict=True):
        operand = y if rng.random() < 0.3 else builder.constant(float(number))
        value = builder.operation(str(name), value, operand)
        op = {"add": lambda p, q: p + q, "sub": lambda p, q: p - q, "mul": lambda p, q: p * q}[name]
        other = None if operand == y else Fraction(float(number))
        # Kept near 1, so that nothing overflows.
        value = builder.operation("mul", value, builder.constant(2.0**-13))

        def exact(a, b, op=op, other=other, before=exact):
            return op(before(a, b), b if other is None else other) * Fraction(1, 2**13)

    tape = BoxTape.of(builder.tape(value))
    points = rng.normal(size=(200, 3))
    least, most, _ = tape.values(points, points)
    for low, high, (a, b, _) in zip(least, most, points, strict=True):
        true = exact(Fraction(float(a)), Fraction(float(b)))
        assert Fraction(float(low)) <= true <= Fraction(float(high))
        assert high - low < 1e-9 * max(abs(float(true)), 1e-3)


def _of(*names: str) -> BoxTape:
    """Return one operation after the other, of x and y or of the result before."""
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    value = x
    for name in names:
        count = OPERATIONS[[row.name for row in OPERATIONS].index(name)].operands
        value = builder.operation(name, *(value, y)[:count])
    return BoxTape.of(builder.tape(value))


def _ends(tape: BoxTape, low, high):
    least, most, _ = tape.values(np.array([low], float), np.array([high], float))
    return least[0], most[0]


@pytest.mark.parametrize(
    ("names", "low", "high", "expected"),
    [
        (["square"], (-2, 0, 0), (1, 0, 0), (0.0, 4.0)),
        (["sqrt"], (-2, 0, 0), (4, 0, 0), (0.0, 2.0)),
        (["abs"], (-3, 0, 0), (2, 0, 0), (0.0, 3.0)),
        (["sin"], (0, 0, 0), (math.pi, 0, 0), (0.0, 1.0)),
        (["cos"], (3, 0, 0), (4, 0, 0), (-1.0, math.cos(4.0))),
        (["sin"], (100.0, 0, 0), (100.1, 0, 0), (math.sin(100.0), math.sin(100.1))),
        (["cos"], (-1e7, 0, 0), (-1e7 + 1e-3, 0, 0), (-1.0, 1.0)),
        (["exp"], (-1, 0, 0), (2, 0, 0), (math.exp(-1.0), math.exp(2.0))),
        (["cosh"], (-1, 0, 0), (2, 0, 0), (1.0, math.cosh(2.0))),
        (["acos"], (-1, 0, 0), (1, 0, 0), (0.0, math.pi)),
        (["tan"], (-1, 0, 0), (1, 0, 0), (-math.tan(1.0), math.tan(1.0))),
        (["pow"], (0, 0.5, 0), (4, 2, 0), (0.0, 16.0)),
        (["pow"], (-1, 0.5, 0), (0.25, 1, 0), (0.0, 0.5)),
        (["atan2"], (1, 1, 0), (1, 2, 0), (math.atan2(1, 2), math.atan2(1, 1))),
        (["atan2"], (-1, -1, 0), (1, 1, 0), (-math.pi, math.pi)),
        (["div"], (1, 2, 0), (2, 4, 0), (0.25, 1.0)),
        (["floor"], (-0.5, 0, 0), (1.5, 0, 0), (-1.0, 1.0)),
        (["less"], (0, 2, 0), (1, 3, 0), (1.0, 1.0)),
        (["less"], (0, 0.5, 0), (1, 3, 0), (0.0, 1.0)),
        (["equal"], (0, 2, 0), (1, 3, 0), (0.0, 0.0)),
    ],
)
def test_intervals_are_those_of_the_function(names, low, high, expected):
    found = _ends(_of(*names), low, high)
    assert found[0] <= expected[0] and expected[1] <= found[1]
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("names", "low", "high"),
    [
        (["div"], (1, -1, 0), (2, 1, 0)),
        (["div"], (0, 0, 0), (2, 1, 0)),
        (["tan"], (1.5, 0, 0), (1.6, 0, 0)),
        (["tan"], (-4, 0, 0), (4, 0, 0)),
        (["pow"], (0, -1, 0), (2, 1, 0)),
        # What may not be a number makes nothing certain, whatever it is compared with.
        (["div", "min"], (1, -1, 0), (2, 1, 0)),
        (["div", "max"], (1, -1, 0), (2, 1, 0)),
        (["div", "abs", "sqrt", "exp", "sin"], (1, -1, 0), (2, 1, 0)),
    ],
)
def test_where_nothing_is_known(names, low, high):
    assert np.isnan(_ends(_of(*names), low, high)).all()


def test_a_condition_may_be_unknown():
    builder = TapeBuilder()
    x = builder.operation("x")
    ratio = builder.operation("div", builder.constant(1.0), x)
    condition = builder.operation("less", ratio, builder.constant(5.0))
    chosen = builder.operation("select", condition, builder.constant(2.0), builder.constant(3.0))
    assert _ends(BoxTape.of(builder.tape(chosen)), (-1, 0, 0), (1, 0, 0)) == (2.0, 3.0)


def test_operands_that_do_not_matter_are_dropped_where_they_do_not():
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    both = builder.operation("min", builder.operation("sin", x), y)
    whole = BoxTape.of(builder.tape(both))
    near, far = np.array([(0.0, 2.0, 0.0)]), np.array([(0.0, -2.0, 0.0)])
    assert len(whole.values(near, near + 0.1)[2]) == 2  # the sine alone
    assert len(whole.values(far, far + 0.1)[2]) == 1
    mixed = np.concatenate([near, far])
    assert whole.values(mixed, mixed + 0.1)[2] is whole


@settings(max_examples=40)
@given(case=cases())
def test_values_differ_from_the_middle_by_at_most_the_gradient_times_the_way(case: Case):
    """Random expressions in small boxes: only where value and derivatives are known."""
    box = BoxTape.of(case.tape)
    low = np.clip(case.low.astype(np.float64), -1e6, 1e6)
    high = np.clip(case.high.astype(np.float64), low, low + 0.1 * (1.0 + np.abs(low)))
    falling, rising = box.gradients(low, high)
    least, most, _ = box.values(low, high)
    known = np.isfinite(falling).all(1) & np.isfinite(rising).all(1)
    known &= np.isfinite(least) & np.isfinite(most)
    middle = low + (high - low) / 2.0
    points = low[:, None] + (high - low)[:, None] * np.random.default_rng(5).random((LANES, 60, 3))
    way = points - middle[:, None]
    with np.errstate(all="ignore"):
        ends = [falling[:, None] * way, rising[:, None] * way]
        down, up = np.minimum(*ends).sum(axis=2), np.maximum(*ends).sum(axis=2)
        values = _at(case.tape, points.reshape(-1, 3)).reshape(LANES, -1)
        at_middle = _at(case.tape, middle)[:, None]
        # The values themselves are rounded, step by step.
        scale = np.maximum(np.abs(values), np.abs(at_middle)).max(axis=1, keepdims=True)
        below, above, _ = box.values(points.reshape(-1, 3), points.reshape(-1, 3))
        room = 2.0 * (above - below).reshape(LANES, -1) + 1e-12 * scale
        inside = (at_middle + down - room <= values) & (values <= at_middle + up + room)
    assert inside[known].all()


@pytest.mark.parametrize(
    ("name", "low", "high", "expected"),
    [
        ("abs", (-1, 0, 0), (2, 0, 0), (-1.0, 1.0)),
        ("square", (-1, 0, 0), (2, 0, 0), (-2.0, 4.0)),
        ("sin", (0, 0, 0), (1, 0, 0), (math.cos(1.0), 1.0)),
        ("exp", (0, 0, 0), (1, 0, 0), (1.0, math.e)),
        ("asin", (-0.5, 0, 0), (0.5, 0, 0), (1.0, 1.0 / math.sqrt(0.75))),
        ("floor", (0.25, 0, 0), (0.75, 0, 0), (0.0, 0.0)),
        ("floor", (0.75, 0, 0), (1.25, 0, 0), None),
        ("sqrt", (0, 0, 0), (1, 0, 0), None),
        ("asin", (0.5, 0, 0), (1, 0, 0), None),
        ("tan", (1.5, 0, 0), (1.6, 0, 0), None),
    ],
)
def test_derivatives_along_x(name, low, high, expected):
    tape = _of(name)
    falling, rising = tape.gradients(np.array([low], float), np.array([high], float))
    found = falling[0, 0], rising[0, 0]
    if expected is None:
        assert np.isnan(found).any()
    else:
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-8)
        assert found[0] <= expected[0] and expected[1] <= found[1]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("mul", [(2, 3), (0, 1)]),
        ("div", [(1 / 3, 1 / 2), (-1 / 4, 0)]),
        ("sub", [(1, 1), (-1, -1)]),
        ("pow", [(0, 3), None]),
        ("atan2", [(2 / 10, 1 / 2), (-1 / 4, 0)]),
        ("max", [(0, 0), (1, 1)]),
        ("min", [(1, 1), (0, 0)]),
    ],
)
def test_derivatives_of_two_numbers(name, expected):
    """For x from 0 to 1 and y from 2 to 3; ``atan2`` of x over y."""
    falling, rising = _of(name).gradients(np.array([(0.0, 2, 0)]), np.array([(1.0, 3, 0)]))
    for axis, ends in enumerate(expected):
        found = falling[0, axis], rising[0, axis]
        if ends is None:
            assert np.isnan(found).any()
        else:
            assert found[0] <= ends[0] + 1e-15 and ends[1] - 1e-15 <= found[1]
            assert found == pytest.approx(ends, abs=0.11 if name == "atan2" else 1e-9)


def test_the_faces_of_a_box_have_one_derivative():
    """``length(max(q, 0)) + min(max(q), 0)``: on a face the terms do not add up to two."""
    builder = TapeBuilder()
    zero = builder.constant(0.0)
    q = [
        builder.operation("sub", builder.operation("abs", builder.operation(axis)), number)
        for axis, number in zip("xyz", map(builder.constant, (1.0, 0.5, 0.25)), strict=True)
    ]
    squares = [builder.operation("square", builder.operation("max", part, zero)) for part in q]
    total = builder.operation("add", builder.operation("add", *squares[:2]), squares[2])
    most = builder.operation("max", builder.operation("max", *q[:2]), q[2])
    outside, inside = builder.operation("sqrt", total), builder.operation("min", most, zero)
    tape = BoxTape.of(builder.tape(builder.operation("add", outside, inside)))
    low = np.array([(0.9, -0.1, 0.0), (0.0, 0.45, -0.1), (0.9, 0.45, 0.0)])
    high = np.array([(1.1, 0.1, 0.1), (0.2, 0.55, 0.1), (1.1, 0.55, 0.1)])
    falling, rising = tape.gradients(low, high)
    assert falling[0] == pytest.approx([1, 0, 0]) and rising[0] == pytest.approx([1, 0, 0])
    assert falling[1] == pytest.approx([0, 1, 0]) and rising[1] == pytest.approx([0, 1, 0])
    # At the edge between them, anything between the two.
    assert falling[2] == pytest.approx([0, 0, 0]) and rising[2] == pytest.approx([1, 1, 0])
