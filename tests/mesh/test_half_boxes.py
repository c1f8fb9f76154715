"""Boxes cut by planes: volumes against closed forms and points, corners against points."""

from __future__ import annotations

import numpy as np
import pytest

from distal.mesh.half_boxes import ends, shares

ROOM = 2e-3  # planes that are almost parallel to a side are moved by less than this


@pytest.mark.parametrize(
    ("normal", "distance", "share"),
    [
        ((1, 0, 0), 0.0, 0.5),
        ((1, 0, 0), 0.5, 0.25),
        ((0, -2, 0), -1.0, 0.75),
        ((1, 1, 0), 1.0, 0.125),
        ((1, 1, 1), 2.0, 1 / 48),  # a corner: a tetrahedron with legs 1 in a cube of 2
        ((1, -1, 1), 0.0, 0.5),
        ((1, 1, 1), 4.0, 0.0),
        ((1, 1, 1), -4.0, 1.0),
        ((0, 0, 0), -1.0, 1.0),
        ((0, 0, 0), 1.0, 0.0),
    ],
)
def test_shares_of_a_cube(normal, distance, share):
    given = np.ones((1, 3)), np.array([normal], float), np.array([distance])
    low, high = shares(*given, -1)[0], shares(*given, 1)[0]
    assert low <= share <= high
    assert high - low < ROOM


def test_random_planes_contain_what_points_say():
    rng = np.random.default_rng(1)
    count = 300
    half = 10.0 ** rng.uniform(-2, 2, (count, 3))
    normal = rng.normal(size=(count, 3)) * 10.0 ** rng.choice([-9.0, -2.0, 0.0, 0.0], (count, 3))
    distance = rng.normal(size=count) * 0.5 * (np.abs(normal) * half).sum(axis=1)
    low, high = (shares(half, normal, distance, side) for side in (-1, 1))
    first, last = ends(half, normal, distance)
    points = rng.uniform(-1.0, 1.0, (20_000, 3))
    for i in range(count):
        places = points * half[i]
        inside = places @ normal[i] < -distance[i]
        assert low[i] - 0.02 <= inside.mean() <= high[i] + 0.02
        if inside.any():
            room = 1e-12 * half[i]
            assert (first[i] - room <= places[inside].min(axis=0)).all()
            assert (places[inside].max(axis=0) <= last[i] + room).all()
    assert (high - low).max() < ROOM
