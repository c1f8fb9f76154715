"""What is given in 64 bits stays in 64 bits: points, data and tables against closed forms."""

from __future__ import annotations

import array
import math

import numpy as np
import pytest
from scipy.optimize import minimize

from distal import Polygon, Polyline, Shape, Sphere, SvgPath
from distal.lang import Buffer, Texture2D, func, sample, sin, vec2, vec3

EPS = float(np.finfo(np.float64).eps)
NEAR = 1.0 + 1e-9  # a float32 rounds it to 1
POINT = (NEAR, 0.0, 0.0)
AWAY = NEAR - 1.0


def ulps(found, expected, size):
    """The largest error, in spacings of 64-bit numbers of the size of what was computed with."""
    return float(np.abs(np.asarray(found) - expected).max() / (EPS * size))


SINGLE = {
    "tuple": POINT,
    "list": [*POINT],
    "vec3": vec3(*POINT),
    "array": np.array(POINT),
    "longdouble": np.array(POINT, np.longdouble),
    "big-endian": np.array(POINT, ">f8"),
    "memory": array.array("d", POINT),
}


@pytest.mark.parametrize("point", SINGLE.values(), ids=SINGLE)
def test_one_point(point):
    assert Sphere(1.0)(point) == AWAY
    assert isinstance(Sphere(1.0)(point), float)
    assert Sphere(1.0).gradient(point).x == 1.0


ROWS = {
    "float64": (np.array([POINT, POINT]), np.float64),
    "longdouble": (np.array([POINT, POINT], np.longdouble), np.float64),
    "big-endian": (np.array([POINT, POINT], ">f8"), np.float64),
    "by columns": (np.array([POINT, POINT], order="F"), np.float64),
    "every second": (np.array([POINT] * 4)[::2], np.float64),
    "list": ([POINT, POINT], np.float64),
    "vectors": ([vec3(*POINT), vec3(*POINT)], np.float64),
    "grid": (np.array([[POINT, POINT]]), np.float64),
    "no points": (np.zeros((0, 3)), np.float64),
    "array of integers, no points": (np.zeros((0, 3), int), np.float64),
    "integers": (np.array([[2, 0, 0], [0, 3, 0]]), np.float64),
    "whole numbers": ([(2, 0, 0), (0, 3, 0)], np.float64),
    "float16": (np.array([[2, 0, 0]], np.float16), np.float64),
    "float32": (np.array([[2, 0, 0]], np.float32), np.float32),
    "big-endian float32": (np.array([[2, 0, 0]], ">f4"), np.float32),
    "grid of float32": (np.array([[[2, 0, 0]]], np.float32), np.float32),
    "no float32": (np.zeros((0, 3), np.float32), np.float32),
}


@pytest.mark.parametrize(("points", "dtype"), ROWS.values(), ids=ROWS)
def test_many_points(points, dtype):
    found, slope = Sphere(1.0)(points), Sphere(1.0).gradient(points)
    assert (found.dtype, slope.dtype) == (dtype, dtype)
    wide = np.asarray(points, np.float64)
    assert (found.shape, slope.shape) == (wide.shape[:-1], wide.shape)
    np.testing.assert_array_equal(found, np.sqrt((wide * wide).sum(-1)).astype(dtype) - dtype(1))


def test_an_empty_list_is_no_points():
    assert (Sphere(1.0)([]).shape, Sphere(1.0).gradient([]).shape) == ((0,), (0, 3))
    assert scaled([], [], []).shape == (0,)


@pytest.mark.parametrize("strange", ["complex128", "bool", "object"])
def test_arrays_that_are_no_numbers(strange):
    with pytest.raises(TypeError, match=rf"not take \(an array of shape \(1, 3\) of {strange}\)"):
        Sphere(1.0)(np.ones((1, 3), strange))


@func
def scaled(p: vec3, k: float, seed: int = 0) -> float:
    return k * p.x + float(seed)


