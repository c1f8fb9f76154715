"""Noise: smooth random functions of a point, equal on every target.

Input: a point of space or of the plane, and a seed that selects one of many such functions. Output:
a number in an exactly known range; each function states the bound on its gradient. Random numbers
are integer hashes of lattice cells. Does not depend on shapes: patterns call these functions
directly, and ``noise.solids`` makes shapes of them.

The stated ranges and slopes are the largest that any choice of lattice values can produce. The
slope of value noise follows from Poincaré's inequality on the cell's corners; the others are the
maxima, over a cell, of a sum of support functions of the gradients
(``tests/fields/test_tiers_noise.py`` computes them again).
"""

from __future__ import annotations

from typing import Final

from distal.fields.noise.lattice import (
    FROM_24_BITS,
    THIRD,
    corner_ramp,
    corner_value,
    faded,
    next_octave,
    simplex_part,
)
from distal.fields.noise.plane import (
    fbm_2,
    gradient_noise_2,
    simplex_noise_2,
    turbulence_2,
    value_noise_2,
)
from distal.lang import abs, floor, func, ivec3, max, mix, select, vec2, vec3

VALUE_SLOPE: Final = 3.75
GRADIENT_SLOPE: Final = 3.6185
SIMPLEX_SLOPE: Final = 6.967

# Scale factors to the range -1 to 1.
GRADIENT_SCALE: Final = 0.9649214
SIMPLEX_SCALE: Final = 76.8807


@func
def value_noise(p: vec3, seed: int = 0) -> float:
    """Value noise: random values at integer points, interpolated; -1 to 1, slope up to 3.75.

    Args:
        p: Point; one unit is one cell.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "Improving Noise" (2002), for the blend.
    """
    corner = floor(p)
    t = faded(p - corner)
    cell = ivec3(corner)
    bottom_near = mix(corner_value(cell, seed), corner_value(cell + ivec3(1, 0, 0), seed), t.x)
    top_near = mix(
        corner_value(cell + ivec3(0, 1, 0), seed), corner_value(cell + ivec3(1, 1, 0), seed), t.x
    )
    bottom_far = mix(
        corner_value(cell + ivec3(0, 0, 1), seed), corner_value(cell + ivec3(1, 0, 1), seed), t.x
    )
    top_far = mix(
        corner_value(cell + ivec3(0, 1, 1), seed), corner_value(cell + ivec3(1, 1, 1), seed), t.x
    )
    return mix(mix(bottom_near, top_near, t.y), mix(bottom_far, top_far, t.y), t.z)


@value_noise.overload
def value_noise_in_plane(p: vec2, seed: int = 0) -> float:
    """Return value noise in the plane."""
    return value_noise_2(p, seed)


@func
def gradient_noise(p: vec3, seed: int = 0) -> float:
    """Gradient noise (Perlin noise), 0 at integer points; -1 to 1, slope up to 3.6185.

    Args:
        p: Point; one unit is one cell.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "Improving Noise" (2002).
    """
    corner = floor(p)
    d = p - corner
    t = faded(d)
    cell = ivec3(corner)
    bottom_near = mix(
        corner_ramp(cell, ivec3(0, 0, 0), d, seed), corner_ramp(cell, ivec3(1, 0, 0), d, seed), t.x
    )
    top_near = mix(
        corner_ramp(cell, ivec3(0, 1, 0), d, seed), corner_ramp(cell, ivec3(1, 1, 0), d, seed), t.x
    )
    bottom_far = mix(
        corner_ramp(cell, ivec3(0, 0, 1), d, seed), corner_ramp(cell, ivec3(1, 0, 1), d, seed), t.x
    )
    top_far = mix(
        corner_ramp(cell, ivec3(0, 1, 1), d, seed), corner_ramp(cell, ivec3(1, 1, 1), d, seed), t.x
    )
    near = mix(bottom_near, top_near, t.y)
    return GRADIENT_SCALE * mix(near, mix(bottom_far, top_far, t.y), t.z)


