"""Integer hashes: the same random numbers on every target.

Source: Mark Jarzynski and Marc Olano, "Hash Functions for GPU Rendering", Journal of
Computer Graphics Techniques 9(3), 2020; the scalar hash after Melissa O'Neill's PCG (2014).
"""

from __future__ import annotations

from distal.lang import func, uint, uvec2, uvec3, uvec4

# The multiplier and increment of the generator in "Numerical Recipes"; vector hashes use them.
MULTIPLIER = 1664525
INCREMENT = 1013904223


@func
def pcg(v: uint) -> uint:
    """One step of a linear congruential generator, then PCG's RXS-M-XS permutation."""
    state = v * uint(747796405) + uint(2891336453)
    word = ((state >> ((state >> uint(28)) + uint(4))) ^ state) * uint(277803737)
    return (word >> uint(22)) ^ word


@pcg.overload
def pcg2d(v: uvec2) -> uvec2:
    """Hash two numbers to two."""
    h = v * uint(MULTIPLIER) + uint(INCREMENT)
    h.x += h.y * uint(MULTIPLIER)
    h.y += h.x * uint(MULTIPLIER)
    h ^= h >> uint(16)
    h.x += h.y * uint(MULTIPLIER)
    h.y += h.x * uint(MULTIPLIER)
    h ^= h >> uint(16)
    return h


@pcg.overload
def pcg3d(v: uvec3) -> uvec3:
    """Hash three numbers to three."""
    h = v * uint(MULTIPLIER) + uint(INCREMENT)
    h.x += h.y * h.z
    h.y += h.z * h.x
    h.z += h.x * h.y
    h ^= h >> uint(16)
    h.x += h.y * h.z
    h.y += h.z * h.x
    h.z += h.x * h.y
    return h


@pcg.overload
def pcg4d(v: uvec4) -> uvec4:
    """Hash four numbers to four."""
    h = v * uint(MULTIPLIER) + uint(INCREMENT)
    h.x += h.y * h.w
    h.y += h.z * h.x
    h.z += h.x * h.y
    h.w += h.y * h.z
    h ^= h >> uint(16)
    h.x += h.y * h.w
    h.y += h.z * h.x
    h.z += h.x * h.y
    h.w += h.y * h.z
    return h


@func
def unit_float(v: uint) -> float:
    """Return the hash of ``v`` as a float in [0, 1): its upper 24 bits, exact in a float."""
    return float(pcg(v) >> uint(8)) * 5.9604644775390625e-08
