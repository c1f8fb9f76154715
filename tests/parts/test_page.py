"""A page carries the table of a scene as data, and shows the picture of the CPU."""

from __future__ import annotations

import numpy as np
import pytest

import distal
from distal import (
    AmbientLight,
    Box,
    Camera,
    CompileError,
    DistantLight,
    Plane,
    Scene,
    Sphere,
    time,
    union,
)
from distal.lang import slider
from distal.scene.lowering.parts.moving_boxes import MovingBoxes
from distal.scene.viewing.viewable import viewable
from tests.page.looking import looked_at

SMALL = {"width": 220, "height": 160}  # a driver in software takes seconds for a larger picture


def pebbles(count):
    rng = np.random.default_rng(4)
    made = []
    for i, p in enumerate(rng.uniform(-1, 1, (count, 3)) * (2.0, 0.3, 2.0)):
        a = float(rng.uniform(0.2, 0.6)) * count ** (-1 / 3)
        pebble = Sphere(a) if i % 2 else Box(a, a, a).rotate(y=float(rng.uniform(0, 6)))
        made.append(pebble.translate(*p).paint(tuple(rng.uniform(0.2, 0.9, 3))))
    return made[0].union(made[1:]) | Plane(y=-0.4)


def scene_of(count):
    light = DistantLight((1.0, 2.0, 1.5), angle=0.05)
    camera = Camera((3.0, 2.0, 4.0), target=(0.0, -0.2, 0.0), fov_deg=30.0)
    return Scene(pebbles(count), camera=camera, lights=light, ambient_occlusion=0.1)


def test_a_page_of_many_parts(tmp_path):
    file = tmp_path / "pebbles.html"
    scene = scene_of(500)
    scene.export(file, panel=False)
    assert file.stat().st_size < 210_000  # 160 bytes a part, and 110 kB for everything else
    with looked_at(file, viewport=SMALL) as looked:
        assert looked.beside(viewable(scene)).is_agreement


def test_a_page_with_a_grid_of_distances(tmp_path):
    options = {"camera": scene_of(3).camera, "lights": AmbientLight(0.8)}
    pages = {}
    for name, reach in (("grid", 0.9), ("search", 0.01)):
        pages[name] = Scene(pebbles(300), ambient_occlusion=reach, **options)
        pages[name].export(tmp_path / f"{name}.html", panel=False)
    sizes = {name: (tmp_path / f"{name}.html").stat().st_size for name in pages}
    assert 0 < sizes["grid"] - sizes["search"] < 60_000
    with looked_at(tmp_path / "grid.html", viewport=SMALL) as looked:
        assert looked.beside(viewable(pages["grid"])).is_agreement


def test_targets_without_buffers_draw_a_few_parts_without_a_table():
    text = distal.compile(scene_of(20), target="glsl-es100").text
    assert "part_boxes" not in text
    assert "part_boxes" in distal.compile(scene_of(300), target="glsl-es300").text


@pytest.mark.parametrize("target", ["glsl-es100", "shadertoy"])
def test_targets_without_buffers_refuse_many(target):
    with pytest.raises(CompileError) as caught:
        distal.compile(scene_of(3000), target=target)
    (found,) = caught.value.diagnostics
    assert found.message == ("3,001 parts of 'union' need a table, and this target has no buffers")
    assert found.hint == "take a target with buffers; 2,048 parts are possible without"


def test_a_page_of_parts_that_move(tmp_path, monkeypatch):
    # A page has boxes of all times: a ray that grazes a part may stop at another place.
    monkeypatch.setattr(MovingBoxes, "at", lambda self, params, time: self.data)
    rng = np.random.default_rng(5)
    swing = slider("Swing", 0.5, low=0.0, high=1.0)
    boats = [
        Box(0.1, 0.04, 0.06).rotate(y=time + x).translate(x, swing * np.sin(time + 2.0 * z), z)
        for x, z in rng.uniform(-1.5, 1.5, (300, 2)).tolist()
    ]
    camera = Camera((3.0, 2.0, 4.0), target=(0.0, -0.2, 0.0), fov_deg=30.0)
    scene = Scene(union(boats) | Plane(y=-0.6), camera=camera, lights=DistantLight((1.0, 2.0, 1.5)))
    assert "part_boxes" in distal.compile(scene, target="glsl-es300").text
    file = tmp_path / "boats.html"
    scene.export(file, panel=False)
    with looked_at(file, viewport=SMALL) as looked:
        assert looked.beside(viewable(scene)).is_agreement
