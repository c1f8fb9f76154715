"""Random numbers of a path: points of the unit square, well distributed over a pixel's samples.

Input: a pixel, the number of its sample, a seed. Output: a ``Stream``, and from it pairs and
triples of numbers in [0, 1), by the number of the decision that they are for. The same numbers on
every target, bit for bit. Does not depend on scenes.

The points of a pair are the (0, 2)-sequence of Sobol with Owen's scrambling: of the first 2^k
samples, each elementary interval of area 2^-k holds exactly one. Each pair of a path has its own
order of the samples and its own scrambling, both by a hash, so that pairs are independent.

Decision 38 has the measurements that this choice is based on.
"""

from __future__ import annotations

from distal.lang import func, ivec2, pcg, select, struct, uint, vec2, vec3

FROM_24_BITS = 5.9604644775390625e-08
# Distances of the seeds of successive decisions and of a decision's numbers: 2^32 divided by the
# golden ratio, and two odd numbers of well mixed bits.
DECISION_STEP = 2654435769
SECOND = 2246822519
THIRD = 3266489917


@struct
class Stream:
    """The random numbers of one sample.

    Attributes:
        seed: Selects the scrambling; equal for all samples that are distributed together.
        place: The number of the sample among those, with its bits reversed.
    """

    seed: uint
    place: uint


@func
def reversed_bits(x: uint) -> uint:
    """Return the 32 bits in reversed order."""
    x = (x << uint(16)) | (x >> uint(16))
    x = ((x & uint(0x00FF00FF)) << uint(8)) | ((x >> uint(8)) & uint(0x00FF00FF))
    x = ((x & uint(0x0F0F0F0F)) << uint(4)) | ((x >> uint(4)) & uint(0x0F0F0F0F))
    x = ((x & uint(0x33333333)) << uint(2)) | ((x >> uint(2)) & uint(0x33333333))
    return ((x & uint(0x55555555)) << uint(1)) | ((x >> uint(1)) & uint(0x55555555))


@func
def scrambled(x: uint, seed: uint) -> uint:
    """Return Owen's scrambling of a fraction whose bits are reversed: the lowest bit counts most.

    Each bit is flipped or not by a hash of the bits below it.

    Source: Samuli Laine and Tero Karras, "Stratified Sampling for Stochastic Transparency" (2011);
        Brent Burley, "Practical Hash-based Owen Scrambling" (2020), for its use; Nathan Vegdahl,
        "Building a Better LK Hash" (2021), for the constants.
    """
    x ^= x * uint(0x3D20ADEA)
    x += seed
    x *= (seed >> uint(16)) | uint(1)
    x ^= x * uint(0x05526C56)
    x ^= x * uint(0x53A22864)
    return x


@func
def second_of_sobol(index: uint) -> uint:
    """Return the second coordinate of a point of Sobol's sequence, with its bits reversed.

    The first coordinate with its bits reversed is the index itself. The second is the product with
    Pascal's triangle modulo 2, which has a factor for each bit of a bit's number.

    Source: Ilya Sobol, "On the distribution of points in a cube" (1967); Abdalla Ahmed, "An
        Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact" (2024), for the
        factors.
    """
    x = index
    x ^= (x & uint(0xAAAAAAAA)) >> uint(1)
    x ^= (x & uint(0xCCCCCCCC)) >> uint(2)
    x ^= (x & uint(0xF0F0F0F0)) >> uint(4)
    x ^= (x & uint(0xFF00FF00)) >> uint(8)
    return x ^ (x >> uint(16))


@func
def fraction_of_reversed(x: uint) -> float:
    """Convert reversed bits to a number in [0, 1), of 24 bits."""
    return float(reversed_bits(x) >> uint(8)) * FROM_24_BITS


