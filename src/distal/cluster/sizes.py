"""How large the parts are into which work is divided: from what a task costs.

Input: how many workers there are, what earlier parts took. Output: ranges of numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, TypeAlias

# The first number of a part, and the one after its last.
Range: TypeAlias = tuple[int, int]
# What a task costs the scheduler, in seconds: benchmarks/bench_cluster.py measures it.
TASK_S: Final = 1e-3
# The share of a worker's time that tasks may cost.
_MOST_COST: Final = 0.05
# Parts of each worker's share: more of them even out the workers' speeds.
_OF_EACH: Final = 6
# Numbers that come one after the other are taken together until a task takes so many times the
# shortest: what a task costs is hardly seen then, and each worker still ends some every second.
_TASKS_WORTH: Final = 4


def least_seconds(slots: int, task_s: float = TASK_S) -> float:
    """Return the shortest time of a task for which the scheduler is not the limit.

    While workers do ``slots`` tasks at once, the scheduler hands out the next ones, which takes
    ``slots * task_s`` seconds of its time. And a worker waits about ``task_s`` for its next task.

    Args:
        slots: How many tasks the workers do at once.
        task_s: What a task costs, in seconds.
    """
    return max(task_s / _MOST_COST, slots * task_s)


@dataclass(slots=True)
class PartSizes:
    """Chooses the size of parts from what the parts before have taken.

    Attributes:
        least: The smallest part while nothing is known.
        unit: Parts are multiples of it.
        seconds: What the parts so far have taken.
        done: The numbers that they had.
        most: The most numbers of a task that ``of_task`` gives.
    """

    least: int
    unit: int = 1
    seconds: float = 0.0
    done: int = 0
    most: int = 2**62

    def ranges(self, count: int, slots: int) -> list[Range]:
        """Divide numbers into parts.

        Args:
            count: How many numbers there are, from 0.
            slots: How many tasks the workers do at once.
        """
        of_part = -(-count // (slots * _OF_EACH))
        if self.done and self.seconds > 0.0:
            least = least_seconds(slots) * self.done / self.seconds
        else:
            least = self.least
        # Fewer parts than workers would leave some without work.
        of_part = max(of_part, min(round(least), -(-count // slots)), 1)
        of_part = -(-of_part // self.unit) * self.unit
        return [(first, min(first + of_part, count)) for first in range(0, count, of_part)]

    def of_task(self, left: int, slots: int) -> int:
        """Return how many of the numbers that are left, one after the other, the next task gets.

        One while nothing is known. Near the end fewer, so that workers end at the same time.

        Args:
            left: How many numbers are left.
            slots: How many tasks the workers do at once.
        """
        if not self.done or self.seconds <= 0.0:
            return 1
        wanted = _TASKS_WORTH * least_seconds(slots) * self.done / self.seconds
        return max(1, min(int(wanted), self.most, left // (2 * slots)))

    def saw(self, numbers: Range, seconds: float) -> None:
        """Note what a part took."""
        self.done += numbers[1] - numbers[0]
        self.seconds += seconds
