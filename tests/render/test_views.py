"""Views, samples of a pixel, legends, the numbers of a march: where the answer is a formula."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal.fields.guarantees import Bounds
from distal.lang import func, length, vec2, vec3, vec4
from distal.lang.runtime_access import executor
from distal.render import camera, layers, local_views, settings, views
from distal.render.camera import Ray
from distal.render.march import Hit, March
from distal.render.material import Surface
from distal.render.ranges import Range
from distal.render.segment import segment

AHEAD = (0.0, 0.0, -1.0)


def asked(function: Any, *args: Any) -> Any:
    """A scene function's values by the reference."""
    return executor().call(function, args, {}, device="reference")


# Views


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def steep_ball(p: vec3) -> float:
    return 2.0 * (length(p) - 1.0)


@func
def shiny(p: vec3) -> Surface:
    return Surface(color=vec3(0.5, p.z, 0.25), emission=vec3(0.0, 0.0, 0.5))


@func
def everywhere() -> Bounds:
    return Bounds(vec3(-1e18), vec3(1e18))


@func
def march_of(divisor: float) -> March:
    return March(divisor, 0.0, 50.0, 1e-5)


# One ray for each pixel, parallel to the others, 0.02 apart: a line each 0.5.
LINES = views.Lines(vec2(0.02, 0.0), 0.5, 1.0)


@func
def ball_hit(ray: Ray) -> Hit:
    return segment(ball, ray, 0.0, 0.0, everywhere(), march_of(1.0), 100)


@func
def steep_hit(ray: Ray) -> Hit:
    return segment(steep_ball, ray, 0.0, 0.0, everywhere(), march_of(2.0), 100)


@func
def view_of(name: int, origin: vec3, direction: vec3) -> vec4:
    ray = Ray(origin, direction)
    if name == 0:
        return views.view_normal(ray, ball_hit, ball, march_of(1.0))
    if name == 1:
        return views.view_depth(ray, ball_hit, Range(2.0, 3.5, 5.0))
    if name == 2:
        return views.view_coordinate(ray)
    if name == 3:
        return views.view_signal(ray, ball_hit, Range(2.0, 3.5, 5.0))
    if name == 4:
        return views.view_slope(ray, steep_hit, steep_ball, march_of(2.0), 4.0)
    if name == 5:
        return views.view_slope(ray, steep_hit, steep_ball, march_of(2.0), 1.5)
    if name == 6:
        return views.view_material(ray, ball_hit, shiny)
    if name == 7:
        return views.view_distance(ray, ball, vec3(0.6, 0.0, 0.8), 30.0, LINES)
    if name == 8:
        return views.view_slice(ray, ball, vec3(0.6, 0.0, 0.8), 0.5, 30.0, LINES)
    return views.view_steps(ray, ball_hit, 100)


VIEWS = ("normal", "depth", "coordinate", "signal", "slope", "too steep", "material")
VIEWS += ("distance", "slice", "steps")
# At a ball of radius 1 from 5 away, 0.6 above its middle: 4.2 along, where the normal is this.
HIT, MISS = (0.0, 0.6, 5.0), (0.0, 3.0, 5.0)
NORMAL = np.array([0.0, 0.6, 0.8])


def seen(view: str, origin: Any, direction: Any = AHEAD) -> Any:
    return asked(view_of, VIEWS.index(view), np.array([origin]), np.array([direction]))[0]


def srgb(c: float) -> float:
    return 1.055 * c ** (1.0 / 2.4) - 0.055 if c > 0.0031308 else 12.92 * c


