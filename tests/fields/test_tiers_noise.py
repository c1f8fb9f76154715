"""Noise keeps its ranges and slopes, which are found again here; cells against brute force."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from distal.fields.noise import plane as noise_flat
from distal.fields.noise import space as noise
from distal.fields.noise import voronoi

MASK = 0xFFFFFFFF
EDGES = np.array(
    [g for g in itertools.product((-1.0, 0.0, 1.0), repeat=3) if np.abs(g).sum() == 2.0]
)
C, S = np.cos(np.pi / 8), np.sin(np.pi / 8)
SLANTS = np.array([(i * u, j * v) for u, v in ((C, S), (S, C)) for i in (-1, 1) for j in (-1, 1)])


def pcg(v):
    state = (v * 747796405 + 2891336453) & MASK
    word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737 & MASK
    return (word >> 22) ^ word


def hashed(x, y, z, seed):
    plane = pcg((z + seed * 2654435769) & MASK)
    return pcg((x + pcg((y + plane) & MASK)) & MASK)


def climbed(f: Callable, size: int, seed: int = 1) -> float:
    """The largest value of f in the unit cube, by random steps uphill."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(size=(3000, size))
    best = f(x)
    kept = np.argsort(-best)[:100]
    x, best, step = x[kept], best[kept], 0.2
    for _ in range(50):
        for _ in range(8):
            tried = np.clip(x + rng.normal(size=x.shape) * step, 0.0, 1.0)
            value = f(tried)
            better = value > best
            x[better], best[better] = tried[better], value[better]
        step *= 0.8
    return float(best.max())


def support(gradients, v):
    """The most that any of the gradients reaches along v."""
    return (v @ gradients.T).max(axis=-1)


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-9)


def lattice_parts(gradients, size, steepness):
    """The largest sum over a cell's corners, of values or of derivatives along a direction."""
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=size)))

    def total(x):
        p, u = x[:, :size], unit(2.0 * x[:, size:] - 1.0) if steepness else None
        s, rise = p**3 * (p * (p * 6 - 15) + 10), 30 * p * p * (1 - p) ** 2
        found = 0.0
        for corner in corners:
            shares = np.where(corner > 0, s, 1 - s)
            weight = shares.prod(axis=1)
            if not steepness:
                found = found + weight * support(gradients, p - corner)
                continue
            turned = [
                np.where(np.arange(size) == i, np.where(corner > 0, rise, -rise), shares).prod(1)
                for i in range(size)
            ]
            along = (np.stack(turned, 1) * u).sum(1)
            found = found + support(gradients, weight[:, None] * u + along[:, None] * (p - corner))
        return found

    return total


def simplex_parts(gradients, size, steepness):
    """As ``lattice_parts``, over a simplex, whose places are shares of its corners."""
    unskew = (1 - 1 / np.sqrt(size + 1)) / size
    corners = np.tril(np.ones((size + 1, size)), -1)
    corners = corners - corners.sum(1, keepdims=True) * unskew

    def total(x):
        shares = -np.log(np.clip(x[:, : size + 1], 1e-9, 1 - 1e-9))
        p = shares / shares.sum(1, keepdims=True) @ corners
        u = unit(2.0 * x[:, size + 1 :] - 1.0) if steepness else None
        found = 0.0
        for corner in corners:
            d = p - corner
            k = np.maximum(0.5 - (d * d).sum(1), 0.0)
            if steepness:
                along = -8.0 * k**3 * (d * u).sum(1)
                found = found + support(gradients, (k**4)[:, None] * u + along[:, None] * d)
            else:
                found = found + k**4 * support(gradients, d)
        return found

    return total


@pytest.mark.parametrize(
    ("parts", "gradients", "size", "scale", "slope"),
    [
        (lattice_parts, EDGES, 3, noise.GRADIENT_SCALE, noise.GRADIENT_SLOPE),
        (lattice_parts, SLANTS, 2, noise_flat.GRADIENT_SCALE_2, noise_flat.GRADIENT_SLOPE_2),
        (simplex_parts, EDGES, 3, noise.SIMPLEX_SCALE, noise.SIMPLEX_SLOPE),
        (simplex_parts, SLANTS, 2, noise_flat.SIMPLEX_SCALE_2, noise_flat.SIMPLEX_SLOPE_2),
    ],
)
def test_ranges_and_slopes_are_the_largest_that_can_be(parts, gradients, size, scale, slope):
    places = size + 1 if parts is simplex_parts else size
    assert climbed(parts(gradients, size, False), places) * scale == pytest.approx(1.0, abs=2e-4)
    steepest = climbed(parts(gradients, size, True), places + size) * scale
    assert slope * 0.998 < steepest <= slope


def test_value_noise_by_its_corners():
    """Poincaré: the variance over corners is at least each share's, times its square of change."""
    x = np.linspace(1e-4, 1 - 1e-4, 9999)
    s, rise = x**3 * (x * (x * 6 - 15) + 10), 30 * x * x * (1 - x) ** 2
    assert np.sqrt((rise**2 / (s * (1 - s))).max()) == pytest.approx(noise.VALUE_SLOPE, rel=1e-4)


