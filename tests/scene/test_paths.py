"""Paths name every number of an object, and ``replace`` takes them."""

from __future__ import annotations

import pytest

from distal import Bolt, Box, OrbitCamera, PointLight, Scene, Sphere, glass, outdoor
from distal.lang import slider
from distal.scene.tree.errors import SceneTypeError, SceneValueError

RADIUS = slider("Radius", 1.0, low=0.1, high=3.0)
SCENE = Scene(
    Sphere(RADIUS).paint(glass(ior=1.4)).translate(1, 2, 3) | Box(1, 2, 3).paint((1, 0, 0)),
    [PointLight((1, 2, 3)), PointLight((3, 4, 5), intensity=2)],
    OrbitCamera(fov_deg=40, focus_distance=4.0),
    look=outdoor(exposure=1.5),
)


def test_paths_name_the_numbers_of_a_scene_and_of_its_parts():
    numbers = SCENE.paths()
    expected = {
        "shape.children.0.offset": (1.0, 2.0, 3.0),
        "shape.children.0.children.0.material.ior": 1.4,
        "shape.children.1.size": (1.0, 2.0, 3.0),
        "shape.children.1.material.color": (1.0, 0.0, 0.0),
        "lights.1.intensity": 2.0,
        "camera.fov_deg": 40,
        "look.exposure": 1.5,
        "exposure": 1.5,  # the scene's, which the look has chosen
    }
    assert {path: numbers[path] for path in expected} == expected
    assert numbers["shape.children.0.children.0.radius"] is RADIUS


@pytest.mark.parametrize("path", SCENE.paths())
def test_a_scene_with_another_number_at_a_path_has_it_there_alone(path):
    before = SCENE.paths()
    value = before[path]
    if path == "shape.children.0.children.0.radius":
        other = 0.5
    elif isinstance(value, tuple):
        other = tuple([0.25 + 0.5 * component for component in value])
    else:
        other = value + (1 if isinstance(value, int) else 0.125)
    after = SCENE.replace(**{path: other}).paths()
    assert after.pop(path) == pytest.approx(other)
    # What a look chooses follows its other numbers.
    follows = {"exposure", "ambient_occlusion", "fog", "fog_density"}
    same = before.keys() - {path} - follows
    assert after.keys() | follows | {path} == before.keys()
    for name in same:
        assert after[name] is before[name] or after[name] == before[name], name


def test_several_paths_and_names_at_once():
    other = SCENE.replace(**{"lights.0.intensity": 3.0, "lights.1.intensity": 4.0}, far=50.0)
    assert [light.intensity for light in other.lights] == [3.0, 4.0]
    assert other.far == 50.0


def test_shapes_composites_and_materials_have_paths():
    assert Bolt("M5", 25.0).paths() == {"length": 25.0}
    assert Bolt("M5", 25.0).replace(length=30.0).paths() == {"length": 30.0}
    moved = Sphere(1.0).translate(1, 0, 0)
    assert moved.replace(**{"children.0.radius": 2.0})((0.0, 0.0, 0.0)) == pytest.approx(-1.0)
    assert set(glass(ior=1.4).paths()) >= {"ior"}


@pytest.mark.parametrize(
    ("path", "message", "hint"),
    [
        ("shape.child.0.size", "there is no 'child' in 'shape'", "did you mean 'children'?"),
        ("lights.5.intensity", "there is no '5' in 'lights'", "it has 0, 1"),
        ("shap.size", "there is no 'shap'", "did you mean 'shape'?"),
        ("camera.fov_deg.x", "'x'", ""),
    ],
)
def test_a_path_that_leads_nowhere_is_refused_where_it_ends(path, message, hint):
    with pytest.raises((SceneValueError, SceneTypeError)) as caught:
        SCENE.replace(**{path: 1.0})
    (found,) = caught.value.diagnostics
    assert message in found.message and hint in (found.hint or "")
    assert found.span is not None and found.span.file == __file__


@pytest.mark.parametrize(
    "changes",
    [
        {"children": [Box(2), Sphere(9)], "children.1.radius": 0.3},
        {"children.1": Sphere(9), "children.1.radius": 0.3},
        {"children.1.radius": 0.3, "children.1": Sphere(9)},
    ],
)
def test_a_path_into_what_is_replaced_is_refused(changes):
    with pytest.raises(SceneValueError, match=r"is a part of 'children.*', which is replaced too"):
        (Box(1) - Sphere(0.5)).replace(**changes)


def test_x_y_z_are_parts_of_the_only_vector_as_in_calls():
    assert Sphere(1).translate(1, 0, 0).replace(y=2) == Sphere(1).translate(1, 2, 0)
    assert Box(1, 2, 3).replace(x=5, z=7).size == (5.0, 2.0, 7.0)
    with pytest.raises(SceneTypeError, match="got 'size' and its part 'x' too"):
        Box(1, 2, 3).replace(x=5, size=(3, 3, 3))


def test_what_was_not_given_has_no_parts_to_replace():
    with pytest.raises(SceneValueError, match=r"'lights' has no parts .*was not given") as told:
        Scene(Sphere()).replace(**{"lights.0.intensity": 2})
    assert "give it: replace(lights=…)" in str(told.value)
