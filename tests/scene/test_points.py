"""Points along curves, on surfaces and in volumes: distances, densities, seeds."""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest

from distal import (
    Box,
    CapsuleBetween,
    Circle,
    Ellipsoid,
    Plane,
    Sphere,
    Torus,
    circle_path,
    helix_path,
    points_along,
    points_in,
    points_on,
)
from distal.lang import slider
from distal.scene.points import poisson
from distal.scene.points.regions import Random
from distal.scene.tree.errors import SceneTypeError, SceneValueError

# Kolmogorov's bound: a sample of independent points is beyond it once in 10,000 seeds; blue noise
# is more even than independent points.
KOLMOGOROV = 2.23
COUNT = 2000


def nearest_distances(points):
    """The distance of each point from its nearest neighbor, by comparing all pairs."""
    found = np.empty(len(points))
    for at in range(0, len(points), 256):
        part = points[at : at + 256]
        apart = np.linalg.norm(part[:, None] - points, axis=2)
        apart[np.arange(len(part)), np.arange(at, at + len(part))] = np.inf
        found[at : at + 256] = apart.min(axis=1)
    return found


def assert_distributed(values, cumulative):
    """Compare a sample with its distribution function, by the largest difference."""
    values = np.sort(values)
    expected = cumulative(values)
    ranks = np.arange(len(values) + 1) / len(values)
    largest = max(np.abs(ranks[1:] - expected).max(), np.abs(ranks[:-1] - expected).max())
    assert largest < KOLMOGOROV / math.sqrt(len(values))


# In boxes and solids


def test_points_in_a_box_are_even_on_each_axis():
    low, high = np.array([-1.0, 2.0, 0.5]), np.array([1.0, 2.5, 4.5])
    points = points_in((low, high), COUNT, seed=3)
    assert points.shape == (COUNT, 3)
    assert (points >= low).all()
    assert (points < high).all()
    for axis in range(3):
        assert_distributed((points[:, axis] - low[axis]) / (high - low)[axis], lambda v: v)


def test_points_in_a_ball_are_even():
    points = points_in(Sphere(1.5), COUNT, seed=1)
    radius = np.linalg.norm(points, axis=1)
    assert radius.max() <= 1.5 + 1e-6
    assert_distributed(radius / 1.5, lambda r: r**3)
    assert_distributed(points[:, 2] / 1.5, lambda z: 0.25 * (2.0 + 3.0 * z - z**3))


def test_points_in_a_plane():
    points = points_in(((-2.0, 0.5, -1.0), (2.0, 0.5, 1.0)), COUNT)
    assert (points[:, 1] == 0.5).all()
    assert_distributed(0.25 * (points[:, 0] + 2.0), lambda v: v)
    disk = points_in(Sphere(1.0), COUNT, within=((-1, 0, -1), (1, 0, 1)))
    assert (disk[:, 1] == 0.0).all()
    assert_distributed(np.linalg.norm(disk, axis=1), lambda r: r**2)
    line = points_in(((0.0, 0.0, 0.0), (3.0, 0.0, 0.0)), 100)
    assert (line[:, 1:] == 0.0).all()


# On surfaces


def on_sphere(count=COUNT, **given):
    return points_on(Sphere(1.0), count, **given)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_points_on_a_sphere_are_even(seed):
    """The area between two heights is in proportion to their difference (Archimedes)."""
    points, normals = on_sphere(seed=seed)
    for axis in range(3):
        assert_distributed(0.5 * (points[:, axis] + 1.0), lambda v: v)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose(normals, points, atol=1e-5)


def test_points_on_a_torus_have_the_density_of_its_area():
    """Around the tube, the area is in proportion to the distance from the axis."""
    points, _ = points_on(Torus(1.0, 0.4), COUNT)
    away = np.hypot(points[:, 0], points[:, 2]) - 1.0
    angle = np.arctan2(points[:, 1], away) % math.tau
    assert_distributed(angle, lambda a: (a + 0.4 * np.sin(a)) / math.tau)


def test_points_on_a_box_are_shared_by_area():
    points, normals = points_on(Box(1.0, 2.0, 3.0), COUNT)
    for axis, area in enumerate((6.0, 3.0, 2.0)):
        share = np.mean(np.abs(normals[:, axis]) > 0.99)
        assert share == pytest.approx(2.0 * area / 22.0, abs=0.02)
    on = np.abs(points) / (0.5, 1.0, 1.5)
    np.testing.assert_allclose(on.max(axis=1), 1.0, atol=1e-5)


