"""What a pixel saw: closed forms, the picture's own pixels, and the place in the source."""

import json

import numpy as np
import pytest

import distal
from distal import (
    Box,
    Camera,
    OrthographicCamera,
    Plane,
    RoundBox,
    Scene,
    Sphere,
    matte,
    mirror,
)
from distal.lang import Frame, image, slider, struct, vec3, vec4
from distal.scene.checks.probe import probe
from distal.scene.checks.probe_image import probe_image

FRONT = Camera((0.0, 0.0, 5.0), target=(0.0, 0.0, 0.0), fov_deg=40.0)


def test_the_middle_of_a_sphere():
    found = probe(Scene(Sphere(1.0), camera=FRONT, floor=False), (50, 50), (101, 101))
    assert found.hit
    assert found.ended == "hit"
    seen = found.seen
    assert tuple(seen.origin) == pytest.approx((0.0, 0.0, 5.0))
    assert tuple(seen.direction) == pytest.approx((0.0, 0.0, -1.0), abs=1e-6)
    assert seen.t == pytest.approx(4.0, abs=5e-3)
    assert tuple(seen.p) == pytest.approx((0.0, 0.0, 1.0), abs=5e-3)
    assert tuple(seen.normal) == pytest.approx((0.0, 0.0, 1.0), abs=1e-5)
    assert seen.steepness == pytest.approx(1.0)
    assert [node.name for node in found.path] == ["Sphere"]


def test_rows_count_from_the_top():
    scene = Scene(Sphere(0.5).translate(0.0, 1.0, 0.0), camera=FRONT)
    assert probe(scene, (50, 20), (101, 101)).hit
    assert not probe(scene, (50, 80), (101, 101)).hit


def test_a_pixel_sees_what_the_picture_shows_there():
    scene = Scene(
        RoundBox(1.2, 0.1).paint("#ff0000") | Sphere(0.8).translate(1.0, 0.3, 0.0).paint("#00ff00"),
        camera=Camera((1.0, 2.0, 5.0)),
        floor=False,
    )
    size = (32, 24)
    normals = scene.render(size=size, view="normal").array
    materials = scene.render(size=size, view="material").array
    steps = 0
    for x, y in ((16, 12), (14, 12), (19, 11), (20, 10), (2, 2)):
        found = probe(scene, (x, y), size)
        steps += found.seen.steps
        if not found.hit:
            assert (x, y) == (2, 2)
            continue
        color = tuple(round(float(c)) for c in found.seen.surface.color)
        assert tuple(materials[y, x, :3]) == pytest.approx(color, abs=1e-3)
        assert normals[y, x, :3] == pytest.approx(0.5 + 0.5 * np.array(found.seen.normal), abs=1e-3)
        assert found.path[-1].name == ("RoundBox" if color[0] else "Sphere")
    assert steps > 5


def test_a_ray_that_meets_nothing_says_how_it_ended():
    ended = {}
    floor = Plane(y=-1.0)
    shapes = {"sphere": Sphere(0.5), "plane": floor, "slope": floor.rotate(z=0.1)}
    for name, shape in shapes.items():
        for y in (2, 30):
            ended[name, y] = probe(
                Scene(shape, camera=FRONT, floor=False), (2, y), (100, 100)
            ).ended
    assert ended["sphere", 2] == "passed the box"
    assert ended["plane", 2] == "passed the box"
    assert ended["slope", 2] == "left the scene"
    level = {"camera": OrthographicCamera((0, 0, 5), height=2), "floor": False}
    corner = probe(Scene(Sphere(1.0), **level), (1, 1), (50, 50))
    assert corner.ended == "left the box"
    few = Scene(Sphere(0.9).round(0.1), **level, steps=1)
    assert probe(few, (8, 8), (50, 50)).ended == "ran out of steps"


def test_a_cut_names_its_cutter_and_shows_the_bodys_material():
    body = Box(2.0).paint(matte("#ff0000"))
    scene = Scene(body - Sphere(0.8).translate(0.0, 0.0, 1.0), camera=FRONT)
    found = probe(scene, (50, 50), (101, 101))
    assert found.path[-1].name == "Sphere"
    assert found.material is body.node.material
    cut = Sphere(0.8).translate(0.0, 0.0, 1.0).cut_material(mirror())
    painted = probe(Scene(body - cut, camera=FRONT), (50, 50), (101, 101))
    assert painted.material is cut.node.cut_material


def test_the_outermost_paint_is_named():
    inner = Sphere(1.0).paint("#ff0000")
    outer = (inner | Box(0.1)).paint(mirror())
    found = probe(Scene(outer, camera=FRONT), (50, 50), (101, 101))
    assert found.material is outer.node.material
    assert found.as_json()["material"]["name"] == "mirror"
    bare = probe(Scene(Sphere(1.0), camera=FRONT), (50, 50), (101, 101))
    assert bare.material is not None


