"""Groups: what is in them moves together, lights and cameras too.

A scene that is placed as a whole, with its camera and its lights, shows the same picture.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import distal
from distal import (
    AmbientLight,
    Box,
    Camera,
    Circle,
    CompileError,
    DistantLight,
    HemisphereLight,
    OrbitCamera,
    PointLight,
    Scene,
    Sky,
    Sphere,
    SpotLight,
    deg,
    group,
    time,
)
from distal.lang import func, slider, vec3
from distal.render.declarations import BACKGROUNDS, CAMERAS, LIGHTS, Declaration, Move
from distal.render.lights import LightSample
from distal.scene.objects.cameras import CLASSES as CAMERA_CLASSES
from distal.scene.objects.cameras import TurnedCamera
from distal.scene.objects.declared import declared_class
from distal.scene.objects.lights import Light
from distal.scene.tree.arguments import slots_of, takes_color

SOLID = (Sphere(0.6) - Box(0.7).translate(0.5, 0.6, 0.4)).paint("red") | Box(0.5).translate(
    -1, 0, 0
)
LIGHT = SpotLight((1.5, 3.0, 2.5), (0.2, 0.0, 0.1), intensity=9.0, angle=0.9, radius=0.2)
CAMERA = Camera((1.0, 1.5, 4.0), (0.1, 0.2, 0.0), fov_deg=45)
SIZE = (32, 24)

ROTATION = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
MOVES = {
    "translate": lambda o: o.translate(0.3, -0.2, 0.5),
    "rotate x": lambda o: o.rotate(x=0.4),
    "rotate all": lambda o: o.rotate(x=0.4, y=-0.7, z=1.1),
    "rotate about": lambda o: o.rotate(0.8, axis=(0.6, 0.0, 0.8)),
    "quaternion": lambda o: o.rotate(quaternion=(0.1, 0.5, -0.1, 0.73**0.5)),
    "matrix": lambda o: o.rotate(matrix=ROTATION),
    "orient": lambda o: o.orient((1.0, 2.0, -0.5), (0.3, -1.0, 0.4)),
    "mirror": lambda o: o.mirror("x"),
    "mirror across": lambda o: o.mirror(across=(0.6, 0.0, -0.8), offset=0.3),
    "transform": lambda o: o.transform(np.c_[ROTATION, (0.1, 0.2, 0.3)]),
    "transform mirrored": lambda o: o.transform(np.c_[-ROTATION, (0.1, 0.2, 0.3)]),
    "several": lambda o: o.translate(1, 0, 0).rotate(y=0.3).mirror("z").translate(0, 1, 0),
}


def shown(scene: Scene, **given) -> np.ndarray:
    return np.asarray(scene.render(SIZE, samples=1, **given))


def picture(*scene, **given) -> np.ndarray:
    return shown(Scene(*scene, background="#203040", **given))


def alike(found: np.ndarray, wanted: np.ndarray, *, edges: int = 12) -> bool:
    """Whether pictures agree, but for pixels at edges, which rays of other digits may miss."""
    return int((np.abs(found - wanted).max(-1) > 2e-3).sum()) <= edges


@pytest.mark.parametrize("name", MOVES)
def test_a_light_and_a_camera_move_as_a_shape_does(name: str):
    for place in (LIGHT.position, LIGHT.target, CAMERA.target):
        ball = Sphere(0.1).translate(place)
        there = MOVES[name](
            group(ball, PointLight(place, radius=0.1), CAMERA.replace(target=place))
        )
        for moved in (there.lights[0].position, there.cameras[0].target):
            assert there.shape(moved) == pytest.approx(-0.1, abs=1e-9)
        assert there.lights[0].radius == pytest.approx(0.1)


@pytest.mark.parametrize("name", ["rotate all", "mirror across", "transform mirrored", "several"])
def test_what_is_placed_with_its_light_and_its_camera_shows_the_same_picture(name: str):
    there = MOVES[name](group(SOLID, LIGHT, CAMERA))
    assert alike(picture(there), picture(SOLID, LIGHT, CAMERA))
    # The camera alone would show another picture.
    assert not alike(picture(SOLID, LIGHT, there.cameras[0]), picture(SOLID, LIGHT, CAMERA))


def test_a_spot_light_turned_by_a_matrix_lights_what_one_given_turned_lights():
    position, target = ROTATION @ (1.5, 3.0, 2.5), ROTATION @ (0.2, 0.0, 0.1)
    turned, given = LIGHT.rotate(matrix=ROTATION), LIGHT.replace(position=position, target=target)
    assert turned.position == pytest.approx(given.position)
    assert np.array_equal(picture(SOLID, turned, CAMERA), picture(SOLID, given, CAMERA))


def test_a_scale_leaves_the_light_of_a_distant_light():
    light = DistantLight((1.0, 2.0, 1.0), intensity=0.8, angle=0.1)
    large = group(SOLID, light, CAMERA).scale(2.5)
    assert large.lights[0].arguments == light.arguments
    assert alike(picture(large), picture(SOLID, light, CAMERA))


def test_a_scale_keeps_the_intensity_and_scales_the_size_of_a_light():
    large = LIGHT.scale(2.0)
    assert (large.intensity, large.angle) == (9.0, 0.9)
    assert (large.radius, large.position) == (0.4, (3.0, 6.0, 5.0))
    # Twice as far, a fourth of the light.
    brighter = group(SOLID, large.replace(intensity=36.0), CAMERA.scale(2.0))
    assert alike(
        picture(brighter.replace(parts=(SOLID.scale(2.0), *brighter.parts[1:]))),
        picture(SOLID, LIGHT, CAMERA),
    )


def test_unequal_factors_move_places_and_scale_lengths_by_their_mean():
    large = LIGHT.scale(1.0, 2.0, 4.0)
    assert large.position == (1.5, 6.0, 10.0)
    assert large.radius == pytest.approx(0.4)
    assert HemisphereLight(up=(1, 1, 1)).scale(1, 2, 3).up == (1.0, 2.0, 3.0)
    assert DistantLight((1, 1, 1)).scale(3).direction == (1.0, 1.0, 1.0)


def test_a_mirrored_group_is_the_mirrored_picture():
    front = CAMERA.replace(position=(0.0, 1.0, 4.0), target=(0.0, 0.0, 0.0))
    there = picture(group(SOLID, LIGHT).mirror("x"), None, front)
    assert alike(there, picture(SOLID, LIGHT, front)[:, ::-1])


@pytest.mark.parametrize("name", ["rotate all", "mirror across"])
def test_cameras_of_angles_become_cameras_at_places(name: str):
    orbit = OrbitCamera(4.0, azimuth=0.4, elevation=0.3, target=(0.1, 0.2, 0.0), fov=0.9)
    turned = TurnedCamera((0.5, 0.4, 4.0), yaw=0.1, pitch=-0.1, roll=0.2, screen_distance=1.2)
    for camera in (orbit, turned):
        there = MOVES[name](group(SOLID, LIGHT, camera))
        assert type(there.cameras[0]).__name__ == "Camera"
        assert alike(picture(there), picture(SOLID, LIGHT, camera))


@pytest.mark.parametrize("name", CAMERA_CLASSES)
def test_every_camera_is_placed(name: str):
    camera = CAMERA_CLASSES[name]().translate(0.0, 0.0, 4.0 * (name == "PanoramaCamera"))
    there = group(SOLID, LIGHT, camera).rotate(y=0.5, x=0.3).mirror("z").translate(0, 0, 1)
    assert alike(picture(there), picture(SOLID, LIGHT, camera), edges=30)


def test_sizes_of_lenses_and_pictures_are_scaled():
    lens = CAMERA.replace(aperture=0.2, focus_distance=3.0).scale(2.0)
    assert (lens.aperture, lens.focus_distance) == (0.4, 6.0)
    assert distal.OrthographicCamera(height=3).scale(2).height == 6.0


def test_each_vector_of_a_light_and_a_camera_says_how_it_moves():
    for family in (LIGHTS, CAMERAS, BACKGROUNDS):
        for declaration in family.members.values():
            for slot in slots_of(declaration.function):
                if not slot.is_vector or slot.name in family.site:
                    continue
                moves = {**family.moves, **declaration.moves}
                is_color = takes_color(slot.name, family.colors)
                assert is_color is (slot.name not in moves), (declaration.name, slot.name)
    assert LIGHTS.moves["radius"] is Move.LENGTH


def test_a_new_light_is_placed_by_its_declaration():
    @func
    def lamp(p: vec3, position: vec3, end: vec3, intensity: float = 1.0) -> LightSample:
        """A lamp.

        Args:
            p: Point.
            position: One end.
            end: The other end.
            intensity: Brightness.
        """
        return LightSample(vec3(0.0, 1.0, 0.0), 1.0, vec3(intensity), 0.0)

    moves = {"end": Move.POSITION}
    made = declared_class(Declaration("Lamp", lamp, LIGHTS, LIGHTS.limits, moves=moves), Light)
    there = made((1, 0, 0), (2, 0, 0), 3.0).translate(0, 1, 0)
    assert there.arguments == {"position": (1, 1, 0), "end": (2, 1, 0), "intensity": 3.0}


def test_sliders_and_expressions_move_lights():
    turn, side = slider("Turn", 0.4, low=-2, high=2), slider("Side", 0.3, low=-2, high=2)
    moves = (
        lambda o, t, s: o.rotate(y=t).translate(s, 0, 0),
        lambda o, t, s: o.rotate(x=t, z=s).scale(1 + s),
        lambda o, t, s: o.rotate(t, axis=(0, 0, 1)).mirror(across=(0, 1, 0), offset=s),
        lambda o, t, s: o.translate((s, t, s)).orient((1, 0, 0), (s, 1, t)),
        lambda o, t, s: o.scale(1 + s, 1, 1 + t),
    )
    values = {"Turn": -0.7, "Side": 0.9}
    for move in moves:
        light, plain = move(LIGHT, turn, side), move(LIGHT, -0.7, 0.9)
        assert light.position.value(values) == pytest.approx(plain.position, abs=1e-6)
    whole = group(SOLID, LIGHT, CAMERA)
    scene = Scene(moves[0](whole, turn, side), background="#203040")
    assert alike(shown(scene, params=values), picture(moves[0](whole, -0.7, 0.9)))
    assert LIGHT.rotate(y=time).position.value(time=0.5) == pytest.approx(
        LIGHT.rotate(y=0.5).position
    )
    swung = PointLight((side, 1, 0)).translate(1, 0, 0).position
    assert tuple(swung.value({"Side": 0.5})) == (1.5, 1.0, 0.0)


def test_groups_nest_and_show_their_parts():
    lamp = group(Sphere(0.2), PointLight((0, 0.5, 0), 2.0))
    street = group(lamp.translate(1, 0, 0), lamp.translate(-1, 0, 0), Box(3, 0.1, 1), CAMERA)
    there = street.translate(0, 0, 2)
    assert [light.position for light in there.lights] == [(1, 0.5, 2), (-1, 0.5, 2)]
    assert there.shape.operator == "union"
    assert len(there.shape.children) == 3
    assert there.cameras[0].position == (1.0, 1.5, 6.0)
    assert there.parts[0].parts[0].operator == "translate"
    assert lamp.arguments == {"parts": lamp.parts}
    assert lamp.replace(parts=lamp.parts[1:]).shape is None
    assert eval(repr(street)) == street != lamp
    assert group([Sphere(), CAMERA]).parts[1] is CAMERA
    with pytest.raises(AttributeError, match="does not change"):
        lamp.parts = ()


def test_groups_are_added():
    lamp = group(Sphere(0.2), PointLight((0, 0.5, 0)))
    for added in (lamp | Box(), Box() | lamp, lamp | lamp, lamp | CAMERA, LIGHT | lamp):
        assert isinstance(added, distal.Group)
        assert len(added.parts) == 3
    assert (Box() | lamp).shape.operator == "union"
    with pytest.raises(TypeError):
        lamp | 3


def test_a_scene_takes_the_lights_and_the_camera_of_a_group():
    whole = group(SOLID, LIGHT, CAMERA)
    scene = Scene(whole, AmbientLight(0.2))
    assert scene.lights[1] is LIGHT
    assert isinstance(scene.lights[0], AmbientLight)
    assert scene.camera is CAMERA
    assert scene.arguments["shape"] is whole
    assert len(scene.arguments["lights"]) == 1
    assert scene.replace(exposure=2).lights == scene.lights
    assert scene.replace(camera=OrbitCamera()).camera.declaration.name == "OrbitCamera"
    assert not scene.has_floor
    assert Scene(group(SOLID)).lights == Scene(SOLID).lights or Scene(group(SOLID)).has_floor
    assert np.array_equal(np.asarray(whole.render(SIZE, samples=1)), shown(Scene(whole)))
    assert whole.paint("blue").shape.material.color == pytest.approx((0, 0, 1))
    assert whole.paint("blue").lights == (LIGHT,)


def test_a_scene_in_a_scene_brings_its_shapes_and_lights_alone():
    room = Scene(SOLID, LIGHT, CAMERA, background="red", look="night", exposure=3, floor=True)
    outer = Scene([room, Box(0.2)], None, OrbitCamera(), background="#203040")
    assert outer.lights == (LIGHT,)
    assert outer.look.name == Scene(SOLID).look.name
    assert outer.camera.declaration.name == "OrbitCamera"
    assert alike(picture(room, None, CAMERA), picture(SOLID, LIGHT, CAMERA), edges=0)
    moved = group(room, CAMERA).translate(1, 2, 3).rotate(y=0.4)
    assert moved.lights[0].arguments == LIGHT.translate(1, 2, 3).rotate(y=0.4).arguments
    assert alike(picture(moved), picture(SOLID, LIGHT, CAMERA))
    nested = Scene(group(Scene(group(SOLID, LIGHT, CAMERA)), OrbitCamera()))
    assert nested.lights == (LIGHT,)
    assert nested.camera.declaration.name == "OrbitCamera"
    assert Scene(Scene(SOLID)).lights != ()  # the look's


def test_a_sky_turns_by_its_sun():
    assert Sky(sun=(1, 0, 0)).rotate(y=90 * deg).sun == pytest.approx((0, 0, -1))
    assert Sky(sun=(1, 1, 0)).translate(5, 5, 5).sun == (1, 1, 0)


REFUSED = {
    "a number": (lambda: group(3), "a group is of shapes, lights and cameras, not 3"),
    "a class": (lambda: group(Sphere), "not the class Sphere"),
    "nothing": (lambda: group(), "a group has at least one part"),
    "flat": (lambda: group(Circle()), "'Circle' is a flat shape; a group is of solids"),
    "another argument": (lambda: group(LIGHT).replace(shape=1), "a group has no 'shape'"),
    "no shape": (lambda: Scene(group(LIGHT)), "a scene without shapes shows nothing"),
    "cameras": (lambda: Scene(group(SOLID, CAMERA, CAMERA)), "the group has 2 cameras"),
    "a light alone": (lambda: Scene([SOLID, LIGHT]), "group(shape, light, camera) groups them"),
    "a light united": (lambda: Sphere() | LIGHT, "group(shape, light) places them together"),
    "a group united": (lambda: Sphere().union(group(LIGHT)), "a | group, or group(a, b)"),
    "by cell": (lambda: LIGHT.translate(distal.cell.x, 0, 0), "a light is one: its offset differs"),
    "a letter": (lambda: LIGHT.mirror("w"), "mirror takes letters of 'xyz'"),
    "two ways": (lambda: CAMERA.rotate(x=1, quaternion=(0, 0, 0, 1)), "in exactly one way"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_part_or_no_placement_is_refused(name: str):
    wrong, message = REFUSED[name]
    with pytest.raises(CompileError) as caught:
        wrong()
    assert message in str(caught.value)
    assert "test_groups.py" in str(caught.value)


def test_lights_and_cameras_keep_their_other_arguments():
    for light in (PointLight((1, 2, 3), radius=0.1), AmbientLight(0.3), DistantLight()):
        assert light.translate(1, 2, 4).translate(-1, -2, -4).arguments == light.arguments
    assert CAMERA.rotate(y=math.tau).position == pytest.approx(CAMERA.position)
    assert CAMERA.translate(1, 0, 0).fov_deg == 45


def test_a_group_that_grows_in_a_loop_is_one_list():
    lamps = group(Sphere(0.1))
    for number in range(2_000):
        lamps = lamps | PointLight((number, 1, 1))
    assert len(lamps.parts) == 2_001 == len(lamps.lights) + 1
    assert hash(lamps.translate(0, 1, 0)) == hash(lamps.translate(0, 1, 0))


def test_a_command_shows_a_group_by_its_name(tmp_path):
    file = tmp_path / "lamp.py"
    file.write_text(
        "from distal import *\nball = Sphere(0.2)\nlamp = group(ball, PointLight((0, 2, 0)))\n",
        encoding="utf-8",
    )
    shown = distal.load(f"{file}:lamp")
    assert isinstance(shown, distal.Scene)
    assert len(shown.lights) == 1
    file.write_text("from distal import *\nlamp = group(Sphere(0.2))\n", encoding="utf-8")
    assert isinstance(distal.load(file), distal.Scene)
