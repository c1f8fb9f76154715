"""Pruned tapes give the same values, to the bit, and are shorter."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from distal.devices.features import host_levels
from distal.tape.runtime import TapeProgram
from distal.tape.tape import TapeBuilder
from tests.tape.random_tapes import LANES, Case, bits, cases


@pytest.mark.parametrize("level", host_levels(), ids=lambda level: level.name)
def test_pruned_tapes_give_the_same_bits(level):
    @settings(max_examples=60)
    @given(case=cases())
    def check(case: Case) -> None:
        program = TapeProgram(case.tape, level)
        whole = program.values(case.points.reshape(-1, 3)).reshape(LANES, LANES)
        pruned, lengths = program.pruned_values(case.low, case.high, case.points)
        assert (bits(pruned) == bits(whole)).all()
        assert (lengths >= 1).all()
        assert (lengths <= len(case.tape)).all()

    check()


def _far_apart(count: int) -> TapeProgram:
    """A union of ``count`` disks of radius 0.1, at x = 0, 1, 2 …"""
    builder = TapeBuilder()
    x, y = builder.operation("x"), builder.operation("y")
    union = None
    for i in range(count):
        across = builder.operation("sub", x, builder.constant(float(i)))
        squares = [builder.operation("square", value) for value in (across, y)]
        root = builder.operation("sqrt", builder.operation("add", *squares))
        disk = builder.operation("sub", root, builder.constant(0.1))
        union = disk if union is None else builder.operation("min", union, disk)
    return TapeProgram(builder.tape(union))


def test_only_the_part_that_can_matter_is_left():
    program = _far_apart(64)
    centers = np.array([(i, 0.0, 0.0) for i in range(LANES)], np.float32)
    low, high = centers - np.float32(0.2), centers + np.float32(0.2)
    points = np.repeat(centers[:, None], LANES, axis=1)
    values, lengths = program.pruned_values(low, high, points)
    # x, y, the center, sub, two squares, add, sqrt, the radius, sub.
    assert (lengths == 10).all()
    assert np.allclose(values, -0.1)


def test_a_box_around_everything_prunes_nothing():
    program = _far_apart(8)
    low = np.full((LANES, 3), -100, np.float32)
    points = np.zeros((LANES, LANES, 3), np.float32)
    _, lengths = program.pruned_values(low, -low, points)
    assert (lengths == len(program.tape)).all()


def test_slots_are_reused():
    # Of a union of any number of parts: x, y, the union so far, and three values of a part.
    assert _far_apart(50).slots <= 6
    assert _far_apart(50).slots == _far_apart(500).slots
