"""Looks: what they give a scene, what the author's arguments replace, and what is in the frame."""

import itertools
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    Cylinder,
    DistantLight,
    HemisphereLight,
    Look,
    OrbitCamera,
    Plane,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    Torus,
    blueprint,
    night,
    outdoor,
    studio,
    sunset,
    time,
)
from distal.diagnostics import LoadError
from distal.lang import func, length, slider, vec3
from distal.render.framing import framed
from distal.scene.looks.boxes import subject_box
from distal.scene.looks.rows import NAMES, ROWS
from distal.scene.rerender import plan_rerender, rerender
from distal.scene.viewing.viewable import viewable

FUNCTIONS = {"studio": studio, "outdoor": outdoor, "sunset": sunset, "night": night}
FUNCTIONS["blueprint"] = blueprint


@func
def ball_field(p: vec3, radius: float) -> float:
    return length(p) - radius


def box_of(scene):
    values = scene.camera.call.values
    middle, half = np.array(values["target"].value), np.array(values["half_size"].value)
    return middle - half, middle + half


def projected(scene, resolution):
    """The corners of the scene's box in the picture: 1 is its edge, in both directions."""
    values = {n: v.value for n, v in scene.camera.call.values.items()}
    low, high = box_of(scene)
    corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
    rays = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
    seen = [
        framed(np.array([uv]), np.array([resolution], float), **_columns(values)) for uv in rays
    ]
    eye = np.asarray(seen[0].origin)[0]
    ahead, aside, above = (np.asarray(ray.direction)[0] for ray in seen)
    right = aside / (aside @ ahead) - ahead
    up = above / (above @ ahead) - ahead
    offsets = corners - eye
    depth = offsets @ ahead
    aspect = resolution[0] / resolution[1]
    x = offsets @ right / (right @ right) / depth / aspect
    y = offsets @ up / (up @ up) / depth
    return x, y, depth


def _columns(values):
    return {n: np.array([v], float) for n, v in values.items()}


SHAPES = {
    "sphere": Sphere(),
    "tiny": Sphere(0.01),
    "huge": Box(1e4, 2e4, 1e4),
    "far away": Sphere(0.5).translate(900.0, -40.0, 300.0),
    "flat": Box(3.0, 0.002, 2.0),
    "thin": Cylinder(0.003, 4.0),
    "wide": Box(30.0, 1.0, 1.0),
    "standing": Box(0.2, 9.0, 0.2) | Plane(y=-4.5),
    "deep": Box(1.0, 1.0, 40.0),
}


@pytest.mark.parametrize("resolution", [(640, 480), (1280, 720), (360, 640), (64, 64)])
@pytest.mark.parametrize("name", SHAPES)
def test_the_whole_box_fills_the_picture_up_to_the_margin(name, resolution):
    scene = Scene(SHAPES[name])
    x, y, depth = projected(scene, resolution)
    assert (depth > 0.0).all()
    extent = max(np.abs(x).max(), np.abs(y).max())
    assert extent == pytest.approx(1.0 / ROWS["studio"].numbers["margin"], rel=2e-3)
    # It touches the margin on two opposite sides, so it is in the middle.
    tight = x if np.abs(x).max() > np.abs(y).max() else y
    assert -tight.min() == pytest.approx(tight.max(), rel=2e-3)


@pytest.mark.parametrize("look", NAMES)
def test_every_look_sees_the_whole_shape_from_above_the_floor(look):
    scene = Scene(Torus(1.0, 0.3).paint("#ff0000"), look=look)
    picture = scene.render(size=(48, 36), view="material").array
    red = (picture[..., 0] > 0.9) & (picture[..., 1] < 0.1)
    assert red.sum() > 60
    for edge in (red[0], red[-1], red[:, 0], red[:, -1]):
        assert not edge.any()
    assert np.isfinite(scene.render(size=(16, 12)).array).all()


def test_the_box_is_that_of_the_finite_parts():
    shape = Sphere(0.5).translate(2.0, 1.0, 0.0) | Plane() | Sphere().repeat(3.0, 0.0, 0.0)
    found = subject_box(shape.node, {}, 0.0)
    assert (found.low, found.high) == ((1.5, 0.5, -0.5), (2.5, 1.5, 0.5))
    assert len(found.endless) == 2
    assert not found.cut
    alone = subject_box(Plane().node, {}, 0.0)
    assert (alone.low, alone.high) == ((-2.0, -2.0, -2.0), (2.0, 0.0, 2.0))
    assert alone.cut
    rod = subject_box((Box(1.0, 1.0, 1.0).repeat(0.0, 2.0, 0.0)).node, {}, 0.0)
    assert (rod.low, rod.high) == ((-0.5, -2.0, -0.5), (0.5, 2.0, 0.5))


