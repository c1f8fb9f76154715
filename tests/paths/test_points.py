"""Random numbers of paths: stratified, independent, the same on every target."""

from __future__ import annotations

import numpy as np
import pytest

from distal.lang import func, ivec2, uint, vec2, vec3
from distal.lang.runtime_access import executor
from distal.render.sampling import points
from tests.paths.counting import SURPRISING, counted, deviation


@func
def scattered_pair(pixel: ivec2, sample: int, decision: int, seed: uint) -> vec2:
    return points.pair(points.scattered_stream(pixel, sample, seed), decision)


@func
def scattered_triple(pixel: ivec2, sample: int, decision: int) -> vec3:
    return points.triple(points.scattered_stream(pixel, sample, 9), decision)


@func
def scattered_single(pixel: ivec2, sample: int, decision: int) -> float:
    return points.single(points.scattered_stream(pixel, sample, 9), decision)


@func
def dithered_pair(pixel: ivec2, sample: int, bits: int, decision: int) -> vec2:
    return points.pair(points.dithered_stream(pixel, sample, bits, 9), decision)


def of_one_pixel(count, decision=0, pixel=(3, 5), seed=1):
    places = np.tile(np.array(pixel, np.int32), (count, 1))
    return np.asarray(
        scattered_pair(places, np.arange(count, dtype=np.int32), decision, np.uint32(seed))
    )


def fullest_and_emptiest(found, k):
    """The counts of elementary intervals: all shapes of area 2^-k."""
    for across in range(k + 1):
        counts = counted(found, 2**across, 2 ** (k - across))
        yield counts.max(), counts.min()


@pytest.mark.parametrize("decision", [0, 1, 70])
@pytest.mark.parametrize("k", [0, 1, 4, 9, 12])
def test_each_elementary_interval_holds_one(k, decision):
    found = of_one_pixel(2**k, decision)
    assert set(fullest_and_emptiest(found, k)) == {(1, 1)}


def test_later_samples_are_as_well_distributed():
    found = of_one_pixel(1024)
    for start in (256, 512, 768):
        assert set(fullest_and_emptiest(found[start : start + 256], 8)) == {(1, 1)}


@pytest.mark.parametrize("k", [3, 8])
def test_a_single_number_is_stratified(k):
    places = np.tile(np.array([(3, 5)], np.int32), (2**k, 1))
    samples = np.arange(2**k, dtype=np.int32)
    for found in (
        scattered_single(places, samples, 2),
        np.asarray(scattered_triple(places, samples, 2))[:, 2],
    ):
        assert sorted((np.asarray(found) * 2**k).astype(int)) == list(range(2**k))


@pytest.mark.parametrize("corner", [(0, 0), (8, 4), (64, 1000)])
def test_a_square_of_pixels_is_well_distributed_too(corner):
    bits, side = 3, 4
    y, x = np.mgrid[0:side, 0:side]
    pixels = np.stack([x.ravel() + corner[0], y.ravel() + corner[1]], 1).astype(np.int32)
    samples = np.tile(np.arange(2**bits, dtype=np.int32), side * side)
    for decision in (0, 5):
        found = dithered_pair(np.repeat(pixels, 2**bits, 0), samples, bits, decision)
        assert set(fullest_and_emptiest(np.asarray(found), 7)) == {(1, 1)}
        one = dithered_pair(pixels[3:4].repeat(8, 0), samples[:8], bits, decision)
        assert set(fullest_and_emptiest(np.asarray(one), 3)) == {(1, 1)}


def test_one_sample_of_each_pixel_is_well_distributed_over_squares():
    y, x = np.mgrid[0:16, 0:16]
    pixels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32)
    found = np.asarray(dithered_pair(pixels, 0, 0, 4))
    assert set(fullest_and_emptiest(found, 8)) == {(1, 1)}


def test_more_samples_than_planned_are_distributed_anew():
    pixels = np.tile(np.array([(7, 2)], np.int32), (64, 1))
    found = np.asarray(dithered_pair(pixels, np.arange(64, dtype=np.int32), 4, 0))
    for start in (0, 16, 32, 48):
        assert set(fullest_and_emptiest(found[start : start + 16], 4)) == {(1, 1)}
    assert len(np.unique(found, axis=0)) == 64


