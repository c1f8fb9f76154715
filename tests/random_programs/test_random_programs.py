"""Random programs: all targets give the reference's bits.

``DISTAL_RANDOM_PROGRAMS`` is how many functions are made in all (``make sweep`` makes thousands),
``DISTAL_RANDOM_SEED`` where the choices start (else another place each day); a failure prints the
seed of its part and the smallest program that still fails.
"""

from __future__ import annotations

import os
import time
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings

from distal.ir.nodes import Module
from tests.parity import targets
from tests.random_programs.running import lowered
from tests.random_programs.statements import ROWS, Sources, sources

PROGRAMS = int(os.environ.get("DISTAL_RANDOM_PROGRAMS", "144"))
SEED = int(os.environ.get("DISTAL_RANDOM_SEED") or time.time() // 86400 * 100)
PARTS = 6
FUNCTIONS = 8  # in one picture
EXAMPLES = max(1, PROGRAMS // (PARTS * FUNCTIONS))


BLANK = "@image\ndef picture(frame: Frame) -> vec4:\n    return vec4(frame.coord, 0.0, 1.0)\n"


@cache
def reason_to_leave_out(target: str) -> str | None:
    """Why a target does not run on this machine; None if it does."""
    blank = lowered(Sources("from distal.lang import *\n" + BLANK, (), 1))
    try:
        targets.TARGETS[target](blank, 1, 1, {})
    except targets.Unavailable as reason:
        return str(reason)
    return None


@pytest.mark.parametrize("target", targets.TARGETS)
def test_target_takes_part(target: str) -> None:
    reason = reason_to_leave_out(target)
    if reason is not None:
        pytest.skip(f"random programs are not run on {target}: {reason}")


@pytest.mark.parametrize("part", range(PARTS))
def test_all_targets_give_the_reference_bits(part: int) -> None:
    print(f"seed {SEED + part}")
    available = [name for name in targets.TARGETS if reason_to_leave_out(name) is None]

    @seed(SEED + part)
    @settings(
        max_examples=EXAMPLES,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(sources(functions=FUNCTIONS))
    def check(program: Sources) -> None:
        module = lowered(program)
        expected = targets.reference(module, program.width, ROWS, {})
        assert np.isfinite(expected).all(), (
            f"the grammar made a number that is none\n{program.text}"
        )
        for target in available:
            # These two share their writers with others, and take part in a quarter of the pictures.
            if target in ("glsl-330", "wgsl-compute") and len(program.text) % 4:
                continue
            hold_against(module, program, target, expected)

    check()


def hold_against(module: Module, program: Sources, target: str, expected: targets.Picture) -> None:
    """Fail with the first column that differs and the whole program."""
    actual = targets.TARGETS[target](module, program.width, ROWS, {})
    different = np.argwhere(~(actual == expected))
    if len(different):
        row, column, channel = different[0]
        pytest.fail(
            f"{target}: {len(different)} channels differ; in column {column} and row "
            f"{ROWS - 1 - row} channel {channel} should be {expected[row, column, channel]}, is "
            f"{actual[row, column, channel]}\n{program.text}"
        )
