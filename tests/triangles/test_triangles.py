"""Pictures as triangles: closed forms, the mesh, the coder, files, bad input."""

from __future__ import annotations

import contextlib
import math
import re
from collections import Counter

import numpy as np
import pytest

from distal.lang.runtime_access import executor
from distal.triangles import arithmetic, stream
from distal.triangles.decoding import decode
from distal.triangles.encoding import TriangleEncoding, encode
from distal.triangles.fitting import fitted, weights_of
from distal.triangles.lattice import lattice_of, leaves_of, points_of
from distal.triangles.range_coder import (
    CoderError,
    RangeDecoder,
    RangeEncoder,
    code_number,
    code_signed,
)
from distal.triangles.shapes import CUTS, can_be_cut


def random_points(width, height, seed, share=0.6):
    lattice = lattice_of(width, height)
    random = np.random.default_rng(seed)
    split = {}
    for side, kind in lattice.steps():
        shape = (lattice.rows // side, lattice.columns // side, 4 if kind else 2)
        split[side, kind] = random.random(shape) < share
    return lattice, points_of(lattice, split)


def error(found, wanted):
    return np.abs(found.astype(int) - wanted).max()


def psnr(found, wanted):
    return 10 * math.log10(255**2 / np.mean(np.square(found.astype(float) - wanted)))


# The mesh.


@pytest.mark.parametrize(("width", "height"), [(32, 32), (40, 24), (1, 1), (100, 3), (3, 50)])
@pytest.mark.parametrize("seed", [1, 2])
def test_triangles_meet_side_to_side_and_cover_each_pixel_once(width, height, seed):
    lattice, used = random_points(width, height, seed)
    leaves = leaves_of(lattice, used)
    seen = weights_of(lattice, leaves, [np.full(len(x.rows), -1) for x in leaves])
    np.testing.assert_allclose(seen.weights.sum(1), 1.0, atol=1e-5)
    # A side has two triangles, or lies at the border of those that have a place in the picture.
    sides = Counter()
    points = set()
    for leaf in leaves:
        for triangle in leaf.points.tolist():
            points |= set(triangle)
            for k in range(3):
                a, b = sorted((triangle[k], triangle[(k + 1) % 3]))
                sides[a, b] += 1
    assert set(sides.values()) <= {1, 2}
    stride = lattice.shape[1]
    for (a, b), count in sides.items():
        middle = (a + b) // 2
        straight = (a + b) % 2 == 0 and (a // stride + b // stride) % 2 == 0
        if straight and (a % stride + b % stride) % 2 == 0:
            assert middle not in points, "a point inside of a side"
        if count == 1:
            rows, columns = {a // stride, b // stride}, {a % stride, b % stride}
            outside = min(rows) >= height or min(columns) >= width
            at_border = rows == {0} or columns == {0}
            beyond = max(rows) >= height or max(columns) >= width
            assert outside or at_border or beyond


def test_the_leaves_are_those_that_the_file_lists():
    lattice, used = random_points(50, 40, 3)
    listed = {
        t for t, *_ in stream.triangles(stream.Description(lattice, 4, used, {}, np.zeros(0)))
    }
    found = {tuple(t) for leaf in leaves_of(lattice, used) for t in leaf.points.tolist()}
    # LeafTriangles are left out by their square, the file's triangles by their own corners.
    assert listed <= found
    beyond = [min(p // lattice.shape[1] for p in t) >= 40 for t in found - listed]
    right = [min(p % lattice.shape[1] for p in t) >= 50 for t in found - listed]
    assert all(a or b for a, b in zip(beyond, right, strict=True))


# The formulas.


def called(function, *values):
    plain = [v if isinstance(v, float) else np.asarray(v, np.float32) for v in values]
    return executor().call(function, tuple(plain), {}, device="reference")


def test_the_distance_from_a_cut():
    a, b, c = (0.0, 0.0), (8.0, 0.0), (0.0, 8.0)
    # Places 3 on both sides: the line x + y = 3.5.
    p = np.array([(0, 0), (3.5, 0), (0, 3.5), (8, 0), (4, 4)], float)
    found = called(arithmetic.cut_distance, p, a, b, c, (3.0, 3.0))
    np.testing.assert_allclose(found, (3.5 - p.sum(1)) / math.sqrt(2.0), atol=1e-6)
    # The other way around, the sign is the same.
    found = called(arithmetic.cut_distance, p, a, c, b, (3.0, 3.0))
    np.testing.assert_allclose(found, (3.5 - p.sum(1)) / math.sqrt(2.0), atol=1e-6)
    assert (called(arithmetic.cut_distance, p, a, b, c, (-1.0, -1.0)) < -100.0).all()


def test_codes_are_colors():
    colors = np.random.default_rng(0).integers(0, 256, (50, 3))
    codes = called(arithmetic.color_code, colors)
    np.testing.assert_allclose(called(arithmetic.display_values, codes) * 255.0, colors, atol=1e-3)
    grey = called(arithmetic.color_code, np.full((1, 3), 77.0))
    np.testing.assert_allclose(grey, [[77.0, 0.0, 0.0]])


# Pictures with a known answer.


def test_a_linear_gradient_is_two_triangles():
    y, x = np.mgrid[:48, :64]
    picture = np.stack([x * 3 + 20, y * 4 + 10, 200 - x - y], -1).astype(np.uint8)
    work = TriangleEncoding(picture)
    file = work.file(20.0)
    assert work.triangles == 2
    assert error(decode(file), picture) <= 1
    assert len(file) < 50


def test_one_color_and_one_pixel():
    for shape in ((1, 1), (1, 40), (57, 1), (30, 30)):
        picture = np.full((*shape, 3), (37, 99, 200), np.uint8)
        file = encode(picture, price=1.0)
        # Points amid few pixels have steps of 1.25 levels and more.
        assert error(decode(file), picture) <= 2
        assert decode(file).shape == picture.shape


@pytest.mark.parametrize("cut", [(0, 2, 5), (1, 4, 4), (2, 6, 1)])
def test_a_straight_edge_is_found_as_the_cut_that_made_it(cut):
    lattice = lattice_of(32, 32)
    used = np.zeros(lattice.shape, bool)
    used[::32, ::32] = True
    description = stream.Description(lattice, 4, used, {}, np.zeros((used.size, 3)))
    (triangle, side, kind, _), _ = stream.triangles(description)
    assert can_be_cut(side, kind)
    description.cuts[triangle] = cut
    description.codes[list(triangle)] = [(60, 10, 5), (150, -30, 12), (220, 4, -9)]
    picture = decode(stream.written(description))
    work = TriangleEncoding(picture)
    file = work.file(5.0)
    found = stream.read(file)
    assert found.cuts.get(triangle) == cut
    assert work.triangles == 2
    assert error(decode(file), picture) <= 2


def test_an_edge_across_many_triangles_costs_little():
    y, x = np.mgrid[:96, :128]
    picture = np.where((2 * x + 3 * y > 260)[..., None], (230, 40, 30), (20, 60, 120))
    file = encode(picture.astype(np.uint8), price=200.0)
    # 203 bytes and 33.5 dB; without cuts it has 30.6 dB.
    assert len(file) < 230
    assert psnr(decode(file), picture) > 32.5


def test_codes_have_the_smallest_squared_error():
    lattice, used = random_points(30, 20, 5, share=0.5)
    leaves = leaves_of(lattice, used)
    able = [np.full(len(x.rows), 17 if can_be_cut(x.side, x.kind) else -1) for x in leaves]
    seen = weights_of(lattice, leaves, able)
    pixels = np.random.default_rng(2).integers(0, 256, (600, 3)).astype(np.float32)
    values = fitted(seen, pixels, np.full((used.size, 3), 128.0), used)
    dense = np.zeros((600, used.size))
    np.add.at(dense, (np.arange(600)[:, None], seen.points), seen.weights)
    best, *_ = np.linalg.lstsq(dense, pixels.astype(float), rcond=None)
    least = np.square(dense @ best - pixels).sum()
    assert np.square(seen.shown(values) - pixels).sum() <= 1.01 * least


# The coder and the file.


def test_decisions_come_back_in_about_their_information():
    random = np.random.default_rng(4)
    contexts = random.integers(0, 3, 20_000).tolist()
    chances = (0.5, 0.05, 0.9)
    values = [int(random.random() < chances[c]) for c in contexts]
    coder = RangeEncoder(3)
    for context, value in zip(contexts, values, strict=True):
        coder.bit(context, value)
    data = coder.finished()
    back = RangeDecoder(data, 3)
    assert [back.bit(context) for context in contexts] == values
    bits = sum(-p * math.log2(p) - (1 - p) * math.log2(1 - p) for p in chances) / 3 * 20_000
    assert bits / 8 < len(data) < 1.04 * bits / 8


def test_carries_of_the_coder():
    # Likely zeros bring the low end near a carry again and again.
    for seed in range(40):
        values = (np.random.default_rng(seed).random(400) < 0.02).astype(int).tolist()
        coder = RangeEncoder(1)
        for value in values:
            coder.bit(0, value)
        back = RangeDecoder(coder.finished(), 1)
        assert [back.bit(0) for _ in values] == values


def test_numbers_come_back():
    numbers = [*range(40), 511, 512, 1000, 16_000, -1, -12, -13, -700]
    coder = RangeEncoder(20)
    for number in numbers:
        code_signed(coder, 0, 17, number)
    back = RangeDecoder(coder.finished(), 20)
    assert [code_signed(back, 0, 17, 0) for _ in numbers] == numbers


def test_a_number_that_no_picture_has():
    coder = RangeEncoder(20)
    for step in range(12):
        coder.bit(step, 1)
    for _ in range(30):
        coder.bit(12, 1)
    with pytest.raises(CoderError, match="a number is too large"):
        code_number(RangeDecoder(coder.finished(), 20), 0, 0)


@pytest.mark.parametrize(("width", "height"), [(40, 30), (70, 9)])
def test_a_file_says_what_was_written(width, height):
    lattice, used = random_points(width, height, 7)
    random = np.random.default_rng(8)
    description = stream.Description(lattice, 9, used.copy(), {}, np.zeros((used.size, 3)))
    description.codes[:] = random.normal(100, 60, (used.size, 3))
    for triangle, side, kind, _ in stream.triangles(description):
        if can_be_cut(side, kind) and random.random() < 0.6:
            description.cuts[triangle] = CUTS[random.integers(len(CUTS))]
    file = stream.written(description)
    found = stream.read(file)
    assert (found.lattice, found.step) == (lattice, 9)
    np.testing.assert_array_equal(found.used, used)
    assert found.cuts == description.cuts
    np.testing.assert_array_equal(found.codes, description.codes)


def textured(height, width, seed=0):
    y, x = np.mgrid[:height, :width]
    waves = np.sin(x / 5.0) * np.cos(y / 7.0) * 60 + 120
    noise = np.random.default_rng(seed).normal(0, 12, (height, width))
    return np.clip(np.stack([waves + noise, waves, 255 - waves], -1), 0, 255).astype(np.uint8)


def test_a_dearer_bit_makes_a_smaller_and_worse_file():
    picture = textured(60, 80)
    work = TriangleEncoding(picture)
    files = [work.file(price) for price in (20.0, 200.0, 2000.0, 20000.0)]
    sizes, ratios = [len(f) for f in files], [psnr(decode(f), picture) for f in files]
    assert sizes == sorted(sizes, reverse=True) and len(set(sizes)) == 4
    assert ratios == sorted(ratios, reverse=True)
    assert ratios[0] > 30.0


@pytest.mark.parametrize("most", [300, 900])
def test_a_file_is_as_large_as_it_may_be(most):
    parts = []
    file = encode(textured(64, 64), most_bytes=most, progress=parts.append)
    assert 0.7 * most < len(file) <= most
    assert parts == sorted(parts) and parts[-1] == 1.0 and parts[0] < 0.2


def test_grey_and_opaque_pictures():
    color = textured(20, 20)
    grey = color[..., 0]
    assert encode(grey) == encode(np.stack([grey] * 3, -1))
    opaque = np.concatenate([color, np.full((20, 20, 1), 255, np.uint8)], -1)
    assert encode(opaque) == encode(color)


# Bad input.


@pytest.mark.parametrize(
    ("array", "options", "kind", "text"),
    [
        (np.zeros((4, 4, 3)), {}, TypeError, "pixels are of uint8, from 0 to 255, not float64"),
        (
            np.zeros((0, 4, 3), np.uint8),
            {},
            ValueError,
            "a picture has the shape (height, width, 3), not (0, 4, 3)",
        ),
        (
            np.zeros((4, 4, 2), np.uint8),
            {},
            ValueError,
            "a picture has the shape (height, width, 3), not (4, 4, 2)",
        ),
        (
            np.zeros((2, 5000, 3), np.uint8),
            {},
            ValueError,
            "a picture as triangles has at most 4096 pixels a side, not 5000x2: scale it",
        ),
        (
            np.zeros((4, 4, 4), np.uint8),
            {},
            ValueError,
            "a picture as triangles is opaque: put it on a color first",
        ),
        (
            np.zeros((4, 4, 3), np.uint8),
            {"price": 0.0},
            ValueError,
            "a bit is worth a squared error above 0, not 0.0",
        ),
        (
            textured(64, 64),
            {"most_bytes": 5},
            ValueError,
            r"this picture as triangles has \d+ bytes at least, not 5",
        ),
    ],
)
def test_what_is_no_picture_is_refused(array, options, kind, text):
    with pytest.raises(kind) as caught:
        encode(array, **options)
    assert str(caught.value) == text or re.fullmatch(text, str(caught.value))


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"", "this is no picture as triangles of this version"),
        (b"dtr9\1\0\1\0\4....", "this is no picture as triangles of this version"),
        (b"dtr1\0\0\1\0\4....", "a picture as triangles is not 0x1 with step 4"),
        (b"dtr1\1\0\1\0\0....", "a picture as triangles is not 1x1 with step 0"),
        (b"dtr1\1\0\1\0\4..", "the file ends too early"),
    ],
)
def test_what_is_no_file_is_refused(data, text):
    with pytest.raises(CoderError) as caught:
        decode(data)
    assert str(caught.value) == text


def test_broken_files_end_with_an_error_or_a_picture():
    file = encode(textured(40, 40), price=100.0)
    for length in range(9, len(file), 60):
        with pytest.raises(CoderError, match="the file ends too early"):
            decode(file[:length])
    random = np.random.default_rng(9)
    for _ in range(25):
        broken = bytearray(file)
        broken[random.integers(9, len(file))] ^= int(random.integers(1, 256))
        with contextlib.suppress(CoderError):
            assert decode(bytes(broken)).shape == (40, 40, 3)