def test_pixels_far_apart_have_their_own_numbers():
    """With 18 bits of samples, 7 bits of each coordinate remain; the others change the seed."""
    pixels = np.array([(1, 1), (129, 1), (1, 129), (65, 1)], np.int32)
    found = np.asarray(dithered_pair(pixels, np.zeros(4, np.int32), 18, 0))
    assert len(np.unique(found, axis=0)) == 4


def cells_of_pairs(a, b, count=8):
    return deviation(
        counted(np.stack([a, b], 1), count, count), np.full(count * count, len(a) / count**2)
    )


def test_decisions_are_independent():
    """One sample of many pixels: each number of one decision against each of another."""
    y, x = np.mgrid[0:128, 0:128]
    pixels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32)
    for sample in (0, 5):
        found = [np.asarray(scattered_triple(pixels, sample, d)) for d in (0, 1, 2, 33)]
        columns = [found[d][:, c] for d in range(4) for c in range(3)]
        for i in range(len(columns)):
            for j in range(i):
                assert abs(cells_of_pairs(columns[i], columns[j])) < SURPRISING, (i, j)


def test_the_samples_of_a_pixel_are_independent_between_decisions():
    """All samples of one pixel: a pair of decisions is not a net, but has no pattern either."""
    samples = np.arange(4096, dtype=np.int32)
    pixels = np.tile(np.array([(3, 5)], np.int32), (4096, 1))
    found = [np.asarray(scattered_triple(pixels, samples, d)) for d in (0, 1, 2)]
    for i in range(3):
        for j in range(i):
            for a in range(3):
                for b in range(3):
                    assert cells_of_pairs(found[i][:, a], found[j][:, b]) < SURPRISING
    assert cells_of_pairs(found[0][:, 0], found[0][:, 2]) < SURPRISING


def test_neighboring_pixels_are_independent():
    y, x = np.mgrid[0:128, 0:128]
    pixels = np.stack([x.ravel(), y.ravel()], 1).astype(np.int32)
    found = np.asarray(scattered_triple(pixels, 0, 0)).reshape(128, 128, 3)
    for c in range(3):
        right = cells_of_pairs(found[:, :-1, c].ravel(), found[:, 1:, c].ravel())
        up = cells_of_pairs(found[:-1, :, c].ravel(), found[1:, :, c].ravel())
        assert max(abs(right), abs(up)) < SURPRISING


def test_seeds_select_other_numbers():
    assert not np.isin(of_one_pixel(64, seed=1)[:, 0], of_one_pixel(64, seed=2)[:, 0]).any()


def test_numbers_stay_below_one_and_the_mean_is_a_half():
    found = of_one_pixel(1 << 14)
    assert found.min() >= 0.0
    assert found.max() < 1.0
    assert found.mean(0) == pytest.approx((0.5, 0.5), abs=1e-4)


def test_the_reference_draws_the_same_bits():
    rng = np.random.default_rng(3)
    pixels = rng.integers(0, 4096, (200, 2)).astype(np.int32)
    samples = rng.integers(0, 1 << 20, 200).astype(np.int32)
    for function, arguments in (
        (scattered_triple, (pixels, samples, 6)),
        (dithered_pair, (pixels, samples, 5, 6)),
    ):
        here = np.asarray(function(*arguments))
        there = np.asarray(executor().call(function, arguments, {}, device="reference"))
        assert (here == there).all()


def sobol(index):
    """The second coordinate by Sobol's direction numbers: the polynomial x + 1."""
    columns = [1 << 31]
    for _ in range(31):
        columns.append(columns[-1] ^ (columns[-1] >> 1))
    found = 0
    for bit in range(32):
        if index >> bit & 1:
            found ^= columns[bit]
    return found


def test_the_second_coordinate_has_sobols_direction_numbers():
    indices = [0, 1, 2, 3, 5, 100, 0x80000000, 0xFFFFFFFF, 0x12345678]
    found = np.asarray(points.second_of_sobol(np.array(indices, np.uint32)))
    back = np.asarray(points.reversed_bits(found))
    assert [int(x) for x in back] == [sobol(i) for i in indices]
