"""Modules beside a scene's file: each scene has its own, as they are when it is loaded."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import distal

SCENE = """
from distal.lang import Frame, image, vec3
from neighbor import level
from shapes_near.deep import half
@image
def picture(frame: Frame) -> vec3:
    return vec3(level(1.0), half(1.0), 0.0)
"""


def _write(folder: Path, factor: float) -> None:
    (folder / "shapes_near").mkdir(parents=True, exist_ok=True)
    (folder / "scene.py").write_text(SCENE)
    (folder / "shapes_near" / "deep.py").write_text(_function("half", 0.5))
    (folder / "neighbor.py").write_text(_function("level", factor))


def _function(name: str, factor: float) -> str:
    head = f"from distal.lang import func\n@func\ndef {name}(x: float) -> float:\n"
    return f"{head}    return x * {factor}\n"


def _pixel(scene: Any) -> list[float]:
    pixel: list[float] = scene.render(size=(1, 1)).array[0, 0].tolist()
    return pixel


def test_each_folder_has_its_own_and_an_edited_one_is_read_anew(tmp_path: Path) -> None:
    path = list(sys.path)
    _write(tmp_path / "one", 0.25)
    _write(tmp_path / "two", 0.75)
    one = distal.load(tmp_path / "one" / "scene.py")
    two = distal.load(tmp_path / "two" / "scene.py")
    _write(tmp_path / "two", 0.125)
    edited = distal.load(tmp_path / "two" / "scene.py")
    assert _pixel(edited) == [0.125, 0.5, 0.0, 1.0]
    assert _pixel(two) == [0.75, 0.5, 0.0, 1.0]
    assert _pixel(one) == [0.25, 0.5, 0.0, 1.0]
    assert "neighbor" not in sys.modules and "shapes_near.deep" not in sys.modules
    assert sys.path == path


def test_packages_from_elsewhere_stay(tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(f"import colorsys{SCENE.split('from neighbor')[0]}"
                                       "@image\ndef picture(f: Frame) -> vec3:\n"
                                       "    return vec3(0.0)\n")  # fmt: skip
    sys.modules.pop("colorsys", None)
    distal.load(tmp_path / "scene.py")
    assert "colorsys" in sys.modules
