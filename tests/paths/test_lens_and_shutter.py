"""Blur by a lens and by an open shutter, against closed forms."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from PIL import Image

from distal import (
    Box,
    Camera,
    OrbitCamera,
    OrthographicCamera,
    PointLight,
    Scene,
    Sphere,
    emissive,
)
from distal import time as scene_time
from distal.lang import slider
from distal.scene.steering import Steering
from distal.video.formats import VideoError

WHITE = emissive((1.0, 1.0, 1.0))
FOV = 2.0 * np.arctan(0.1)  # at distance 10 the picture is 2 high
PX = 64
# The variance of a tent filter of two pixels in both directions together.
OF_FILTER = 2.0 / 6.0


def shown(shape, camera, spp=256, **options):
    scene = Scene(shape, lights=(), camera=camera, background=(0.0, 0.0, 0.0), floor=False)
    return scene.render((PX, PX), mode="path", spp=spp, **options).linear[..., 1].astype(float)


def spread(picture) -> float:
    """The mean squared distance of the light from the middle, in pixels."""
    at = np.arange(PX) + 0.5 - PX / 2
    squared = at[:, None] ** 2 + at[None, :] ** 2
    return float((picture * squared).sum() / picture.sum())


@pytest.mark.parametrize("z", [5.0, 0.0, -10.0])
def test_the_circle_of_confusion_is_that_of_a_thin_lens(z):
    aperture, focus, depth, radius = 0.5, 10.0, 10.0 - z, 0.05
    camera = Camera((0.0, 0.0, 10.0), fov=FOV, aperture=aperture)
    found = shown(Sphere(radius).translate(z=z).paint(WHITE), camera, 1024)
    per_pixel = 2.0 / PX  # in the plane of focus
    circle = 0.5 * aperture * abs(depth - focus) / depth / per_pixel
    ball = radius * focus / depth / per_pixel
    expected = 0.5 * circle**2 + 0.5 * ball**2 + OF_FILTER
    assert spread(found) == pytest.approx(expected, rel=0.03)
    # The lens gathers as much light as a pinhole shows.
    assert found.sum() == pytest.approx(np.pi * ball**2, rel=0.03)


def test_the_blurred_disc_is_even():
    camera = Camera((0.0, 0.0, 10.0), fov=FOV, aperture=0.5)
    found = shown(Sphere(0.05).translate(z=5.0).paint(WHITE), camera, 1024)
    ball, circle = 0.05 * 2.0 * PX / 2.0, 8.0
    at = np.arange(PX) + 0.5 - PX / 2
    inner = at[:, None] ** 2 + at[None, :] ** 2 < (circle - ball - 1.0) ** 2
    assert found[inner].mean() == pytest.approx((ball / circle) ** 2, rel=0.02)
    assert found[inner].std() < 0.15 * found[inner].mean()


def test_a_distance_of_focus_replaces_that_of_the_target():
    ball = Sphere(0.05).translate(z=5.0).paint(WHITE)
    near = Camera((0.0, 0.0, 10.0), fov=FOV, aperture=0.5, focus_distance=5.0)
    orbit = OrbitCamera(10.0, fov=FOV, aperture=0.5, focus_distance=5.0)
    turned = Camera.yaw_pitch_roll((0.0, 0.0, 10.0), fov=FOV, aperture=0.5, focus_distance=5.0)
    sharp = 0.5 * (0.1 * PX / 2.0) ** 2 + OF_FILTER
    for camera in (near, orbit, turned):
        assert spread(shown(ball, camera)) == pytest.approx(sharp, rel=0.03)


def test_aperture_may_be_a_parameter():
    size = slider("size", 0.0)
    camera = Camera((0.0, 0.0, 10.0), fov=FOV, aperture=size)
    ball = Sphere(0.02).translate(z=5.0).paint(WHITE)
    sharp = spread(shown(ball, camera))
    blurred = spread(shown(ball, camera, params={"size": 0.5}))
    assert blurred - sharp == pytest.approx(0.5 * 8.0**2, rel=0.03)


def test_what_is_in_focus_stays_so_when_a_person_zooms():
    ball = Sphere(0.05).paint(WHITE)
    camera = Camera((0.0, 0.0, 10.0), fov=FOV, aperture=0.5, focus_distance=10.0)
    found = shown(ball, camera, steering=Steering(0.0, 0.0, 2.0, (0.0, 0.0)))
    assert spread(found) == pytest.approx(0.5 * (0.05 * PX / 4.0) ** 2 + OF_FILTER, rel=0.05)


@pytest.mark.parametrize("speed", [8.0, -8.0])
def test_a_moving_bar_is_a_ramp(speed):
    width, shutter, start = 0.5, 0.1, 0.2
    bar = Box((width, 8.0, 0.1)).translate(x=speed * scene_time).paint(WHITE)
    camera = OrthographicCamera((0.0, 0.0, 5.0), height=4.0)
    found = shown(bar, camera, time=start, shutter=shutter).mean(axis=0)
    x = (np.arange(PX) + 0.5) * 4.0 / PX - 2.0
    times = start + shutter * (np.arange(4000) + 0.5) / 4000
    covered = np.abs(x[:, None] - speed * times[None, :]) < 0.5 * width
    assert np.abs(found - covered.mean(axis=1)).max() < 0.02
    assert found.max() == pytest.approx(width / abs(speed * shutter), abs=0.02)


def test_a_shut_shutter_stops_the_motion():
    bar = Box((0.5, 8.0, 0.1)).translate(x=8.0 * scene_time).paint(WHITE)
    camera = OrthographicCamera((0.0, 0.0, 5.0), height=4.0)
    still = shown(bar, camera, time=0.1, shutter=0.0)
    assert np.array_equal(still, shown(bar, camera, time=0.1))
    assert still.max() == 1.0


def test_a_scene_has_a_shutter_of_its_own(tmp_path):
    bar = Box((0.5, 8.0, 0.1)).translate(x=8.0 * scene_time).paint(WHITE)
    camera = OrthographicCamera((0.0, 0.0, 5.0), height=4.0)
    made = {"lights": (), "camera": camera, "background": (0.0, 0.0, 0.0), "floor": False}
    own = Scene(bar, **made, shutter=0.1, mode="path").render((16, 16), samples=16)
    asked = Scene(bar, **made).render((16, 16), mode="path", spp=16, shutter=0.1)
    assert np.array_equal(own.linear, asked.linear)
    shut = Scene(bar, **made, shutter=0.1).render((16, 16), mode="path", spp=16, shutter=0.0)
    assert not np.array_equal(own.linear, shut.linear)


def test_a_film_with_an_open_shutter_goes_on(tmp_path):
    bar = Box((0.5, 8.0, 0.1)).translate(x=8.0 * scene_time).paint(WHITE)
    kept = tmp_path / "bar.film"
    shown(bar, Camera(), 5, shutter=0.1, film=kept)
    assert np.array_equal(
        shown(bar, Camera(), 12, shutter=0.1, film=kept), shown(bar, Camera(), 12, shutter=0.1)
    )
    with pytest.raises(ValueError, match="another picture"):
        shown(bar, Camera(), 16, shutter=0.2, film=kept)


def test_direct_light_says_that_it_shows_no_blur():
    camera = Camera(aperture=0.1)
    with pytest.warns(UserWarning, match="aperture") as caught:
        Scene(Sphere(), camera=camera).render((4, 4))
    message = "the camera's aperture blurs in mode='path' only: everything is sharp"
    assert [str(w.message) for w in caught] == [message]
    with pytest.warns(UserWarning, match="shutter") as caught:
        Scene(Sphere(), shutter=0.1).render((4, 4))
    message = "the scene's shutter blurs in mode='path' only: nothing moves"
    assert [str(w.message) for w in caught] == [message]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Scene(Sphere(), camera=camera, shutter=0.1).render((4, 4), mode="path", spp=1)
        Scene(Sphere(), camera=Camera(aperture=0.0)).render((4, 4))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Camera(aperture=-1.0), "'aperture of Camera' must be at least 0, not -1"),
        (
            lambda: Camera(aperture=0.1, focus_distance=0.0),
            "'focus_distance of Camera' must be above 0, not 0",
        ),
        (lambda: OrthographicCamera(aperture=0.1), "OrthographicCamera has no 'aperture'"),
        (
            lambda: Camera.yaw_pitch_roll(aperture=0.1),
            "TurnedCamera has no target to focus on",
        ),
        (lambda: Scene(Sphere(), shutter=-1.0), "'shutter of Scene' must be at least 0, not -1"),
        (
            lambda: Scene(Sphere(), shutter=scene_time),
            "shutter is a constant: no parameter, and no expression",
        ),
        (
            lambda: Scene(Sphere()).render((4, 4), mode="path", shutter=-0.1),
            "shutter is 0 or a number above 0, not -0.1",
        ),
        (lambda: Scene(Sphere()).render((4, 4), shutter=0.1), "shutter is for mode 'path'"),
        (
            lambda: Scene(Sphere()).render((4, 4), mode="path", filter="lanczos"),
            "there is no filter 'lanczos'; filters: tent, box, gaussian, blackman-harris, mitchell",
        ),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    assert message in str(caught.value)


def test_frames_of_a_video_are_blurred(tmp_path):
    bar = Box((0.5, 8.0, 0.1)).translate(x=8.0 * scene_time).paint(WHITE)
    camera = OrthographicCamera((0.0, 0.0, 5.0), height=4.0)
    made = {"lights": (), "camera": camera, "background": (0.0, 0.0, 0.0), "floor": False}
    scene = Scene(bar, **made, mode="path")
    shots = {"duration": 0.2, "fps": 10, "size": (16, 16), "samples": 16}
    scene.video(tmp_path / "blurred" / "%d.png", shutter=0.05, **shots)
    still = scene.render((16, 16), time=0.1, index=1, samples=16, shutter=0.05)
    frame = np.asarray(Image.open(tmp_path / "blurred" / "1.png"), float)[..., :3] / 255.0
    assert np.abs(frame - still.array[..., :3]).max() < 0.003
    scene.video(tmp_path / "sharp" / "%d.png", **shots)
    sharp = np.asarray(Image.open(tmp_path / "sharp" / "1.png"), float)[..., :3] / 255.0
    assert np.abs(frame - sharp).max() > 0.2
    with pytest.raises(VideoError, match="shutter is for mode 'path'"):
        Scene(bar, **made).video(tmp_path / "direct" / "%d.png", shutter=0.05, **shots)


def test_a_video_traces_paths_if_asked(tmp_path):
    scene = Scene(Sphere(), lights=PointLight((2.0, 4.0, 3.0), radius=0.5))
    shots = {"duration": 1, "fps": 1, "size": (16, 16), "samples": 8}
    scene.video(tmp_path / "%d.png", mode="path", **shots)
    scene.render((16, 16), mode="path", spp=8).save(tmp_path / "still.png")
    found, still = (np.asarray(Image.open(tmp_path / name)) for name in ("0.png", "still.png"))
    assert np.array_equal(found[..., :3], still[..., :3])
    with pytest.raises(ValueError, match="there is no mode 'paths'; modes: direct, path"):
        scene.video(tmp_path / "%d.png", mode="paths", **shots)
