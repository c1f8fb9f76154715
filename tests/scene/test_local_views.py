"""Locals of an author's image as pictures: the right local, its last value, pixels without it."""

import numpy as np
import pytest

import distal
from distal.lang import Frame, image, struct, vec3
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.scene.lowering.local_views import locals_of, view_of_image
from distal.scene.view_ranges import with_range

SIZE = (8, 4)
UNREACHED = (0.08, 0.08, 0.1, 1.0)


@image
def plain(frame: Frame) -> vec3:
    speed = frame.time
    uv = frame.coord / frame.resolution
    height = uv.y
    if uv.x < 0.5:
        return vec3(0.0)
    late = 0.25 * height
    total = 0.0
    for i in range(3):
        total += late * float(i)
    if uv.y > 0.5:
        inner = 1.0
        total = inner + speed
    return vec3(total, late, 0.0)


@image
def bare(frame: Frame) -> vec3:
    return vec3(frame.coord / frame.resolution, 0.0)


@image
def counted(frame: Frame) -> vec3:
    steps = 0
    right = frame.coord.x > 4.0
    if right:
        steps = 1
    direction = vec3(0.5, -0.5, 2.0)
    return direction * float(steps)


def shown(view, of=plain):
    return executor().render(view_of_image(of, view), RenderOptions(size=SIZE)).array


def test_locals_are_those_of_the_author_and_tell_what_varies():
    found = {x.name: (str(x.type), x.varies) for x in locals_of(plain)}
    assert found == {
        "speed": ("float", False),
        "uv": ("vec2", True),
        "height": ("float", True),
        "late": ("float", True),
        "total": ("float", True),
        "inner": ("float", False),
    }


def test_a_number_is_grey_from_0_to_1():
    rows = (np.arange(4)[::-1, None] + 0.5) / 4.0
    picture = shown("local:height")
    for channel in range(3):
        assert picture[..., channel] == pytest.approx(np.broadcast_to(rows, (4, 8)), abs=1e-6)
    assert (picture[..., 3] == 1.0).all()
    assert np.array_equal(shown("signal"), picture)


def test_a_pixel_that_left_before_shows_none():
    picture = shown("local:late")
    assert picture[:, :4] == pytest.approx(np.broadcast_to(UNREACHED, (4, 4, 4)))
    assert picture[0, 6, 0] == pytest.approx(0.25 * 0.875)


def test_the_last_value_counts_and_inner_locals_only_where_reached():
    total = shown("local:total")
    assert total[3, 6, 0] == pytest.approx(3.0 * 0.25 * 0.125, abs=1e-6)
    assert total[0, 6, :3] == pytest.approx(1.0, abs=1e-6)
    inner = shown("local:inner")
    assert inner[3, 6] == pytest.approx(UNREACHED)
    assert inner[0, 6, :3] == pytest.approx(1.0)


def test_a_coordinate_is_red_and_green():
    columns = 0.5 + 0.5 * (np.arange(8) + 0.5) / 8.0
    picture = shown("coordinate")
    assert picture[0, :, 0] == pytest.approx(columns, abs=1e-6)
    assert picture[0, 0, 1] == pytest.approx(0.5 + 0.5 * 0.875)


def test_an_image_without_one_shows_the_pixels_own():
    picture = shown("coordinate", bare)
    assert picture[0, 0, 1] == pytest.approx(0.5 + 0.5 * 0.75)


def test_an_image_without_a_number_shows_its_brightness():
    """Weights of BT.709; red is x, green is y, of a picture without blue."""
    x, y = (np.arange(8) + 0.5) / 8.0, (np.arange(4)[::-1] + 0.5) / 4.0
    light = 0.2126 * x[None] + 0.7152 * y[:, None]
    assert shown("signal", bare)[..., 0] == pytest.approx(light, abs=1e-6)


@struct
class Found:
    distance: float
    direction: vec3


@image
def structured(frame: Frame) -> vec3:
    hit = Found(frame.coord.x, vec3(0.25, frame.coord.y, 0.5))
    hit.distance = hit.distance / 8.0
    return hit.direction * hit.distance


def test_fields_of_a_struct_are_locals():
    found = {x.name: str(x.type) for x in locals_of(structured)}
    assert found == {"hit.distance": "float", "hit.direction": "vec3"}
    x = np.broadcast_to((np.arange(8) + 0.5) / 8.0, (4, 8))
    assert shown("signal", structured)[..., 0] == pytest.approx(x, abs=1e-6)
    assert np.array_equal(shown("local:hit.distance", structured), shown("signal", structured))
    assert shown("local:hit.direction", structured)[0, 0, 0] == pytest.approx(0.25)


