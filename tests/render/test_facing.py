"""Patterns that know where the eye is: limb darkening against its law."""

from __future__ import annotations

import math

import pytest

from distal import Box, Camera, Rectangle, Scene, Sphere, emissive, facing, matte, pattern
from distal.lang import func, vec3
from distal.scene.checks.probe import probe

BLACK = (0.0, 0.0, 0.0)


def shown(shape, place, mode="direct"):
    """The light that an eye far away, on the z axis, sees at a place of the picture."""
    camera = Camera((place[0], place[1], 50), (place[0], place[1], 0), fov=1e-5)
    scene = Scene(shape, lights=[], background=BLACK, camera=camera, floor=False)
    return scene.render(size=(3, 3), mode=mode, samples=1).linear[1, 1, 0]


@pytest.mark.parametrize("mode", ["direct", "path"])
@pytest.mark.parametrize("darkening", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("out", [0.0, 0.5, 0.95])
def test_the_limb_of_a_sun(darkening, out, mode):
    bright, dim = (2.0,) * 3, (2.0 * (1 - darkening),) * 3
    sun = Sphere(3.0).rotate(x=0.4).translate(z=-1.0).paint(emissive(facing(bright, dim)))
    cosine = math.sqrt(1 - out**2)
    expected = 2.0 * (1 - darkening * (1 - cosine))
    assert shown(sun, (3.0 * out, 0.0), mode) == pytest.approx(expected, rel=2e-4)


def test_power_makes_the_rim_broader():
    sun = Sphere(3.0).paint(emissive(facing((1.0,) * 3, BLACK, power=2.0)))
    assert shown(sun, (1.5, 0.0)) == pytest.approx(0.75, rel=1e-3)


@func
def by_angle(p: vec3, facing: float) -> vec3:
    """The cosine, as a color."""
    return vec3(facing)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.2])
def test_own_patterns_take_the_cosine(turn):
    for block in (Box(2.0), Rectangle((2.0, 2.0)).extrude(2.0), Box(1.0).scale(2.0)):
        painted = block.rotate(y=turn).paint(emissive(pattern(by_angle)))
        expected = max(math.cos(turn), 0.0)
        found = shown(painted, (0.0, 0.0))
        assert found == pytest.approx(expected if turn < 0.785 else math.sin(turn), abs=1e-3)


def test_a_part_of_a_table_knows_the_eye():
    balls = [Sphere(0.3).translate(x=i % 5, y=i // 5) for i in range(25)]
    shape = balls[0]
    for ball in balls[1:]:
        shape = shape | ball
    glow = emissive(facing((1.0,) * 3, BLACK))
    assert shown(shape.paint(glow), (2.15, 2.0)) == pytest.approx(math.sqrt(0.75), rel=2e-3)


def test_probes_and_views_show_it_face_on():
    shape = Sphere().paint(matte(facing("white", "black")))
    scene = Scene(shape, floor=False)
    assert probe(scene, (20, 20), (40, 40)).hit
    assert scene.render(size=(20, 20), view="normal").array.shape == (20, 20, 4)
