"""A page carries the pieces of a large smooth union as data, and shows the picture of the CPU."""

from __future__ import annotations

import numpy as np

import distal
from distal import Box, Camera, DistantLight, Plane, Scene, Sphere, union
from distal.scene.viewing.viewable import viewable
from tests.page.looking import looked_at

SMALL = {"width": 220, "height": 160}  # a driver in software takes seconds for a larger picture


def scene_of(count):
    rng = np.random.default_rng(4)
    made = []
    for i, p in enumerate(rng.uniform(-1, 1, (count, 3))):
        a = float(rng.uniform(0.3, 0.6)) * count ** (-1 / 3)
        ball = Sphere(a) if i % 2 else Box(a, a, a).rotate(y=float(rng.uniform(0, 6)))
        made.append(ball.translate(*p).paint(tuple(rng.uniform(0.2, 0.9, 3))))
    shape = union(made, smooth=0.1 * count ** (-1 / 3)) | Plane(y=-1.2)
    light = DistantLight((1.0, 2.0, 1.5), angle=0.05)
    camera = Camera((3.0, 2.0, 4.0), target=(0.0, 0.0, 0.0))
    return Scene(shape, camera=camera, lights=light, ambient_occlusion=0.1)


def test_a_page_of_a_large_smooth_union(tmp_path):
    file = tmp_path / "cloud.html"
    scene = scene_of(300)
    scene.export(file, panel=False)
    with looked_at(file, viewport=SMALL) as looked:
        assert looked.beside(viewable(scene)).is_agreement


def test_targets_without_buffers_have_no_pieces():
    assert "value_of_piece" not in distal.compile(scene_of(20), target="glsl-es100").text
    assert "value_of_piece" in distal.compile(scene_of(300), target="glsl-es300").text
