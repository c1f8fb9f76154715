"""Glass: Snell's law, total reflection, Fresnel's shares, absorption, through whole scenes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal import Box, Camera, Plane, Scene, Sphere, emissive, glass
from tests.optics.looking import (
    bent,
    clear,
    compass,
    fresnel,
    seen,
    through_ball,
    thrown_back,
    unit,
    upper_half,
    way_seen,
)

UP = np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize("height", [0.0, 0.2, 0.5, 0.8, 0.9])
@pytest.mark.parametrize("ior", [1.1, 1.5, 2.42])
def test_a_ball_bends_rays_as_snell_says(ior, height):
    origin, target = (0.3 * height, height, 5.0), (0.3 * height, height, 0.0)
    _, expected = through_ball(np.array(origin), np.array([0.0, 0.0, -1.0]), 1.0, ior)
    found = way_seen(Sphere(1.0).paint(clear(ior)), origin, target)
    assert found == pytest.approx(expected, abs=4e-3)


def test_no_ray_leaves_a_ball_unbent():
    """Rounding let rays that reach the end of the box in one step leave as they were."""
    far_off = 0
    for height in np.linspace(0.02, 0.8, 27):
        origin = (0.3 * height, height, 5.0)
        _, expected = through_ball(np.array(origin), np.array([0.0, 0.0, -1.0]), 1.0, 1.5)
        eye = Camera(origin, (0.3 * height, height, 0.0), fov=1e-4)
        ball = Scene(Sphere(1.0).paint(clear(1.5)), lights=[], camera=eye, background=compass)
        for rows in (240, 2500):
            ways = 2.0 * ball.render(size=(1, rows)).linear[:, 0, :3] - 1.0
            far_off += int((np.abs(ways - expected).max(axis=1) > 0.01).sum())
    assert far_off == 0


def test_a_ball_of_the_same_index_as_the_air_is_not_there():
    found = way_seen(Sphere(1.0).paint(clear(1.0)), (0.5, 0.5, 5.0), (0.5, 0.5, 0.0))
    assert found == pytest.approx((0.0, 0.0, -1.0), abs=1e-4)


def test_a_pane_moves_rays_but_keeps_their_way():
    way = unit(0.5, -0.3, -1.0)
    pane = Box(20.0, 20.0, 1.0).paint(clear(1.5))
    assert way_seen(pane, -5.0 * way, (0, 0, 0)) == pytest.approx(way, abs=1e-3)


def test_a_ball_of_air_in_water_spreads_light():
    """Seen from within the water: the ball is the thinner side."""
    water = (Sphere(50.0) - Sphere(1.0)).paint(clear(1.333))
    way = np.array([0.0, 0.0, -1.0])
    enters = np.array([0.0, 0.4, math.sqrt(1 - 0.16)])
    inside = bent(way, enters, 1.333, 1.0)
    leaves = enters - 2.0 * (enters @ inside) * inside
    after = bent(inside, -leaves, 1.0, 1.333)
    assert after is not None
    there = leaves + (-(leaves @ after) + math.sqrt((leaves @ after) ** 2 + 2499.0)) * after
    expected = bent(after, -there / 50.0, 1.333, 1.0)
    assert way_seen(water, (0, 0.4, 5), (0, 0.4, 0)) == pytest.approx(expected, abs=4e-3)


def image_of(bead, ior):
    """Where a ball of glass shows a small shining ball behind it, by the picture: (x, y) as uv."""
    scene = Scene(
        Sphere(1.0).paint(clear(ior)) | Sphere(0.06).translate(bead).paint(emissive("#fff")),
        lights=[],
        camera=Camera((0, 0, 5), fov=math.pi / 4),
        background=(0, 0, 0),
    )
    light = scene.render(size=(360, 360)).linear[..., 0]
    y, x = np.mgrid[0:360, 0:360]
    u, v = (2 * x + 1) / 360 - 1, 1 - (2 * y + 1) / 360
    through = light * (np.hypot(u, v) < math.tan(math.asin(0.2)) / math.tan(math.pi / 8) - 0.02)
    assert through.sum() > 20, "the ball shows no image"
    return float((through * u).sum() / through.sum()), float((through * v).sum() / through.sum())


@pytest.mark.parametrize("ior", [1.3, 1.7])
@pytest.mark.parametrize("bead", [(0.25, 0.1, -2.2), (-0.1, 0.3, -4.0)])
def test_a_ball_shows_what_is_behind_it_where_snell_says(bead, ior):
    """The ray through a pixel at the bead's side of the axis is found by bisection in Python."""
    across = np.hypot(*bead[:2])
    toward = np.array([bead[0] / across, bead[1] / across, 0.0])
    tangent = math.tan(math.pi / 8)

    def passes(w):
        """How far from the axis, on the bead's side, the ray of uv w * toward passes its depth."""
        origin = np.array([0.0, 0.0, 5.0])
        place, way = through_ball(origin, unit(*(w * tangent * toward - [0, 0, 1])), 1.0, ior)
        return float((place + way * (bead[2] - place[2]) / way[2]) @ toward)

    low, high = -0.46, 0.46
    ws = np.linspace(low, high, 4001)
    offs = np.array([passes(w) for w in ws]) - across
    roots = ws[:-1][offs[:-1] * offs[1:] <= 0.0]
    assert len(roots) == 1
    expected = roots[0] * toward[:2]
    assert image_of(bead, ior) == pytest.approx(tuple(expected), abs=2 * 2 / 360)


