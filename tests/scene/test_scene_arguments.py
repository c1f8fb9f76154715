"""Every argument of a scene changes its picture; near, far, steps and strides as they say."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    DistantLight,
    GradientBackground,
    Plane,
    Scene,
    Sphere,
    emissive,
    glossy,
)
from distal.frontend import lower
from distal.ir.printer import print_identity
from distal.render import normals
from distal.scene.lowering.picture import NORMALS, RENDERERS

SIZE = (18, 12)
EYE = Camera((0.4, 1.2, 3.0), (0.1, 0.3, 0.0), fov=0.9)
SHAPE = Sphere(0.6).translate(0.1, 0.5, -0.2) | Plane(y=0.0).paint(glossy((0.3, 0.5, 0.7)))
SAID = {
    "shape": SHAPE,
    "lights": [DistantLight((1.0, 2.0, 0.5), 0.6), AmbientLight(0.3)],
    "camera": EYE,
    "background": GradientBackground((0.2, 0.1, 0.4), (0.9, 0.7, 0.3)),
    "exposure": 1.0,
    "fog": (0.5, 0.6, 0.1),
    "fog_density": 0.05,
}
OTHERS = {
    "shape": Sphere(0.7).translate(0.1, 0.5, -0.2) | Plane(y=0.0).paint(glossy((0.3, 0.5, 0.7))),
    "lights": [DistantLight((1.0, 2.0, 0.5), 0.7), AmbientLight(0.3)],
    "camera": Camera((0.4, 1.3, 3.0), (0.1, 0.3, 0.0), fov=0.9),
    "background": GradientBackground((0.2, 0.1, 0.4), (0.9, 0.5, 0.3)),
    "look": "blueprint",
    "floor": True,
    "exposure": 1.2,
    "tone_map": "reinhard",
    "default_material": (0.7, 0.8, 0.8),
    "fog": (0.5, 0.8, 0.1),
    "fog_density": 0.08,
    "shadows": False,
    "ambient_occlusion": 0.7,
    "mode": "path",
    "bounces": 0,
    "normals": "forward",
    "march": "heightfield",
    "steps": 9,
    "near": 2.5,
    "far": 3.5,
}
# Only the march over terrain takes these; below.
STRIDES = {"stride", "stride_growth"}
# Only what is brighter than white has a halo: ``tests/render/test_glow.py``.
HALO = {"glow"}


# Choices that are constants of the program; "tone_map" one of the program that encodes it.
CHOICES = {"look", "floor", "tone_map", "shadows", "bounces", "normals", "march", "steps"}


def picture(**changed):
    return Scene(**SAID | changed).render(size=SIZE).array


@pytest.fixture(scope="module")
def as_it_is():
    return picture()


def program(**changed):
    """What does not depend on numbers, as a text."""
    return print_identity(lower(Scene(**SAID | changed).emitted()))


def test_every_argument_is_changed_here():
    named = set(inspect.signature(Scene).parameters)
    # With and without acceleration the picture is the same (``tests/parts``); the shutter is
    # open in mode "path" (``tests/paths/test_lens_and_shutter``).
    assert named == set(OTHERS) | STRIDES | HALO | {"name", "acceleration", "shutter"}
    assert Scene(SHAPE, name="pool").name == "pool"


@pytest.mark.parametrize("name", sorted(set(OTHERS) - CHOICES))
def test_a_number_changes_the_picture(name, as_it_is):
    """All of these are one kernel."""
    assert np.abs(picture(**{name: OTHERS[name]}) - as_it_is)[..., :3].max() > 5e-3


@pytest.mark.parametrize("name", sorted(CHOICES))
def test_a_choice_changes_the_program(name):
    assert program() == program(exposure=1.2)
    assert program(**{name: OTHERS[name]}) != program()


def test_choices_are_called_by_their_names():
    assert [getattr(normals, name.upper()) for name in NORMALS] == list(range(len(NORMALS)))
    assert {n: f.__name__ for n, f in RENDERERS.items()} == {
        n: f"seen_{n}" for n in ("plain", "mirrored", "refracted")
    }


LAMPS = Box(9.0, 9.0, 0.2).translate(z=-4.1).paint(emissive((1.0, 0.0, 0.0))) | Sphere(
    0.5
).translate(z=-2.0).paint(emissive((0.0, 1.0, 0.0)))


@pytest.mark.parametrize(
    ("near", "far", "shown"),
    [
        (0.001, 200.0, (0.0, 1.0, 0.0)),
        (0.001, 1.4, (0.0, 0.0, 1.0)),
        (0.001, 1.6, (0.0, 1.0, 0.0)),
        (2.6, 200.0, (1.0, 0.0, 0.0)),
        (2.6, 3.9, (0.0, 0.0, 1.0)),
    ],
)
def test_rays_begin_near_and_end_far(near, far, shown):
    """A ball from 1.5 to 2.5 away, a wall 4 away, the sky behind."""
    scene = Scene(
        LAMPS,
        lights=[AmbientLight(1.0)],
        camera=Camera((0, 0, 0), (0, 0, -1)),
        background=(0.0, 0.0, 1.0),
        near=near,
        far=far,
    )
    middle = scene.render(size=(3, 3), samples=1).linear[1, 1, :3]
    assert tuple(middle) == pytest.approx(shown, abs=1e-4)


def test_a_march_over_terrain_is_given_its_strides():
    scene = Scene(SHAPE, march="heightfield", stride=0.07, stride_growth=1.2)
    numbers = {n: v.plain for n, v in scene.numbers.items() if "stride" in n}
    assert numbers == {"stride": 0.07, "stride_growth": 1.2}