SINGLE_ROW = np.array([[0.1, 0.0, 0.0]], np.float32)


@pytest.mark.parametrize(
    ("k", "seed", "dtype"),
    [
        (0.1, 0, np.float32),
        (1, 0, np.float32),
        (np.array([0.1], np.float32), np.array([1]), np.float32),  # for an int: no float
        (np.float64(0.1), 0, np.float64),
        (np.array([0.1]), 0, np.float64),
        (np.array([1]), 0, np.float64),
        ([0.1], 0, np.float64),
    ],
)
def test_beside_an_array_of_float32(k, seed, dtype):
    assert scaled(SINGLE_ROW, k, seed).dtype == dtype


def test_functions_of_the_language_and_of_integers():
    assert sin(0.1) == pytest.approx(math.sin(0.1), abs=EPS)
    assert scaled((0, 0, 0), 0.0, 7) == 7.0


def row_of_balls(count, offset):
    places = [offset + 0.1 + 3.3 * i for i in range(count)]
    balls = [Sphere(0.5).translate((x, 0.0, 0.0)) for x in places]
    return balls[0].union(balls[1:]) if count > 1 else balls[0], np.array(places)


@pytest.mark.parametrize("offset", [0.0, 1.0, 1000.0, 1e6])
@pytest.mark.parametrize("count", [1, 15, 16, 17, 40])
def test_unions_of_any_size(count, offset):
    shape, places = row_of_balls(count, offset)
    random = np.random.default_rng(count)
    points = random.uniform(-2.0, 3.3 * count, (300, 3)) * (1.0, 0.1, 0.1) + (offset, 0.0, 0.0)
    x = points[:, :1] - places
    distances = np.sqrt(x * x + (points[:, 1:] ** 2).sum(1)[:, None])
    nearest = distances.argmin(1)[:, None]
    ways = np.concatenate([np.take_along_axis(x, nearest, 1), points[:, 1:]], 1)
    slopes = ways / np.take_along_axis(distances, nearest, 1)
    # Differences of coordinates are exact to half a spacing here, of distances likewise.
    assert ulps(shape(points), distances.min(1) - 0.5, 1.0 + 0.5 * distances.min(1).max()) <= 4.0
    assert ulps(shape.gradient(points), slopes, 1.0) <= 8.0
    assert shape(tuple(points[0].tolist())) == shape(points)[0]


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_a_smooth_union_with_a_table(offset):
    places = [(0.31 * i + offset, 0.1 * math.sin(i), 0.07 * i) for i in range(60)]
    balls = [Sphere(0.21).translate(place) for place in places]
    shape = balls[0].union(balls[1:], smooth=0.02)
    points = np.random.default_rng(3).uniform(0.0, 1.0, (200, 3)) * (18.0, 0.2, 4.0)
    points[:, 0] += offset
    expected = np.linalg.norm(points - places[0], axis=1) - 0.21
    for place in places[1:]:
        other = np.linalg.norm(points - place, axis=1) - 0.21
        part = np.maximum(0.08 - np.abs(expected - other), 0.0) / 0.08
        expected = np.minimum(expected, other) - 0.02 * part * part
    assert ulps(shape(points), expected, 4.0) <= 4.0


@pytest.mark.parametrize("offset", [0.0, 1.0, 1000.0])
def test_polygons_lines_and_outlines(offset):
    corners = np.array([(0.1, 0.1), (1.1, 0.3), (0.7, 1.3)]) + offset
    polygon = Polygon(corners)
    assert ulps(polygon(corners), 0.0, 1.0 + offset) <= 1.0
    for shares in (0.1, 0.37):
        along = corners + shares * (np.roll(corners, -1, 0) - corners)
        assert ulps(polygon(along), 0.0, 1.0 + offset) <= 2.0
    far = corners[0] - (3.0, 4.0)
    assert ulps(polygon(far), 5.0, 5.0 + offset) <= 2.0
    edges = " L ".join(f"{x!r} {-y!r}" for x, y in corners.tolist())
    middle = 0.5 * (corners.min(0) + corners.max(0))
    assert ulps(SvgPath(f"M {edges} Z")(corners - middle), 0.0, 1.0 + offset) <= 2.0
    line = Polyline(corners, radius=0.125)
    assert ulps(line(corners[0] - (3.0, 4.0)), 4.875, 5.0 + offset) <= 2.0


