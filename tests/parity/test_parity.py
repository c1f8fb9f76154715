"""Every row of the table and every operator, on every type, on every target: one meaning.

To see what each row's tolerance would have to be on this machine, run
``DISTAL_PARITY_REPORT=1 pytest -s tests/parity/test_parity.py``.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import BinaryOp, CompareOp
from tests.parity import targets
from tests.parity.cases import operator_cases, table_cases
from tests.parity.comparing import disagreement
from tests.parity.programs import Case, Program, program
from tests.parity.sampling import SAMPLES

CASES_AT_ONCE = 40
# LLVM's time grows faster than its text: 40 cases with matrices take it twice as long as by tens.
CASES_BY_LLVM = 10
REPORT = os.environ.get("DISTAL_PARITY_REPORT") == "1"


@cache
def _cases() -> tuple[Case, ...]:
    return (*table_cases(), *operator_cases())


BATCHES = range(-(-len(_cases()) // CASES_AT_ONCE))


@cache
def _batch(first: int, last: int) -> tuple[Program, NDArray[np.float32]]:
    packed = program(_cases()[first:last])
    return packed, targets.reference(packed.module, packed.width, SAMPLES, packed.buffers)


def _programs(target: str, batch: int) -> Iterator[tuple[Program, NDArray[np.float32]]]:
    """The programs of a batch, with what they are to give."""
    first = batch * CASES_AT_ONCE
    last = min(first + CASES_AT_ONCE, len(_cases()))
    at_once = CASES_BY_LLVM if target == "llvm" else CASES_AT_ONCE
    for start in range(first, last, at_once):
        yield _batch(start, min(start + at_once, last))


# glsl-330 shares its writer with glsl-es300: every fourth batch tells.
RUNS = [
    (target, batch)
    for target in targets.TARGETS
    for batch in BATCHES
    if target != "glsl-330" or batch % 4 == 0
]


@pytest.mark.parametrize(("target", "batch"), RUNS)
def test_agrees_with_reference(target: str, batch: int) -> None:
    found = []
    for packed, expected in _programs(target, batch):
        try:
            actual = targets.TARGETS[target](packed.module, packed.width, SAMPLES, packed.buffers)
        except targets.Unavailable as reason:
            pytest.skip(f"{target} does not run here: {reason}")
        found += [
            disagreement(case, before, after, on_cpu=target == "llvm")
            for (case, before), (_, after) in zip(
                packed.results(expected), packed.results(actual), strict=True
            )
        ]
    first = batch * CASES_AT_ONCE
    assert [each.case for each in found] == list(_cases()[first : first + CASES_AT_ONCE])
    if REPORT:
        worst: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
        for d in found:
            row = worst[d.case.name.split("(")[0]]
            row[:] = [max(row[0], d.absolute), max(row[1], d.relative)]
        for name, (absolute, relative) in worst.items():
            if absolute:
                print(f"{target:12} {name:20} absolute {absolute:.1e} relative {relative:.1e}")
    messages = [d.message for d in found if d.message]
    assert not messages, "\n".join(messages)


def test_every_row_is_sampled() -> None:
    names = {case.name.split("(")[0] for case in table_cases()}
    assert names == set(INTRINSICS)


def test_every_operator_is_sampled() -> None:
    names = {case.name.split(" (")[0] for case in operator_cases()}
    missing = {op.value for op in (*BinaryOp, *CompareOp)} - names
    assert not missing


def test_samples_reach_negative_divisors_and_edges() -> None:
    quotients = [case for case in _cases() if case.name == "// (int, int)"]
    (dividends, divisors) = quotients[0].inputs()
    assert (divisors == 0).any() and (divisors < 0).any() and (dividends < 0).any()
    assert ((dividends == -(2.0**31)) & (divisors == -1)).any()
