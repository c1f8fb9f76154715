"""Directions and points made of the unit square: uniform, or as dense as their density says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.render import microfacets
from distal.render.sampling import warps
from tests.paths.counting import (
    SURPRISING,
    counted,
    deviation,
    directions_of,
    expected_in_cells,
    places_of,
)

COUNT = 1 << 16


def square(count=COUNT, seed=11):
    return np.random.default_rng(seed).random((count, 2)).astype(np.float32)


def agrees(directions, density, rows=24, columns=16, fine=24):
    found = counted(places_of(directions), rows, columns)
    expected = expected_in_cells(density, rows, columns, fine) * len(directions)
    return deviation(found, expected) < SURPRISING


NORMALS = [
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
    (1e-4, 2e-4, -0.999999975),
    (-2e-4, 1e-4, 0.999999975),
    (0.6, 0.8, 0.0),
    (-0.48, 0.6, -0.64),
    (0.6, -0.8, -1e-9),
]


@pytest.mark.parametrize("n", NORMALS)
def test_axes_are_orthogonal_and_right_handed(n):
    axes = warps.axes_about(n)
    found = np.array([axes.s, axes.t, axes.n], float)
    assert found @ found.T == pytest.approx(np.eye(3), abs=3e-7)
    assert np.linalg.det(found) == pytest.approx(1.0, abs=3e-7)
    v = np.asarray(warps.into_space(axes, (0.2, -0.3, 0.5)))
    assert np.asarray(warps.along_axes(axes, tuple(v))) == pytest.approx((0.2, -0.3, 0.5), abs=3e-7)


def test_a_disc_is_uniform_and_keeps_neighbors():
    found = np.asarray(warps.on_disc(square()), float)
    radius = np.hypot(found[:, 0], found[:, 1])
    assert radius.max() <= 1 + 1e-6
    turn = np.arctan2(found[:, 1], found[:, 0]) / (2 * math.pi) % 1.0
    cells = counted(np.stack([np.minimum(radius**2, 1 - 1e-9), turn], 1), 16, 16)
    assert deviation(cells, np.full(256, COUNT / 256)) < SURPRISING
    step = np.float32(1e-3)
    u = square(2000) * (1 - step)
    moved = np.asarray(warps.on_disc(u + np.array([step, 0], np.float32)), float)
    far = np.hypot(*(moved - np.asarray(warps.on_disc(u), float)).T)
    assert far.max() < 4 * step
    assert tuple(np.asarray(warps.on_disc((0.5, 0.5)))) == (0.0, 0.0)


def test_the_cosine_hemisphere():
    found = np.asarray(warps.in_cosine_hemisphere(square()))
    assert np.linalg.norm(found, axis=1) == pytest.approx(1, abs=1e-6)
    assert found[:, 2].min() >= 0
    assert agrees(found, lambda d: np.asarray(warps.cosine_density(d[:, 2])))


def test_the_sphere():
    found = np.asarray(warps.on_sphere(square()))
    assert np.linalg.norm(found, axis=1) == pytest.approx(1, abs=1e-6)
    assert agrees(found, lambda d: np.full(len(d), 1 / (4 * math.pi)))


@pytest.mark.parametrize("angle", [1e-5, 0.00465, 0.3, 1.5, 3.0])
def test_a_cone_is_uniform_by_solid_angle(angle):
    """The height above the rim and the turn are uniform; the density is one over the area."""
    narrow = 2 * math.sin(angle / 2) ** 2
    found = np.asarray(warps.in_cone(square(), narrow), float)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1, abs=1e-6)
    level = np.hypot(found[:, 0], found[:, 1])
    down = 2 * np.sin(0.5 * np.arctan2(level, found[:, 2])) ** 2 / narrow
    assert down.max() <= 1 + 1e-5
    turn = np.arctan2(found[:, 1], found[:, 0]) / (2 * math.pi) % 1.0
    cells = counted(np.stack([np.minimum(down, 1 - 1e-9), turn], 1), 16, 16)
    assert deviation(cells, np.full(256, COUNT / 256)) < SURPRISING
    area = 2 * math.pi * narrow
    assert warps.cone_density(narrow) * area == pytest.approx(1, rel=1e-5)


@pytest.mark.parametrize("angle", [1e-6, 1e-3, 0.5, 1.5])
def test_narrowness_is_one_minus_the_cosine(angle):
    found = warps.narrowness(math.sin(angle) ** 2)
    assert found == pytest.approx(2 * math.sin(angle / 2) ** 2, rel=1e-5)


def visible_density(view, alpha):
    """Visible normals as Heitz (2014) writes them, by Smith's Lambda."""

    def density(d):
        cosine = view[2]
        tangent = (1 - cosine**2) / cosine**2
        masked = 1 / (1 + 0.5 * (math.sqrt(1 + alpha**2 * tangent) - 1))
        z = np.maximum(d[:, 2].astype(float), 1e-3)
        slope = (1 - z**2) / (z * alpha) ** 2
        facets = 1 / (math.pi * (alpha * z**2 * (1 + slope)) ** 2)
        facing = np.maximum(d @ np.array(view), 0)
        return np.where(d[:, 2] > 0, masked * facing * facets / cosine, 0.0)

    return density


@pytest.mark.parametrize("alpha", [0.15, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.05])
def test_visible_facets(alpha, cosine):
    view = (math.sqrt(1 - cosine**2), 0.0, cosine)
    found = np.asarray(warps.visible_facet(view, alpha, square()))
    assert np.linalg.norm(found, axis=1) == pytest.approx(1, abs=1e-6)
    assert (found @ np.array(view)).min() > -1e-5
    assert agrees(found, visible_density(view, alpha), 48, 16, 48)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 1.0])
def test_facets_cover_the_surface(alpha):
    """The projected area of all facets is that of the surface: by the tangent, in closed form."""
    share = (np.arange(4000) + 0.5) / 4000
    tangent = alpha * np.sqrt(share / (1 - share))
    z = 1 / np.sqrt(1 + tangent**2)
    facets = np.stack([np.sqrt(1 - z**2), 0 * z, z], 1).astype(np.float32)
    found = np.asarray(microfacets.facet_density(facets, alpha), float)
    # d(tan^2) per share, and the solid angle pi z^3 d(tan^2) ... times z for the projection.
    width = alpha**2 / (1 - share) ** 2
    assert (found * math.pi * z**4 * width).mean() == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("alpha", [1e-4, 1e-3])
def test_sharp_facets_keep_their_digits(alpha):
    tangent = np.array([0.0, 0.5, 1.0, 3.0]) * alpha
    z = 1 / np.sqrt(1 + tangent**2)
    facets = np.stack([tangent * z, 0 * z, z], 1).astype(np.float32)
    found = np.asarray(microfacets.facet_density(facets, alpha), float)
    expected = 1 / (math.pi * alpha**2 * z**4 * (1 + (tangent / alpha) ** 2) ** 2)
    assert found == pytest.approx(expected, rel=1e-5)


def test_directions_of_cells_and_back():
    rng = np.random.default_rng(2)
    cells = rng.random((100, 2))
    assert places_of(directions_of(cells)) == pytest.approx(cells, abs=1e-5)
