"""What a pixel saw: closed forms, the picture's own pixels, and the place in the source."""

import json

import numpy as np
import pytest

from distal import Box, Camera, OrthographicCamera, Plane, Scene, Sphere, matte, mirror
from distal.lang import slider
from distal.scene.checks.probe import probe

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
        Box(1.2).paint("#ff0000") | Sphere(0.8).translate(1.0, 0.3, 0.0).paint("#00ff00"),
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
        assert found.path[-1].name == ("Box" if color[0] else "Sphere")
    assert steps > 5


def test_a_ray_that_meets_nothing_says_how_it_ended():
    ended = {}
    for name, shape in (("sphere", Sphere(0.5)), ("plane", Plane(y=-1.0))):
        for y in (2, 30):
            ended[name, y] = probe(
                Scene(shape, camera=FRONT, floor=False), (2, y), (100, 100)
            ).ended
    assert ended["sphere", 2] == "passed the box"
    assert ended["plane", 2] == "left the scene"
    level = {"camera": OrthographicCamera((0, 0, 5), height=2), "floor": False}
    corner = probe(Scene(Sphere(1.0), **level), (1, 1), (50, 50))
    assert corner.ended == "left the box"
    few = Scene(Sphere(1.0), **level, steps=1)
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
