"""What gestures do to a camera, a time and a slider: the same in windows, pages and notebooks.

Input: movements in parts of the picture's height, notches of a wheel, steps, positions.
Output: numbers. ``tools/gen_player.py`` translates this module to TypeScript for the page's
player: it is written in the part of Python which that tool knows, and a test holds both together.
Knows no window and no page.
"""

from __future__ import annotations

import math
from typing import Final

from distal.ir.limits import LARGEST_TIME
from distal.lang.number_text import fixed, precise

# The camera

# A drag over the picture's height turns half around: the far side comes within one drag.
TURN_PER_HEIGHT: Final = math.pi
# At the poles "right" has no direction; so near them nothing is seen to be missing.
HIGHEST: Final = math.pi / 2.0 - 0.02
# Pan counts half heights.
PAN_PER_HEIGHT: Final = 2.0
FARTHEST_PAN: Final = 1000.0
NEAREST: Final = 0.015625
FARTHEST: Final = 64.0
ZOOM_PER_NOTCH: Final = 1.15
# A touch pad's burst may carry hundreds: one event does no more than this.
MOST_NOTCHES: Final = 10.0
# A wheel's notch is 100 pixels, or 3 lines, or a quarter of a page.
NOTCHES_PER_UNIT: Final = (0.01, 1.0 / 3.0, 4.0)
# A pinch on a touch pad arrives as a wheel with ctrl, in small steps.
NOTCHES_PER_PINCH: Final = 7.0
# An arrow key's turn or way, in picture heights.
ARROW: Final = 1.0 / 24.0


def clamped(value: float, low: float, high: float) -> float:
    """The nearest number within a range."""
    return min(max(value, low), high)


def whole(value: float) -> float:
    """The nearest whole number; halves go up."""
    return math.floor(value + 0.5)


def turned(yaw: float, right: float) -> float:
    """The yaw after a drag to the right: the scene follows the hand, the eye goes against it."""
    moved = yaw - TURN_PER_HEIGHT * right
    full = 2.0 * math.pi
    return moved - full * whole(moved / full)


def raised(pitch: float, down: float, elevation: float) -> float:
    """The pitch after a drag downward; with the camera's own elevation it stays off the poles.

    A camera that starts beyond them goes no further.
    """
    low = min(-HIGHEST - elevation, 0.0)
    high = max(HIGHEST - elevation, 0.0)
    return clamped(pitch + TURN_PER_HEIGHT * down, low, high)


def dragged(pan: float, way: float) -> float:
    """One of pan's numbers after a drag along its axis."""
    return clamped(pan + PAN_PER_HEIGHT * way, -FARTHEST_PAN, FARTHEST_PAN)


def zoomed(zoom: float, factor: float) -> float:
    """The zoom times a factor."""
    return clamped(zoom * factor, NEAREST, FARTHEST)


def notched(zoom: float, notches: float) -> float:
    """The zoom after so many notches of a wheel; farther where they are positive."""
    return zoomed(zoom, ZOOM_PER_NOTCH ** clamped(notches, -MOST_NOTCHES, MOST_NOTCHES))


def notches_of(delta: float, unit: int, is_pinch: bool) -> float:
    """The notches of a wheel event: its way in pixels (unit 0), lines (1) or pages (2)."""
    return delta * NOTCHES_PER_UNIT[unit] * (NOTCHES_PER_PINCH if is_pinch else 1.0)


# Time

LATEST_S: Final = LARGEST_TIME
FIRST_SPAN_S: Final = 10.0
STEP_S: Final = 0.25
FRAMES_PER_S: Final = 60.0
SPEEDS: Final = (0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def advanced(time: float, passed: float, start: float, duration: float | None) -> float:
    """The time after so many seconds: a loop begins anew, an endless time ends at last."""
    if duration is None:
        return min(time + passed, max(time, LATEST_S))
    past = time + passed - start
    return start + (past - duration * math.floor(past / duration))


def first_time(start: float, duration: float | None) -> float:
    """The earliest time that a hand reaches: 0, or where the time starts before it, or the loop."""
    return min(start, 0.0) if duration is None else start


def last_time(time: float, start: float, duration: float | None) -> float:
    """The right end of the time's strip: ten seconds, doubled until the time is on it."""
    if duration is not None:
        return start + duration
    low = first_time(start, duration)
    span = FIRST_SPAN_S
    while low + span < time:
        span = 2.0 * span
    return low + span


def jumped(time: float, start: float, duration: float | None) -> float:
    """The nearest time that a hand reaches."""
    high = LATEST_S if duration is None else start + duration
    return clamped(time, first_time(start, duration), high)


def index_at(time: float) -> float:
    """The frame's number: by time, so that a paused one can be made again."""
    return whole(time * FRAMES_PER_S)


def speed_after(speed: float, steps: int) -> float:
    """The speed so many of the offered ones up or down."""
    at = 0
    for i in range(len(SPEEDS)):
        if SPEEDS[i] <= speed:
            at = i
    return SPEEDS[int(clamped(at + steps, 0, len(SPEEDS) - 1))]


# Sliders

# About as many as a hand can tell apart, where a slider has no steps.
POSITIONS: Final = 200.0
# Of a point's coordinate.
POINT_STEP: Final = 0.05


def position_count(low: float, high: float, step: float | None) -> float:
    """The positions of a slider: it runs from 0 to this number."""
    # A step that does not divide the range leaves a last, shorter one, so that the end is reached.
    return POSITIONS if step is None else float(math.ceil((high - low) / step - 1e-6))


def position_of(value: float, low: float, high: float, step: float | None, log: bool) -> float:
    """Where a slider stands for a value."""
    count = position_count(low, high, step)
    inside = clamped(value, low, high)
    if inside == high:
        return count
    if log:
        return (math.log(inside / low) / math.log(high / low)) * count
    return (inside - low) / ((high - low) / count if step is None else step)


def value_at(
    position: float, low: float, high: float, step: float | None, log: bool, usual: float
) -> float:
    """The value for which a slider stands; the ends are the range's to the last bit.

    Where the slider has no steps, the position that is nearest to the default stands for it.
    """
    count = position_count(low, high, step)
    if position <= 0.0:
        return low
    if position >= count:
        return high
    if step is None and whole(position) == whole(position_of(usual, low, high, step, log)):
        return usual
    if log:
        exact = low * (high / low) ** (position / count)
        if step is None:
            return clamped(precise(exact, 3), low, high)
        return clamped(rounded(low + whole((exact - low) / step) * step, step), low, high)
    unit = (high - low) / count if step is None else step
    return clamped(rounded(low + whole(position) * unit, unit), low, high)


def rounded(value: float, unit: float) -> float:
    """A number without the digits far below ``unit``: 0.1 + 0.2 is 0.3."""
    return fixed(value, int(clamped(3.0 - math.floor(math.log10(unit)), 0.0, 20.0)))
