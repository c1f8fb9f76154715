"""The scene's time: it runs, pauses, jumps, and goes faster or slower.

Input: readings of a steady wall clock, in seconds. Output: the scene's seconds at
each. Reads no clock itself.
"""

from __future__ import annotations

from distal.scene.viewing import interaction


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
        return interaction.advanced(self._time, passed, self._time, None)

    def run(self, running: bool, now: float) -> None:
        """Run or pause; the time itself does not change."""
        self.jump(self.time(now), now)
        self.running = running

    def jump(self, time: float, now: float) -> None:
        """Continue from another time."""
        self._time, self._since = time, now

    def change_speed(self, steps: int, now: float) -> None:
        """Go faster, or slower, by so many of the offered speeds; the time does not jump."""
        self.jump(self.time(now), now)
        self.speed = interaction.speed_after(self.speed, steps)