KINDS = [
    (noise.value_noise, noise.VALUE_SLOPE, noise_flat.VALUE_SLOPE_2, 0.35),
    (noise.gradient_noise, noise.GRADIENT_SLOPE, noise_flat.GRADIENT_SLOPE_2, 0.2),
    (noise.simplex_noise, noise.SIMPLEX_SLOPE, noise_flat.SIMPLEX_SLOPE_2, 0.3),
]


@pytest.mark.parametrize("size", [3, 2])
@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k[0].name)
def test_noise_is_in_its_range_smooth_and_spread(kind, size):
    function, slope, slope_2, spread = kind
    bound = slope if size == 3 else slope_2
    rng = np.random.default_rng(3)
    points = rng.uniform(-40.0, 40.0, (60000, size))
    values = function(points)
    assert np.abs(values).max() <= 1.0
    assert values.std() > spread and abs(values.mean()) < 0.02
    moved = points + rng.normal(size=points.shape) * 10.0 ** rng.uniform(-6, -0.5, (len(points), 1))
    way = np.linalg.norm(moved - points, axis=1)
    assert (np.abs(function(moved) - values) <= bound * way + 1e-9).all()
    # Across the borders of cells too, where the way there is nothing.
    edge = np.round(points)
    before, after = np.nextafter(edge, -np.inf), np.nextafter(edge, np.inf)
    assert np.abs(function(before) - function(after)).max() < 1e-6
    assert np.abs(function(points, 1) - values).max() > 0.5


def test_the_hash_is_the_one_that_is_written_down():
    cells = np.random.default_rng(0).integers(-1000, 1000, (200, 3))
    wanted = [2.0 * (hashed(*(int(c) & MASK for c in cell), 7) >> 8) / 2**24 - 1 for cell in cells]
    np.testing.assert_array_equal(noise.value_noise(cells.astype(np.float64), 7), wanted)


@pytest.mark.parametrize("size", [3, 2])
def test_fractal_noise(size):
    points = np.random.default_rng(5).uniform(-20.0, 20.0, (30000, size))
    one = noise.fbm(points, 1)
    np.testing.assert_allclose(one, noise.gradient_noise(points), atol=1e-12)
    many = noise.fbm(points, 4, 2.1, 0.6)
    assert np.abs(many).max() <= 1.0
    moved = points + 1e-4 * np.random.default_rng(6).normal(size=points.shape)
    rise = np.abs(noise.fbm(moved, 4, 2.1, 0.6) - many) / np.linalg.norm(moved - points, axis=1)
    assert rise.max() <= noise.fbm_slope(4, 2.1, 0.6)
    billows = noise.turbulence(points, 4)
    assert billows.min() >= 0.0 and billows.max() <= 1.0
    assert noise.fbm(points, 0).max() == 0.0


def scattered(cell, jitter, seed):
    bits = hashed(*(int(c) & MASK for c in cell), seed)
    spread = np.array([bits & 1023, bits >> 10 & 1023, bits >> 20 & 1023]) / 1024.0
    return cell + 0.5 + jitter * (spread - 0.5)


@pytest.mark.parametrize("jitter", [0.0, 0.6, 1.0])
def test_cells_against_all_points_around(jitter):
    offsets = np.array(list(itertools.product(range(-2, 3), repeat=3)))
    limit = 1.5 - 0.5 * jitter
    for p in np.random.default_rng(9).uniform(-30.0, 30.0, (60, 3)):
        around = np.array([scattered(np.floor(p) + o, jitter, 2) for o in offsets])
        order = np.argsort(np.linalg.norm(around - p, axis=1))
        away = np.linalg.norm(around[order] - p, axis=1)
        assert voronoi.worley(p[None], jitter, 2)[0] == pytest.approx(min(away[0], limit))
        across = around[order[1:]] - around[order[0]]
        middle = 0.5 * (around[order[1:]] + around[order[0]]) - p
        borders = (middle * across).sum(1) / np.linalg.norm(across, axis=1)
        wanted = min(borders.min(), max(0.5 * (limit - away[0]), 0.0))
        found = voronoi.voronoi_border(p[None], jitter, 2)[0]
        assert found <= borders.min() + 1e-9
        assert found == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("size", [3, 2])
@pytest.mark.parametrize("function", [voronoi.worley, voronoi.voronoi_border])
def test_cells_never_jump(function, size):
    rng = np.random.default_rng(11)
    points = rng.uniform(-40.0, 40.0, (60000, size))
    for jitter in (0.8, 1.0):
        values = function(points, jitter)
        assert values.min() >= 0.0
        step = rng.normal(size=points.shape) * 10.0 ** rng.uniform(-6, -0.5, (len(points), 1))
        rise = np.abs(function(points + step, jitter) - values)
        assert (rise <= np.linalg.norm(step, axis=1) + 1e-9).all()
