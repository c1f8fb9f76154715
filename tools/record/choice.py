"""Choose the tests of ``make test``.

Input: a record. Output: names of tests: those that cost little, and of the others a greedy cover:
again and again the test with the most functions that no chosen test runs, for its seconds; then
those are taken back whose functions the others all run. What time is left is for test functions
that have no case among these: the cheapest case of each, the cheapest first. What was written about
a function finds more in it than what runs it on its way.
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


def chosen(record: Record, seconds: float) -> set[str]:
    """Return the tests of ``make test``.

    Args:
        record: All tests.
        seconds: The processor time that they may take.

    Raises:
        ValueError: A cover takes longer.
    """
    found = cover(record, pinned(record))
    left = seconds - record.seconds(found)
    if left < 0.0:
        raise ValueError(f"a cover takes {record.seconds(found):.0f} s; {seconds:.0f} are allowed")
    for name in cases(record, found):
        left -= record.rows[name].seconds
        if left < 0.0:
            break
        found.add(name)
    return found


def pinned(record: Record) -> set[str]:
    """Return the tests that are chosen in any case: cheap ones, error texts, guarantees, rules."""
    return {
        name
        for name, row in record.rows.items()
        if row.seconds <= next((s for f, s in PINNED.items() if name.startswith(f)), CHEAP_S)
    }


def cases(record: Record, tests: Iterable[str]) -> list[str]:
    """Return the cheapest case of each test function that has none among some tests, in order."""
    found = {function_of(name) for name in tests}
    least: list[str] = []
    for name in sorted(record.rows, key=lambda n: (record.rows[n].seconds, n)):
        if function_of(name) not in found:
            found.add(function_of(name))
            least.append(name)
    return least


def function_of(name: str) -> str:
    """Return the name of a test without its parameters."""
    return name.partition("[")[0]
