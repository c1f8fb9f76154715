"""The integer hashes, against the published ones in Python's integers."""

import numpy as np
import pytest

from distal.lang import func, pcg, uint, uvec2, uvec3, uvec4

MULTIPLIER, INCREMENT, WHOLE = 1664525, 1013904223, 2**32
# The component that is changed, and the two whose product is added (Jarzynski and Olano, 2020).
MIXED = {
    2: ((0, 1, None), (1, 0, None)),
    3: ((0, 1, 2), (1, 2, 0), (2, 0, 1)),
    4: ((0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)),
}


@func
def hash1(v: uint) -> uint:
    return pcg(v)


@func
def hash2(v: uvec2) -> uvec2:
    return pcg(v)


@func
def hash3(v: uvec3) -> uvec3:
    return pcg(v)


@func
def hash4(v: uvec4) -> uvec4:
    return pcg(v)


def published(v: list[int]) -> list[int]:
    """The hash of a vector."""
    h = [(x * MULTIPLIER + INCREMENT) % WHOLE for x in v]
    for is_last in (False, True):
        for to, a, b in MIXED[len(v)]:
            h[to] = (h[to] + h[a] * (MULTIPLIER if b is None else h[b])) % WHOLE
        if not is_last or len(v) == 2:
            h = [x ^ (x >> 16) for x in h]
    return h


@pytest.mark.parametrize("made", [hash2, hash3, hash4])
def test_a_hash_of_a_vector_is_the_published_one(made):
    size = int(made.name[-1])
    numbers = np.random.default_rng(size).integers(0, WHOLE, (50, size), dtype=np.uint32)
    wanted = [published(row) for row in numbers.tolist()]
    assert np.asarray(made(numbers)).tolist() == wanted


def test_a_hash_of_a_number_is_the_published_one():
    """O'Neill's RXS-M-XS permutation of a step of the generator."""

    def wanted(v: int) -> int:
        state = (v * 747796405 + 2891336453) % WHOLE
        word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) % WHOLE
        return (word >> 22) ^ word

    numbers = np.random.default_rng(1).integers(0, WHOLE, 50, dtype=np.uint32)
    assert np.asarray(hash1(numbers)).tolist() == [wanted(v) for v in numbers.tolist()]
