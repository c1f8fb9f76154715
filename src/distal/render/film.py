"""Samples in a pixel: their offsets, and their filtered mean.

Input: a pixel, a camera, and the light along a ray. Output: linear light and straight alpha.
"""

from __future__ import annotations

from collections.abc import Callable

from distal.lang import abs, func, max, min, select, sign, sqrt, vec2, vec4
from distal.render.camera import Ray


@func
def tent(u: float) -> float:
    """Map a uniform number from 0 to 1 to an offset from -1 to 1 with a tent distribution."""
    x = 2.0 * u - 1.0
    return sign(x) * (1.0 - sqrt(max(1.0 - abs(x), 0.0)))


@func
def sample_offset(index: int, count: int) -> vec2:
    """Return the offset of a sample from the middle of a pixel, in pixels.

    The first coordinate is stratified, the second follows the golden ratio, so that any count
    covers the square evenly (the R2-like rank-1 lattice). The offsets have the distribution of a
    tent filter that is two pixels wide. A single sample is in the middle.
    """
    if count <= 1:
        return vec2(0.0, 0.0)
    u = (float(index) + 0.5) / float(count)
    v = (float(index) * 0.6180339887 + 0.5) % 1.0
    return vec2(tent(u), tent(v))


@func
def exposed(
    coord: vec2,
    resolution: vec2,
    camera: Callable[[vec2], Ray],
    radiance: Callable[[Ray], vec4],
    samples: int,
    transparent: bool,
) -> vec4:
    """Return the linear light of a pixel: the mean of its samples.

    Alpha is straight: the color is the mean over the samples that have one. Alpha is 1 unless
    ``transparent``, except for rays that start inside a solid and do not leave it.
    """
    total = vec4(0.0)
    for i in range(max(samples, 1)):
        place = coord + sample_offset(i, samples)
        seen = radiance(camera((2.0 * place - resolution) / resolution.y))
        weight = max(seen.w, 0.0) if transparent else select(seen.w < 0.0, 0.0, 1.0)
        total += vec4(seen.xyz * weight, weight)
    mean = total.xyz / max(total.w, 1e-6)
    return vec4(mean, min(total.w / float(max(samples, 1)), 1.0))
