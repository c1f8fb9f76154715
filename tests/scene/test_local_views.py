"""Locals of an author's image as pictures: the right local, its last value, pixels without it."""

import numpy as np
import pytest

import distal
from distal.lang import Frame, image, vec3
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.scene.lowering.local_views import locals_of, view_of_image

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
    with pytest.raises(
        ValueError, match="'bare' has no number that differs from pixel to pixel\nit"
    ):
        view_of_image(bare, "signal")


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
    for name in ("melting", "raymarcher", "course_2_depth"):
        made = distal.load(f"example:{name}")
        for view in ("coordinate", "signal"):
            options = RenderOptions(size=(16, 12))
            picture = executor().render(view_of_image(made, view), options).array
            assert np.isfinite(picture).all()
            assert np.ptp(picture[..., :3]) > 0.1, (name, view)
