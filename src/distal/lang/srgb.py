"""sRGB's curve (IEC 61966-2-1): the one definition, scene code and plain Python at once.

Input: linear light, or values encoded for display. Output: the other of the two.
Pictures, parameters' colors, shaders and the page's player (through ``tools/gen_player.py``) take
the curve from here. Needs the standard library only.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache

from distal.lang import func, max, select, vec3

_HEX = re.compile(r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})")


@func
def encode_srgb(c: vec3) -> vec3:
    """Linear light to sRGB's curve; nothing is darker than 0."""
    x = max(c, 0.0)
    return select(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)


@func
def decode_srgb(c: vec3) -> vec3:
    """From sRGB's curve to linear light; the straight part goes on below 0."""
    curved = ((max(c, 0.0) + 0.055) / 1.055) ** 2.4
    return select(c > 0.04045, curved, c / 12.92)


def linear_of(text: str) -> tuple[float, ...] | None:
    """Linear red, green, blue of "#rrggbb" or "#rgb"; None for any other text."""
    if not _HEX.fullmatch(text):
        return None
    digits = text[1:] if len(text) == 7 else "".join(2 * c for c in text[1:])
    return tuple(light_of(int(digits[i : i + 2], 16)) for i in (0, 2, 4))


def hex_of(linear: Iterable[float]) -> str:
    """Linear red, green, blue as the nearest "#rrggbb"."""
    return "#" + "".join(f"{code_of(light):02x}" for light in linear)


@cache
def light_of(code: int) -> float:
    """What one of 256 codes shows. The curve is the same for each channel: a float will do."""
    return float(decode_srgb.python_function(code / 255.0))


def code_of(light: float) -> int:
    """The code that shows light best, from 0 to 255."""
    encoded = float(encode_srgb.python_function(light))
    return int(min(255.0 * encoded, 255.0) + 0.5)
