"""Submit the parts of some work, and take the parts that workers have finished.

Input: a pool, ranges, a function that submits the task of a range. Output: the ranges and their
results, as they are finished.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import Any

from distal.cluster.errors import OtherVersionError
from distal.cluster.pool import WorkerPool
from distal.cluster.sizes import Range
from distal.devices.base import Cancelled


class SentParts:
    """Parts that workers make.

    Attributes:
        waiting: The tasks that are not finished, with their ranges.
        count: How many parts there are.

    Args:
        pool: The workers.
        begun: Submits the task of a range, and returns its future.
        ranges: The ranges.
        named: Names a part for messages.
    """

    def __init__(
        self,
        pool: WorkerPool,
        begun: Callable[[Range], Any],
        ranges: Sequence[Range],
        named: Callable[[Range], str],
    ) -> None:
        self._pool, self._begun, self._named = pool, begun, named
        self.waiting = {begun(each): each for each in ranges}
        self.count = len(ranges)

    def finished(self, wanted: Callable[[], bool]) -> Iterator[tuple[Range, Any]]:
        """Return the range and the result of each part as it is finished.

        Args:
            wanted: Says whether to stop.

        Raises:
            Cancelled: ``wanted`` said so.
            TaskError: A part failed.
            ClusterError: The scheduler is lost.
        """
        pool = self._pool
        with ExitStack() as watched:
            for future, numbers in self.waiting.items():
                watched.enter_context(pool.watch.on([future], self._named(numbers)))
            try:
                while self.waiting:
                    if wanted():
                        raise Cancelled
                    yield from self._ended(watched)
            except BaseException:
                pool.give_up(list(self.waiting))
                raise

    def _ended(self, watched: ExitStack) -> Iterator[tuple[Range, Any]]:
        pool = self._pool
        ended = [future for future in self.waiting if future.done()]
        for future in ended:
            numbers = self.waiting.pop(future)
            try:
                yield numbers, pool.taken(future, self._named(numbers))
            except OtherVersionError as error:
                pool.refuse(error)
                again = self._begun(numbers)
                watched.enter_context(pool.watch.on([again], self._named(numbers)))
                self.waiting[again] = numbers
        if not ended:
            for future in self.waiting:
                pool.watch.look(future)
            pool.wait(list(self.waiting))
