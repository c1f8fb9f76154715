"""Cameras send rays where geometry says, and refuse views that have no direction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from distal.ir.types import VEC3
from distal.lang import slider
from distal.lang.expressions import time
from distal.scene.objects.cameras import (
    Camera,
    FisheyeCamera,
    OrbitCamera,
    OrthographicCamera,
    PanoramaCamera,
    TurnedCamera,
)
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from tests.scene.probing import emitted

MIDDLE = (0.0, 0.0)
HALF = math.sqrt(0.5)


def ray(camera, uv=MIDDLE, part="direction", **options):
    return emitted(camera, part, VEC3, uv=uv, **options)


def test_a_camera_looks_from_its_position_at_its_target():
    camera = Camera((0, 0, 5), fov_deg=90)
    assert ray(camera, part="origin") == pytest.approx((0, 0, 5))
    assert ray(camera) == pytest.approx((0, 0, -1), abs=1e-12)
    assert ray(camera, (0, 1)) == pytest.approx((0, HALF, -HALF))
    assert ray(camera, (1, 0)) == pytest.approx((HALF, 0, -HALF))
    assert ray(Camera((0, 0, 5), fov_deg=90, mirrored=True), (1, 0)) == pytest.approx(
        (-HALF, 0, -HALF)
    )


def test_an_angle_in_degrees_is_one_in_radians():
    for uv in ((0.3, -0.4), (0.0, 1.0)):
        degrees, radians = Camera(fov_deg=60), Camera(fov=math.radians(60))
        assert ray(degrees, uv) == pytest.approx(ray(radians, uv))


def test_cameras_move():
    zoom = slider("Zoom", 90, 10, 120)
    camera = Camera((5 * np.sin(time), 0, 5 * np.cos(time)), fov_deg=zoom)
    assert ray(camera, (0, 1)) == pytest.approx((0, HALF, -HALF))
    assert ray(camera, time=math.pi / 2) == pytest.approx((-1, 0, 0), abs=1e-9)
    narrow = ray(camera, (0, 1), params={"zoom": 60})
    assert narrow == pytest.approx((0, 0.5, -math.sqrt(0.75)))


def test_a_turned_camera():
    camera = TurnedCamera((0, 0, 0), screen_height=2.0, screen_distance=1.0)
    assert ray(camera, (0, 1)) == pytest.approx((0, HALF, -HALF))
    assert ray(TurnedCamera(yaw=math.pi / 2)) == pytest.approx((-1, 0, 0), abs=1e-9)
    assert ray(TurnedCamera(pitch=0.5)) == pytest.approx((0, math.sin(0.5), -math.cos(0.5)))
    rolled = Camera.yaw_pitch_roll((0, 0, 0), roll=math.pi / 2, fov_deg=90)
    assert abs(ray(rolled, (0, 1))[0]) == pytest.approx(HALF)
    for height in (1.0, 3.0):
        same = TurnedCamera(screen_height=height, fov_deg=50)
        assert ray(same, (0.2, 0.7)) == pytest.approx(ray(Camera(fov_deg=50), (0.2, 0.7)))


def test_an_orbit_camera():
    camera = OrbitCamera(4.0, azimuth=math.pi / 2, target=(1, 2, 3))
    assert ray(camera, part="origin") == pytest.approx((5, 2, 3))
    assert ray(camera) == pytest.approx((-1, 0, 0), abs=1e-9)
    above = OrbitCamera(4.0, elevation=math.pi / 2)
    assert ray(above) == pytest.approx((0, -1, 0), abs=1e-9)
    assert np.isfinite(ray(above, (0.5, 0.5))).all()


def test_an_orthographic_camera():
    camera = OrthographicCamera((0, 0, 5), height=4.0)
    assert ray(camera, (0.5, -1)) == pytest.approx((0, 0, -1), abs=1e-12)
    assert ray(camera, (0.5, -1), "origin") == pytest.approx((1.0, -2.0, 5.0))


def test_a_fisheye_camera_sees_half_of_the_world():
    camera = FisheyeCamera((0, 0, 0), (0, 0, -1))
    assert ray(camera, (0, 1)) == pytest.approx((0, 1, 0), abs=1e-9)
    assert ray(camera, (0.5, 0)) == pytest.approx((HALF, 0, -HALF))


def test_a_panorama_goes_around():
    camera = PanoramaCamera()
    assert ray(camera) == pytest.approx((0, 0, -1), abs=1e-9)
    assert ray(camera, (1.0, 0.0)) == pytest.approx((1, 0, 0), abs=1e-9)
    assert ray(camera, (0.0, 1.0)) == pytest.approx((0, 1, 0), abs=1e-9)


@pytest.mark.parametrize(
    ("make", "error", "message", "hint"),
    [
        (
            lambda: Camera((1, 2, 3), (1, 2, 3)),
            SceneValueError,
            "Camera: position and target are the same place",
            None,
        ),
        (
            lambda: Camera((0, 5, 0)),
            SceneValueError,
            "Camera: up points along the view; for a view straight down, give up=(0, 0, -1)",
            None,
        ),
        (
            lambda: Camera(up=(0, 0, 0)),
            SceneValueError,
            "Camera: up is a vector of zeros, which has no direction",
            None,
        ),
        (
            lambda: Camera(fov=45),
            SceneValueError,
            "'fov of Camera' must be below 3.14159, not 45",
            "fov is in radians; fov_deg= takes degrees",
        ),
        (
            lambda: Camera(fov=math.pi),
            SceneValueError,
            "'fov of Camera' must be below 3.14159, not 3.14159",
            "fov is in radians; fov_deg= takes degrees",
        ),
        (
            lambda: Camera(fov_deg=180),
            SceneValueError,
            "'fov_deg of Camera' must be below 180, not 180",
            None,
        ),
        (
            lambda: Camera(fov_deg=slider("Zoom", 40, 10, 200)),
            SceneValueError,
            "'fov_deg of Camera' must be below 180, not 200",
            None,
        ),
        (
            lambda: Camera(fov=1, fov_deg=45),
            SceneTypeError,
            "Camera takes fov or fov_deg, not both",
            "fov is in radians",
        ),
        (
            lambda: TurnedCamera(screen_distance=1, fov=1),
            SceneTypeError,
            "TurnedCamera takes screen_distance or an angle, not both",
            "each follows from the other",
        ),
        (
            lambda: OrbitCamera(0),
            SceneValueError,
            "'distance of OrbitCamera' must be above 0, not 0",
            None,
        ),
        (
            lambda: FisheyeCamera(fov_deg=361),
            SceneValueError,
            "'fov_deg of FisheyeCamera' must be at most 360, not 361",
            None,
        ),
        (
            lambda: OrthographicCamera(height=-1),
            SceneValueError,
            "'height of OrthographicCamera' must be above 0, not -1",
            None,
        ),
    ],
)
def test_mistakes_say_what_is_wrong_and_what_mends_it(make, error, message, hint):
    with pytest.raises(error) as caught:
        make()
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.message, diagnostic.hint) == (message, hint)