def test_views_show_what_they_say():
    assert seen("normal", HIT)[:3] == pytest.approx(0.5 + 0.5 * NORMAL, abs=1e-4)
    # From inside: toward the eye.
    assert seen("normal", (0.0, 0.6, 0.0))[:3] == pytest.approx([0.5, 0.2, 0.9], abs=1e-4)
    assert seen("coordinate", HIT, (0.48, 0.6, -0.64))[:3] == pytest.approx([0.74, 0.8, 0.18])
    # 4.2 is at 22/30 of the range of 2 to 5, whose middle has no curve.
    assert seen("signal", HIT)[:3] == pytest.approx([1.0 - 0.9 * 2.2 / 3.0] * 3, abs=1e-4)
    assert seen("material", HIT)[:3] == pytest.approx([srgb(0.5), srgb(0.8), srgb(0.75)], abs=1e-4)
    assert seen("slope", HIT)[:3] == pytest.approx(slope_colors(2.0)[0], abs=1e-4)
    assert tuple(seen("too steep", HIT)[:3]) == (1.0, 0.0, 1.0)


def slope_colors(*slopes: float) -> Any:
    return asked(views.slope_color, np.array(slopes))


def test_slope_1_is_calm_less_is_blue_more_is_red():
    """LOOKS.md: the colors and the slopes where they stand."""
    found = slope_colors(0.2, 1.0, 1.5, 2.5, 9.0)
    calm, warm, red = (0.80, 0.84, 0.86), (0.96, 0.70, 0.25), (0.78, 0.10, 0.10)
    expected = [(0.45, 0.62, 0.80), calm, warm, red, red]
    assert found == pytest.approx(np.array(expected), abs=1e-6)
    # Between them each channel goes straight from one color to the next.
    between = slope_colors(1.25, 2.0)
    assert between[0] == pytest.approx((np.array(calm) + warm) / 2.0, abs=1e-6)
    assert between[1] == pytest.approx((np.array(warm) + red) / 2.0, abs=1e-6)


def test_depth_is_shown_within_its_range():
    shown = asked(views.depth_color, np.array([2.2 / 3.0]))[0]
    assert seen("depth", HIT)[:3] == pytest.approx(shown, abs=1e-4)
    near, middle, far = asked(views.depth_color, np.array([0.0, 0.5, 1.0]))
    assert near == pytest.approx((0.99, 0.94, 0.78))
    assert middle == pytest.approx((0.24, 0.62, 0.62))
    assert far == pytest.approx((0.08, 0.09, 0.26))


@pytest.mark.parametrize("view", ["normal", "depth", "slope", "material"])
def test_where_nothing_is_met_a_view_is_clear(view):
    assert seen(view, MISS)[3] == 0.0
    assert seen(view, HIT)[3] == 1.0


def test_a_signal_of_nothing_is_black():
    assert tuple(seen("signal", MISS)) == (0.0, 0.0, 0.0, 1.0)


def changed(origin: Any, way: Any, offset: float) -> tuple[float, float]:
    """The ball's distance on the plane, and how much it changes 0.02 beside the ray: measured."""
    normal, way = np.array([0.6, 0.0, 0.8]), np.asarray(way)
    side = np.cross(way, [0.0, 0.6, -0.8])
    side /= np.linalg.norm(side)
    over = np.cross(way, side)

    def at(moved: Any) -> float:
        start = np.asarray(origin) + moved
        t = (offset - start @ normal) / (way @ normal)
        return float(np.linalg.norm(start + t * way) - 1.0)

    h = 1e-4
    slopes = [(at(h * axis) - at(-h * axis)) / (2.0 * h) for axis in (side, over)]
    return at(0.0 * side), 0.02 * math.hypot(*slopes)


@pytest.mark.parametrize("way", [AHEAD, (0.48, 0.0, -0.64)])
def test_a_slice_is_shown_where_the_ray_meets_its_plane(way):
    unit = np.array(way) / np.linalg.norm(way)
    d, change = changed((0.1, 0.6, 5.0), unit, 0.5)
    found = seen("slice", (0.1, 0.6, 5.0), unit)
    assert found[:3] == pytest.approx(lines_at(d, change), abs=1e-4)
    assert found[3] == 1.0


