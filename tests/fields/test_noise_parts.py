"""Noise put together again from its parts: measured at its lattice's points, computed between them.

What a lattice's point adds is measured where it is alone; that the noise between is the blend its
source tells is computed from these measurements, over all points around.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from distal.fields import ease
from distal.fields.noise import lattice as noise_lattice
from distal.fields.noise import plane as noise_flat
from distal.fields.noise import space as noise
from distal.fields.noise import voronoi
from tests.fields.test_tiers_noise import MASK, pcg

TINY = 1e-4
SEED = 3


def around(size: int, reach: int) -> np.ndarray:
    return np.array(list(itertools.product(range(-reach, reach + 1), repeat=size)), np.float64)


def places(size: int, count: int = 200) -> np.ndarray:
    return np.random.default_rng(size).uniform(-20.0, 20.0, (count, size))


def gradients_at(function: Any, points: np.ndarray) -> np.ndarray:
    """By differences across each point: what it is linear in there."""
    found = np.empty_like(points)
    for axis, step in enumerate(np.eye(points.shape[1]) * TINY):
        found[:, axis] = (function(points + step, SEED) - function(points - step, SEED)) / 2 / TINY
    return found


def blended(p: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """The weight of a corner: Perlin's quintic of each distance, multiplied."""
    t = 1.0 - np.abs(p - corner)
    return np.where(t > 0.0, t**3 * (t * (6.0 * t - 15.0) + 10.0), 0.0).prod(axis=1)


@pytest.mark.parametrize("size", [3, 2])
def test_value_noise_blends_its_corners(size: int) -> None:
    p = places(size)
    corners = [np.floor(p) + o for o in around(size, 1)]
    wanted = sum(blended(p, c) * noise.value_noise(c, SEED) for c in corners)
    np.testing.assert_allclose(noise.value_noise(p, SEED), wanted, atol=1e-12)


def test_the_hash_of_the_plane_is_the_one_that_is_written_down() -> None:
    cells = np.random.default_rng(0).integers(-1000, 1000, (200, 2))
    start = SEED * 2654435769
    bits = [pcg((int(x) + pcg((int(y) + start) & MASK)) & MASK) for x, y in cells]
    wanted = [2.0 * (b >> 8) / 2**24 - 1 for b in bits]
    np.testing.assert_array_equal(noise.value_noise(cells.astype(np.float64), SEED), wanted)


@pytest.mark.parametrize("size", [3, 2])
def test_gradient_noise_blends_the_ramps_of_its_corners(size: int) -> None:
    p = places(size)
    wanted = np.zeros(len(p))
    for offset in around(size, 1):
        corner = np.floor(p) + offset
        assert np.abs(noise.gradient_noise(corner, SEED)).max() == 0.0
        ramp = (gradients_at(noise.gradient_noise, corner) * (p - corner)).sum(axis=1)
        wanted += blended(p, corner) * ramp
    # A quintic's own bend beside the corner: 10 of its cubes times a ramp.
    np.testing.assert_allclose(noise.gradient_noise(p, SEED), wanted, atol=100 * TINY**2)


@pytest.mark.parametrize("size", [3, 2])
def test_simplex_noise_sums_the_kernels_of_all_points_around(size: int) -> None:
    p = places(size)
    skew = (np.sqrt(size + 1.0) - 1.0) / size
    unskew = (1.0 - 1.0 / np.sqrt(size + 1.0)) / size
    cells = np.floor(p + skew * p.sum(axis=1, keepdims=True))
    wanted = np.zeros(len(p))
    for offset in around(size, 2):
        cell = cells + offset
        point = cell - unskew * cell.sum(axis=1, keepdims=True)
        assert np.abs(noise.simplex_noise(point, SEED)).max() < 1e-12
        d = p - point
        kernel = np.maximum(0.5 - (d * d).sum(axis=1), 0.0) ** 4 / 0.5**4
        wanted += kernel * (gradients_at(noise.simplex_noise, point) * d).sum(axis=1)
    np.testing.assert_allclose(noise.simplex_noise(p, SEED), wanted, atol=2000 * TINY**2)


