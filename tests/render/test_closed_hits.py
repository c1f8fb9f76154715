"""Rays meet solids with chords where their fields say, from outside and inside, under moves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from distal import Box, Camera, Capsule, Cylinder, DistantLight, Plane, Scene, Sphere, Torus, glass
from distal.scene.lowering.chords import has_chord
from distal.scene.objects.shape import Shape

SIZE = (96, 72)
SUN = DistantLight((1.0, 2.0, 1.5), angle=0.1)
EYE = Camera((2.0, 2.0, 4.0), target=(0.0, 0.5, 0.0))
BALL = Sphere(0.6).translate(-0.9, 0.7, 0.2)
BOX = Box(0.8, 0.8, 0.8).rotate(y=0.5, x=0.3).translate(0.3, 0.6, 0.0)
CYLINDER = Cylinder(0.3, 1.2).rotate(x=0.4, z=0.3).translate(1.2, 0.8, 0.3)
CAPSULE = Capsule(0.15, 0.5).scale(1.3).translate(0.2, 1.6, 0.2)
SOLIDS = BALL | BOX | CYLINDER | CAPSULE
# Off the picture: it has no chord, so all shapes beside it are marched.
MARCHED = Torus(0.1, 0.01).translate(0.0, 0.5, 60.0)


def rendered(shape: Shape, lights: DistantLight = SUN, eye: Camera = EYE) -> np.ndarray:
    scene = Scene(shape, lights=lights, camera=eye, ambient_occlusion=0.0)
    return scene.render(size=SIZE, samples=1).array


def share_that_differs(shape: Shape, **options: Any) -> float:
    """The share of pixels that differ if the same shape is marched."""
    off = np.abs(rendered(shape, **options) - rendered(shape | MARCHED, **options))
    return float((off.max(axis=-1) > 0.05).mean())


@pytest.mark.parametrize("floor", [True, False])
def test_closed_hits_are_where_marched_ones_are(floor: bool):
    shape = SOLIDS | Plane() if floor else SOLIDS
    assert share_that_differs(shape) < 0.02  # silhouettes: a march's are a third of a pixel wider


def test_a_ball_far_away_is_met_exactly():
    eye = Camera((0.0, 0.0, 3000.0), target=(0.0, 0.0, 0.0), fov=0.002)
    depth = Scene(Sphere(3.0), camera=eye).render(size=SIZE, layers=("depth",)).layers["depth"]
    assert depth[36, 48] == pytest.approx(2997.0, abs=1e-3)


def test_only_rigid_moves_keep_a_chord():
    assert has_chord(SOLIDS.node.children[0])
    assert has_chord(CAPSULE.node)
    assert not has_chord(Sphere().scale(1.0, 2.0, 1.0).node)
    assert not has_chord(Sphere().round(0.1).node)
    assert not has_chord(Torus().node)


def test_overlapping_glass_has_no_face_inside():
    two = Sphere(0.7).translate(x=-0.4) | Sphere(0.7).translate(x=0.4)
    eye = Camera((0.0, 0.0, 4.0), target=(0.0, 0.0, 0.0))
    assert share_that_differs(two.paint(glass()) | Plane(-2.0), eye=eye) < 0.03


def test_the_penumbra_of_a_ball_is_that_of_its_field():
    wide = DistantLight((0.3, 1.0, 0.2), angle=2 * math.atan(0.05))
    eye = Camera((0.0, 3.0, 0.1), target=(0.0, 0.0, 0.0))
    shape = Sphere(0.3).translate(y=0.8) | Plane()
    assert share_that_differs(shape, lights=wide, eye=eye) < 0.01
    picture = rendered(shape, wide, eye)
    assert picture[..., :3].min() < 0.2 < 0.5 < picture[..., :3].max()
