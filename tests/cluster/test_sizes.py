"""How much of the work a task gets."""

from __future__ import annotations

import pytest

from distal.cluster.sizes import PartSizes, least_seconds


def test_nothing_is_put_together_before_anything_is_known():
    assert PartSizes(1).of_task(1000, 2) == 1


@pytest.mark.parametrize(
    ("seconds", "left", "expected"),
    [
        (0.001, 10_000, 80),  # 80 ms, four times the shortest task of two workers
        (0.010, 10_000, 8),
        (0.200, 10_000, 1),
        (0.001, 40, 10),  # a quarter of what is left, so that both workers end at the same time
        (0.001, 3, 1),
        (0.0, 10_000, 1),
    ],
)
def test_quick_pictures_share_a_task(seconds, left, expected):
    sizes = PartSizes(1)
    for _ in range(4):
        sizes.saw((0, 1), seconds)
    assert sizes.of_task(left, 2) == expected


def test_a_task_has_a_most():
    sizes = PartSizes(1, most=5)
    sizes.saw((0, 1), 1e-6)
    assert sizes.of_task(10_000, 2) == 5


def test_parts_take_at_least_what_the_scheduler_needs():
    sizes = PartSizes(16, unit=8)
    assert sizes.ranges(100, 2) == [(i, min(i + 16, 100)) for i in range(0, 100, 16)]
    sizes.saw((0, 100), 0.1)
    assert least_seconds(2) == 0.02  # 20 rows, in whole units
    assert sizes.ranges(100, 2)[0] == (0, 24)
    assert least_seconds(100) == 0.1