NUMBERS = np.array([0.1, 1000.1, 3.3e7])
GIVEN = [NUMBERS, NUMBERS.tolist(), NUMBERS.astype(">f8"), NUMBERS.astype(np.longdouble)]


@pytest.mark.parametrize("data", GIVEN, ids=["array", "list", "big-endian", "longdouble"])
def test_buffers(data):
    table = Buffer(data)

    @func
    def entry(i: int) -> float:
        return table[i]

    assert entry(np.array([0, 1, 2])).tolist() == NUMBERS.tolist()


def test_pairs_and_textures():
    rows = np.array([[0.1, 0.2], [0.3, 0.4]])
    pairs = Buffer(rows)

    @func
    def pair(i: int) -> vec2:
        return pairs[i]

    assert pair([0, 1]).tolist() == rows.tolist()
    heights = Texture2D(np.full((2, 2), 0.1))
    single = Texture2D(np.full((2, 2), 0.1, np.float32))

    @func
    def height(p: vec2) -> float:
        return sample(heights, p).x

    @func
    def single_height(p: vec2) -> float:
        return sample(single, p).x

    assert height((0.3, 0.3)) == pytest.approx(0.1, abs=EPS)
    assert single_height((0.3, 0.3)) == pytest.approx(float(np.float32(0.1)), abs=EPS)


def test_pictures_read_the_same_numbers_of_32_bits():
    """A buffer of 64 bits is rounded where a kernel of 32 bits reads it."""
    shape, _ = row_of_balls(20, 1000.0)
    points = np.random.default_rng(1).uniform(-2.0, 60.0, (100, 3))
    points[:, 0] += 1000.0
    near = shape(points.astype(np.float32))
    assert near.dtype == np.float32
    off = np.abs(near - shape(points.astype(np.float32).astype(np.float64)))
    assert 1e-7 < off.max() < 1e-3


@pytest.mark.parametrize("read", [tuple, list, np.array, np.longdouble], ids=str)
def test_a_minimizer_moves(read):
    shape, places = row_of_balls(20, 1.0)
    target = (places[7], 0.0, 0.0)
    found = minimize(lambda p: shape(read(p)), (target[0] + 0.3, 0.2, -0.4), method="Nelder-Mead",
                     options={"xatol": 1e-9, "fatol": 1e-12})  # fmt: skip
    assert np.abs(found.x - target).max() < 1e-8
    slid = minimize(lambda p: shape(read(p)) ** 2, (target[0] + 1.0, 0.5, 0.5), tol=1e-12)
    assert slid.nit > 0 and slid.fun < 1e-12


@pytest.mark.parametrize("count", [12, 97])  # as a grid, and in bricks
def test_volumes(count):
    step = 1.0 / 64.0
    z, y, x = np.mgrid[0:count, 0:count, 0:count] * step
    tilt = np.array([0.3, -0.4, np.sqrt(0.75)])
    middle = 0.5 * (count - 1) * step
    plane = tilt[0] * (x - middle) + tilt[1] * (y - middle) + tilt[2] * (z - middle)
    points = np.random.default_rng(5).uniform(-0.02, 0.02, (50, 3))
    wide, single = (
        Shape.from_volume(plane.astype(dtype), spacing=step) for dtype in (np.float64, np.float32)
    )
    assert np.abs(wide(points) - points @ tilt).max() < 4e-16
    assert 1e-10 < np.abs(single(points) - points @ tilt).max() < 1e-7
