"""What noise is made of: hashed lattices of space and plane, ramps, octaves.

Input: cells of a lattice, places in them, a seed. Output: random bits and what
each corner of a cell adds to noise. ``noise`` and ``noise_flat`` blend these.
"""

from __future__ import annotations

from typing import Final

from distal.lang import dot, func, ivec2, ivec3, mat2, mat3, max, pcg, select, uint, vec2, vec3

# Lattices of neighbouring seeds lie this far apart: 2^32 over the golden ratio.
SEED_STEP: Final = 2654435769
FROM_24_BITS: Final = 5.9604644775390625e-08

# Where the kernels of a simplex's corners end: half the square of the lattice's smallest distance.
SIMPLEX_REACH: Final = 0.5

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


@func
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


@func
def faded_2(x: vec2) -> vec2:
    """In the plane."""
    return x * x * x * (x * (x * 6.0 - 15.0) + 10.0)


@func
def corner_value(cell: ivec3, seed: int) -> float:
    """A random number from -1 to 1."""
    return 2.0 * fraction(lattice_hash(cell, seed)) - 1.0


@func
def corner_value_2(cell: ivec2, seed: int) -> float:
    """In the plane."""
    return 2.0 * fraction(lattice_hash_2(cell, seed)) - 1.0


@func
def ramp(bits: uint, d: vec3) -> float:
    """How far ``d`` reaches along one of the 12 directions to the middles of a cube's edges."""
    left_out = ((bits >> uint(16)) * uint(3)) >> uint(16)
    a = select(left_out == uint(0), d.y, d.x)
    b = select(left_out == uint(2), d.y, d.z)
    a = select((bits & uint(256)) == uint(0), a, -a)
    return a + select((bits & uint(512)) == uint(0), b, -b)


@func
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


@func
def corner_ramp_2(cell: ivec2, offset: ivec2, inside: vec2, seed: int) -> float:
    """In the plane."""
    return ramp_2(lattice_hash_2(cell + offset, seed), inside - vec2(offset))


@func
def simplex_part(cell: ivec3, d: vec3, seed: int) -> float:
    """What one corner of a simplex adds at ``d`` from it."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp(lattice_hash(cell, seed), d)


@func
def simplex_part_2(cell: ivec2, d: vec2, seed: int) -> float:
    """In the plane."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp_2(lattice_hash_2(cell, seed), d)


@func
def next_octave(p: vec3) -> vec3:
    """Turned and moved, lengths kept."""
    turn = mat3(
        vec3(2.0 * THIRD, 2.0 * THIRD, -THIRD),
        vec3(-THIRD, 2.0 * THIRD, 2.0 * THIRD),
        vec3(2.0 * THIRD, -THIRD, 2.0 * THIRD),
    )
    return turn @ p + vec3(0.37, 0.71, 0.53)


@func
def next_octave_2(p: vec2) -> vec2:
    """In the plane."""
    return mat2(vec2(0.8, 0.6), vec2(-0.6, 0.8)) @ p + vec2(0.37, 0.71)
