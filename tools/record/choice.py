"""Choose tests that together run every function several times, for the least time.

Input: a record. Output: names of tests. A greedy cover: again and again the test with the most
functions that too few chosen tests run, for its seconds; then those are taken back whose functions
the others all run often enough.
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


class Cover:
    """How often chosen tests run each function, up to a number of times.

    Attributes:
        levels: Masks: the functions that are run once or more, twice or more, and so on.
    """

    def __init__(self, times: int) -> None:
        self.levels = [0] * times

    def add(self, functions: int) -> None:
        """Count the functions of a test."""
        for i, level in enumerate(self.levels):
            self.levels[i], functions = level | functions, level & functions

    def lacks(self, most: Cover) -> int:
        """Return the functions that are run less often here than in another cover."""
        found = 0
        for here, there in zip(self.levels, most.levels, strict=True):
            found |= there & ~here
        return found


def cover(record: Record, pinned: Iterable[str] = (), times: int = 1) -> set[str]:
    """Return tests that run each function so many times, or as often as any tests do.

    Args:
        record: All tests.
        pinned: Tests that are in it in any case.
        times: How often each function is to be run.
    """
    rows, chosen, now, most = record.rows, dict.fromkeys(pinned), Cover(times), Cover(times)
    for row in rows.values():
        most.add(row.functions)
    for name in chosen:
        now.add(rows[name].functions)
    lacking = now.lacks(most)

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
        now.add(rows[name].functions)
        lacking = now.lacks(most)
    return _without_spare(record, chosen, frozenset(pinned), most)


def _without_spare(
    record: Record, chosen: Iterable[str], pinned: frozenset[str], most: Cover
) -> set[str]:
    """Take the tests back, the longest first, without which the cover is as good."""
    kept = set(chosen)
    for name in sorted(kept - pinned, key=lambda n: (-record.rows[n].seconds, n)):
        if record.rows[name].seconds < 10 * LEAST_S:
            break
        rest = Cover(len(most.levels))
        for other in kept - {name}:
            rest.add(record.rows[other].functions)
        if not rest.lacks(most):
            kept.remove(name)
    return kept


def chosen(record: Record, times: int, seconds: float) -> set[str]:
    """Return the tests of ``make test``: pins, and the largest cover that the time allows.

    Args:
        record: All tests.
        times: How often each function is to be run at most.
        seconds: The processor time that they may take.

    Raises:
        ValueError: A cover that runs each function once takes longer.
    """
    pins = pinned(record)
    for count in range(times, 0, -1):
        found = cover(record, pins, count)
        if record.seconds(found) <= seconds:
            return found
    raise ValueError(f"{record.seconds(found):.0f} s run each function once; {seconds:.0f} allowed")


def pinned(record: Record) -> set[str]:
    """Return the tests that are chosen in any case: cheap ones, error texts, guarantees, rules."""
    return {
        name
        for name, row in record.rows.items()
        if row.seconds <= next((s for f, s in PINNED.items() if name.startswith(f)), CHEAP_S)
    }
