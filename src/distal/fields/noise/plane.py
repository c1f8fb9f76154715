"""Noise in the plane; ``space`` exports it under the names of noise in space.

Input: a point of the plane and a seed. Output: a number in an exactly known range, and the bound on
its gradient.
"""

from __future__ import annotations

from typing import Final

from distal.fields.noise.lattice import (
    FROM_24_BITS,
    corner_ramp_2,
    corner_value_2,
    faded_2,
    next_octave_2,
    simplex_part_2,
)
from distal.lang import abs, floor, func, ivec2, max, mix, select, vec2

VALUE_SLOPE_2: Final = 3.75
GRADIENT_SLOPE_2: Final = 3.1282
SIMPLEX_SLOPE_2: Final = 7.3541

# Scale factors to the range -1 to 1.
GRADIENT_SCALE_2: Final = 1.5132794
SIMPLEX_SCALE_2: Final = 100.0401
SIMPLEX_UNSKEW_2: Final = 0.21132486540518713  # (3 - sqrt(3)) / 6
SIMPLEX_SKEW_2: Final = 0.36602540378443865  # (sqrt(3) - 1) / 2


@func
def value_noise_2(p: vec2, seed: int = 0) -> float:
    """Return value noise in the plane: from -1 to 1, slope up to 3.75."""
    corner = floor(p)
    t = faded_2(p - corner)
    cell = ivec2(corner)
    bottom = mix(corner_value_2(cell, seed), corner_value_2(cell + ivec2(1, 0), seed), t.x)
    top = mix(
        corner_value_2(cell + ivec2(0, 1), seed), corner_value_2(cell + ivec2(1, 1), seed), t.x
    )
    return mix(bottom, top, t.y)


@func
def gradient_noise_2(p: vec2, seed: int = 0) -> float:
    """Return gradient noise in the plane: from -1 to 1, slope up to 3.1282."""
    corner = floor(p)
    d = p - corner
    t = faded_2(d)
    cell = ivec2(corner)
    bottom = mix(
        corner_ramp_2(cell, ivec2(0, 0), d, seed), corner_ramp_2(cell, ivec2(1, 0), d, seed), t.x
    )
    top = mix(
        corner_ramp_2(cell, ivec2(0, 1), d, seed), corner_ramp_2(cell, ivec2(1, 1), d, seed), t.x
    )
    return GRADIENT_SCALE_2 * mix(bottom, top, t.y)


@func
def simplex_noise_2(p: vec2, seed: int = 0) -> float:
    """Return simplex noise in the plane (on triangles): from -1 to 1, slope up to 7.3541."""
    corner = floor(p + (p.x + p.y) * SIMPLEX_SKEW_2)
    cell = ivec2(corner)
    d = p - corner + (corner.x + corner.y) * SIMPLEX_UNSKEW_2
    right = select(d.x >= d.y, 1, 0)
    one = ivec2(right, 1 - right)
    total = simplex_part_2(cell, d, seed)
    total += simplex_part_2(cell + one, d - vec2(one) + SIMPLEX_UNSKEW_2, seed)
    total += simplex_part_2(cell + 1, d - (1.0 - 2.0 * SIMPLEX_UNSKEW_2), seed)
    return SIMPLEX_SCALE_2 * total


@func
def fbm_2(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Return ``fbm`` in the plane."""
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * gradient_noise_2(p, seed + i)
        weights += weight
        weight *= gain
        p = next_octave_2(p * lacunarity)
    return total / max(weights, FROM_24_BITS)


@func
def turbulence_2(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Return ``turbulence`` in the plane."""
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * abs(gradient_noise_2(p, seed + i))
        weights += weight
        weight *= gain
        p = next_octave_2(p * lacunarity)
    return total / max(weights, FROM_24_BITS)
