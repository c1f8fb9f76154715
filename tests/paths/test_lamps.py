"""Shapes that emit light: directions to them, and their light on a floor in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Camera, Plane, Scene, Sphere, emissive, matte, time
from distal.render import lamps
from distal.scene.lowering.lamps import MOST, is_ball, lamps_of
from tests.paths.counting import (
    SURPRISING,
    counted,
    deviation,
    directions_of,
    expected_in_cells,
    grid,
    places_of,
)
from tests.paths.test_integrator import WHITE, check, estimate

GLOW = emissive(WHITE, 5.0)
DARK = matte(WHITE)


def sampled(lamp, p, count=1 << 16):
    side = int(math.sqrt(count))
    u = np.column_stack([grid(side), np.random.default_rng(3).random(side * side)])
    return np.asarray(lamps.aim_at_lamp(lamp, p, u.astype(np.float32)))


@pytest.mark.parametrize("round", [True, False])
@pytest.mark.parametrize("p", [(2.0, 1.0, 1.5), (0.0, -1.2, 0.1), (-30.0, 0.1, 0.0)])
def test_directions_are_as_dense_as_the_density(p, round):
    lamp = lamps.Lamp((0.1, 0.2, -0.3), (0.5, 0.5, 0.5), round)

    def density(d):
        return lamps.lamp_density(lamp, p, d)

    found = sampled(lamp, p)
    mean = np.asarray(density(found), float)
    assert (mean > 0).mean() > 0.99
    if np.linalg.norm(p) > 10:
        offset = np.subtract(p, (0.1, 0.2, -0.3))
        solid_angle = math.pi * 0.25 / np.dot(offset, offset)
        assert not round or (1 / mean).mean() == pytest.approx(solid_angle, rel=1e-3)
        return
    expected = expected_in_cells(density, 12, 12, 100)
    assert expected.sum() == pytest.approx(1, abs=0.01)
    counts = counted(places_of(found), 12, 12)
    assert deviation(counts, expected / expected.sum() * counts.sum()) < SURPRISING


def test_inside_of_a_ball_every_direction_is_as_likely():
    lamp = lamps.Lamp((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), True)
    for p in ((0.0, 0.0, 0.0), (0.3, 0.2, 0.1)):
        density = np.asarray(lamps.lamp_density(lamp, p, directions_of(grid(16))))
        assert density == pytest.approx(0.25 / math.pi, rel=1e-5)
        assert np.isfinite(sampled(lamp, p, 256)).all()


def test_shapes_without_bounds_are_no_lamps():
    lamp = lamps.lamp_in(([-1e30] * 3, [1e30] * 3), False)
    density = lamps.lamp_density(lamp, (0.0, 1.0, 0.0), directions_of(grid(16)))
    assert not np.asarray(density).any()


def square_above(side: float, height: float) -> float:
    """The share of a floor's half space that a square straight above it covers, by the cosine."""
    x = 0.5 * side / height
    root = math.sqrt(1 + x * x)
    return 4 / math.pi * (x / root * math.atan(x / root))


@pytest.mark.parametrize("material", [matte((0.5,) * 3)], ids=str)
@pytest.mark.parametrize(("side", "height"), [(0.1, 2.0), (1.0, 0.5), (2.0, 0.05)])
def test_a_square_lamp_lights_the_floor(side, height, material):
    panel = Box((side, 0.02, side)).translate(y=height + 0.01).paint(GLOW)
    found = estimate(Plane().paint(material) | panel, (3, 0.04, 0), (0, 0, 0), 16, bounces=1)
    expected = 0.5 * 5.0 * square_above(side, height)
    assert found[1].max() < 0.02 * expected
    check(found, expected, 0.02 * expected)


def test_a_lamp_may_be_looser_than_its_shape_and_overlap_another():
    """Half of a ball, and a second lamp that is hidden in the first: one ball's light."""
    ball = Sphere(0.5).translate(y=2.0)
    lamp = ball & Box((4, 1, 4)).translate(y=1.5)  # its lower half
    hidden = Box(0.2).translate(y=2.0).rotate(y=0.5)
    floor = Plane().paint(matte(WHITE))
    whole = estimate(floor | ball.paint(GLOW), (3, 1, 0), (0, 0, 0), 16)
    cut = estimate(floor | lamp.paint(GLOW) | hidden.paint(GLOW), (3, 1, 0), (0, 0, 0), 16)
    check(whole, 5.0 * (0.5 / 2.0) ** 2, 0.01)
    assert cut[0] == pytest.approx(whole[0], abs=4 * cut[1].max() + 4 * whole[1].max() + 0.006)


def test_a_lamp_that_moves_is_found_where_it_is():
    lamp = Sphere(0.1).translate(y=1.0 + time).paint(GLOW)
    for at in (0.0, 1.0):
        camera = Camera((1, 0.5, 0), (0, 0, 0), fov=1e-5)
        scene = Scene(
            Plane().paint(matte(WHITE)) | lamp,
            lights=[],
            background=(0, 0, 0),
            camera=camera,
        )
        light = scene.render(size=(16, 16), mode="path", spp=4, time=at).linear[..., 0]
        expected = 5.0 * (0.1 / (1.0 + at)) ** 2
        assert light.std() < 0.01 * expected
        assert light.mean() == pytest.approx(expected, rel=1e-3)


def found_in(shape, default=DARK):
    return lamps_of(shape.node, default)


def test_which_shapes_are_lamps():
    ball = Sphere(0.2).rotate(y=1.0).scale(2.0).translate(1, 2, 3).paint(GLOW)
    (only,) = found_in(Plane() | ball | Box().paint(DARK))
    assert is_ball(only)
    (smooth,) = found_in(Box().union(ball, smooth=0.1))
    assert is_ball(smooth)
    (box,) = found_in(Plane() | Box().paint(GLOW))
    assert not is_ball(box)
    assert not found_in(Plane().paint(DARK) | Box())
    # The outermost paint counts.
    assert not found_in((ball | Box()).paint(DARK))
    assert len(found_in(Box() | Sphere(), GLOW)) == 2


def test_many_lamps_are_left_to_chance():
    row = [Sphere(0.1).translate(x=i).paint(GLOW) for i in range(MOST + 1)]
    assert len(found_in(row[0] | row[1])) == 2
    shape = row[0]
    for ball in row[1:]:
        shape = shape | ball
    assert not found_in(shape)