def test_a_field_that_is_no_distance_is_sampled_by_area_too():
    """The value of an ellipsoid is a bound: its gradient differs from 1."""
    shape = Ellipsoid((1.0, 0.4, 1.0))
    points, _ = points_on(shape, COUNT)
    eccentricity = math.sqrt(1.0 - 0.4**2)

    def area(y):  # of an oblate spheroid up to a height, by its own closed form
        s = eccentricity / 0.4**2 * y
        return 0.5 * (s * np.sqrt(1.0 + s * s) + np.arcsinh(s))

    assert_distributed(points[:, 1], lambda y: (area(y) + area(0.4)) / (2.0 * area(0.4)))
    assert np.abs(shape(points)).max() <= 1e-5


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(1.0).union(Box(1.2).translate(0.8, 0, 0), smooth=0.2),
        Box(1.0).twist(1.0),
        Torus(1.0, 0.2) - Box(1.0).translate(1.0, 0.0, 0.0),
        Sphere(50.0).translate(100.0, 0.0, 0.0),
        Sphere(0.01),
        CapsuleBetween((0, 0, 0), (3, 0.1, 0.2), 0.02),
    ],
)
def test_points_are_on_the_surface_with_its_normals(shape):
    points, normals = points_on(shape, 300)
    assert points.shape == normals.shape == (300, 3)
    assert np.abs(shape(points)).max() <= 1e-5
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)
    low, high = shape.bounds()
    step = 1e-3 * float(np.max(np.subtract(high, low)))
    outwards = shape(points + step * normals) > shape(points - step * normals)
    assert outwards.mean() > 0.98  # not where two surfaces meet


def test_infinite_surfaces_are_sampled_within_a_box():
    points, normals = points_on(Plane(), 500, within=((-2, -1, -3), (2, 1, 3)))
    np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-6)
    np.testing.assert_allclose(normals, np.tile((0.0, 1.0, 0.0), (500, 1)), atol=1e-6)
    assert_distributed(0.25 * (points[:, 0] + 2.0), lambda v: v)
    assert_distributed((points[:, 2] + 3.0) / 6.0, lambda v: v)


# Blue noise

SPACED = {
    "box": lambda **given: points_in(((0, 0, 0), (1, 1, 1)), **given),
    "square": lambda **given: points_in(((0, 0, 0), (1, 0, 1)), **given),
    "ball": lambda **given: points_in(Sphere(0.6), **given),
    "sphere": lambda **given: points_on(Sphere(0.3), **given)[0],
}


@pytest.mark.parametrize("name", SPACED)
def test_points_keep_their_spacing(name):
    points = SPACED[name](spacing=0.05, seed=5)
    apart = nearest_distances(points)
    assert apart.min() >= 0.05 - 1e-9
    # No candidate is left: hardly any point could be added, and most are close to others.
    assert np.median(apart) < 1.2 * 0.05


@pytest.mark.parametrize("name", SPACED)
def test_a_count_is_spaced_as_far_as_it_may(name):
    points = SPACED[name](count=1000)
    assert len(points) == 1000
    least = nearest_distances(points).min()
    # Independent points would come within a hundredth of this distance.
    size = {"box": 1.0, "square": 1.0, "ball": 0.904779, "sphere": 1.130973}[name]
    dimensions = 2 if name in ("square", "sphere") else 3
    assert least > 0.8 * poisson.distance_for(1000, size, dimensions)


@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_the_count_is_exact(count):
    assert len(points_in(((0, 0, 0), (1, 1, 1)), count)) == count
    assert len(points_on(Sphere(1.0), count)[0]) == count


def test_the_choice_is_that_of_one_by_one():
    """The parallel form keeps the candidates that dart throwing keeps, one after the other."""
    candidates = np.random.default_rng(4).uniform(0, 1, (600, 2))
    kept = []
    for at, point in enumerate(candidates):
        if all(np.linalg.norm(point - candidates[k]) >= 0.06 for k in kept):
            kept.append(at)
    np.testing.assert_array_equal(poisson.kept_with_distance(candidates, 0.06), kept)


