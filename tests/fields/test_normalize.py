"""Badly scaled functions, normalized: about the distance near the surface, at any scale."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import Box, Scene, Shape, Shape2D
from distal.lang import dot, floor, func, slider, vec2, vec3
from distal.scene.checks.validation import check
from tests.fields.seeds import seed_of

BOX = ((-1.1,) * 3, (1.1,) * 3)
TANGLE_BOX = ((-2.5,) * 3, (2.5,) * 3)


@func
def ball(p: vec3, factor: float) -> float:
    return factor * (dot(p, p) - 1.0)


@func
def disc(p: vec2) -> float:
    return 40.0 * (dot(p, p) - 1.0)


@func
def tangle(p: vec3) -> float:
    """Goursat's quartic with seven holes: its gradient vanishes at 27 points off the surface."""
    q = p * p
    return dot(q, q) - 5.0 * (q.x + q.y + q.z) + 11.8


@func
def steps(p: vec3) -> float:
    return floor(p.x) + floor(p.y)


@func
def by_cell(p: vec3, cell: vec3) -> float:
    return 9.0 * (dot(p, p) - 0.04 - 0.01 * cell.x)


def points(box, count, name):
    return np.random.default_rng(seed_of(name)).uniform(*box, (count, 3)).astype(np.float32)


@pytest.mark.parametrize("factor", [1.0, 1e4, 1e-4, 1e25, 1e-25])
def test_the_scale_of_the_function_does_not_matter(factor):
    p = points(BOX, 4000, "normalized balls")
    away = np.linalg.norm(p, axis=1) - 1.0
    value = Shape.from_function(ball, factor=factor, normalize=True, bounds=BOX)(p)
    # To first order the distance; (r^2 - 1) / 2r differs from r - 1 by (r - 1)^2 / 2r.
    near = np.abs(away) < 0.1
    assert np.abs(value - away)[near].max() < 0.006
    # Never more than the distance, and never larger than the box allows.
    assert (value - away).max() < 1e-6
    assert value.min() >= -1.1


def test_without_bounds_values_are_at_most_1():
    p = points(((-9.0,) * 3, (9.0,) * 3), 2000, "normalized without bounds")
    value = Shape.from_function(ball, factor=50.0, normalize=True)(p)
    assert np.abs(value).max() <= 1.0
    assert value[np.linalg.norm(p, axis=1) > 3.0].min() > 0.6


def test_gradients_on_the_surface_have_length_1():
    p = points(BOX, 500, "normals of normalized balls").astype(np.float64)
    p /= np.linalg.norm(p, axis=1)[:, None]
    shape = Shape.from_function(ball, factor=-7.0, normalize=True, bounds=((-3.0,) * 3, (3.0,) * 3))
    np.testing.assert_allclose(shape.gradient(p), -p, atol=1e-9)


def test_a_vanishing_gradient_makes_no_long_step():
    shape = Shape.from_function(tangle, normalize=True, bounds=TANGLE_BOX)
    p = points(TANGLE_BOX, 20000, "tangle")
    values = shape(p)
    assert np.isfinite(values).all()
    critical = np.array([[0, 0, 0], [2.5**0.5, 0, 0], [2.5**0.5, 2.5**0.5, 0]], np.float32)
    assert (np.abs(shape(critical)) <= 2.5).all()
    # Where rays march, outside, a step of the value hardly ever crosses the surface: 0.9 %
    # of steps in random directions do.
    outside = p[values > 0.0].astype(np.float64)
    rng = np.random.default_rng(1)
    way = rng.normal(size=outside.shape)
    way /= np.linalg.norm(way, axis=1)[:, None]
    ends = outside + shape(outside)[:, None] * way
    assert (np.asarray(Shape.from_function(tangle)(ends)) < 0.0).mean() < 0.02


def test_the_slope_is_an_estimate_or_the_authors():
    estimated = Shape.from_function(ball, factor=3.0, normalize=True, bounds=BOX)
    assert (estimated.slope, estimated.node.estimate) == (1.0, True)
    found = check(estimated)
    assert found.holds
    assert [f.diagnostic.code for f in found.findings if f.severity.value == "warning"] == [
        "slope-exceeded"
    ]
    given = Shape.from_function(ball, factor=3.0, normalize=True, bounds=BOX, slope=1.5)
    assert (given.slope, given.node.estimate) == (1.5, False)
    assert check(given).holds


def test_flat_functions_cells_and_parameters():
    rectangle = ((-1.2, -1.2), (1.2, 1.2))
    flat = Shape2D.from_function(disc, normalize=True, bounds=rectangle)
    assert flat((1.1, 0.0)) == pytest.approx(0.1, abs=0.01)
    assert flat.extrude(0.5)((0.0, 0.0, 0.35)) == pytest.approx(0.1, abs=0.01)
    balls = Shape.from_function(by_cell, normalize=True, bounds=((-0.4,) * 3, (0.4,) * 3))
    row = balls.repeat(1.0, count=(3, 1, 1))
    for cell in (-1, 0, 1):
        radius = (0.04 + 0.01 * (cell + 1)) ** 0.5
        assert row((cell, radius + 0.02, 0.0)) == pytest.approx(0.02, abs=2e-3)
    factor = slider("Factor", 1.0, low=0.1, high=100.0)
    own = Shape.from_function(ball, factor=factor, normalize=True, bounds=BOX)
    assert own((0.0, 1.05, 0.0), params={"Factor": 90.0}) == pytest.approx(0.05, abs=2e-3)


def test_a_function_without_a_gradient_is_refused():
    with pytest.raises(ValueError, match="'steps' has no gradient at any of 64 places") as raised:
        Shape.from_function(steps, normalize=True)
    assert "not one made by floor, round or comparisons" in str(raised.value)
    with pytest.raises(ValueError, match="'ball' cannot be both exact and normalized"):
        Shape.from_function(ball, factor=1.0, normalize=True, exact=True)


@pytest.mark.parametrize("target", ["wgsl", "glsl-es300", "glsl-es100"])
def test_all_targets_take_it(target):
    own = Shape.from_function(ball, factor=4.0, normalize=True, bounds=BOX)
    twice = own.translate(1.0, 0.0, 0.0) | own | Box(0.5)
    assert "normalized_within" in distal.compile(Scene(twice), target=target).text
