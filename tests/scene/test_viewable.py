"""One interface over all that is a picture."""

import math

import numpy as np
import pytest

from distal import Scene, Sphere, time
from distal.diagnostics import LoadError
from distal.lang import Frame, func, image, vec3
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import viewable


@image
def plain(frame: Frame) -> vec3:
    return vec3(0.2, 0.4, 0.6)


@image
def moving(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    level = uv.x * frame.time
    return vec3(level)


@func
def distance(p: vec3) -> float:
    return p.x


def test_a_scene_is_seen_in_every_way():
    seen = viewable(Scene(Sphere(), name="ball"))
    assert seen.name == "ball"
    assert seen.views[0] == "color" and {"normal", "depth", "slice"} <= set(seen.views)
    assert seen.steers and not seen.animated
    assert seen.file.name == "test_viewable.py"


def test_a_shape_stands_on_a_stage():
    seen = viewable(Sphere(2.0))
    assert seen.steers and seen.scene is not None
    picture = seen.render(RenderOptions(size=(16, 12)))
    assert picture.array.std() > 0.05


def test_an_image_has_the_views_that_it_can_show():
    assert viewable(plain).views == ("color", "coordinate", "signal")
    views = viewable(moving).views
    assert views[:3] == ("color", "coordinate", "signal")
    assert all(view.startswith("local:") for view in views[3:])
    assert not viewable(moving).steers
    assert viewable(moving).settings(Steering(yaw=1.0)) == {}


def test_animated_is_what_reads_the_time():
    assert viewable(moving).animated and not viewable(plain).animated
    assert viewable(Scene(Sphere().translate(np.sin(time), 0.0, 0.0))).animated


def test_a_scene_whose_exposure_moves_is_animated():
    # Nothing but what encodes its light for display reads the time.
    assert viewable(Scene(Sphere(), exposure=1.0 + 0.5 * np.sin(time))).animated


def test_encoded_views_are_the_pictures_values():
    seen = viewable(Scene(Sphere().paint("#c63"), tone_map="aces", exposure=1.3))
    options = RenderOptions(size=(24, 18), samples=1)
    whole = seen.render(options).array
    encoded = executor().render(seen.image("color", encoded=True), options)
    assert np.abs(whole - encoded.array).max() < 1e-4


@pytest.mark.parametrize(
    ("obj", "message"),
    [
        (distance, "'distance' is a @func; only a scene, a shape or an @image is a picture"),
        (3, "'3' is of type int; only a scene, a shape or an @image is a picture"),
    ],
)
def test_what_is_no_picture(obj, message):
    with pytest.raises(LoadError) as caught:
        viewable(obj)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"zoom": 0.0}, "zoom is a factor above 0, not 0"),
        ({"zoom": -1.0}, "zoom is a factor above 0, not -1"),
        ({"yaw": math.nan}, "a camera is moved by finite numbers"),
        ({"pan": (math.inf, 0.0)}, "a camera is moved by finite numbers"),
    ],
)
def test_a_steering_is_checked(numbers, message):
    with pytest.raises(ValueError, match=message):
        Steering(**numbers)
