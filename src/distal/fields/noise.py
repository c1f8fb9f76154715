"""Noise: smooth random functions of a place, the same on every target.

What flows in: a point of space or of the plane, and a seed that picks one of many such functions.
What flows out: a number in an exactly known range, and beside each function the bound on its
gradient. Random numbers are integer hashes of lattice cells. Knows no shapes: patterns call these
as they are, ``noise_solids`` makes shapes of them.

The named ranges and slopes are the largest that any choice of lattice values can give. That of
value noise follows from Poincaré's inequality on the cell's corners; the others are the maxima,
over a cell, of a sum of support functions of the gradients (``tests/fields/test_tiers_noise.py``
finds them again).
"""

from __future__ import annotations

from typing import Final

from distal.lang import (
    abs,
    dot,
    floor,
    func,
    ivec2,
    ivec3,
    mat2,
    mat3,
    max,
    mix,
    pcg,
    select,
    uint,
    vec2,
    vec3,
)

# Lattices of neighbouring seeds lie this far apart: 2^32 over the golden ratio.
SEED_STEP: Final = 2654435769
FROM_24_BITS: Final = 5.9604644775390625e-08

VALUE_SLOPE: Final = 3.75
GRADIENT_SLOPE: Final = 3.6185
GRADIENT_SLOPE_2: Final = 3.1282
SIMPLEX_SLOPE: Final = 6.967
SIMPLEX_SLOPE_2: Final = 7.3541

# What makes the ranges -1 to 1.
GRADIENT_SCALE: Final = 0.9649214
GRADIENT_SCALE_2: Final = 1.5132794
SIMPLEX_SCALE: Final = 76.8807
SIMPLEX_SCALE_2: Final = 100.0401
# Where the kernels of a simplex's corners end: half the square of the lattice's smallest distance.
SIMPLEX_REACH: Final = 0.5
SIMPLEX_UNSKEW_2: Final = 0.21132486540518713  # (3 - sqrt(3)) / 6
SIMPLEX_SKEW_2: Final = 0.36602540378443865  # (sqrt(3) - 1) / 2

# A direction between an axis and a diagonal, so that none of the eight favours either.
COSINE: Final = 0.9238795325112867
SINE: Final = 0.3826834323650898

# Octaves turn by a sixth around the space's diagonal, and move, so that no lattices coincide.
THIRD: Final = 1.0 / 3.0


@func
def lattice_hash(cell: ivec3, seed: int) -> uint:
    """32 random bits of a cell of space."""
    plane = pcg(uint(cell.z) + uint(seed) * uint(SEED_STEP))
    return pcg(uint(cell.x) + pcg(uint(cell.y) + plane))


@lattice_hash.overload
def lattice_hash_2(cell: ivec2, seed: int) -> uint:
    """32 random bits of a cell of the plane."""
    return pcg(uint(cell.x) + pcg(uint(cell.y) + uint(seed) * uint(SEED_STEP)))


@func
def fraction(bits: uint) -> float:
    """From 0 up to 1, by the upper 24 of 32 bits."""
    return float(bits >> uint(8)) * FROM_24_BITS


@func
def faded(x: vec3) -> vec3:
    """Perlin's quintic from 0 to 1, level and without curvature at both ends."""
    return x * x * x * (x * (x * 6.0 - 15.0) + 10.0)


@faded.overload
def faded_2(x: vec2) -> vec2:
    """In the plane."""
    return x * x * x * (x * (x * 6.0 - 15.0) + 10.0)


@func
def corner_value(cell: ivec3, seed: int) -> float:
    """A random number from -1 to 1."""
    return 2.0 * fraction(lattice_hash(cell, seed)) - 1.0


@corner_value.overload
def corner_value_2(cell: ivec2, seed: int) -> float:
    """In the plane."""
    return 2.0 * fraction(lattice_hash(cell, seed)) - 1.0


@func
def value_noise(p: vec3, seed: int = 0) -> float:
    """Random values at whole coordinates, blended between: from -1 to 1, slope up to 3.75.

    Args:
        p: Point; one unit is one cell.
        seed: Which of many.

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
def value_noise_2(p: vec2, seed: int = 0) -> float:
    """In the plane: from -1 to 1, slope up to 3.75."""
    corner = floor(p)
    t = faded(p - corner)
    cell = ivec2(corner)
    bottom = mix(corner_value(cell, seed), corner_value(cell + ivec2(1, 0), seed), t.x)
    top = mix(corner_value(cell + ivec2(0, 1), seed), corner_value(cell + ivec2(1, 1), seed), t.x)
    return mix(bottom, top, t.y)


@func
def ramp(bits: uint, d: vec3) -> float:
    """How far ``d`` reaches along one of the 12 directions to the middles of a cube's edges."""
    left_out = ((bits >> uint(16)) * uint(3)) >> uint(16)
    a = select(left_out == uint(0), d.y, d.x)
    b = select(left_out == uint(2), d.y, d.z)
    a = select((bits & uint(256)) == uint(0), a, -a)
    return a + select((bits & uint(512)) == uint(0), b, -b)


@ramp.overload
def ramp_2(bits: uint, d: vec2) -> float:
    """How far ``d`` reaches along one of eight unit directions."""
    steep = (bits & uint(65536)) == uint(0)
    a = COSINE * select(steep, d.y, d.x)
    b = SINE * select(steep, d.x, d.y)
    a = select((bits & uint(131072)) == uint(0), a, -a)
    return a + select((bits & uint(262144)) == uint(0), b, -b)


