"""The range of a view's values: measured by a small probe, or estimated from the scene's box.

Input: values, and three numbers that a host sets: a low, a middle and a high value. Output: shares
from 0 to 1, and values packed into colors, from which the host computes the three numbers
(``scene/view_ranges.py``).
"""

from __future__ import annotations

from collections.abc import Callable

from distal.fields.guarantees import Bounds
from distal.lang import (
    abs,
    clamp,
    floor,
    func,
    length,
    log2,
    max,
    min,
    select,
    sign,
    sqrt,
    struct,
    vec2,
    vec3,
    vec4,
)
from distal.render.camera import Ray

# The curve of a range: its middle value is shown at this share, within these exponents.
STEEPEST = 5.0
# Packed numbers: sign(v) log2(1 + |v| SMALLEST) / OCTAVES in 24 bits.
SMALLEST = 65536.0
OCTAVES = 48.0
HALF_CODES = 8388607.0


@struct
class Range:
    """Which values a view shows; ``low`` above ``high`` asks for packed values (``packed``).

    Attributes:
        low: Shown at one end of the scale.
        middle: Shown in the middle of the scale.
        high: Shown at the other end.
    """

    low: float
    middle: float
    high: float


@func
def is_packed(shown: Range) -> bool:
    """Return whether the host asks for packed values."""
    return shown.low > shown.high


@func
def packed(value: float, found: bool) -> vec4:
    """Return a value as three bytes of a color; 0, 0, 0 if there is none."""
    most = clamp(value, -1e9, 1e9)
    part = sign(most) * log2(1.0 + abs(most) * SMALLEST) / OCTAVES
    code = floor(8388608.0 + part * HALF_CODES + 0.5)
    high = floor(code / 65536.0)
    rest = code - 65536.0 * high
    middle = floor(rest / 256.0)
    color = vec3(high, middle, rest - 256.0 * middle) / 255.0
    return vec4(select(found, color, vec3(0.0)), 1.0)


@func
def exponent(shown: Range) -> float:
    """Return the exponent of the scale's curve, which puts ``middle`` in its middle."""
    part = (shown.middle - shown.low) / max(shown.high - shown.low, 1e-20)
    return clamp(-1.0 / log2(clamp(part, 1e-6, 0.999999)), 1.0 / STEEPEST, STEEPEST)


@func
def share_of(value: float, shown: Range) -> float:
    """Return the place of a value on the scale: 0 at ``low``, 1 at ``high``."""
    part = (value - shown.low) / max(shown.high - shown.low, 1e-20)
    share: float = clamp(part, 0.0, 1.0) ** exponent(shown)
    return share


@func
def value_at(share: float, shown: Range) -> float:
    """Return the value at a place of the scale."""
    part: float = share ** (1.0 / exponent(shown))
    return shown.low + (shown.high - shown.low) * part


@func
def range_of_host(view_low: float, view_middle: float, view_high: float) -> Range:
    """Return the host's range; it is empty without a host."""
    return Range(view_low, view_middle, view_high)


@func
def range_of_scene(
    view_low: float,
    view_middle: float,
    view_high: float,
    camera: Callable[[vec2], Ray],
    bounds: Bounds,
    near: float,
    far: float,
) -> Range:
    """Return the range of distances along rays: the host's, or one from the scene's box.

    Args:
        view_low: The host's low value; without a host it equals ``view_high``.
        view_middle: The host's middle value.
        view_high: The host's high value.
        camera: Ray of a place in the picture.
        bounds: Box around the surface.
        near: Distance along the ray where rays begin.
        far: Distance along the ray where rays end.
    """
    if view_low != view_high:
        return Range(view_low, view_middle, view_high)
    eye = camera(vec2(0.0)).origin
    first = length(max(max(bounds.low - eye, eye - bounds.high), 0.0))
    last = length(max(abs(bounds.low - eye), abs(bounds.high - eye)))
    low = clamp(first, near, far)
    high = clamp(last, low + 1e-6, far)
    # A box without end: the distances that matter are near, in ratios.
    middle = select(high > 100.0 * max(low, 0.01), sqrt(max(low, 1.0) * high), 0.5 * (low + high))
    return Range(low, min(middle, high), high)