WATER = Plane(y=0.0).paint(clear(1.333))
CRITICAL = math.asin(1 / 1.333)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.6, CRITICAL - 0.02])
def test_from_under_water_the_sky_is_bent_into_a_window(angle):
    way = np.array([math.sin(angle), math.cos(angle), 0.0])
    expected = bent(way, -UP, 1.333, 1.0)
    assert way_seen(WATER, -way, (0, 0, 0)) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("angle", [CRITICAL + 0.01, 1.0, 1.3])
def test_beyond_the_critical_angle_all_is_mirrored(angle):
    way = np.array([math.sin(angle), math.cos(angle), 0.0])
    expected = thrown_back(way, -UP)
    assert way_seen(WATER, -way, (0, 0, 0)) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 56.3, 75.0, 85.0, 89.0])
def test_glass_mirrors_the_share_of_fresnel(degrees):
    angle = math.radians(degrees)
    way = np.array([math.sin(angle), -math.cos(angle), 0.0])
    floor = Plane(y=0.0).paint(glass(ior=1.5))
    # So flat a ray needs many steps.
    found = seen(floor, -way, (0, 0, 0), background=upper_half, steps=500)
    assert found == pytest.approx([fresnel(angle, 1.0, 1.5)] * 3, abs=4e-3)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 40.0, 41.0, 42.5, 60.0])
def test_glass_mirrors_inside_the_share_of_fresnel(degrees):
    angle = math.radians(degrees)
    way = np.array([math.sin(angle), math.cos(angle), 0.0])
    floor = Plane(y=0.0).paint(glass(ior=1.5))
    found = seen(floor, -way, (0, 0, 0), background=upper_half)
    assert found == pytest.approx([1.0 - fresnel(angle, 1.5, 1.0)] * 3, abs=1e-2)


def test_colored_glass_takes_light_by_beer_and_lambert():
    pane = Box(8.0, 8.0, 1.5).paint(clear(1.5, absorption=(0.2, 0.7, 1.5)))
    found = seen(pane, (0, 0, 5), (0, 0, 0), background=(1.0, 1.0, 1.0))
    assert found == pytest.approx(np.exp(-1.5 * np.array([0.2, 0.7, 1.5])), abs=2e-3)


def test_the_color_of_glass_is_what_white_becomes_on_one_unit():
    pane = Box(8.0, 8.0, 2.0).paint(glass(ior=1.0, color=(0.9, 0.5, 0.25)))
    found = seen(pane, (0, 0, 5), (0, 0, 0), background=(1.0, 1.0, 1.0))
    assert found == pytest.approx((0.81, 0.25, 0.0625), abs=2e-3)


@pytest.mark.parametrize("height", [0.0, 0.3, 0.6, 0.8])
def test_clear_glass_before_white_is_white(height):
    """Nothing is lost but rays dimmer than a display's step."""
    ball = Sphere(1.0).paint(glass(ior=1.5))
    found = seen(ball, (0, height, 5), (0, height, 0), background=(1.0, 1.0, 1.0), bounces=8)
    assert np.all(found <= 1.0 + 1e-5)
    assert found == pytest.approx((1.0, 1.0, 1.0), abs=1.5e-2)


def test_two_panes_that_touch_nothing_show_one_way():
    panes = Box(20.0, 20.0, 0.2) | Box(20.0, 20.0, 0.2).translate(z=-1.0)
    way = unit(0.2, 0.1, -1.0)
    assert way_seen(panes.paint(clear(1.6)), -4.0 * way, (0, 0, 0)) == pytest.approx(way, abs=1e-3)


def test_what_stands_in_glass_is_seen_bent():
    """A shining ball in a block of glass: a ray at an angle reaches it only by Snell's way."""
    way = unit(0.8, 0.0, -1.0)
    below = bent(way, np.array([0.0, 0.0, 1.0]), 1.0, 1.5)
    assert below is not None
    bead = 2.0 * below
    block = Box(10, 10, 10).translate(z=-5.0).paint(clear(1.5))
    inner = Sphere(0.05).translate(tuple(bead)).paint(emissive("#fff"))
    # The bead takes the place of the glass there: it is cut out and put in.
    both = (block - Sphere(0.06).translate(tuple(bead))) | inner
    assert seen(both, -4.0 * way, (0, 0, 0))[0] == pytest.approx(1.0, abs=1e-3)
    straight = Sphere(0.05).translate(tuple(2.0 * way)).paint(emissive("#fff"))
    empty = (block - Sphere(0.06).translate(tuple(2.0 * way))) | straight
    assert seen(empty, -4.0 * way, (0, 0, 0))[0] == pytest.approx(0.0, abs=1e-3)


def test_the_compass_shows_directions():
    assert way_seen(Sphere(0.1).translate(y=50), (0, 0, 0), (0, 0, -1)) == pytest.approx((0, 0, -1))
    assert compass.name == "compass"
