"""Gradients of random fields agree with finite differences in 64 bits.

The reference measures the slopes of the plain field; its own gradients and those of the CPU device
are held against them. Points at creases, jumps and where the field bends too fast to measure are
told by the field's values alone (``differences``) and left out; a tenth of them at most.
``DISTAL_GRADIENT_FIELDS`` is how many fields are made. The CPU device compiles a twelfth of them,
a third of them in ``make sweep``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from distal.devices import cpu, reference
from distal.devices.cache import Cache
from distal.frontend import lower
from distal.ir.intrinsics import INTRINSICS
from distal.ir.types import Kind, kind_of
from tests.gradients.differences import Slopes, differences
from tests.gradients.fields import Field, make_field
from tests.gradients.running import Doubles, on_reference, points_of, scope_of
from tests.selection import all_cases

FIELDS = int(os.environ.get("DISTAL_GRADIENT_FIELDS", "64"))
COMPILED = 3 if all_cases() else 12
PARTS = 8
POINTS = 50


@cache
def scope(seed: int) -> dict[str, Any]:
    return scope_of(make_field(seed).text, f"random_field_{seed}")


@cache
def measured(seed: int) -> tuple[Field, Doubles, Doubles, Slopes]:
    """A field, its points, its values and slopes there."""
    field = make_field(seed)
    points = points_of(field, POINTS, seed)
    kernel = reference.prepare(lower(scope(seed)["field"]), precision=64)

    def function(at: Doubles) -> Doubles:
        return kernel.evaluate([at], {}, {})  # type: ignore[return-value]

    return field, points, function(points), differences(function, points)


def assert_agrees(seed: int, value: Doubles, gradient: Doubles, who: str) -> None:
    field, points, expected, slopes = measured(seed)
    off = slopes.disagreement(gradient.reshape(len(points), -1))
    worst = int(off.argmax())
    assert off[worst] < 1.0, (
        f"{who}: the gradient at {points[worst]} is {gradient[worst]}, "
        f"measured {slopes.slopes[worst]}\n# seed {seed}\n{field.text}"
    )
    same = np.abs(value - expected) <= 1e-9 * (1.0 + np.abs(expected))
    assert same[slopes.smooth].all(), f"{who}: the value is another\n# seed {seed}\n{field.text}"


@pytest.mark.parametrize("part", range(PARTS))
def test_gradients_agree_with_finite_differences(part: int) -> None:
    for seed in range(part, FIELDS, PARTS):
        _, points, _, _ = measured(seed)
        both = scope(seed)["both"]
        assert_agrees(seed, *on_reference(both, points), "reference")
        # Compiling takes four times as long as all else.
        if seed % COMPILED == 0:
            kernel = cpu.prepare(lower(both), precision=64, cache=Cache(None))
            assert_agrees(seed, *kernel.evaluate([points], {}, {}), "cpu")


def test_calls_from_python_measure_the_same_slopes() -> None:
    for seed in range(1, 33, 6):
        _, points, values, slopes = measured(seed)
        function, both = scope(seed)["field"], scope(seed)["both"]
        near = slopes.smooth
        assert np.allclose(function(points)[near], values[near], rtol=1e-9, atol=1e-9)
        own = differences(function, points)
        own.smooth[:] &= near  # contraction may move a jump
        off = own.disagreement(both(points)[1].reshape(POINTS, -1))
        assert off.max() < 1.0, make_field(seed).text


def test_few_points_are_left_out() -> None:
    left_out = [int((~measured(seed)[3].smooth).sum()) for seed in range(FIELDS)]
    print(f"left out: {sum(left_out)} of {FIELDS * POINTS} points; by field {left_out}")
    assert sum(left_out) < 0.1 * FIELDS * POINTS
    # And few fields have no slope to speak of.
    flat = [s for s in range(FIELDS) if np.abs(measured(s)[3].slopes).max() < 1e-3]
    assert len(flat) < 0.1 * FIELDS, flat


def smooth_rows() -> Iterator[str]:
    """The built-ins that take floats and give floats."""
    for row in INTRINSICS.values():
        instances = [i for s in row.signatures for i in s.instances()]
        floats = any(
            kind_of(result) is Kind.FLOAT and all(kind_of(p) is Kind.FLOAT for p in params)
            for params, result in instances
        )
        if floats and not row.hidden:
            yield row.name


def fields_with(word: str) -> list[int]:
    pattern = re.compile(rf"\b{word}\(")
    return [s for s in range(FIELDS) if pattern.search(make_field(s).text)]


def test_every_row_is_in_some_field() -> None:
    assert [name for name in smooth_rows() if not fields_with(name)] == []


@pytest.mark.sample(3)
@pytest.mark.parametrize("name", sorted(smooth_rows()))
def test_a_wrong_derivative_is_seen(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each row in turn loses its derivative, or gets one it has not; some field must notice."""
    row = INTRINSICS[name]
    rule = row.derivative
    assert rule is not None

    def wrong(e: Any, d: Any) -> Any:
        tangent = rule(e, d)
        if tangent is not None:
            return None
        return d[-1] if d[-1] is not None and d[-1].type is e.type else None

    monkeypatch.setitem(INTRINSICS, name, replace(row, derivative=wrong))
    for seed in fields_with(name):
        try:
            _, points, _, slopes = measured(seed)
            gradient = on_reference(scope(seed)["both"], points)[1].reshape(POINTS, -1)
        except AssertionError:
            continue
        if slopes.disagreement(gradient).max() > 1.0:
            return
    pytest.fail(f"no field notices the derivative of {name}")