def test_parameters_and_the_time_are_at_their_start():
    size = slider("Size", 1.0, low=0.5, high=50.0)
    moving = Sphere(size).translate(5.0 * time + 1.0, 0.0, 0.0)
    assert subject_box(moving.node, {}, 0.0).low == (0.0, -1.0, -1.0)
    assert subject_box(moving.node, {"size": 3.0}, 2.0).low == (8.0, -3.0, -3.0)
    wide = viewable(moving, {"size": 3.0}, 2.0).scene
    assert box_of(wide)[1] == pytest.approx((14.0, 3.0, 3.0))


def test_boxes_need_no_device():
    shapes = (
        Box(1.0, 2.0, 3.0).rotate(y=0.3, x=1.0).scale(2.0).translate(1.0, 2.0, 3.0),
        Torus().union(Sphere(0.4), smooth=0.2).twist(0.5).round(0.1),
        (Box(1.0) - Sphere(0.6)).repeat(2.0, 2.0, 2.0, count=(3, 1, 2)),
        Sphere().symmetry("xz").elongate(0.5, 0.0, 0.2).shell(0.1, where="center"),
    )
    for shape in shapes:
        found, known = subject_box(shape.node, {}, 0.0), shape.bounds()
        assert np.allclose((found.low, found.high), known, rtol=1e-6, atol=1e-6)


# The floor


def has_floor(scene):
    return any(node.label == "floor" for node in scene.shape.node.walk())


def test_a_floor_is_where_nobody_says_otherwise():
    ball, sun = Sphere(), DistantLight((1, 1, 1))
    assert has_floor(Scene(ball))
    assert has_floor(Scene(ball, camera=Camera((0, 1, 5))))
    assert not has_floor(Scene(ball | Plane(-1.0)))
    assert not has_floor(Scene(ball.repeat(3.0, 3.0, 3.0)))
    assert not has_floor(Scene(ball, lights=sun))
    assert not has_floor(Scene(ball, background="#123"))
    assert has_floor(Scene(ball, lights=sun, look="outdoor"))
    assert not has_floor(Scene(ball | Plane(-1.0), look="outdoor"))
    assert not has_floor(Scene(ball, look="studio", floor=False))
    assert has_floor(Scene(ball, lights=sun, floor=True))


@pytest.mark.parametrize("mode", ["direct", "path"])
def test_a_camera_below_the_floor_sees_the_scene(mode):
    ball = Sphere(0.5).translate(0, 3, 0)
    camera = Camera((0, 0, 4), target=(0, 3, 0))
    scene = Scene(ball, camera=camera)
    assert not has_floor(scene)
    scene.render(size=(24, 18), mode=mode)  # no warning
    inside = "inside 'translate' or below the floor"
    hidden = Scene(ball, camera=camera, floor=True)
    if mode == "direct":
        with pytest.warns(UserWarning, match=f"{inside}: give floor=False"):
            hidden.render(size=(24, 18))
    else:
        with pytest.raises(distal.CompileError, match=inside):
            hidden.render(size=(24, 18), mode=mode)


def test_the_floor_touches_the_lowest_point():
    scene = Scene(Box(2.0, 1.0, 2.0).translate(y=7.0))
    floor = next(node for node in scene.shape.node.walk() if node.label == "floor")
    assert floor.numbers["y"].value == pytest.approx(6.5, abs=2e-4)
    assert floor.numbers["y"].value < 6.5


def test_unpainted_ground_has_the_floors_color():
    def shows(scene, name):
        shown = scene.render(size=(32, 24), layers=["albedo"]).layers["albedo"]
        return (np.abs(shown - ROWS["studio"].numbers[name]).max(axis=-1) < 1e-3).any()

    both = Scene(Sphere() | Plane(-1.0))
    assert shows(both, "material")
    assert shows(both, "floor_color")
    assert not shows(Scene(Plane(-1.0)), "floor_color")
    red = Scene(Sphere() | Plane(-1.0), default_material=(1.0, 0.0, 0.0))
    assert not shows(red, "floor_color")


# What the author gives


