"""Views, samples of a pixel, legends, the numbers of a march: where the answer is a formula."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal.fields.guarantees import Bounds
from distal.lang import func, length, vec2, vec3, vec4
from distal.lang.runtime_access import executor
from distal.render import camera, layers, legend, local_views, settings, views
from distal.render.camera import Ray
from distal.render.march import Hit, March, march
from distal.render.material import Surface

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


@func
def ball_hit(ray: Ray) -> Hit:
    return march(ball, ray, everywhere(), march_of(1.0), 100)


@func
def steep_hit(ray: Ray) -> Hit:
    return march(steep_ball, ray, everywhere(), march_of(2.0), 100)


@func
def view_of(name: int, origin: vec3, direction: vec3) -> vec4:
    ray = Ray(origin, direction)
    if name == 0:
        return views.view_normal(ray, ball_hit, ball, march_of(1.0))
    if name == 1:
        return views.view_depth(ray, ball_hit)
    if name == 2:
        return views.view_coordinate(ray)
    if name == 3:
        return views.view_signal(ray, ball_hit)
    if name == 4:
        return views.view_slope(ray, steep_hit, steep_ball, march_of(2.0), 4.0)
    if name == 5:
        return views.view_slope(ray, steep_hit, steep_ball, march_of(2.0), 1.5)
    if name == 6:
        return views.view_material(ray, ball_hit, shiny)
    if name == 7:
        return views.view_distance(ray, ball)
    if name == 8:
        return views.view_slice(ray, ball, vec3(0.6, 0.0, 0.8), 0.5, 30.0)
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
    assert seen("signal", HIT)[:3] == pytest.approx([math.exp(-0.2 * 4.2)] * 3, abs=1e-4)
    assert seen("material", HIT)[:3] == pytest.approx([srgb(0.5), srgb(0.8), srgb(0.75)], abs=1e-4)
    assert seen("slope", HIT)[:3] == pytest.approx(asked(views.heat, np.array([0.5]))[0], abs=1e-4)
    assert tuple(seen("too steep", HIT)[:3]) == (1.0, 0.0, 1.0)


def test_depth_is_bright_near_and_halves_at_twenty_thirds():
    near, far = seen("depth", HIT)[0], seen("depth", (0.0, 0.0, 1.0 + 20.0 / 3.0))[0]
    assert near == pytest.approx(1.0 / (1.0 + 0.15 * 4.2), abs=1e-4)
    assert far == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("view", ["normal", "depth", "slope", "material"])
def test_where_nothing_is_met_a_view_is_clear(view):
    assert seen(view, MISS)[3] == 0.0
    assert seen(view, HIT)[3] == 1.0


def test_a_signal_of_nothing_is_black():
    assert tuple(seen("signal", MISS)) == (0.0, 0.0, 0.0, 1.0)


def test_distance_is_shown_on_the_plane_through_the_origin_that_faces_the_camera():
    origin, way = np.array([0.4, 0.3, 5.0]), np.array([0.48, 0.0, -0.64]) / 0.8
    t = -(origin @ way)
    d = float(np.linalg.norm(origin + t * way) - 1.0)
    assert seen("distance", origin, way)[:3] == pytest.approx(lines_at(d), abs=1e-4)


def test_a_slice_is_shown_where_the_ray_meets_its_plane():
    """0.6 x + 0.8 z = 0.5, within the far end and before the eye."""
    d = math.hypot(0.1, 0.6, (0.5 - 0.06) / 0.8) - 1.0
    found = seen("slice", (0.1, 0.6, 5.0))
    assert found[:3] == pytest.approx(lines_at(d), abs=1e-4)
    assert found[3] == 1.0
    assert seen("slice", (0.1, 0.6, 5.0), (0.0, 0.0, 1.0))[3] == 0.0
    assert seen("slice", (0.1, 0.6, 35.0))[3] == 0.0
    assert seen("slice", (0.1, 0.6, 5.0), (0.0, 1.0, 0.0))[3] == 0.0


def lines_at(d: float) -> Any:
    return asked(views.isolines, np.array([d]), 0.1)[0]


def test_views_and_layers_are_called_by_their_names():
    assert {n: f.__name__ for n, f in views.VIEWS.items()} == {n: f"view_{n}" for n in views.VIEWS}
    known = layers.LAYERS
    assert {n: f.__name__ for n, f in known.items()} == {n: f"layer_{n}" for n in known}


def test_lines_of_equal_distance_lie_a_spacing_apart():
    """White at 0; far from there brightest at every spacing and 0.7 of that halfway."""
    assert lines_at(0.0) == pytest.approx([1.0] * 3)
    for side in (1.0, -1.0):
        far = side * 20.0  # where the fade with the distance is over
        line, between = lines_at(far), lines_at(far + 0.05)
        assert between == pytest.approx(0.7 * line, abs=1e-3)
        assert lines_at(far + 0.1) == pytest.approx(line, abs=1e-3)
        near = lines_at(side * 0.4)
        assert near == pytest.approx(line * (1.0 - math.exp(-1.2)), abs=1e-3)
        assert (line[0] > line[2]) == (side > 0.0), "warm outside, cool inside"


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


# Legends


@func
def legend_at(coord: vec2, most: int) -> vec4:
    return legend.with_legend(vec4(0.2, 0.4, 0.6, 0.5), coord, vec2(400.0, 240.0), most)


def test_a_legend_is_a_bar_under_numbers_along_the_lower_edge():
    """A unit is a 120th of the shorter side: 2 pixels. The bar is 8 high, 8 from the rim."""
    x = np.array([8.5, 104.0, 200.0, 391.0])
    bar = asked(legend_at, np.stack([x, np.full(4, 11.0)], axis=1), 96)
    assert bar[:, :3] == pytest.approx(asked(views.heat, (x - 8.0) / 384.0), abs=1e-5)
    beside = np.array([(7.5, 11.0), (392.5, 11.0), (200.0, 7.5), (200.0, 32.5), (200.0, 100.0)])
    assert asked(legend_at, beside, 96) == pytest.approx(np.tile([0.2, 0.4, 0.6, 0.5], (5, 1)))
    rows, columns = np.mgrid[0:33, 0:400] + 0.5
    places = np.stack([columns.ravel(), rows.ravel()], axis=1)
    ink = (asked(legend_at, places, 96)[:, :3] > 0.99).all(1).reshape(33, 400)
    # A digit is 3 by 5 squares of 2 pixels, 4 above the bar; "0" has 12 squares inked.
    assert ink[:20].sum() == 0
    assert ink[20:30, :200].sum() == 12 * 4
    assert ink[20:30, 8:16].sum() == 12 * 4, "the 0 stands at the bar's left end"
    right = ink[20:30, 200:]
    assert right.sum() == 4 * sum(bin(legend.DIGITS[d]).count("1") for d in (9, 6))
    assert right[:, -8:].sum() == 0
    assert right[:, -24:].sum() == right.sum(), "96 ends where the bar does"


def test_digits_look_as_they_are_drawn_here():
    """Rows from the top, three squares each."""
    full, left, right = "###", "#..", "..#"
    sides = "#.#"
    drawn = [
        [full, sides, sides, sides, full],
        [".#.", "##.", ".#.", ".#.", "###"],
        [full, right, full, left, full],
        [full, right, ".##", right, full],
        [sides, sides, full, right, right],
        [full, left, full, right, full],
        [full, left, full, sides, full],
        [full, right, right, right, right],
        [full, sides, full, sides, full],
        [full, sides, full, right, full],
    ]
    x, y = np.meshgrid(np.arange(3), np.arange(4, -1, -1))
    squares = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    for digit, rows in enumerate(drawn):
        found = asked(legend.digit_covers, digit, squares)
        text = "".join("#" if square else "." for square in found)
        assert [text[i : i + 3] for i in range(0, 15, 3)] == rows, digit


# The numbers of a march


@pytest.mark.parametrize("height", [240, 480, 1080, 2160])
def test_a_hit_is_within_a_third_of_a_pixel(height):
    """Of a lens of 40 degrees."""
    pixel = 2.0 * math.tan(math.radians(20.0)) / height
    found = settings.march_numbers(1.7, 0.1, 60.0, (1.5 * height, float(height)))
    assert 0.9 * pixel / 3.0 <= found.threshold <= 1.05 * pixel / 3.0
    assert found.near == pytest.approx(0.1)
    assert found.far == 60.0
    assert found.divisor == pytest.approx(1.7)


def test_a_hit_is_no_nearer_than_32_bits_tell_and_no_farther_than_a_thousandth():
    for height, threshold in ((10.0, 1e-3), (90000.0, 1e-4)):
        found = settings.march_numbers(0.3, 0.1, 60.0, (height, height))
        assert found.threshold == pytest.approx(threshold)
        assert found.divisor == 1.0, "a field that is too flat is not stretched"


def test_a_box_has_room_for_rounding():
    """A thousandth, and a ten thousandth of its size; a box that is empty does not turn over."""
    grown = settings.grown_bounds(Bounds((-1.0, -2.0, 5.0), (3.0, 8.0, 2.0)))
    room = np.array([1e-3 + 4e-4, 1e-3 + 1e-3, 1e-3])
    assert np.asarray(grown.low) == pytest.approx(np.array([-1.0, -2.0, 5.0]) - room, abs=1e-6)
    assert np.asarray(grown.high) == pytest.approx(np.array([3.0, 8.0, 2.0]) + room, abs=1e-6)


def test_strides_begin_at_the_top_of_the_box():
    found = settings.stride_over(Bounds((-1.0, -2.0, 5.0), (3.0, 8.0, 9.0)), 0.07, 1.2)
    assert (found.top, found.first, found.growth) == pytest.approx((8.0, 0.07, 1.2))


def test_the_look_of_places_is_its_numbers():
    found = settings.look(0.3, 0.05)
    assert (found.occlusion, found.fog_density) == pytest.approx((0.3, 0.05))


def test_a_pixels_angle_is_its_share_of_the_screen():
    found = camera.pixel_angle(0.8, 240.0)
    assert found == pytest.approx(2.0 * math.tan(0.4) / 240.0, rel=1e-6)
    assert camera.pixel_angle(-0.8, 240.0) == pytest.approx(found)


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