@func
def scattered_stream(pixel: ivec2, sample: int, seed: uint) -> Stream:
    """Return the random numbers of a sample; those of different pixels are independent.

    Any number of samples is well distributed, and more may be added later.

    Args:
        pixel: Column and row, from 0.
        sample: The number of the pixel's sample, from 0.
        seed: Selects one of many sets of numbers.
    """
    of_pixel = pcg(uint(pixel.x) + pcg(uint(pixel.y) + pcg(seed)))
    return Stream(of_pixel, reversed_bits(uint(sample)))


@func
def spread_bits(x: uint) -> uint:
    """Move bit k to bit 2 k; of 16 bits."""
    x &= uint(0xFFFF)
    x = (x | (x << uint(8))) & uint(0x00FF00FF)
    x = (x | (x << uint(4))) & uint(0x0F0F0F0F)
    x = (x | (x << uint(2))) & uint(0x33333333)
    return (x | (x << uint(1))) & uint(0x55555555)


@func
def dithered_stream(pixel: ivec2, sample: int, bits: int, seed: uint) -> Stream:
    """Return the random numbers of a sample; neighboring pixels have complementary ones.

    All pixels share one sequence, along a curve in the order of the bits of both coordinates, so
    that the samples of each square of 2^k pixels are well distributed, too. The error of a picture
    is blue noise: its low frequencies are small. That needs the number of samples in advance:
    each further 2^``bits`` samples are distributed on their own.

    Args:
        pixel: Column and row, from 0 to 65535.
        sample: The number of the pixel's sample, from 0.
        bits: The binary logarithm of the number of samples of a pixel, 0 to 30.
        seed: Selects one of many sets of numbers.

    Source: Abdalla Ahmed and Peter Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo
        Sampling Error via Hierarchical Ordering of Pixels" (2020). The random order of the four
        quarters of a square, one for each pair of numbers, is the scrambling of the order here.
    """
    count = uint(bits)
    curve = spread_bits(uint(pixel.x)) | (spread_bits(uint(pixel.y)) << uint(1))
    repeated = uint(sample) >> count
    far = select(bits > 0, curve >> (uint(32) - count), uint(0))
    inside = uint(sample) & ((uint(1) << count) - uint(1))
    together = pcg(far + pcg(repeated + pcg(seed)))
    return Stream(together, reversed_bits((curve << count) | inside))


@func
def decision_seed(stream: Stream, decision: int) -> uint:
    """Return the seed of the numbers of a decision."""
    return pcg(stream.seed + uint(decision) * uint(DECISION_STEP))


@func
def single_of(place: uint, seed: uint) -> float:
    """Return a number in [0, 1), stratified over the samples.

    Args:
        place: The number of the sample, with its bits reversed.
        seed: Selects the order and the scrambling.
    """
    index = reversed_bits(scrambled(place, seed))
    return fraction_of_reversed(scrambled(index, pcg(seed)))


@func
def single(stream: Stream, decision: int) -> float:
    """Return a number in [0, 1) for a decision.

    Args:
        stream: The random numbers of the sample.
        decision: The number of the decision on the path; each has its own numbers.
    """
    return single_of(stream.place, decision_seed(stream, decision))


@func
def pair(stream: Stream, decision: int) -> vec2:
    """Return a point of the unit square for a decision.

    Args:
        stream: The random numbers of the sample.
        decision: The number of the decision on the path; each has its own numbers.

    Source: Burley (2020), for the padding of two dimensions by a scrambled order.
    """
    seed = decision_seed(stream, decision)
    index = reversed_bits(scrambled(stream.place, seed))
    first = scrambled(index, pcg(seed))
    second = scrambled(second_of_sobol(index), pcg(seed ^ uint(SECOND)))
    return vec2(fraction_of_reversed(first), fraction_of_reversed(second))


@func
def triple(stream: Stream, decision: int) -> vec3:
    """Return three numbers in [0, 1) for a decision: a ``pair`` and, independent, a ``single``.

    Args:
        stream: The random numbers of the sample.
        decision: The number of the decision on the path; each has its own numbers.
    """
    seed = decision_seed(stream, decision)
    return vec3(pair(stream, decision), single_of(stream.place, seed ^ uint(THIRD)))
