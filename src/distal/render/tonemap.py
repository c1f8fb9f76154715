"""Tone maps: from linear light to display values.

Input: linear light, an exposure, the number of a tone map. Output: sRGB values from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import clamp, func, log2, mat3, max, min, mix, vec3, vec4
from distal.lang.srgb import decode_srgb as decode_srgb
from distal.lang.srgb import encode_srgb as encode_srgb

NONE = 0
REINHARD = 1
ACES = 2
AGX = 3
NEUTRAL = 4
NAMES = ("none", "reinhard", "aces", "agx", "neutral")


@func
def reinhard(c: vec3) -> vec3:
    """Map each c to c / (1 + c) (Reinhard et al., "Photographic tone reproduction", 2002)."""
    return c / (1.0 + c)


@func
def aces(c: vec3) -> vec3:
    """The fitted film curve of ACES (Krzysztof Narkowicz, 2015), with exposure kept at 1."""
    x = c * 0.6
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0)


@func
def neutral(c: vec3) -> vec3:
    """Khronos PBR Neutral: keeps colors up to 0.8, then compresses them towards white."""
    start = 0.76
    desaturation = 0.15
    low = min(c.x, min(c.y, c.z))
    offset = low - 6.25 * low * low if low < 0.08 else 0.04
    shifted = c - offset
    peak = max(shifted.x, max(shifted.y, shifted.z))
    if peak < start:
        return shifted
    d = 1.0 - start
    new_peak = 1.0 - d * d / (peak + d - start)
    scaled = shifted * (new_peak / peak)
    g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0)
    return mix(scaled, vec3(new_peak), g)


@func
def agx_contrast(x: vec3) -> vec3:
    """AgX's default contrast as a polynomial (Benjamin Wrensch, "Minimal AgX", 2023)."""
    x2 = x * x
    x4 = x2 * x2
    high = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4
    return high - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232


@func
def agx(c: vec3) -> vec3:
    """AgX (Troy Sobotka), in linear light: bright colors fade to white without changing hue."""
    into = mat3(
        vec3(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        vec3(0.0784335999999992, 0.878468636469772, 0.0784336),
        vec3(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
    )
    back = mat3(
        vec3(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
        vec3(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
        vec3(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
    )
    low = -12.47393
    high = 4.026069
    seen = clamp(log2(max(into @ c, 1e-10)), low, high)
    return decode_srgb_power(back @ agx_contrast((seen - low) / (high - low)))


@func
def decode_srgb_power(c: vec3) -> vec3:
    """Invert AgX's own display curve, a plain power of 2.2."""
    return max(c, 0.0) ** 2.2


@func
def tone_mapped(c: vec3, tone_map: int) -> vec3:
    """Map linear light to 0 to 1 with one of ``NAMES``."""
    if tone_map == REINHARD:
        return reinhard(c)
    if tone_map == ACES:
        return aces(c)
    if tone_map == AGX:
        return agx(c)
    if tone_map == NEUTRAL:
        return neutral(c)
    return c


@func
def display(color: vec4, exposure: float, tone_map: int) -> vec4:
    """Convert linear light with straight alpha to display values."""
    return vec4(encode_srgb(tone_mapped(max(color.xyz, 0.0) * exposure, tone_map)), color.w)


@func
def display_by(color: vec4, exposure: float, curve: Callable[[vec3], vec3]) -> vec4:
    """Convert linear light with straight alpha to display values by an author's tone map."""
    return vec4(encode_srgb(curve(max(color.xyz, 0.0) * exposure)), color.w)
