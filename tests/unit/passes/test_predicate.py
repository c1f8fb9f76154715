"""Predicate: one way out of every function and loop, and the same results."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy import interpreter as reference
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.nodes import Break, Continue, Function, If, Return, Stmt
from distal.ir.verify import verify
from distal.ir.walk import blocks, statements_in
from distal.lang import func
from distal.passes.predicate import predicated


@func
def first_above(limit: int) -> int:
    for i in range(20):
        if i * i > limit:
            return i
    return -1


@func
def skips(limit: int) -> int:
    total = 0
    for i in range(12):
        if i % 3 == limit % 3:
            continue
        if i > limit:
            if limit > 4:
                break
            total += 100
        total += i
    return total


@func
def returns_from_within(limit: int) -> int:
    total = 0
    for i in range(6):
        for j in range(6):
            if j == i:
                continue
            if i * j > limit:
                return total
            if j > limit + 2:
                break
            total += j
        if total > 40:
            break
        total += 1
    return total * 2


@func
def hidden_deeper(limit: int) -> int:
    total = 0
    if limit > 2:
        if limit > 5:
            return 7
        total = 1
    else:
        for i in range(4):
            if i == limit:
                return 50 + i
            total += i
    total += 10
    while total < 40:
        if limit == 4:
            if total > 20:
                return total
            total += 1
        total += 5
    return total


@func
def loop_under_condition_in_loop(limit: int) -> int:
    total = 0
    for i in range(5):
        if i > limit:
            for j in range(5):
                if j + i > 6:
                    return total
                total += j
        else:
            total += 3
        if total % 2 == 0:
            continue
        total += 1
    return -total


@func
def straight(limit: int) -> int:
    return limit + 1


CASES: list[Any] = [
    first_above,
    skips,
    returns_from_within,
    hidden_deeper,
    loop_under_condition_in_loop,
    straight,
]


def leaving(block: tuple[Stmt, ...]) -> list[Stmt]:
    return [s for s in statements_in(block) if isinstance(s, Return | Break | Continue)]


def check_shape(function: Function) -> None:
    *before, last = function.body
    assert isinstance(last, Return)
    for stmt in statements_in(tuple(before)):
        assert not isinstance(stmt, Return | Continue)
        for block in blocks(stmt):
            if isinstance(stmt, If):
                # The one If around a Break is a loop's last statement, checked there.
                assert len(block) == 1 or not [s for s in block if isinstance(s, Break)]
            else:
                inside = block[:-1] if is_exit(block[-1:]) else block
                assert not [s for s in inside if is_exit((s,))]


def is_exit(block: tuple[Stmt, ...]) -> bool:
    match block:
        case (If(_, (Break(),), ()),):
            return True
        case _:
            return False


@pytest.mark.parametrize("function", CASES, ids=lambda f: f.name)
def test_one_way_out_and_the_same_results(function: Any) -> None:
    module = run_passes(lower(function), get_target("numpy"))
    changed = replace(module, functions=tuple(map(predicated, module.functions)))
    verify(changed)
    for f in changed.functions:
        check_shape(f)
    limits = [np.arange(-3, 30, dtype=np.int32)]
    before = reference.evaluate(module, limits, {}, {})
    after = reference.evaluate(changed, limits, {}, {})
    np.testing.assert_array_equal(before, after)
    assert len(np.unique(before)) > 2


def test_a_function_without_early_exits_is_left_alone() -> None:
    module = run_passes(lower(straight), get_target("numpy"))
    (function,) = module.functions
    assert predicated(function) is function


def test_a_target_that_wants_none_gets_none() -> None:
    module = run_passes(lower(first_above), get_target("glsl-es300"))
    assert len(leaving(module.functions[-1].body)) == 2
