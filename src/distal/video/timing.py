"""The times of the frames of a sequence.

Input: a start, a duration, a frame rate, as people write them. Output: exact counts and times.
Fractions are used everywhere, because 30000/1001 is not a decimal number.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from distal.ir.limits import LARGEST_TIME
from distal.video.formats import VideoError

# More frames are a mistake in units: three hours at 90 frames per second are fewer.
MOST_FRAMES: Final = 1_000_000
PIECE_S: Final = 2
# Longer numbers are a mistake, and as fractions could fill the memory, such as 1e999999999.
_MOST_DIGITS: Final = 40
# Broadcast rates in the short form that people write.
_BROADCAST: Final = {
    "23.976": Fraction(24000, 1001),
    "23.98": Fraction(24000, 1001),
    "29.97": Fraction(30000, 1001),
    "47.95": Fraction(48000, 1001),
    "59.94": Fraction(60000, 1001),
    "119.88": Fraction(120000, 1001),
}


@dataclass(frozen=True, slots=True)
class Timing:
    """The times of the frames.

    Attributes:
        start: Time of the first frame in seconds.
        duration: Seconds; for a loop its period, because the frame after the last would equal the
            first.
        rate: Frames per second.
    """

    start: Fraction
    duration: Fraction
    rate: Fraction

    @property
    def count(self) -> int:
        """The number of frames: the nearest to duration * rate, at least 1."""
        return max(1, math.floor(self.duration * self.rate + Fraction(1, 2)))

    def time(self, index: int) -> float:
        """Return the time of a frame in seconds."""
        return float(self.start + index / self.rate)

    @property
    def pieces(self) -> list[range]:
        """The frames of each segment of two seconds."""
        step = max(1, round(PIECE_S * self.rate))
        return [range(i, min(i + step, self.count)) for i in range(0, self.count, step)]


def timing(start: object, duration: object, rate: object) -> Timing:
    """Return the timing of a video, checked.

    Args:
        start: Time of the first frame in seconds.
        duration: Seconds.
        rate: Frames per second, as for ``frame_rate``.

    Raises:
        VideoError: A value is not a number, or is out of range.
    """
    made = Timing(_seconds("start", start), _seconds("duration", duration), frame_rate(rate))
    if made.duration <= 0:
        raise VideoError(f"a duration is more than 0 seconds, not {_plain(duration)}")
    first, last = made.time(0), made.time(made.count - 1)
    if max(abs(first), abs(last)) > LARGEST_TIME:
        raise VideoError(
            f"times are within {LARGEST_TIME:.0f} seconds (12 days) of 0, this goes from "
            f"{first:g} to {last:g}"
        )
    if made.count > MOST_FRAMES:
        raise VideoError(
            f"{made.count} frames are too many: {float(made.duration):g} s at "
            f"{float(made.rate):g} fps; a sequence has at most {MOST_FRAMES}"
        )
    return made


def frame_rate(rate: object) -> Fraction:
    """Return frames per second as a fraction: 30, "30000/1001", or 29.97 for the same.

    Raises:
        VideoError: It is not a number, or is out of range.
    """
    text = _plain(rate)
    if text in _BROADCAST:
        return _BROADCAST[text]
    found = _fraction(rate)
    if found is None:
        raise VideoError(f"a frame rate is a number like 30, 29.97 or 30000/1001, not {text:.40}")
    if found <= 0:
        raise VideoError(f"a frame rate is more than 0 a second, not {text:.40}")
    if found > 1000:
        raise VideoError(f"a frame rate is at most 1000 a second, not {text:.40}")
    if found < Fraction(1, 1000):
        raise VideoError(f"a frame rate is at least 0.001 a second, not {text:.40}")
    return found.limit_denominator(100_000)


def _seconds(name: str, value: object) -> Fraction:
    found = _fraction(value)
    if found is None:
        raise VideoError(f"a {name} is a number of seconds, not {_plain(value):.40}")
    if abs(found) > 10**9:
        raise VideoError(f"a {name} is at most 1e9 seconds, not {_plain(value):.40}")
    return found


def _fraction(value: object) -> Fraction | None:
    """Return a number exactly as it is written: 0.1 is a tenth; None if it is not a number."""
    if isinstance(value, Fraction):
        return value
    text = _plain(value)
    exponent = re.search(r"[eE]([+-]?\d+)$", text)
    if len(text) > _MOST_DIGITS or (exponent and abs(int(exponent[1])) > _MOST_DIGITS):
        return None
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None


def _plain(value: object) -> str:
    return str(value).strip()
