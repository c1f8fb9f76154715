"""The effect of gestures on a camera, a time and a slider, for windows, pages and notebooks.

Input: movements as fractions of the picture's height, notches of a wheel, steps, positions. Output:
numbers. ``tools/gen_player.py`` translates this module to TypeScript for the page's player, so it
is written in the subset of Python that this tool supports; a test compares the results. Does not
depend on windows or pages.
"""

from __future__ import annotations

import math
from typing import Final

from distal.ir.limits import LARGEST_TIME
from distal.lang.number_text import fixed, precise

# The camera

# A drag over the picture's height rotates by half a turn, so one drag shows the far side.
TURN_PER_HEIGHT: Final = math.pi
# Limit of the elevation: at the poles the direction "right" is undefined.
HIGHEST: Final = math.pi / 2.0 - 0.02
# The unit of pan is half the picture's height.
PAN_PER_HEIGHT: Final = 2.0
FARTHEST_PAN: Final = 1000.0
NEAREST: Final = 0.015625
FARTHEST: Final = 64.0
ZOOM_PER_NOTCH: Final = 1.15
# Limit for one event: a touch pad may send hundreds of notches at once.
MOST_NOTCHES: Final = 10.0
# A wheel's notch is 100 pixels, or 3 lines, or a quarter of a page.
NOTCHES_PER_UNIT: Final = (0.01, 1.0 / 3.0, 4.0)
# Browsers send a pinch on a touch pad as wheel events with ctrl, in small steps.
NOTCHES_PER_PINCH: Final = 7.0
# Movement by an arrow key, in picture heights.
ARROW: Final = 1.0 / 24.0


def clamped(value: float, low: float, high: float) -> float:
    """Return the nearest number within a range."""
    return min(max(value, low), high)


def whole(value: float) -> float:
    """Return the nearest whole number; halves are rounded up."""
    return math.floor(value + 0.5)


def turned(yaw: float, right: float) -> float:
    """Return the yaw after a drag to the right: the eye moves in the opposite direction."""
    moved = yaw - TURN_PER_HEIGHT * right
    full = 2.0 * math.pi
    return moved - full * whole(moved / full)


def raised(pitch: float, down: float, elevation: float) -> float:
    """Return the pitch after a drag downwards.

    The camera's elevation plus the pitch is kept away from the poles. A camera that starts beyond
    the limit moves no further.

    Args:
        pitch: Pitch before the drag, in radians.
        down: Length of the drag, in picture heights.
        elevation: The camera's own elevation, in radians.
    """
    low = min(-HIGHEST - elevation, 0.0)
    high = max(HIGHEST - elevation, 0.0)
    return clamped(pitch + TURN_PER_HEIGHT * down, low, high)


def dragged(pan: float, way: float) -> float:
    """Return one component of pan after a drag along its axis."""
    return clamped(pan + PAN_PER_HEIGHT * way, -FARTHEST_PAN, FARTHEST_PAN)


def zoomed(zoom: float, factor: float) -> float:
    """Return the zoom multiplied by a factor."""
    return clamped(zoom * factor, NEAREST, FARTHEST)


def notched(zoom: float, notches: float) -> float:
    """Return the zoom after a number of wheel notches; a positive number moves the camera away."""
    return zoomed(zoom, ZOOM_PER_NOTCH ** clamped(notches, -MOST_NOTCHES, MOST_NOTCHES))


def notches_of(delta: float, unit: int, is_pinch: bool) -> float:
    """Return the notches of a wheel event whose unit is pixels (0), lines (1) or pages (2).

    Args:
        delta: Movement of the wheel, in the event's unit.
        unit: Unit of the event, as in browsers: 0, 1 or 2.
        is_pinch: Whether the event is a pinch on a touch pad.
    """
    return delta * NOTCHES_PER_UNIT[unit] * (NOTCHES_PER_PINCH if is_pinch else 1.0)


# Time

LATEST_S: Final = LARGEST_TIME
FIRST_SPAN_S: Final = 10.0
STEP_S: Final = 0.25
FRAMES_PER_S: Final = 60.0
SPEEDS: Final = (0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def advanced(time: float, passed: float, start: float, duration: float | None) -> float:
    """Return the time after ``passed`` seconds.

    A loop restarts at its end; a time without a duration stops at ``LATEST_S``.

    Args:
        time: Time before, in seconds.
        passed: Seconds that have passed.
        start: Start of the time, in seconds.
        duration: Length of the loop in seconds, or None.
    """
    if duration is None:
        return min(time + passed, max(time, LATEST_S))
    past = time + passed - start
    return start + (past - duration * math.floor(past / duration))


def first_time(start: float, duration: float | None) -> float:
    """Return the earliest time that a person can choose: the smaller of 0 and ``start``.

    In a loop it is ``start``.
    """
    return min(start, 0.0) if duration is None else start


def last_time(time: float, start: float, duration: float | None) -> float:
    """Return the right end of the timeline: ten seconds, doubled until the time is within it.

    Args:
        time: Current time, in seconds.
        start: Start of the time, in seconds.
        duration: Length of the loop in seconds, or None.
    """
    if duration is not None:
        return start + duration
    low = first_time(start, duration)
    span = FIRST_SPAN_S
    while low + span < time:
        span = 2.0 * span
    return low + span


def jumped(time: float, start: float, duration: float | None) -> float:
    """Return the nearest time that a person can choose.

    Args:
        time: Requested time, in seconds.
        start: Start of the time, in seconds.
        duration: Length of the loop in seconds, or None.
    """
    high = LATEST_S if duration is None else start + duration
    return clamped(time, first_time(start, duration), high)


def index_at(time: float) -> float:
    """Return the frame number of a time, so that a paused frame can be reproduced."""
    return whole(time * FRAMES_PER_S)


def speed_after(speed: float, steps: int) -> float:
    """Return the speed some steps up or down in the list of speeds."""
    at = 0
    for i in range(len(SPEEDS)):
        if SPEEDS[i] <= speed:
            at = i
    return SPEEDS[int(clamped(at + steps, 0, len(SPEEDS) - 1))]


# Sliders

# Number of positions of a slider without steps; about as many as a person can distinguish.
POSITIONS: Final = 200.0
# Step of a point's coordinate.
POINT_STEP: Final = 0.05


def position_count(low: float, high: float, step: float | None) -> float:
    """Return the number of the last position of a slider, which starts at 0.

    Args:
        low: Start of the range.
        high: End of the range.
        step: The slider's step, or None.
    """
    # If the step does not divide the range, the last step is shorter and ends at the limit.
    return POSITIONS if step is None else float(math.ceil((high - low) / step - 1e-6))


def position_of(value: float, low: float, high: float, step: float | None, log: bool) -> float:
    """Return the position of a slider for a value.

    Args:
        value: The value.
        low: Start of the range.
        high: End of the range.
        step: The slider's step, or None.
        log: Whether the slider is logarithmic.
    """
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
    """Return the value at a position of a slider; the ends are exactly those of the range.

    If the slider has no steps, the position nearest to the default stands for the default.

    Args:
        position: The position, from 0.
        low: Start of the range.
        high: End of the range.
        step: The slider's step, or None.
        log: Whether the slider is logarithmic.
        usual: The default.
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
    """Round away the digits far below ``unit``: 0.1 + 0.2 becomes 0.3."""
    return fixed(value, int(clamped(3.0 - math.floor(math.log10(unit)), 0.0, 20.0)))
