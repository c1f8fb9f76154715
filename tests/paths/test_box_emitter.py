"""A box as a light: directions to its faces, against its solid angle in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.render import box_emitter
from tests.paths.counting import (
    SURPRISING,
    counted,
    deviation,
    directions_of,
    expected_in_cells,
    grid,
    places_of,
)

HALF = (0.5, 0.3, 0.8)
PLACES = [(2.0, 1.0, 1.5), (0.9, -0.2, 2.0), (-0.8, 0.1, 0.0), (0.2, 1.0, -1.0)]


def numbers(count=1 << 16):
    rng = np.random.default_rng(3)
    side = int(math.sqrt(count))
    return np.column_stack([grid(side), rng.random(side * side)]).astype(np.float32)


@pytest.mark.parametrize("p", PLACES)
def test_directions_meet_the_box_and_have_their_density(p):
    found = box_emitter.aim_at_box(p, HALF, numbers(1 << 12))
    direction, distance = np.asarray(found.direction, float), np.asarray(found.distance, float)
    place = np.array(p) + direction * distance[:, None]
    assert (np.abs(place) - HALF).max() < 1e-5
    assert np.abs(np.abs(place) / HALF - 1).min(1).max() < 1e-5
    again = box_emitter.box_density(p, HALF, np.asarray(found.direction))
    same = np.isclose(np.asarray(again.density), np.asarray(found.density), rtol=1e-3)
    assert same.mean() > 0.995  # the others are within rounding errors of an edge
    near = np.isclose(np.asarray(again.distance), distance, rtol=1e-4)
    assert near[same].all()


@pytest.mark.parametrize("p", PLACES)
def test_directions_are_as_dense_as_the_density(p):
    found = box_emitter.aim_at_box(p, HALF, numbers())

    def density(d):
        return box_emitter.box_density(p, HALF, d).density

    expected = expected_in_cells(density, 12, 12, 100)
    assert expected.sum() == pytest.approx(1, abs=0.01)
    counts = counted(places_of(np.asarray(found.direction)), 12, 12)
    assert deviation(counts, expected / expected.sum() * counts.sum()) < SURPRISING


def test_the_solid_angle_of_a_cube_from_its_axis():
    """A face of side 2 a at distance d: 4 asin(a^2 / (a^2 + d^2))."""
    found = box_emitter.aim_at_box((0.0, 0.0, 1.5), (0.5, 0.5, 0.5), numbers())
    angle = (1 / np.asarray(found.density, float)).mean()
    assert angle == pytest.approx(4 * math.asin(0.25 / (0.25 + 1)), rel=1e-4)


@pytest.mark.parametrize("p", [(0.0, 0.0, 0.0), (0.5, 0.3, 0.8), (0.5, 0.0, 0.0)])
def test_from_inside_nothing_is_aimed_at(p):
    found = box_emitter.aim_at_box(p, HALF, numbers(256))
    for part in (found.direction, found.distance, found.density):
        assert np.isfinite(np.asarray(part)).all()
    assert not np.asarray(found.density).any()
    missed = box_emitter.box_density(p, HALF, directions_of(grid(16)))
    assert not np.asarray(missed.density).any()
