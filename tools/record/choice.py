"""Choose the tests of ``make test``.

Input: a record. Output: names of tests: those that cost little, the cheapest case of each test
function that has none among them, unless it takes long, and of the others a greedy cover: again and
again the test with the most functions that no chosen test runs, for its seconds; then those are
taken back whose functions the others all run.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable
from typing import Final

from tools.record.rows import Record

LEAST_S: Final = 0.02  # what any test costs
CHEAP_S: Final = 0.15  # a test that takes no longer is in every choice
# Of these folders longer tests too, in seconds: error texts and declared guarantees; rules of the
# repository, which no cover of functions can stand for.
PINNED: Final = {
    "tests/errors/": 0.5,
    "tests/fields/": 0.5,
    "tests/meta/": 5.0,
    "tests/record/": 5.0,
}
# The cheapest case of a test function is in every choice if it takes no longer: what was written
# about a function finds more in it than what runs it on its way.
CASE_S: Final = 1.0


def cover(record: Record, pinned: Iterable[str] = ()) -> set[str]:
    """Return tests that run each function that any test runs.

    Args:
        record: All tests.
        pinned: Tests that are in it in any case.
    """
    rows, chosen = record.rows, dict.fromkeys(pinned)
    lacking = run_by(record, rows) & ~run_by(record, chosen)

    def gain(name: str) -> float:
        return (rows[name].functions & lacking).bit_count() / (rows[name].seconds + LEAST_S)

    heap = [(-gain(name), name) for name in sorted(rows) if name not in chosen]
    heapq.heapify(heap)
    while heap and lacking:
        _, name = heapq.heappop(heap)
        value = -gain(name)
        if heap and value > heap[0][0]:  # others have been chosen since: it is worth less now
            heapq.heappush(heap, (value, name))
            continue
        chosen[name] = None
        lacking &= ~rows[name].functions
    return _without_spare(record, set(chosen), frozenset(pinned))


def run_by(record: Record, tests: Iterable[str]) -> int:
    """Return the mask of the functions that some tests run."""
    found = 0
    for name in tests:
        found |= record.rows[name].functions
    return found


def _without_spare(record: Record, chosen: set[str], pinned: frozenset[str]) -> set[str]:
    """Take the tests back, the longest first, without which the cover is as good."""
    every = run_by(record, chosen)
    for name in sorted(chosen - pinned, key=lambda n: (-record.rows[n].seconds, n)):
        if run_by(record, chosen - {name}) == every:
            chosen.remove(name)
    return chosen


def chosen(record: Record) -> set[str]:
    """Return the tests of ``make test``."""
    return cover(record, pinned(record))


def pinned(record: Record) -> set[str]:
    """Return the tests that are chosen in any case."""
    cheap = {
        name
        for name, row in record.rows.items()
        if row.seconds <= next((s for f, s in PINNED.items() if name.startswith(f)), CHEAP_S)
    }
    least: dict[str, str] = {}
    for name in sorted(record.rows, key=lambda n: (record.rows[n].seconds, n)):
        least.setdefault(name.partition("[")[0], name)
    cases = (name for name in least.values() if record.rows[name].seconds <= CASE_S)
    return cheap.union(cases)
