"""Scenes saved as files of several parts: names, places, colors, materials."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from distal import Box, Cylinder, Plane, Scene, Sphere, brass, glass
from distal.diagnostics import CompileError
from distal.file_writer import SaveError
from distal.mesh.scene_parts import parts_of

BALL = Sphere(0.5).named("ball").paint(brass())
POST = Cylinder(0.2, 1.0).translate(x=3.0)
TWO = Box(1.0).named("two") | Sphere(0.3).translate(y=2.0).named("top")
LENS = (Sphere(0.4).paint(glass()) | Box(0.3).translate(x=1.0).paint("#ff0000")).named("lens")


def scene() -> Scene:
    shape = (BALL | POST | TWO.translate(z=4.0)).translate(y=1.0) | LENS.translate(x=-3.0)
    return Scene(shape | Plane(), floor=False)


def content_of(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    found: dict[str, Any] = json.loads(data[20 : 20 + length])
    return found


def test_named_parts_of_unions_are_parts_below_rigid_moves_too() -> None:
    found = [part.label or part.name for part in parts_of(scene().subject.node)]
    assert found == ["ball", "translate", "two", "top", "lens", "Plane"]


def test_what_is_joined_smoothly_or_cut_stays_whole() -> None:
    smooth = BALL.union(POST, smooth=0.1) | (BALL - POST)
    assert [part.label for part in parts_of(smooth.node)] == ["", ""]
    scaled = (BALL | POST).scale(1.0, 2.0, 1.0)  # no rigid move
    assert len(list(parts_of(scaled.node))) == 1


def test_the_outermost_paint_counts(tmp_path: Path) -> None:
    found = Scene((BALL | TWO).paint("#00ff00"), floor=False).save(tmp_path / "a.stl", 0.02)
    for mesh in found.meshes:
        assert mesh.colors is not None
        assert np.allclose(mesh.colors, (0.0, 1.0, 0.0))


def test_a_scene_is_saved_as_glb_with_its_parts(tmp_path: Path) -> None:
    shares: list[float] = []
    path = tmp_path / "a.glb"
    found = scene().save(path, 0.02, progress=shares.append, unit="m")
    assert [mesh.name for mesh in found.meshes] == ["ball", "two", "top", "lens", "rest"]
    assert found.endless[0].startswith("'Plane'")
    assert shares == sorted(shares) and shares[-1] == 1.0
    content = content_of(path)
    assert [node["name"] for node in content["nodes"]] == ["ball", "two", "top", "lens", "rest"]
    # Where each part is: the box of its points.
    lows = []
    for mesh in content["meshes"]:
        at = [p["attributes"]["POSITION"] for p in mesh["primitives"]]
        lows.append(np.min([content["accessors"][i]["min"] for i in at], axis=0))
    expected = [(-0.5, 0.5, -0.5), (-0.5, 0.5, 3.5), (-0.3, 2.7, 3.7), (-3.4, -0.4, -0.4)]
    assert np.allclose(lows[:4], expected, atol=0.02)
    assert np.allclose(lows[4], (2.8, 0.5, -0.2), atol=0.02)
    # Brass is a metal; the lens has a piece of glass and a matte one.
    materials = {p["material"] for p in content["meshes"][3]["primitives"]}
    pieces = [content["materials"][i] for i in sorted(materials)]
    sent = [m.get("extensions", {}).get("KHR_materials_transmission") for m in pieces]
    assert len(pieces) == 2 and sum(s is not None for s in sent) == 1
    ball = content["materials"][0]["pbrMetallicRoughness"]
    assert ball["metallicFactor"] == 1.0 and ball["roughnessFactor"] < 0.5
    assert content["extensionsUsed"] == ["KHR_materials_ior", "KHR_materials_transmission"]


def test_other_formats_have_the_parts_too(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    Scene(BALL | TWO, floor=False).save(tmp_path / "a.obj", 0.05)
    text = (tmp_path / "a.obj").read_text()
    assert [line for line in text.splitlines() if line.startswith("o ")] == [
        "o ball",
        "o two",
        "o top",
    ]
    Scene(BALL | TWO, floor=False).save(tmp_path / "a.stl", 0.05)
    mesh = trimesh.load(str(tmp_path / "a.stl"))
    assert mesh.is_watertight and mesh.body_count == 3


def test_mistakes_are_named_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(CompileError) as caught:
        Scene(Plane(), floor=False).save(tmp_path / "a.glb")
    first = caught.value.diagnostics[0]
    assert first.message == "nothing of 'Plane' has an end, so there is no part to mesh"
    assert first.hint == "intersect it with a box: shape & Box(…)"
    with pytest.raises(SaveError, match=r"a mesh is not saved as '\.step'"):
        Scene(BALL, floor=False).save(tmp_path / "a.step")
    assert not list(tmp_path.iterdir())