def test_each_argument_replaces_its_part_alone():
    plain = Scene(Sphere())
    lamp, camera = PointLight((1, 2, 3)), Camera((0, 1, 5))
    given = Scene(Sphere(), lamp, camera, "#203040", exposure=2.0, tone_map="agx", fog_density=0.5)
    assert given.lights == (lamp,)
    assert given.camera is camera
    assert given.tone_map == "agx"
    assert given.numbers["exposure"].value == 2.0
    assert given.numbers["fog_density"].value == 0.5
    assert given.material.call.values["color"] == plain.material.call.values["color"]
    assert len(Scene(Sphere(), camera=camera).lights) == len(plain.lights) == 3
    assert Scene(Sphere(), look="night", tone_map="none").tone_map == "none"


def test_a_background_that_is_a_light_is_the_light():
    sky = Sky(light=True)
    assert Scene(Sphere(), background=sky).lights == (sky,)
    assert len(Scene(Sphere(), background=Sky()).lights) == 3
    assert Scene(Sphere(), lights=[sky]).background.call is sky.background


def test_fog_belongs_to_the_looks_own_background():
    assert Scene(Sphere(), look="night").numbers["fog_density"].value > 0.0
    assert Scene(Sphere(), look="night", background="#000").numbers["fog_density"].value == 0.0


def test_occlusion_reaches_half_the_radius():
    for radius in (0.01, 1.0, 300.0):
        reach = Scene(Sphere(radius)).numbers["ambient_occlusion"].value
        assert reach == pytest.approx(0.5 * math.sqrt(3.0) * radius)
    assert Scene(Sphere(), ambient_occlusion=0.0).numbers["ambient_occlusion"].value == 0.0


@pytest.mark.parametrize("name", NAMES)
def test_a_look_is_its_name_with_other_numbers(name):
    made = FUNCTIONS[name](exposure=0.5, azimuth=1.0, light_color="#ff0000")
    assert isinstance(made, Look)
    scene = Scene(Sphere(), look=made)
    assert scene.numbers["exposure"].value == 0.5
    assert scene.camera.call.values["azimuth"].value == 1.0
    assert scene.lights[0].sample.values["color"].value == (1.0, 0.0, 0.0)
    same = Scene(Sphere(), look=FUNCTIONS[name]()).render(size=(16, 12)).array
    assert np.array_equal(same, Scene(Sphere(), look=name).render(size=(16, 12)).array)


def test_numbers_of_a_look_may_be_parameters():
    height = slider("Sun height", 0.6, low=0.05, high=1.5)
    scene = Scene(Sphere(), look=outdoor(light_elevation=height))
    low, high = (scene.render(size=(24, 18), params={"sun_height": h}).array for h in (0.1, 1.2))
    assert np.abs(low - high).max() > 0.1


def test_lights_stand_around_the_camera():
    def picture(turn, **given):
        camera = OrbitCamera(6.0, azimuth=0.5 + turn, elevation=0.3, **given)
        return Scene(Sphere(), camera=camera).render(size=(24, 18)).array

    # In penumbrae the few rays to a wide light lie otherwise; elsewhere all pixels are alike.
    turned = np.abs(picture(0.0) - picture(2.0))
    assert turned.mean() < 2e-3
    assert np.percentile(turned, 95.0) < 0.01
    # Lights do not follow a camera that moves.
    moving = Scene(Sphere(), camera=OrbitCamera(6.0, azimuth=0.5 + time, elevation=0.3))
    start, later = (moving.render(size=(24, 18), time=t).array for t in (0.0, 2.0))
    assert np.abs(start - picture(0.0)).max() < 1e-6
    assert np.abs(start - later).max() > 0.2
    eye = Camera((6.0 * math.sin(0.5), 0.0, 6.0 * math.cos(0.5)))
    lights = Scene(Sphere(), camera=eye).lights
    first = Scene(Sphere()).lights[0].sample.values["position"].value
    assert lights[0].sample.values["position"].value == pytest.approx(first)


def test_a_scene_looks_the_same_at_every_size_and_place():
    one = Scene(Torus(1.0, 0.4)).render(size=(32, 24)).array
    many = Scene(Torus(10.0, 4.0).translate(50.0, 20.0, -30.0)).render(size=(32, 24)).array
    assert np.abs(one - many).mean() < 2e-3


