"""Pieces of work in several threads: their order, failures, progress and end."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from distal import Sphere
from distal.devices import threads
from distal.devices.base import Cancelled
from distal.mesh.parallel import parallel_map, slices_of


@pytest.fixture(autouse=True)
def three_threads(monkeypatch):
    """As if there were three processors."""
    monkeypatch.setattr(threads, "usable_threads", lambda: 3)


def test_results_are_in_the_order_of_the_pieces():
    used = set()

    def later_pieces_first(number):
        used.add(threading.current_thread())
        time.sleep(0.002 * (20 - number))
        return number * number

    assert parallel_map(later_pieces_first, range(20)) == [n * n for n in range(20)]
    assert len(used) == 3 and threading.current_thread() not in used


def test_the_first_piece_that_fails_is_reported():
    def fail(number):
        if number in (4, 5):
            time.sleep(0.05 * (5 - number))  # the later one fails first
            raise ValueError(number)

    for _ in range(3):
        with pytest.raises(ValueError, match=r"^4$"):
            parallel_map(fail, range(30))


def test_work_ends_where_the_caller_says_so():
    begun = []

    def slow(number):
        begun.append(number)
        time.sleep(0.01)

    def watch(share):
        if share > 0.0:
            raise Cancelled

    with pytest.raises(Cancelled):
        parallel_map(slow, range(300), watch)
    count = len(begun)
    assert count < 100
    time.sleep(0.05)
    assert len(begun) == count  # nothing goes on


def test_pieces_may_have_pieces():
    rows = np.arange(1000)

    def inner(some):
        return sum(parallel_map(lambda part: int(rows[some][part].sum()), slices_of(100, 7)))

    assert sum(parallel_map(inner, slices_of(1000, 100))) == rows.sum()


def test_slices_cover_all_rows_once():
    assert slices_of(0, 4) == []
    assert slices_of(9, 4) == [slice(0, 4), slice(4, 8), slice(8, 9)]


def test_a_mesh_is_cancelled_while_bricks_are_sampled():
    calls = []

    def cancel():
        calls.append(1)
        return len(calls) > 5

    with pytest.raises(Cancelled):
        Sphere(1.0).mesh(tolerance=0.0005, cancel=cancel)