def test_distance_is_shown_on_the_plane_through_the_origin():
    d, change = changed((0.4, 0.3, 5.0), AHEAD, 0.0)
    assert seen("distance", (0.4, 0.3, 5.0))[:3] == pytest.approx(lines_at(d, change), abs=1e-4)


def test_a_slice_ends_before_the_eye_and_at_the_far_end():
    assert seen("slice", (0.1, 0.6, 5.0), (0.0, 0.0, 1.0))[3] == 0.0
    assert seen("slice", (0.1, 0.6, 40.0))[3] == 0.0
    assert seen("slice", (0.1, 0.6, 5.0), (0.0, 1.0, 0.0))[3] == 0.0


def lines_at(d: float, change: float = 0.02, step: float = 0.5, width: float = 1.0) -> Any:
    return asked(views.isolines, np.array([d]), change, step, width)[0]


def test_views_and_layers_are_called_by_their_names():
    assert {n: f.__name__ for n, f in views.VIEWS.items()} == {n: f"view_{n}" for n in views.VIEWS}
    known = layers.LAYERS
    assert {n: f.__name__ for n, f in known.items()} == {n: f"layer_{n}" for n in known}


def test_lines_have_a_constant_width_in_pixels():
    """One pixel wide, every fifth two, that at 0 three, whatever the distance changes by."""
    across = np.arange(-4.0, 4.0, 1.0 / 64.0)  # pixels
    for change in (0.01, 0.002):

        def dark_at(level: float, change: float = change) -> Any:
            d = level + across * change
            color = asked(views.isolines, d, change, 0.5, 1.0)
            plain = asked(views.isolines, d, 1e-9, 0.5, 1.0)  # lines of no width
            plain = np.where(np.abs(across)[:, None] < 0.01, plain[[0]], plain)
            return 1.0 - (color / plain).mean(1)

        for level in (1.0, -1.5):
            dark = dark_at(level)
            assert dark.max() == pytest.approx(0.35, abs=0.01)
            assert dark.sum() / 64.0 == pytest.approx(0.35 * 1.0, rel=0.03)
        bold = dark_at(2.5)
        assert bold.max() == pytest.approx(1.0 - 0.65 * 0.55, abs=0.01)
        assert (bold > 0.2).sum() / 64.0 == pytest.approx(2.0, abs=0.2)
        zero = asked(views.isolines, across * change, change, 0.5, 1.0)
        assert (zero.max(1) < 0.5).sum() / 64.0 == pytest.approx(3.0, abs=0.2)
        assert zero[256] == pytest.approx([0.05] * 3, abs=1e-3)


def test_a_slice_is_warm_outside_and_blue_inside():
    for d in (0.3, 4.0):
        outside, inside = lines_at(d), lines_at(-d)
        assert outside[0] > outside[2]
        assert inside[0] < inside[2]


def test_lines_too_close_to_be_told_apart_are_left_out():
    d = np.arange(3.9, 4.1, 0.01)
    far = asked(views.isolines, d, 0.5, 0.01, 1.0)
    assert np.ptp(far, axis=0).max() == pytest.approx(0.0, abs=1e-6)


@func
def lines_seen(height: float, fov: float) -> vec2:
    lines = views.lines_on(
        lambda uv: camera.look_at(uv, vec3(0.0, 0.0, 5.0), vec3(0.0), vec3(0.0, 1.0, 0.0), fov),
        vec2(1.5 * height, height),
        vec3(0.0, 0.0, 1.0),
        1.0,
    )
    return vec2(lines.step, lines.width)


@pytest.mark.parametrize(("height", "fov"), [(240.0, 0.7), (480.0, 0.1), (2160.0, 1.2)])
def test_lines_are_about_twenty_pixels_apart_in_round_steps(height, fov):
    """At the plane, 4 away: within the ratio of two neighboring round steps."""
    step, width = (float(x) for x in asked(lines_seen, height, fov))
    pixel = 2.0 * 4.0 * math.tan(0.5 * fov) / height
    scale = max(height / 480.0, 1.0)
    assert width == pytest.approx(scale)
    assert 20.0 / 1.6 < step / pixel / scale < 20.0 * 1.6
    part = step / 10.0 ** math.floor(math.log10(step) + 1e-6)
    assert min(abs(part - n) for n in (1.0, 2.0, 5.0)) < 1e-4