@func
def corner_ramp(cell: ivec3, offset: ivec3, inside: vec3, seed: int) -> float:
    """The plane through 0 at one of a cell's corners."""
    return ramp(lattice_hash(cell + offset, seed), inside - vec3(offset))


@corner_ramp.overload
def corner_ramp_2(cell: ivec2, offset: ivec2, inside: vec2, seed: int) -> float:
    """In the plane."""
    return ramp(lattice_hash(cell + offset, seed), inside - vec2(offset))


@func
def gradient_noise(p: vec3, seed: int = 0) -> float:
    """Random slopes at whole coordinates, where it is 0: from -1 to 1, slope up to 3.6185.

    Args:
        p: Point; one unit is one cell.
        seed: Which of many.

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
def gradient_noise_2(p: vec2, seed: int = 0) -> float:
    """In the plane: from -1 to 1, slope up to 3.1282."""
    corner = floor(p)
    d = p - corner
    t = faded(d)
    cell = ivec2(corner)
    bottom = mix(
        corner_ramp(cell, ivec2(0, 0), d, seed), corner_ramp(cell, ivec2(1, 0), d, seed), t.x
    )
    top = mix(corner_ramp(cell, ivec2(0, 1), d, seed), corner_ramp(cell, ivec2(1, 1), d, seed), t.x)
    return GRADIENT_SCALE_2 * mix(bottom, top, t.y)


@func
def simplex_part(cell: ivec3, d: vec3, seed: int) -> float:
    """What one corner of a simplex adds at ``d`` from it."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp(lattice_hash(cell, seed), d)


@simplex_part.overload
def simplex_part_2(cell: ivec2, d: vec2, seed: int) -> float:
    """In the plane."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp(lattice_hash(cell, seed), d)


@func
def simplex_noise(p: vec3, seed: int = 0) -> float:
    """Gradient noise on tetrahedra, four corners instead of eight: from -1 to 1, slope up to 6.967.

    Args:
        p: Point.
        seed: Which of many.

    Source: Ken Perlin, "Noise Hardware" (2001), for the lattice; Stefan Gustavson, "Simplex noise
    demystified" (2005).
    """
    corner = floor(p + (p.x + p.y + p.z) * THIRD)
    cell = ivec3(corner)
    d = p - corner + (corner.x + corner.y + corner.z) * (0.5 * THIRD)
    # The way from the cell's lower to its upper corner goes along the longest part first.
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
def simplex_noise_2(p: vec2, seed: int = 0) -> float:
    """In the plane, on triangles: from -1 to 1, slope up to 7.3541."""
    corner = floor(p + (p.x + p.y) * SIMPLEX_SKEW_2)
    cell = ivec2(corner)
    d = p - corner + (corner.x + corner.y) * SIMPLEX_UNSKEW_2
    right = select(d.x >= d.y, 1, 0)
    one = ivec2(right, 1 - right)
    total = simplex_part(cell, d, seed)
    total += simplex_part(cell + one, d - vec2(one) + SIMPLEX_UNSKEW_2, seed)
    total += simplex_part(cell + 1, d - (1.0 - 2.0 * SIMPLEX_UNSKEW_2), seed)
    return SIMPLEX_SCALE_2 * total


@func
def next_octave(p: vec3) -> vec3:
    """Turned and moved, lengths kept."""
    turn = mat3(
        vec3(2.0 * THIRD, 2.0 * THIRD, -THIRD),
        vec3(-THIRD, 2.0 * THIRD, 2.0 * THIRD),
        vec3(2.0 * THIRD, -THIRD, 2.0 * THIRD),
    )
    return turn @ p + vec3(0.37, 0.71, 0.53)


@next_octave.overload
def next_octave_2(p: vec2) -> vec2:
    """In the plane."""
    return mat2(vec2(0.8, 0.6), vec2(-0.6, 0.8)) @ p + vec2(0.37, 0.71)


@func
def fbm(
    p: vec3, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """Fractal noise: gradient noise at ever finer scales, from -1 to 1; ``fbm_slope`` bounds it.

    Args:
        p: Point; one unit is one cell of the coarsest octave.
        octaves: How many scales.
        lacunarity: How much finer each octave is than the one before.
        gain: How much weaker.
        seed: Which of many.

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
def fbm_2(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """In the plane."""
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * gradient_noise(p, seed + i)
        weights += weight
        weight *= gain
        p = next_octave(p * lacunarity)
    return total / max(weights, FROM_24_BITS)


@func
def fbm_slope(octaves: int, lacunarity: float, gain: float) -> float:
    """Bound on the gradient of ``fbm`` and ``turbulence``: each octave at its steepest."""
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
    """Billows: as ``fbm`` of the magnitude of noise, from 0 to 1, with sharp valleys at 0.

    Args:
        p: Point; one unit is one cell of the coarsest octave.
        octaves: How many scales.
        lacunarity: How much finer each octave is than the one before.
        gain: How much weaker.
        seed: Which of many.

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
def turbulence_2(
    p: vec2, octaves: int = 5, lacunarity: float = 2.0, gain: float = 0.5, seed: int = 0
) -> float:
    """In the plane."""
    total = 0.0
    weight = 1.0
    weights = 0.0
    for i in range(octaves):
        total += weight * abs(gradient_noise(p, seed + i))
        weights += weight
        weight *= gain
        p = next_octave(p * lacunarity)
    return total / max(weights, FROM_24_BITS)
