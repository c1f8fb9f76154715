"""Noise as infinite shapes: the inside is where the noise is above a level.

Input: a point, the size of the noise's cells, a level. Output: the value of the noise divided by
its typical gradient, which is about the distance near the surface (so offsets and shells have about
their nominal size), and the bound on its slope.

The typical gradients are means over surfaces of level 0 (measured at 200,000 points).
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import NOTHING, Limit, primitive
from distal.fields.noise.lattice import FROM_24_BITS
from distal.fields.noise.space import (
    GRADIENT_SLOPE,
    SIMPLEX_SLOPE,
    VALUE_SLOPE,
    fbm,
    fbm_slope,
    gradient_noise,
    simplex_noise,
    value_noise,
)
from distal.lang import func, max, sqrt, vec3

VALUE_TYPICAL: Final = 1.25
GRADIENT_TYPICAL: Final = 1.13
SIMPLEX_TYPICAL: Final = 2.45

# Above half of the range, almost nothing of the noise is solid; of fractal noise even earlier.
HIGHEST_LEVEL: Final = 0.5
HIGHEST_FBM_LEVEL: Final = 0.25


def _level_is_met(level: float) -> str | None:
    if not -HIGHEST_LEVEL <= level <= HIGHEST_LEVEL:
        return f"level must lie between {-HIGHEST_LEVEL} and {HIGHEST_LEVEL}"
    return None


def _octaves_are_met(level: float, octaves: int) -> str | None:
    if not -HIGHEST_FBM_LEVEL <= level <= HIGHEST_FBM_LEVEL:
        return f"level must lie between {-HIGHEST_FBM_LEVEL} and {HIGHEST_FBM_LEVEL}"
    return "octaves must be 1 or more" if octaves < 1 else None


@primitive(
    "ValueNoiseSolid", NOTHING, slope=VALUE_SLOPE / VALUE_TYPICAL, requires=_level_is_met, tier=2
)
@func
def value_noise_solid(p: vec3, cell_size: float = 0.5, level: float = 0.0, seed: int = 0) -> float:
    """Infinite lumps of value noise, aligned with the axes.

    Args:
        p: Point.
        cell_size: Size of the noise's cells.
        level: The noise above this level is solid; from -0.5 to 0.5.
        seed: Selects one of many noise functions.

    Source: ``value_noise`` of the field library.

    Measured:
        value_noise_solid((1.5, 0.5, 2.0), 0.5, 0.25, 3) = -0.1147923
        value_noise_solid((0.0, 0.0, 0.0), 1.0, 0.0, 0) = 0.0008373
        value_noise_solid((2.0, -4.0, 6.0), 2.0, 0.0, 7) = 1.2454653
    """
    return (level - value_noise(p / cell_size, seed)) * cell_size / VALUE_TYPICAL


@primitive(
    "GradientNoiseSolid",
    NOTHING,
    slope=GRADIENT_SLOPE / GRADIENT_TYPICAL,
    requires=_level_is_met,
    tier=2,
)
@func
def gradient_noise_solid(
    p: vec3, cell_size: float = 0.5, level: float = 0.0, seed: int = 0
) -> float:
    """Infinite lumps of gradient noise (Perlin noise).

    Args:
        p: Point.
        cell_size: Size of the noise's cells.
        level: The noise above this level is solid; from -0.5 to 0.5.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "Improving Noise" (2002).

    Measured:
        gradient_noise_solid((1.5, 0.5, 2.0), 0.5, 0.226, 3) = 0.1
        gradient_noise_solid((4.0, -6.0, 2.0), 2.0, -0.113, 0) = -0.2
        gradient_noise_solid((0.0, 0.0, 0.0), 1.0, 0.0, 5) = 0.0
    """
    return (level - gradient_noise(p / cell_size, seed)) * cell_size / GRADIENT_TYPICAL


@primitive(
    "SimplexNoiseSolid",
    NOTHING,
    slope=SIMPLEX_SLOPE / SIMPLEX_TYPICAL,
    requires=_level_is_met,
    tier=2,
)
@func
def simplex_noise_solid(
    p: vec3, cell_size: float = 0.5, level: float = 0.0, seed: int = 0
) -> float:
    """Infinite lumps of simplex noise, rounder and smaller than those of gradient noise.

    Args:
        p: Point.
        cell_size: Size of the noise's cells.
        level: The noise above this level is solid; from -0.5 to 0.5.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "Noise Hardware" (2001).

    Measured:
        simplex_noise_solid((0.0, 0.0, 0.0), 0.5, 0.245, 3) = 0.05
        simplex_noise_solid((1.0, 1.0, 1.0), 2.0, -0.245, 0) = -0.2
        simplex_noise_solid((0.0, 0.0, 0.0), 1.0, 0.0, 5) = 0.0
    """
    return (level - simplex_noise(p / cell_size, seed)) * cell_size / SIMPLEX_TYPICAL


@func
def fbm_typical(octaves: int, lacunarity: float, gain: float) -> float:
    """Return the typical gradient of fractal noise, with octaves independent of each other."""
    total = 0.0
    weights = 0.0
    weight = 1.0
    scale = GRADIENT_TYPICAL
    for _ in range(octaves):
        total += (weight * scale) ** 2
        weights += weight
        weight *= gain
        scale *= lacunarity
    return max(sqrt(total), FROM_24_BITS) / max(weights, FROM_24_BITS)


@func
def fbm_solid_slope(octaves: int, lacunarity: float, gain: float) -> float:
    """Return the largest gradient of all octaves together, divided by the typical one."""
    return fbm_slope(octaves, lacunarity, gain) / fbm_typical(octaves, lacunarity, gain)


@primitive(
    "FbmSolid",
    NOTHING,
    slope=fbm_solid_slope,
    limits={"lacunarity": Limit.POSITIVE, "gain": Limit.POSITIVE},
    requires=_octaves_are_met,
    tier=2,
)
@func
def fbm_solid(
    p: vec3,
    cell_size: float = 1.0,
    level: float = 0.0,
    octaves: int = 4,
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
) -> float:
    """Infinite rugged lumps of fractal noise (fBm): noise at several scales.

    Args:
        p: Point.
        cell_size: Size of the cells of the coarsest octave.
        level: The noise above this level is solid; from -0.25 to 0.25.
        octaves: Number of scales.
        lacunarity: Ratio of the frequencies of consecutive octaves.
        gain: Ratio of the amplitudes of consecutive octaves.
        seed: Selects one of many noise functions.

    Source: F. Kenton Musgrave in "Texturing and Modeling" (1994).

    Measured:
        fbm_solid((1.5, 0.5, 2.0), 0.5, 0.226, 1, 2.0, 0.5, 3) = 0.1
        fbm_solid((4.0, -6.0, 2.0), 2.0, -0.113, 1) = -0.2
        fbm_solid((0.0, 0.0, 0.0), 1.0, 0.0, 1, 3.0, 0.25, 5) = 0.0
    """
    height = level - fbm(p / cell_size, octaves, lacunarity, gain, seed)
    return height * cell_size / fbm_typical(octaves, lacunarity, gain)
