"""One way: no If of two ways of one length where the target wants none, and the same results."""

# ruff: noqa: SIM108 (the statements are what is tested)

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy import interpreter as reference
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.nodes import Function, If, Return
from distal.ir.verify import verify
from distal.ir.walk import statements_in
from distal.lang import func
from distal.passes.one_way import parted


@func
def plain(n: int) -> int:
    total = n
    if n % 3 == 0:
        total += 5
        total *= 2
    else:
        total -= 7
    return total


@func
def changes_its_own_condition(n: int) -> int:
    total = n
    if total > 4:
        total = -total
    else:
        total = total * 3 + 10
    return total


@func
def two_returns(n: int) -> int:
    if n % 2 == 0:
        half = n // 2
        return half + 1
    more = 3 * n
    return more + 1


@func
def three_returns(n: int) -> int:
    if n % 3 == 0:
        return 100 + n
    if n % 3 == 1:
        return 200 - n
    return 7 * n


@func
def alike_within(n: int) -> int:
    first = 1
    total = 0
    if n > 5:
        if n > 9:
            total = 1
        else:
            total = first + 4
    else:
        if n > 1:
            total = 12
        else:
            total = first - 33
    return total


@func
def in_a_loop(n: int) -> int:
    total = n
    for i in range(6):
        if total % 2 == 0:
            total += i
        else:
            total -= 3 * i
        if total > 40:
            break
    return total


@func
def unlike(n: int) -> int:
    total = n
    if n > 3:
        total += 1
    else:
        for i in range(3):
            total += i * n
    return total


PARTED: list[Any] = [
    plain,
    changes_its_own_condition,
    two_returns,
    three_returns,
    alike_within,
    in_a_loop,
]


def forks(function: Function) -> list[If]:
    return [s for s in statements_in(function.body) if isinstance(s, If) and s.otherwise]


@pytest.mark.parametrize("function", PARTED, ids=lambda f: f.name)
def test_the_same_results_with_single_ways(function: Any) -> None:
    module = run_passes(lower(function), get_target("numpy"))
    changed = replace(module, functions=tuple(map(parted, module.functions)))
    verify(changed)
    assert changed != module
    assert not [fork for f in changed.functions for fork in forks(f)]
    values = [np.arange(-20, 30, dtype=np.int32)]
    before = reference.evaluate(module, values, {}, {})
    np.testing.assert_array_equal(before, reference.evaluate(changed, values, {}, {}))
    assert len(np.unique(before)) > 2


def test_two_returns_become_one() -> None:
    module = run_passes(lower(two_returns), get_target("glsl-es300"))
    returns = [s for s in statements_in(module.functions[-1].body) if isinstance(s, Return)]
    assert len(returns) == 1


def test_ways_of_unequal_length_stay_an_else() -> None:
    module = run_passes(lower(unlike), get_target("glsl-es300"))
    assert len(forks(module.functions[-1])) == 1


def test_a_target_that_does_not_mind_keeps_its_else() -> None:
    module = run_passes(lower(plain), get_target("wgsl"))
    assert len(forks(module.functions[-1])) == 1
