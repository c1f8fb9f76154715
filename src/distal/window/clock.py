"""The scene's time: it runs, stands, jumps, and goes faster or slower.

What flows in: readings of a steady wall clock, in seconds. What flows out: the scene's seconds at
each. Reads no clock itself.
"""

from __future__ import annotations

from typing import Final

SPEEDS: Final = (0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
# A finite float of 32 bits still tells frames apart here: 2 ** 20 s is twelve days.
LATEST_S: Final = 1048576.0


class Clock:
    """The scene's time as a function of the wall clock's.

    Attributes:
        running: Whether time goes by.
        speed: Scene seconds for each second.
    """

    def __init__(self, time: float, *, running: bool, now: float) -> None:
        self.running = running
        self.speed = 1.0
        self._time, self._since = time, now

    def time(self, now: float) -> float:
        """The scene's seconds when the wall clock says ``now``."""
        passed = (now - self._since) * self.speed if self.running else 0.0
        return min(self._time + passed, max(self._time, LATEST_S))

    def run(self, running: bool, now: float) -> None:
        """Go on or stand still; the time stays what it is."""
        self.jump(self.time(now), now)
        self.running = running

    def jump(self, time: float, now: float) -> None:
        """Go on from another time."""
        self._time, self._since = time, now

    def change_speed(self, steps: int, now: float) -> None:
        """Go faster, or slower, by so many of the offered speeds; the time does not jump."""
        self.jump(self.time(now), now)
        position = SPEEDS.index(self.speed) + steps
        self.speed = SPEEDS[max(0, min(position, len(SPEEDS) - 1))]