@pytest.mark.parametrize(
    ("function", "size", "scale", "count"),
    [
        (noise.gradient_noise, 3, noise.GRADIENT_SCALE, 12),
        (noise.gradient_noise, 2, noise_flat.GRADIENT_SCALE_2, 8),
    ],
    ids=["space", "plane"],
)
def test_every_direction_of_a_ramp_is_as_likely(
    function: Any, size: int, scale: float, count: int
) -> None:
    corners = np.random.default_rng(1).integers(-1000, 1000, (6000, size)).astype(np.float64)
    found = np.round(gradients_at(function, corners) / scale, 3) + 0.0
    directions, times = np.unique(found, axis=0, return_counts=True)
    assert len(directions) == count
    # As the corners of a cube's edges, and of an octagon turned by half a corner, lie.
    lengths = np.linalg.norm(directions, axis=1)
    np.testing.assert_allclose(lengths, np.sqrt(2.0) if size == 3 else 1.0, atol=2e-3)
    np.testing.assert_allclose(directions.sum(axis=0), 0.0, atol=1e-9)
    expected = len(corners) / count
    assert np.abs(times - expected).max() < 5.0 * np.sqrt(expected)  # five standard deviations


@pytest.mark.parametrize(
    ("octave", "size", "turns"),
    [(noise_lattice.next_octave, 3, 6), (noise_lattice.next_octave_2, 2, None)],
    ids=["space", "plane"],
)
def test_an_octave_is_turned_and_moved(octave: Any, size: int, turns: int | None) -> None:
    shift = octave(np.zeros((1, size)))[0]
    turn = (octave(np.eye(size)) - shift).T
    np.testing.assert_allclose(turn @ turn.T, np.eye(size), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    # No lattice coincides: neither a corner nor an axis lands on one.
    assert np.abs(shift - np.round(shift)).min() > 0.2
    assert np.abs(turn).max() < 0.9
    if turns is not None:
        np.testing.assert_allclose(turn @ np.ones(size), 1.0, atol=1e-12)
        powers = [np.linalg.matrix_power(turn, k) for k in range(1, turns + 1)]
        whole = [np.allclose(power, np.eye(size)) for power in powers]
        assert whole == [False] * (turns - 1) + [True]


@pytest.mark.parametrize("size", [3, 2])
def test_fractal_noise_sums_its_octaves(size: int) -> None:
    octave = noise_lattice.next_octave if size == 3 else noise_lattice.next_octave_2
    p = places(size)
    numbers = {"octaves": 4, "lacunarity": 1.9, "gain": 0.7, "seed": SEED}
    layers, q = [], p
    for i in range(4):
        layers.append(0.7**i * noise.gradient_noise(q, SEED + i))
        q = octave(1.9 * q)
    whole = sum(0.7**i for i in range(4))
    np.testing.assert_allclose(noise.fbm(p, **numbers), sum(layers) / whole, atol=1e-9)
    wanted = sum(map(np.abs, layers)) / whole
    np.testing.assert_allclose(noise.turbulence(p, **numbers), wanted, atol=1e-9)


def test_the_slope_of_fractal_noise_is_the_weighted_sum_of_its_octaves() -> None:
    steep = sum(0.7**i * 1.9**i for i in range(4)) / sum(0.7**i for i in range(4))
    found = noise.fbm_slope(4, 1.9, 0.7)
    assert found == pytest.approx(noise.GRADIENT_SLOPE * steep, rel=1e-6)


# Cells in the plane, against all points around


def scattered(cell: np.ndarray, jitter: float) -> np.ndarray:
    row = pcg((int(cell[1]) + SEED * 2654435769) & MASK)
    bits = pcg((int(cell[0]) + row) & MASK)
    return cell + 0.5 + jitter * (np.array([bits & 65535, bits >> 16]) / 65536.0 - 0.5)


@pytest.mark.parametrize("jitter", [0.0, 0.6, 1.0])
def test_cells_of_the_plane_against_all_points_around(jitter: float) -> None:
    limit = 1.5 - 0.5 * jitter
    for p in places(2, 60):
        points = np.array([scattered(np.floor(p) + o, jitter) for o in around(2, 2)])
        points = points[np.argsort(np.linalg.norm(points - p, axis=1))]
        away = np.linalg.norm(points - p, axis=1)
        assert voronoi.worley(p[None], jitter, SEED)[0] == pytest.approx(min(away[0], limit))
        across = points[1:] - points[0]
        middle = 0.5 * (points[1:] + points[0]) - p
        borders = (middle * across).sum(axis=1) / np.linalg.norm(across, axis=1)
        found = voronoi.voronoi_border(p[None], jitter, SEED)[0]
        assert found <= borders.min() + 1e-9
        wanted = min(borders.min(), max(0.5 * (limit - away[0]), 0.0))
        assert found == pytest.approx(wanted, abs=1e-9)


# Ways from 0 to 1

T = np.linspace(0.0, 1.0, 41)
AT_REST = {ease.SMOOTH: (1, 1), ease.SMOOTHER: (2, 2), ease.SINE: (1, 1), ease.CUBIC: (2, 2)}
AT_REST |= {ease.LINEAR: (0, 0), ease.SLOW_START: (1, 0), ease.SLOW_END: (0, 1)}
AT_REST |= {ease.QUARTIC: (3, 3), ease.QUINTIC: (4, 4), ease.BOUNCE: (1, 0)}


@pytest.mark.parametrize("way", range(len(ease.EASES)), ids=ease.EASES)
def test_an_ease_leaves_and_arrives_as_its_name_says(way: int) -> None:
    """How many derivatives vanish at its ends: the order at which it leaves them, less one."""
    # What is left of 1 is rounded where many derivatives vanish; others are looked at closer.
    nearer = 1e-3 if max(AT_REST[way]) > 2 else 1e-4
    near = 2.0 * nearer
    start = np.log2(ease.eased(near, way) / ease.eased(nearer, way)) - 1.0
    rest = (1.0 - ease.eased(np.array([1.0 - near, 1.0 - nearer]), way)).tolist()
    end = np.log2(rest[0] / rest[1]) - 1.0
    assert (start, end) == pytest.approx(AT_REST[way], abs=0.01)
    both = ease.eased(T, way) + ease.eased(1.0 - T, way)
    if AT_REST[way][0] == AT_REST[way][1]:
        np.testing.assert_allclose(both, 1.0, atol=1e-12)


def test_eases_are_what_they_are_called() -> None:
    def of(way: int) -> np.ndarray:
        return np.asarray(ease.eased(T, way))

    np.testing.assert_allclose(of(ease.LINEAR), T, atol=1e-12)
    np.testing.assert_allclose(of(ease.SINE), np.sin(0.5 * np.pi * T) ** 2, atol=1e-12)
    np.testing.assert_allclose(of(ease.SLOW_START), T**2, atol=1e-12)
    np.testing.assert_allclose(of(ease.SLOW_END), 1.0 - of(ease.SLOW_START)[::-1], atol=1e-12)
    half = T[T <= 0.5]
    np.testing.assert_allclose(of(ease.CUBIC)[: len(half)], 0.5 * (2.0 * half) ** 3, atol=1e-12)
    # Smoothsteps: the polynomials of least degree with so many derivatives 0 at both ends.
    for way, power in ((ease.SMOOTH, 1), (ease.SMOOTHER, 2)):
        rise = np.polynomial.Polynomial([0.0, 1.0, -1.0]) ** power
        whole = rise.integ()
        np.testing.assert_allclose(of(way), whole(T) / whole(1.0), atol=1e-12)
