"""Parts of noise functions: hashes of lattice cells, corner contributions, octaves.

Input: cells of a lattice, points in them, a seed. Output: random bits, and the contribution of each
corner of a cell to the noise. ``space`` and ``plane`` combine these.
"""

from __future__ import annotations

from typing import Final

from distal.lang import dot, func, ivec2, ivec3, mat2, mat3, max, pcg, select, uint, vec2, vec3

# Offset of the hash between consecutive seeds: 2^32 divided by the golden ratio.
SEED_STEP: Final = 2654435769
FROM_24_BITS: Final = 5.9604644775390625e-08

# Squared radius of a simplex corner's kernel: half of the lattice's smallest squared distance.
SIMPLEX_REACH: Final = 0.5

# Components of a direction halfway between an axis and a diagonal, so that the eight directions
# favour neither.
COSINE: Final = 0.9238795325112867
SINE: Final = 0.3826834323650898

# Each octave is rotated by a sixth of a turn around the diagonal of space and translated, so that
# no lattices coincide.
THIRD: Final = 1.0 / 3.0


@func
def lattice_hash(cell: ivec3, seed: int) -> uint:
    """Return 32 random bits of a cell of space."""
    plane = pcg(uint(cell.z) + uint(seed) * uint(SEED_STEP))
    return pcg(uint(cell.x) + pcg(uint(cell.y) + plane))


@func
def lattice_hash_2(cell: ivec2, seed: int) -> uint:
    """Return 32 random bits of a cell of the plane."""
    return pcg(uint(cell.x) + pcg(uint(cell.y) + uint(seed) * uint(SEED_STEP)))


@func
def fraction(bits: uint) -> float:
    """Convert the upper 24 of 32 bits to a number from 0 up to, but not including, 1."""
    return float(bits >> uint(8)) * FROM_24_BITS


@func
def faded(x: vec3) -> vec3:
    """Return Perlin's quintic from 0 to 1: first and second derivatives are 0 at both ends."""
    return x * x * x * (x * (x * 6.0 - 15.0) + 10.0)


@func
def faded_2(x: vec2) -> vec2:
    """Return the same as ``faded``, in the plane."""
    return x * x * x * (x * (x * 6.0 - 15.0) + 10.0)


@func
def corner_value(cell: ivec3, seed: int) -> float:
    """Return a random number from -1 to 1."""
    return 2.0 * fraction(lattice_hash(cell, seed)) - 1.0


@func
def corner_value_2(cell: ivec2, seed: int) -> float:
    """Return the same as ``corner_value``, in the plane."""
    return 2.0 * fraction(lattice_hash_2(cell, seed)) - 1.0


@func
def ramp(bits: uint, d: vec3) -> float:
    """Return the dot product of ``d`` and one of the 12 directions to a cube's edges."""
    left_out = ((bits >> uint(16)) * uint(3)) >> uint(16)
    a = select(left_out == uint(0), d.y, d.x)
    b = select(left_out == uint(2), d.y, d.z)
    a = select((bits & uint(256)) == uint(0), a, -a)
    return a + select((bits & uint(512)) == uint(0), b, -b)


@func
def ramp_2(bits: uint, d: vec2) -> float:
    """Return the dot product of ``d`` and one of eight unit directions."""
    steep = (bits & uint(65536)) == uint(0)
    a = COSINE * select(steep, d.y, d.x)
    b = SINE * select(steep, d.x, d.y)
    a = select((bits & uint(131072)) == uint(0), a, -a)
    return a + select((bits & uint(262144)) == uint(0), b, -b)


@func
def corner_ramp(cell: ivec3, offset: ivec3, inside: vec3, seed: int) -> float:
    """Return the value of the linear function that is 0 at one corner of a cell."""
    return ramp(lattice_hash(cell + offset, seed), inside - vec3(offset))


@func
def corner_ramp_2(cell: ivec2, offset: ivec2, inside: vec2, seed: int) -> float:
    """Return the same as ``corner_ramp``, in the plane."""
    return ramp_2(lattice_hash_2(cell + offset, seed), inside - vec2(offset))


@func
def simplex_part(cell: ivec3, d: vec3, seed: int) -> float:
    """Return the contribution of one corner of a simplex at the offset ``d`` from it."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp(lattice_hash(cell, seed), d)


@func
def simplex_part_2(cell: ivec2, d: vec2, seed: int) -> float:
    """Return the same as ``simplex_part``, in the plane."""
    weight = max(SIMPLEX_REACH - dot(d, d), 0.0)
    weight *= weight
    return weight * weight * ramp_2(lattice_hash_2(cell, seed), d)


@func
def next_octave(p: vec3) -> vec3:
    """Rotate and translate a point; lengths do not change."""
    turn = mat3(
        vec3(2.0 * THIRD, 2.0 * THIRD, -THIRD),
        vec3(-THIRD, 2.0 * THIRD, 2.0 * THIRD),
        vec3(2.0 * THIRD, -THIRD, 2.0 * THIRD),
    )
    return turn @ p + vec3(0.37, 0.71, 0.53)


@func
def next_octave_2(p: vec2) -> vec2:
    """Return the same as ``next_octave``, in the plane."""
    return mat2(vec2(0.8, 0.6), vec2(-0.6, 0.8)) @ p + vec2(0.37, 0.71)
