"""A lone shape's own scene: the whole shape in the picture, standing on the ground."""

import numpy as np
import pytest

from distal import Box, Hexagon, Plane, Scene, Sphere
from distal.lang import slider
from distal.scene.viewing.stage import stage


def seen(scene, **options):
    return scene.render(size=(64, 48), view="material", transparent=True, **options).array


def found_of(shape):
    """Which pixels show the shape, painted red."""
    picture = seen(stage(shape.paint("#ff0000")))
    return (picture[..., 0] > 0.9) & (picture[..., 1] < 0.1)


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(1.0),
        Sphere(0.01).translate(50.0, 3.0, -7.0),
        Box(30.0, 1.0, 1.0),
        Box(0.6, 9.0, 0.6),
        Hexagon(1.0),
    ],
    ids=["sphere", "tiny", "long", "tall", "flat"],
)
def test_all_of_a_shape_is_in_the_picture(shape):
    shown = found_of(shape)
    assert shown.sum() > 20
    for edge in (shown[0], shown[-1], shown[:, 0], shown[:, -1]):
        assert not edge.any()


def test_a_shape_without_end_is_shown_without_ground():
    shown = stage(Plane(y=0.0))
    assert isinstance(shown, Scene)
    assert np.isfinite(shown.render(size=(16, 12)).array).all()
    assert len(list(shown.shape.node.walk())) == 1
    assert len(list(stage(Sphere()).shape.node.walk())) == 3


def test_the_frame_follows_parameters():
    size = slider("Size", 1.0, low=0.5, high=50.0)
    scene = stage(Sphere(size).paint("#ff0000"), {"size": 40.0})
    picture = seen(scene, params={"size": 40.0})
    shown = (picture[..., 0] > 0.9) & (picture[..., 1] < 0.1)
    assert shown.any()
    assert not shown[0].any()


def test_a_cut_scene_is_developed_too():
    scene = stage(Sphere())
    assert scene.sectioned.tone_map == scene.tone_map  # is kept by the scene
    developed = scene.replace(exposure=3.0, tone_map="aces")
    assert developed.sectioned.tone_map == "aces"
    assert developed.sectioned.numbers["exposure"].value == 3.0


def test_light_is_developed_anew_and_the_scene_stays():
    scene = stage(Sphere())
    # Without a number of samples, the display values decide where more are taken.
    before = scene.render(size=(8, 6), samples=1).array
    darker = scene.replace(exposure=0.25, tone_map="aces").render(size=(8, 6), samples=1)
    assert darker.array[..., :3].mean() < before[..., :3].mean() - 0.1
    assert np.array_equal(scene.render(size=(8, 6), samples=1).array, before)
    assert np.array_equal(darker.linear, scene.render(size=(8, 6), samples=1).linear)
