"""The box around copies that turn about an axis: the hull of the copies' boxes if they are few."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest

from distal import Box, Rectangle
from distal.lang import integer

ARM = Box(2.0, 0.5, 0.4).translate(2.5, 0.1, 0.3)
CORNERS = np.array([(x, z) for x in (1.5, 3.5) for z in (0.1, 0.5)])


def hull(count: int, corners: Any = CORNERS) -> tuple[Any, Any]:
    """The least and the largest coordinates of all corners, each turned by hand."""
    turned = []
    for i in range(count):
        c, s = cos(2.0 * pi * i / count), sin(2.0 * pi * i / count)
        turned.append(corners @ np.array([[c, s], [-s, c]]))
    places = np.concatenate(turned)
    return places.min(axis=0), places.max(axis=0)


@pytest.mark.parametrize("neighbors", [0, 1, "all"])
@pytest.mark.parametrize("count", [2, 3, 5, 12])
def test_the_box_of_few_copies_is_their_hull(count: int, neighbors: Any) -> None:
    low, high = ARM.repeat_polar(count, neighbors=neighbors).bounds()
    least, most = hull(count)
    assert low[1] == pytest.approx(-0.15) and high[1] == pytest.approx(0.35)
    assert [low[0], low[2]] == pytest.approx(list(least), abs=1e-5)
    assert [high[0], high[2]] == pytest.approx(list(most), abs=1e-5)


def test_the_box_of_many_copies_is_that_of_their_cylinder() -> None:
    low, high = ARM.repeat_polar(13).bounds()
    radius = float(np.hypot(3.5, 0.5))
    assert (low[0], high[2]) == (pytest.approx(-radius), pytest.approx(radius))
    least, most = hull(13)
    assert (least > -radius).all() and (most < radius).all()
    assert radius < 1.04 * float(most.max())


def test_flat_copies_have_the_same_rectangle() -> None:
    arm = Rectangle(2.0, 0.4).translate(2.5, 0.3)
    low, high = arm.repeat_polar(3).bounds()
    least, most = hull(3)
    assert list(low) == pytest.approx(list(least), abs=1e-5)
    assert list(high) == pytest.approx(list(most), abs=1e-5)


def test_the_box_follows_a_number_of_copies() -> None:
    many = integer("Many", 3, 1, 20)
    shape = ARM.repeat_polar(many, neighbors="all")
    for count in (1, 3, 7, 20):
        wanted = ARM.repeat_polar(count, neighbors="all").bounds()
        assert np.array(shape.bounds(params={"many": count})) == pytest.approx(np.array(wanted))


@pytest.mark.parametrize("neighbors", [0, 1, "all"])
@pytest.mark.parametrize("count", [3, 4, 7])
def test_values_are_at_least_the_distance_to_the_box(count: int, neighbors: Any) -> None:
    shape = ARM.repeat_polar(count, neighbors=neighbors)
    low, high = map(np.array, shape.bounds())
    p = np.random.default_rng(4).uniform(-5.0, 5.0, (50_000, 3))
    beyond = np.linalg.norm(np.maximum(np.maximum(low - p, p - high), 0.0), axis=1)
    values = shape(p)
    outside = beyond > 0.0
    assert float((values - beyond)[outside].min()) > -1e-5
    # And no more than the distance to the nearest copy, each computed on its own.
    angles = [2.0 * pi * i / count for i in range(count)]
    true = np.min([ARM.rotate(y=angle)(p) for angle in angles], axis=0)
    assert float((values - true)[true > 0.0].max()) < 1e-5