def test_colors_are_not_clipped():
    for name in NAMES:
        picture = Scene(Sphere(), look=name).render(size=(48, 36)).array[..., :3]
        assert (picture >= 0.998).all(axis=-1).mean() == 0.0
        assert picture.std() > 0.03


# The command line, saved pictures, texts


def test_another_look_keeps_what_the_author_gave():
    scene = Scene(Sphere(), lights=HemisphereLight(), exposure=0.7)
    changed = viewable(scene, look="sunset").scene
    assert changed.lights == scene.lights
    assert changed.numbers["exposure"].value == 0.7
    assert changed.background.call.func is not scene.background.call.func
    assert changed.place == scene.place
    assert viewable(scene).scene is scene
    lamps = (PointLight((i, 2.0, 3.0)) for i in range(2))
    once = viewable(Scene((Sphere(r) for r in (0.5, 0.7)), lamps), look="night").scene
    assert len(once.lights) == 2
    staged = viewable(Sphere(), look="night").scene
    assert staged.tone_map == ROWS["night"].tone_map
    assert staged.asked_display == {"look": "night"}
    with pytest.raises(LoadError, match="looks are for scenes and shapes"):
        viewable(distal.load("example:course_1_rays"), look="night")


def test_a_picture_records_its_look(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("ball.py").write_text("from distal import Sphere\nball = Sphere()\n")
    scene = viewable(distal.load("ball.py"), look="night").scene
    picture = scene.render(size=(16, 12))
    assert picture.provenance.look == "night"
    picture.save(Path("ball.png"))
    again = rerender(plan_rerender(Path("ball.png")))
    assert np.array_equal(again.array, picture.array)


TEXTS_WITHOUT_NUMPY = """
import sys
sys.modules["numpy"] = None
import distal
from distal import Box, Plane, Scene, Sphere, Torus
from distal.lang import slider
turn = slider("Turn", 0.5)
shape = Torus().rotate(y=turn).union(Box(1.0).twist(0.4), smooth=0.1)
for look in ("studio", "outdoor", "sunset", "night", "blueprint"):
    for target in ("glsl-es300", "wgsl", "shadertoy"):
        print(len(distal.compile(Scene(shape, look=look), target).text) > 1000)
"""


def test_texts_need_the_standard_library_alone():
    command = [sys.executable, "-c", TEXTS_WITHOUT_NUMPY]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["True"] * 15, done.stderr


# Mistakes


def told(make):
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    return str(caught.value)


def test_unknown_looks_and_numbers_are_told():
    message = told(lambda: Scene(Sphere(), look="studoi"))
    assert "there is no look 'studoi'" in message
    assert "did you mean 'studio'?" in message
    assert "looks: studio, outdoor, sunset, night, blueprint" in told(
        lambda: Scene(Sphere(), look="moon base")
    )
    message = told(lambda: Scene(Sphere(), look=outdoor))
    assert "a look is wanted, not" in message
    assert "outdoor()" in message
    message = told(lambda: outdoor(exposur=2.0))
    assert "outdoor has no 'exposur'" in message
    assert "did you mean 'exposure'?" in message
    assert "'exposure of night' must be 0 or more, not -1" in told(lambda: night(exposure=-1.0))
    assert "a camera is wanted" in told(lambda: Scene(Sphere(), camera="front"))


def test_a_look_does_not_change():
    look = studio()
    with pytest.raises(AttributeError, match="a look does not change"):
        look.name = "mine"
    assert repr(look) == "studio()"


def test_a_field_without_a_box_is_seen():
    scene = Scene(Shape.from_function(ball_field, radius=0.8).paint("#ff0000"))
    picture = scene.render(size=(24, 18), view="material").array
    assert (picture[..., 0] > 0.9).any()


def test_the_ground_of_a_room_that_is_placed_keeps_the_floors_material():
    room = Sphere(1.0).paint("red") | Plane(-1.0)
    still, moved = Scene(room), Scene(room.translate(5.0, 0.0, 0.0))
    turned = Scene((room.rotate(y=0.5) | Box(0.2).translate(1.5, 0, 0)).scale(2.0))
    painted = Scene(room.paint("blue").translate(5.0, 0.0, 0.0))
    for scene, has_ground in ((still, True), (moved, True), (turned, True), (painted, False)):
        (plane,) = (node for node in scene.shape.node.walk() if node.rule.name == "Plane")
        assert (plane.material is not None) is has_ground
    assert np.abs(moved.render((40, 30)).array - still.render((40, 30)).array).mean() < 1e-3