def test_near_pairs_are_all_pairs():
    points = np.random.default_rng(5).normal(size=(300, 3))
    first, second, apart = poisson.near_pairs(points, 0.4)
    distances = np.linalg.norm(points[:, None] - points, axis=2)
    expected = {(i, j) for i, j in np.argwhere(distances < 0.4) if i < j}
    assert set(zip(first.tolist(), second.tolist(), strict=True)) == expected
    assert len(first) == len(expected)
    np.testing.assert_allclose(apart, distances[first, second])


# Seeds


def test_a_seed_gives_the_same_points():
    one, two, other = on_sphere(200)[0], on_sphere(200)[0], on_sphere(200, seed=1)[0]
    np.testing.assert_array_equal(one, two)
    assert np.abs(one - other).max() > 0.1


def test_random_numbers_never_change():
    """The bits are those of PCG64, so that a scene is the same on every machine and version."""
    numbers = Random(7).fractions(1000, 4)
    assert numbers[0].tolist() == [
        0.625095466604667,
        0.8972138009695755,
        0.7756856902451935,
        0.22520718999059186,
    ]
    digest = hashlib.sha256(numbers.astype("<f8").tobytes()).hexdigest()
    assert digest[:16] == "2244fb63a4efdfae"
    points = np.round(points_in(((0, 0, 0), (1, 1, 1)), 50, seed=7), 9)
    assert hashlib.sha256(points.astype("<f8").tobytes()).hexdigest()[:16] == "32a293f5c0df9138"


# Along curves


def test_points_along_a_polyline():
    points, tangents = points_along([(0, 0, 0), (2, 0, 0), (2, 0, 0), (2, 2, 0)], 5)
    expected = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 2, 0)]
    np.testing.assert_allclose(points, expected, atol=1e-12)
    np.testing.assert_allclose(tangents[[0, 1, 3, 4]], [(1, 0, 0)] * 2 + [(0, 1, 0)] * 2)


def test_a_closed_polyline_has_no_point_twice():
    square = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), (0, 0, 0)]
    points, _ = points_along(square, 8)
    assert len(np.unique(points.round(9), axis=0)) == 8
    np.testing.assert_allclose(nearest_distances(points), 0.5)


def test_points_along_a_circle_are_a_polygon():
    points, tangents = points_along(circle_path(2.0, center=(1, 2, 3)), 12)
    np.testing.assert_allclose(np.linalg.norm(points - (1, 2, 3), axis=1), 2.0)
    np.testing.assert_allclose(points[:, 1], 2.0)
    np.testing.assert_allclose(nearest_distances(points), 4.0 * math.sin(math.pi / 12), rtol=1e-6)
    np.testing.assert_allclose((tangents * (points - (1, 2, 3))).sum(axis=1), 0.0, atol=1e-6)
    # Counterclockwise seen from above.
    turned = np.cross(points[0] - (1, 2, 3), tangents[0])
    np.testing.assert_allclose(turned, (0, 2, 0), atol=1e-6)