@gradient_noise.overload
def gradient_noise_in_plane(p: vec2, seed: int = 0) -> float:
    """Return gradient noise in the plane."""
    return gradient_noise_2(p, seed)


@func
def simplex_noise(p: vec3, seed: int = 0) -> float:
    """Simplex noise: gradient noise on tetrahedra; from -1 to 1, slope up to 6.967.

    Args:
        p: Point.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "Noise Hardware" (2001), for the lattice; Stefan Gustavson, "Simplex noise
    demystified" (2005).
    """
    corner = floor(p + (p.x + p.y + p.z) * THIRD)
    cell = ivec3(corner)
    d = p - corner + (corner.x + corner.y + corner.z) * (0.5 * THIRD)
    # The path from the cell's lower to its upper corner starts along the largest component.
    x_first = d.x >= d.y
    y_first = d.y >= d.z
    x_before_z = d.x >= d.z
    one = ivec3(
        select(x_first and x_before_z, 1, 0),
        select(not x_first and y_first, 1, 0),
        select(not x_before_z and not y_first, 1, 0),
    )
    two = ivec3(
        select(x_first or x_before_z, 1, 0),
        select(not x_first or y_first, 1, 0),
        select(not (x_before_z and y_first), 1, 0),
    )
    total = simplex_part(cell, d, seed)
    total += simplex_part(cell + one, d - vec3(one) + 0.5 * THIRD, seed)
    total += simplex_part(cell + two, d - vec3(two) + THIRD, seed)
    total += simplex_part(cell + 1, d - 0.5, seed)
    return SIMPLEX_SCALE * total


@simplex_noise.overload
def simplex_noise_in_plane(p: vec2, seed: int = 0) -> float:
    """Return simplex noise in the plane."""
    return simplex_noise_2(p, seed)


@func
def fbm(
    p: vec3, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Fractal noise (fBm): octaves of gradient noise; -1 to 1, slope up to ``fbm_slope``.

    Args:
        p: Point; one unit is one cell of the coarsest octave.
        octaves: Number of scales.
        lacunarity: Ratio of the frequencies of consecutive octaves.
        gain: Ratio of the amplitudes of consecutive octaves.
        seed: Selects one of many noise functions.

    Source: Benoit Mandelbrot's fractional Brownian motion; F. Kenton Musgrave in "Texturing and
    Modeling" (1994).
    """
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * gradient_noise(p, seed + i)
        weights += weight
        weight *= gain
        p = next_octave(p * lacunarity)
    return total / max(weights, FROM_24_BITS)


@fbm.overload
def fbm_in_plane(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Return ``fbm`` in the plane."""
    return fbm_2(p, octaves, lacunarity, gain, seed)


@func
def fbm_slope(octaves: int, lacunarity: float, gain: float) -> float:
    """Return a bound on the gradient of ``fbm`` and ``turbulence``: the sum over all octaves."""
    total = 0.0
    weight = 1.0
    weights = 0.0
    scale = GRADIENT_SLOPE
    for _ in range(octaves):
        total += weight * scale
        weights += weight
        weight *= gain
        scale *= lacunarity
    return total / max(weights, FROM_24_BITS)


@func
def turbulence(
    p: vec3, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Turbulence: like ``fbm`` of the noise's absolute value; from 0 to 1, sharp valleys at 0.

    Args:
        p: Point; one unit is one cell of the coarsest octave.
        octaves: Number of scales.
        lacunarity: Ratio of the frequencies of consecutive octaves.
        gain: Ratio of the amplitudes of consecutive octaves.
        seed: Selects one of many noise functions.

    Source: Ken Perlin, "An Image Synthesizer" (1985).
    """
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * abs(gradient_noise(p, seed + i))
        weights += weight
        weight *= gain
        p = next_octave(p * lacunarity)
    return total / max(weights, FROM_24_BITS)


@turbulence.overload
def turbulence_in_plane(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Return ``turbulence`` in the plane."""
    return turbulence_2(p, octaves, lacunarity, gain, seed)