def test_round_steps_are_the_nearest_by_ratio():
    given = np.array([1.0, 1.4, 1.42, 3.1, 3.2, 7.0, 7.1, 0.0099, 0.001, 1000.0, 3e-5])
    expected = [1.0, 1.0, 2.0, 2.0, 5.0, 5.0, 10.0, 0.01, 0.001, 1000.0, 2e-5]
    assert asked(views.round_step, given) == pytest.approx(np.array(expected), rel=1e-5)


def test_heat_goes_from_dark_blue_over_green_to_red():
    cold, low, high, hot = asked(views.heat, np.array([0.0, 0.45, 0.7, 1.0]))
    assert np.argmax(cold) == 2
    assert np.argmax(low) == 1
    assert high[0] > 0.8
    assert high[1] > 0.8
    assert np.argmax(hot) == 0
    assert hot[1] < 0.2
    assert hot[2] < 0.05
    outside = asked(views.heat, np.array([-3.0, 7.0]))
    assert outside == pytest.approx(np.stack([cold, hot]))


def test_steps_are_shown_of_the_most_allowed():
    """A ray that misses everything at once takes one step of 100."""
    found = seen("steps", (0.0, 60.0, 5.0))[:3]
    assert found == pytest.approx(asked(views.heat, np.array([0.01]))[0], abs=1e-5)


# The numbers of a march


@func
def threshold(height: float, fov: float, extent: float, away: float) -> float:
    """Of a camera that looks at a ball: orthographic if ``fov`` is 0."""

    def ray(uv: vec2) -> Ray:
        eye = vec3(0.0, 0.0, away)
        up = vec3(0.0, 1.0, 0.0)
        if fov > 0.0:
            return camera.look_at(uv, eye, vec3(0.0), up, fov=fov)
        return camera.orthographic(uv, eye, vec3(0.0), up, height=extent)

    ball = Bounds(vec3(-1.0), vec3(1.0))
    return settings.hit_threshold(vec2(1.5 * height, height), ball, ray)


@pytest.mark.parametrize("height", [240, 480, 1080, 2160])
def test_a_hit_is_within_a_third_of_a_pixel(height):
    """Of a lens of 40 degrees."""
    pixel = 2.0 * math.tan(math.radians(20.0)) / height
    found = asked(threshold, float(height), math.radians(40.0), 0.0, 5.0)
    assert 0.9 * pixel / 3.0 <= found <= 1.05 * pixel / 3.0


@pytest.mark.parametrize("away", [10.0, 400.0, 3700.0])
def test_a_hit_is_within_a_third_of_a_pixel_of_cameras_far_away(away):
    pixel = 3.0 / 480.0  # at the ball, which fills most of the picture
    allowed = max(0.35 * pixel, 2.1e-6 * away)  # what 32 bits tell
    for fov, extent in ((2.0 * math.atan(1.5 / away), 0.0), (0.0, 3.0)):
        assert asked(threshold, 480.0, fov, extent, away) * away <= allowed


def test_a_hit_is_no_nearer_than_32_bits_tell_and_no_farther_than_a_thousandth():
    assert asked(threshold, 10.0, 1.0, 0.0, 5.0) == pytest.approx(1e-3)
    pixel = 2.0 * math.tan(0.5) / 90000.0
    assert asked(threshold, 90000.0, 1.0, 0.0, 5.0) == pytest.approx(0.343 * pixel, rel=0.05)
    assert asked(threshold, 480.0, 0.0, 1e-6, 1e6) == pytest.approx(2e-6)