@pytest.mark.parametrize("normal", [(1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (1, -2, 3)])
def test_a_circle_has_any_normal(normal):
    points, tangents = points_along(circle_path(0.5, normal=normal), 7)
    unit = np.array(normal) / np.linalg.norm(normal)
    np.testing.assert_allclose(points @ unit, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(points, tangents), np.tile(0.5 * unit, (7, 1)), atol=1e-6)


def test_points_along_a_helix_have_its_slope():
    points, tangents = points_along(helix_path(1.0, height=3.0, turns=2.0), spacing=0.1)
    length = math.hypot(2.0 * math.tau, 3.0)
    assert len(points) == round(length / 0.1) + 1
    np.testing.assert_allclose(points[[0, -1], 1], [0.0, 3.0], atol=1e-9)
    np.testing.assert_allclose(np.diff(points[:, 1]), 3.0 / round(length / 0.1), rtol=1e-5)
    np.testing.assert_allclose(tangents[:, 1], 3.0 / length, rtol=1e-5)


def test_a_function_is_sampled_by_length_not_by_t():
    points, tangents = points_along(lambda t: (t**3, 0.0, 0.0), 11)
    np.testing.assert_allclose(points[:, 0], np.linspace(0, 1, 11), atol=2e-6)
    np.testing.assert_allclose(tangents, np.tile((1.0, 0.0, 0.0), (11, 1)), atol=1e-9)


def test_one_point_is_the_start():
    points, _ = points_along([(1, 2, 3), (4, 5, 6)], 1)
    np.testing.assert_array_equal(points, [(1, 2, 3)])


# Errors

LINE = [(0, 0, 0), (1, 0, 0)]
ERRORS = {
    "both": (
        lambda: points_on(Sphere(), 10, spacing=0.1),
        "points_on takes either count or spacing",
    ),
    "neither": (lambda: points_in(Sphere()), "points_in takes either count or spacing"),
    "neither along": (lambda: points_along(LINE), "points_along takes either count or spacing"),
    "no count": (
        lambda: points_in(Sphere(), 0),
        "'count of points_in' is from 1 to 1,000,000, not 0",
    ),
    "half a count": (
        lambda: points_in(Sphere(), 1.5),
        "'count of points_in' takes a whole number, not float 1.5",
    ),
    "no spacing": (
        lambda: points_on(Sphere(), spacing=0),
        "'spacing of points_on' must be above 0, not 0",
    ),
    "a moving spacing": (
        lambda: points_on(Sphere(), spacing=slider("Spacing", 0.1, low=0.01)),
        "'spacing of points_on' is a plain number, not an expression",
    ),
    "a tiny spacing": (
        lambda: points_in(((0, 0, 0), (1, 1, 1)), spacing=1e-3),
        "a spacing of 0.001 gives about 763,943,727 points; 1,000,000 are the most",
    ),
    "a negative seed": (
        lambda: points_in(Sphere(), 10, seed=-1),
        "'seed of points_in' is from 0 to 2,147,483,647, not -1",
    ),
    "no end": (lambda: points_on(Plane(), 10), "points_on: the box of Plane has no end"),
    "no surface": (
        lambda: points_on(Sphere(), 10, within=((2, 2, 2), (3, 3, 3))),
        "points_on found no surface there",
    ),
    "no inside": (
        lambda: points_in(Sphere(), 10, within=((2, 2, 2), (3, 3, 3))),
        "points_in found no inside there",
    ),
    "one corner": (
        lambda: points_in((1, 2, 3), 10),
        "points_in takes a box as two corners, not (1, 2, 3)",
    ),
    "corners in the wrong order": (
        lambda: points_in(((1, 0, 0), (0, 1, 1)), 10),
        "points_in: nothing lies between (1, 0, 0) and (0, 1, 1): the low corner comes first",
    ),
    "a flat box": (
        lambda: points_on(Sphere(), 10, within=((-1, 0, -1), (1, 0, 1))),
        "points_on needs a box with three sides above 0",
    ),
    "a flat shape": (
        lambda: points_on(Circle(), 10),
        "points_on takes a solid shape, not Circle(radius=1.0)",
    ),
    "no curve": (
        lambda: points_along(3, 10),
        "'curve of points_along' takes a list or an array, not int 3",
    ),
    "a curve of one point": (lambda: points_along([(0, 0, 0)], 10), "the curve has no length"),
    "a curve that stands still": (
        lambda: points_along(lambda t: (min(t, 0.5), 0.0, 0.0), 3, spacing=None),
        "the curve has no direction at t = 1: it does not move there",
    ),
    "a curve of numbers": (
        lambda: points_along(lambda t: t, 3),
        "a curve returns three numbers, not 0.0 as at t = 0",
    ),
    "a curve that is not finite": (
        lambda: points_along(lambda t: (t, math.inf, 0.0), 3),
        "the curve is not finite at t = 0: (0.0, inf, 0.0)",
    ),
    "no radius": (lambda: circle_path(0.0), "'radius of circle_path' must be above 0, not 0"),
    "no normal": (
        lambda: circle_path(1.0, normal=(0, 0, 0)),
        "'normal of circle_path' has no direction: it is zero",
    ),
    "no helix": (lambda: helix_path(-1.0), "'radius of helix_path' must be above 0, not -1"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_are_at_the_authors_line(name):
    make, message = ERRORS[name]
    with pytest.raises((SceneTypeError, SceneValueError)) as caught:
        make()
    (found,) = caught.value.diagnostics
    assert found.message.partition(", test_points.py:")[0] == message
    assert found.span is not None
    assert found.span.file == __file__
