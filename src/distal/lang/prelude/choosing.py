"""Selecting, clamping and blending values, component by component."""

from __future__ import annotations

from typing import TypeVar

from distal.ir.limits import SMALLEST
from distal.lang import (
    Floats,
    abs,
    clamp,
    func,
    ivec2,
    ivec3,
    ivec4,
    max,
    min,
    select,
    step,
    uint,
    uvec2,
    uvec3,
    uvec4,
    vec2,
    vec3,
    vec4,
)

Numbers = TypeVar(
    "Numbers",
    float,
    int,
    uint,
    vec2,
    vec3,
    vec4,
    ivec2,
    ivec3,
    ivec4,
    uvec2,
    uvec3,
    uvec4,
)

RADIANS_PER_DEGREE = 0.017453292519943295
DEGREES_PER_RADIAN = 57.29577951308232


@func
def smaller_int(a: int, b: int) -> int:
    """Return the smaller of two ints, for targets whose ``min`` takes floats only."""
    return select(b < a, b, a)


@func
def larger_int(a: int, b: int) -> int:
    """Return the larger of two ints, for targets whose ``max`` takes floats only."""
    return select(a < b, b, a)


@func
def magnitude_int(x: int) -> int:
    """Return the magnitude of an int, for targets whose ``abs`` takes floats only."""
    return select(x < 0, -x, x)


@func
def sign_int(x: int) -> int:
    """Return -1, 0 or 1, for targets whose ``sign`` takes floats only."""
    return select(x < 0, -1, select(x > 0, 1, 0))


@func
def clamped(x: Numbers, low: Numbers, high: Numbers) -> Numbers:
    """Clamp ``x`` to ``low`` and ``high``; return ``high`` if ``low`` is above it."""
    return min(max(x, low), high)


@func
def mixed(a: Floats, b: Floats, t: Floats) -> Floats:
    """Interpolate linearly from ``a`` (``t`` = 0) to ``b`` (``t`` = 1)."""
    return a + (b - a) * t


@func
def stepped(edge: float, x: float) -> float:
    """Return 0 below ``edge``, else 1."""
    return select(x < edge, 0.0, 1.0)


@func
def smoothstepped(low: Floats, high: Floats, x: Floats) -> Floats:
    """Return Hermite's cubic from 0 at ``low`` to 1 at ``high``, with slope 0 at both ends.

    It is a step function if ``low`` equals ``high``, and falls from 1 to 0 if ``low`` is above.
    """
    extent = high - low
    is_step = abs(extent) < SMALLEST
    ramp = clamp((x - low) / select(is_step, 1.0, extent), 0.0, 1.0)
    t = select(is_step, step(low, x), ramp)
    return t * t * (3.0 - 2.0 * t)


@func
def to_radians(x: Floats) -> Floats:
    """Convert degrees to radians."""
    return x * RADIANS_PER_DEGREE


@func
def to_degrees(x: Floats) -> Floats:
    """Convert radians to degrees."""
    return x * DEGREES_PER_RADIAN