# Ranges


def ranged(view, of, size=(240, 180)):
    """The picture as a host shows it, and what the ends of its scale are."""
    viewed = view_of_image(of, view)
    options = with_range(viewed, RenderOptions(size=size))
    return executor().render(viewed, options).array, options.settings


@image
def ramp(frame: Frame) -> vec3:
    wide = 100.0 * frame.coord.x / frame.resolution.x - 20.0
    return vec3(wide)


def test_a_number_is_shown_between_its_2nd_and_98th_percentile():
    _, settings = ranged("local:wide", ramp)
    # 64 columns of equal shares: the 2nd percentile is in the second, the 98th in the last but one.
    middles = 100.0 * (np.arange(64) + 0.5) / 64.0 - 20.0
    expected = (middles[1], middles[62])
    found = (settings["View_low"], settings["View_high"])
    assert found == pytest.approx(expected, rel=1e-3)
    assert settings["View_middle"] == pytest.approx(30.0, abs=1.0)
    picture, _ = ranged("local:wide", ramp)
    assert np.ptp(picture[100:, 200:, :3].mean((0, 1))) >= 0.0
    assert picture[20, 0, :3] == pytest.approx((0.08, 0.09, 0.26), abs=1e-6)
    assert picture[20, -1, :3] == pytest.approx((0.99, 0.94, 0.78), abs=1e-6)


@image
def sky(frame: Frame) -> vec3:
    """Distances from 2 to 10 in the lower third, and 100 where nothing is hit."""
    part = frame.coord.y / frame.resolution.y
    t = 2.0 + 24.0 * part if part < 1.0 / 3.0 else 100.0 + frame.coord.x
    return vec3(1.0 / t)


def test_distances_to_nothing_do_not_hide_the_others():
    picture, settings = ranged("local:t", sky)
    assert settings["View_middle"] == pytest.approx(6.0, abs=0.3)
    near, far = picture[-1, -1, :3], picture[-58, -1, :3]
    assert np.abs(near - far).max() > 0.4


def test_a_vector_is_shown_between_its_extremes():
    _, settings = ranged("local:uv", plain)
    assert settings["View_low"] > 0.0
    picture, _ = ranged("local:uv", plain)
    # 0 to 1 is shown as it is.
    assert picture[20, 120, :2] == pytest.approx((120.5 / 240, 1.0 - 20.5 / 180), abs=1e-5)
    signed, settings = ranged("coordinate", bare)
    assert settings["View_low"] < 0.0
    most = max(-settings["View_low"], settings["View_high"])
    assert most == pytest.approx(4.0 / 3.0, abs=0.05)
    assert signed[90, 120, :3] == pytest.approx([0.5] * 3, abs=0.06)


def test_counts_truths_and_vectors():
    assert shown("local:steps", counted)[0, :, 0] == pytest.approx([0, 0, 0, 0, 1, 1, 1, 1])
    assert shown("local:right", counted)[0, :, 0] == pytest.approx([0, 0, 0, 0, 1, 1, 1, 1])
    assert shown("local:direction", counted)[0, 0] == pytest.approx([0.5, 0.2, 1.0, 1.0])


def test_what_cannot_be_shown_lists_what_can():
    with pytest.raises(ValueError, match="no local 'x'") as caught:
        view_of_image(counted, "local:x")
    assert str(caught.value) == (
        "'counted' has no local 'x' that can be shown\n"
        "what it can show:\n"
        "  local:steps  int\n"
        "  local:right  bool\n"
        "  local:direction  vec3"
    )
    with pytest.raises(ValueError, match="an @image has no view 'depth'"):
        view_of_image(plain, "depth")


def test_every_example_image_shows_its_coordinate_and_signal():
    courses = ("1_rays", "2_depth", "3_lit", "4_materials", "5_animation", "6_exercise")
    for name in ("melting", "raymarcher", *(f"course_{course}" for course in courses)):
        made = distal.load(f"example:{name}")
        for view in ("coordinate", "signal"):
            options = RenderOptions(size=(16, 12), time=0.6)
            viewed = view_of_image(made, view)
            picture = executor().render(viewed, with_range(viewed, options)).array
            assert np.isfinite(picture).all()
            # Its values use the whole scale.
            assert np.ptp(picture[..., :3], axis=(0, 1)).max() > 0.5, (name, view)