def test_the_numbers_of_a_march():
    found = settings.march_numbers(1.7, 0.1, 60.0, 5e-4)
    assert (found.near, found.far, found.threshold) == pytest.approx((0.1, 60.0, 5e-4))
    assert found.divisor == pytest.approx(1.7)
    flat = settings.march_numbers(0.3, 0.1, 60.0, 5e-4)
    assert flat.divisor == 1.0, "a field that is too flat is not stretched"


def test_a_box_has_room_for_rounding():
    """A part of its longest finite side; a box that is empty does not turn over."""
    grown = settings.grown_bounds(Bounds((-1.0, -2.0, 5.0), (3.0, 8.0, 2.0)))
    room = 1e-4 * 10.0
    assert np.asarray(grown.low) == pytest.approx(np.array([-1.0, -2.0, 5.0]) - room, abs=1e-6)
    assert np.asarray(grown.high) == pytest.approx(np.array([3.0, 8.0, 2.0]) + room, abs=1e-6)
    slab = settings.grown_bounds(Bounds((-1e30, -0.5, -1e30), (1e30, 0.5, 1e30)))
    assert (slab.low.y, slab.high.y) == pytest.approx((-0.5001, 0.5001), abs=1e-6)


def test_strides_begin_at_the_top_of_the_box():
    found = settings.stride_over(Bounds((-1.0, -2.0, 5.0), (3.0, 8.0, 9.0)), 0.07, 1.2)
    assert (found.top, found.first, found.growth) == pytest.approx((8.0, 0.07, 1.2))


def test_the_look_of_places_is_its_numbers():
    found = settings.look(0.3, 0.05)
    assert (found.occlusion, found.fog_density) == pytest.approx((0.3, 0.05))


# Locals of an author's picture


def test_numbers_beyond_0_and_1_show_their_size():
    values = np.array([-40.0, -1.0, -0.2, 0.0, 0.25, 1.0, 1.5, 2.5, 9.5, 3.0])
    shown = asked(local_views.shown_number, values, True)[:, :3]
    blue = np.array([0.15, 0.4, 1.0])
    below = blue * (1.0 - np.exp(np.minimum(values[:3], 0.0)))[:, None]
    assert shown[:3] == pytest.approx(below, abs=1e-5)
    assert shown[3:6] == pytest.approx(np.repeat([[0.0], [0.25], [1.0]], 3, axis=1))
    # Halfway between whole numbers there is no line: from pale to red.
    pale, red = np.array([1.0, 0.95, 0.85]), np.array([0.75, 0.2, 0.05])
    share = np.exp(-0.5 * (values[6:9] - 1.0))[:, None]
    assert shown[6:9] == pytest.approx(share * pale + (1.0 - share) * red, abs=1e-5)
    share = math.exp(-1.0)
    assert shown[9] == pytest.approx(0.7 * (share * pale + (1.0 - share) * red), abs=1e-5)


def test_coordinates_turn_back_at_one():
    at = np.array([(-1.0, 0.0), (1.0, 0.5), (1.5, -1.5), (3.0, 2.0)])
    shown = asked(local_views.shown_coordinate, at, True)
    expected = [(0.0, 0.5), (1.0, 0.75), (0.75, 0.25), (0.0, 0.5)]
    assert shown[:, :2] == pytest.approx(np.array(expected), abs=1e-6)
    assert shown[:, 2:] == pytest.approx(np.tile([0.5, 1.0], (4, 1)))


def test_vectors_show_sizes_and_signs():
    shown = asked(local_views.shown_vector, np.array([(0.5, -0.5, -9.0)]), True)[0]
    assert shown == pytest.approx([0.5, 0.2, 1.0, 1.0], abs=1e-6)


def test_what_was_not_reached_has_a_color_of_its_own():
    for function, value in (
        (local_views.shown_number, np.array([0.5])),
        (local_views.shown_coordinate, np.array([[0.5, 0.5]])),
        (local_views.shown_vector, np.array([[0.5, 0.5, 0.5]])),
    ):
        assert tuple(asked(function, value, False)[0]) == pytest.approx((0.08, 0.08, 0.1, 1.0))
