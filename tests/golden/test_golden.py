"""The text of one small scene on every target, whole and as committed.

A change in how texts look shows itself as a change of the files beside this one: read it, then
accept it with ``DISTAL_UPDATE_GOLDEN=1 pytest tests/golden``.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import pytest

from distal.backends.base import Artifact
from distal.compiler.driver import compile

HERE = Path(__file__).parent
SUFFIXES = {
    "glsl-es300": "frag",
    "glsl-330": "frag",
    "glsl-es100": "frag",
    "glslcanvas": "frag",
    "isf": "fs",
    "shadertoy": "frag",
    "wgsl": "wgsl",
    "wgsl-compute": "wgsl",
}


def compiled(target: str) -> Artifact:
    spec = importlib.util.spec_from_file_location("golden_scene", HERE / "scene.py")
    assert spec is not None and spec.loader is not None
    scene = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = scene
    spec.loader.exec_module(scene)
    return compile(scene.rings, target)


@pytest.mark.parametrize("target", SUFFIXES)
def test_text(target: str) -> None:
    artifact = compiled(target)
    texts = {HERE / f"{target}.{SUFFIXES[target]}": artifact.text}
    if artifact.vertex is not None:
        texts[HERE / f"{target}.vert"] = artifact.vertex
    for path, text in texts.items():
        if os.environ.get("DISTAL_UPDATE_GOLDEN") == "1":
            path.write_text(text)
        assert path.read_text() == text, f"{path.name} differs: see the head of this file"