def test_parameters_and_time_move_what_is_seen():
    away = slider("Away", 0.0, high=9.0)
    scene = Scene(Sphere(1.0).translate(away, 0.0, 0.0), camera=FRONT)
    assert probe(scene, (50, 50), (101, 101)).hit
    assert not probe(scene, (50, 50), (101, 101), {"away": 3.0}).hit


def test_from_inside():
    scene = Scene(Sphere(9.0), camera=FRONT)
    found = probe(scene, (50, 50), (101, 101))
    assert found.hit
    assert found.seen.side == -1.0
    assert found.seen.t == pytest.approx(14.0, abs=0.05)


def test_plain_values_are_json():
    scene = Scene(Sphere(1.0).named("ball") | Plane(y=-9.0), camera=FRONT)
    made = json.loads(json.dumps(probe(scene, (50, 50), (101, 101)).as_json(), allow_nan=False))
    assert set(made) == {
        *(
            "version",
            "pixel",
            "size",
            "ray",
            "steps",
            "hit",
            "ended",
            "distance",
            "inside",
            "point",
        ),
        *("value", "normal", "gradient", "slope", "shape", "material"),
    }
    assert made["shape"]["path"] == ["union", "ball"]
    assert made["shape"]["kind"] == "Sphere"
    assert made["shape"]["place"]["file"] == __file__
    missed = probe(scene, (0, 0), (101, 101)).as_json()
    assert missed["shape"] is None
    assert "point" not in missed


@pytest.mark.parametrize("pixel", [(-1, 0), (4, 0), (0, 3)])
def test_no_such_pixel(pixel):
    with pytest.raises(ValueError, match="a picture of 4x3 has no pixel"):
        probe(Scene(Sphere(1.0), camera=FRONT), pixel, (4, 3))


# Images


@struct
class Met:
    distance: float
    material: int


@image
def drawn(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    met = Met(4.0 * uv.x, 3)
    inside = uv.x < 0.5
    total = 0.0
    for i in range(3):
        total += uv.y * float(i)
    if inside:
        return vec3(uv, 0.25)
    late = vec4(uv, met.distance, frame.time)
    return late.xyz * total


def test_a_pixel_of_an_image_has_the_values_of_its_locals():
    found = probe_image(drawn, (3, 1), (4, 4), time=2.5)
    # The middle of the fourth column, and of the third row from below.
    u, v = 3.5 / 4.0, 2.5 / 4.0
    values = {each.name: each.value for each in found.locals}
    assert tuple(values["uv"]) == pytest.approx((u, v))
    assert values["met.distance"] == pytest.approx(4.0 * u)
    assert values["met.material"] == 3
    assert values["inside"] is False
    assert values["total"] == pytest.approx(3.0 * v)
    assert tuple(values["late"]) == pytest.approx((u, v, 4.0 * u, 2.5))
    assert found.color == pytest.approx((3 * v * u, 3 * v * v, 3 * v * 4 * u, 1.0))
    types = {each.name: str(each.type) for each in found.locals}
    assert types["late"] == "vec4" and types["inside"] == "bool" and types["met.material"] == "int"
    lines = {each.name: each.place.text.strip() for each in found.locals}
    assert lines["uv"] == "uv = frame.coord / frame.resolution"
    assert lines["met.distance"] == "met = Met(4.0 * uv.x, 3)"


def test_a_local_that_a_pixel_did_not_reach_has_no_value():
    found = probe_image(drawn, (0, 0), (4, 4))
    values = {each.name: each.value for each in found.locals}
    assert values["late"] is None and values["inside"] is True
    assert found.color == pytest.approx((0.125, 0.875, 0.25, 1.0))
    made = json.loads(json.dumps(found.as_json()))
    assert made["version"] == 1 and made["image"] == "drawn" and made["pixel"] == [0, 0]
    by_name = {each["name"]: each for each in made["locals"]}
    assert by_name["late"]["value"] is None
    assert by_name["uv"]["value"] == pytest.approx([0.125, 0.875])
    assert by_name["uv"]["type"] == "vec2"
    assert by_name["uv"]["place"]["line"] > 0


def test_an_image_has_no_pixel_outside_its_picture():
    with pytest.raises(ValueError, match="a picture of 4x4 has no pixel 4,0"):
        probe_image(drawn, (4, 0), (4, 4))


def test_the_color_of_a_pixel_is_the_pictures():
    example = distal.load("example:course_6_exercise")
    picture = example.render(size=(32, 24), time=0.7).array
    for x, y in ((16, 12), (3, 20), (28, 14), (10, 1)):
        found = probe_image(example, (x, y), (32, 24), time=0.7)
        assert picture[y, x] == pytest.approx(found.color, abs=2e-3)
