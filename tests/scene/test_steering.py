"""A camera moved by hand is the camera that stands where the hand moved it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from distal import (
    Box,
    Camera,
    DistantLight,
    GradientBackground,
    HemisphereLight,
    OrbitCamera,
    OrthographicCamera,
    PanoramaCamera,
    Scene,
    Sphere,
)
from distal.backends import get_target
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.nodes import Call
from distal.ir.walk import nodes_in
from distal.lang import slider
from distal.lang.render_options import RenderOptions
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable

SIZE = (64, 48)
FOV = 0.7
SHAPE = (Box((1.0, 0.6, 1.4)) | Sphere(0.4).translate(0.7, 0.4, 0.2)).paint("#c96")


def scene_of(camera):
    # Lights of a look stand around the camera; these stand where they are for every camera.
    lights = [DistantLight((0.6, 1.0, 0.7), 0.8, angle=0.05), HemisphereLight()]
    return Scene(SHAPE, lights, camera, GradientBackground(), tone_map="none")


def picture(camera, steering=None, view="color"):
    seen = viewable(scene_of(camera))
    return seen.render(RenderOptions(size=SIZE, view=view, steering=steering)).array


def assert_alike(a, b):
    # Edges may fall on the other side of a pixel's middle; nothing else differs.
    off = np.abs(a - b).max(axis=-1) > 4 / 255
    assert off.mean() < 0.01
    assert np.abs(a - b)[~off].mean() < 5e-4


def front(**k):
    return Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov=FOV, **k)


def test_at_rest_it_is_the_authors_picture():
    assert np.abs(picture(front()) - picture(front(), Steering())).max() < 1e-5


@pytest.mark.parametrize(
    ("yaw", "pitch", "zoom"), [(0.7, 0.0, 1.0), (0.0, 0.5, 1.0), (-2.5, 0.9, 1.6), (0.3, -0.4, 0.7)]
)
def test_turns_and_zoom_are_an_orbit(yaw, pitch, zoom):
    wanted = picture(OrbitCamera(4.0 * zoom, azimuth=yaw, elevation=pitch, fov=FOV))
    assert_alike(picture(front(), Steering(yaw, pitch, zoom)), wanted)


def test_turns_go_on_from_where_the_camera_stands():
    start = OrbitCamera(4.0, azimuth=0.4, elevation=0.3, fov=FOV)
    wanted = picture(OrbitCamera(4.0, azimuth=1.0, elevation=0.8, fov=FOV))
    assert_alike(picture(start, Steering(0.6, 0.5)), wanted)


def test_a_drag_moves_what_is_seen_along_with_the_hand():
    # The pivot, in the middle at first, is seen where it was dragged to.
    across, up = 0.5, -0.25
    unit = 4.0 * math.tan(FOV / 2.0)
    shift = (-across * unit, -up * unit)
    moved = Camera((*shift, 4.0), (*shift, 0.0), fov=FOV)
    assert_alike(picture(front(), Steering(pan=(across, up))), picture(moved))
    near = Camera((shift[0] / 2, shift[1] / 2, 2.0), (shift[0] / 2, shift[1] / 2, 0.0), fov=FOV)
    assert_alike(picture(front(), Steering(pan=(across, up), zoom=0.5)), picture(near))


def test_in_a_mirror_the_eye_still_goes_where_the_hand_goes():
    wanted = picture(OrbitCamera(4.0, azimuth=-0.6, elevation=0.4, fov=FOV, mirrored=True))
    assert_alike(picture(front(mirrored=True), Steering(0.6, 0.4)), wanted)


def test_without_perspective_zoom_shows_less():
    camera = OrthographicCamera((0.0, 0.0, 4.0), height=3.0)
    wanted = picture(OrthographicCamera((0.0, 0.0, 2.0), height=1.5))
    assert_alike(picture(camera, Steering(zoom=0.5)), wanted)


def test_upright_is_what_the_author_says():
    # With z upright the first quarter turn goes from -y to +x.
    camera = Camera((0.0, -4.0, 0.0), up=(0.0, 0.0, 1.0), fov=FOV)
    wanted = picture(Camera((4.0, 0.0, 0.0), up=(0.0, 0.0, 1.0), fov=FOV))
    assert_alike(picture(camera, Steering(yaw=math.pi / 2)), wanted)


def test_a_camera_without_target_turns_around_what_it_sees():
    camera = Camera.yaw_pitch_roll((0.0, 0.0, 4.0), fov=FOV)
    low, high = SHAPE.bounds()
    middle = tuple((a + b) / 2.0 for a, b in zip(low, high, strict=True))
    # The place ahead that is nearest to the box's middle: straight ahead, at the middle's depth.
    pivot = (0.0, 0.0, middle[2])
    wanted = OrbitCamera(4.0 - middle[2], azimuth=0.8, elevation=0.3, target=pivot, fov=FOV)
    assert_alike(picture(camera, Steering(0.8, 0.3)), picture(wanted))


def test_a_panorama_looks_around():
    found = picture(PanoramaCamera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0)), Steering(yaw=0.5))
    place = (3.0 * math.sin(0.5), 0.0, 3.0 * math.cos(0.5))
    assert_alike(found, picture(PanoramaCamera(place, (0.0, 0.0, 0.0))))


@pytest.mark.parametrize("view", ["normal", "depth", "coordinate", "slice"])
def test_every_view_is_seen_from_there(view):
    wanted = picture(OrbitCamera(4.0, azimuth=0.7, elevation=0.5, fov=FOV), view=view)
    assert_alike(picture(front(), Steering(0.7, 0.5), view), wanted)


def test_elevation_tells_how_high_the_camera_stands():
    for camera, wanted in [
        (OrbitCamera(4.0, elevation=0.4), 0.4),
        (Camera((3.0, 3.0, 0.0)), math.pi / 4),
        (Camera((0.0, -3.0, -3.0), up=(0.0, 0.0, 1.0)), -math.pi / 4),
    ]:
        assert viewable(Scene(SHAPE, camera=camera)).elevation == pytest.approx(wanted, abs=1e-6)


def test_a_target_that_is_a_parameter_is_what_it_turns_around():
    height = slider("Height", 0.0, 0.0, 2.0)
    camera = Camera((0.0, height, 4.0), (0.0, height, 0.0), fov=FOV)
    seen = viewable(scene_of(camera))
    options = RenderOptions(size=SIZE, params={"height": 1.0})
    found = seen.render(replace(options, steering=Steering(yaw=0.9)))
    wanted = OrbitCamera(4.0, azimuth=0.9, target=(0.0, 1.0, 0.0), fov=FOV)
    assert_alike(found.array, picture(wanted))


def test_the_numbers_of_a_movement_are_one_uniform_each():
    # A second set under other names would stay at rest: hosts set the names of `settings`.
    for view in ("color", "depth"):
        module = module_of(view)
        names = [u.name for u in module.uniforms if u.name.startswith("View_")]
        of_range = {"View_low", "View_middle", "View_high"}
        assert sorted(set(names) - of_range) == sorted(Steering().settings)


def test_the_frame_part_computes_the_camera_once():
    # The lens needs four rays, the threshold of a hit two; drivers write out every call.
    calls = [
        e.function
        for e in nodes_in(*(value for _, value in module_of("color").frame))
        if isinstance(e, Call)
    ]
    rays = [name for name in calls if name.startswith("through_screen")]
    assert len(rays) <= 6
    assert not [name for name in calls if name.startswith(("camera_ray", "steered_ray", "lens"))]
    assert calls.count("rig") <= 1


def module_of(view):
    image = scene_of(front()).view(view, steered=True, encoded=True, sampled=True)
    return run_passes(lower(image.emitted()), get_target("glsl-es300"))
