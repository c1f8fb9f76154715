"""The scene's time: it runs, pauses, jumps, and changes its speed.

Input: readings of a monotonic clock, in seconds. Output: the scene's time at each. Does not read a
clock itself.
"""

from __future__ import annotations

from distal.scene.viewing import interaction


class Clock:
    """The scene's time as a function of a monotonic clock.

    Attributes:
        running: Whether the time runs.
        speed: Scene seconds per second.
    """

    def __init__(self, time: float, *, running: bool, now: float) -> None:
        self.running = running
        self.speed = 1.0
        self._time, self._since = time, now

    def time(self, now: float) -> float:
        """Return the scene's time in seconds when the clock reads ``now``."""
        passed = (now - self._since) * self.speed if self.running else 0.0
        return interaction.advanced(self._time, passed, self._time, None)

    def run(self, running: bool, now: float) -> None:
        """Run or pause; the time does not change."""
        self.jump(self.time(now), now)
        self.running = running

    def jump(self, time: float, now: float) -> None:
        """Continue from another time.

        Args:
            time: The scene's time in seconds.
            now: The reading of the clock.
        """
        self._time, self._since = time, now

    def change_speed(self, steps: int, now: float) -> None:
        """Select a faster or slower speed, ``steps`` entries away; the time does not jump.

        Args:
            steps: Number of entries in the list of speeds.
            now: The reading of the clock.
        """
        self.jump(self.time(now), now)
        self.speed = interaction.speed_after(self.speed, steps)
