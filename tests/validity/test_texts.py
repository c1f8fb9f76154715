"""Every emitted text is accepted by its compilers, is run, and draws what the reference draws.

``torture.py`` beside this file holds scene code for every corner of the languages; the examples are
compiled as well. A validator or driver that is missing is a skip with its reason.
"""

from __future__ import annotations

import importlib.util
import re
import shutil
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from distal.backends import get_target
from distal.backends.base import Artifact
from distal.backends.messages import map_message
from distal.backends.numpy import interpreter as reference
from distal.compiler.driver import compile, lower, run_passes
from distal.diagnostics import CompileError
from distal.example_files import gallery
from distal.lang import Image
from distal.loading import load
from tests.examples import functions_of_a_pixel

HERE = Path(__file__).parent
SIZE = (80, 60)
VALUES = {"time": 1.3, "index": 3}

GLSL = ("glsl-es300", "glsl-330", "shadertoy", "glsl-es100")
WGSL = ("wgsl", "wgsl-compute")

# What a target cannot do, and says so.
REFUSED = {
    ("statements", "glsl-es100"): "glsl-es100 has no while loops",
    ("choices", "glsl-es100"): "glsl-es100 has no while loops",
    ("integers", "glsl-es100"): "glsl-es100 has no bit operations",
    ("per_frame", "glsl-es100"): "glsl-es100 has no unsigned integers",
    ("textures", "glsl-es100"): "glsl-es100 has no single texels",
    ("crowded", "glsl-es100"): "glsl-es100 has no unsigned integers",
    ("far_loops", "glsl-es100"): "glsl-es100 needs loop bounds",
    ("buffers", "glsl-es100"): "WebGL 1 has no buffers",
    ("buffers", "shadertoy"): "Shadertoy has no buffers",
}


def scene_file(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"validity_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def image_of(path: Path) -> Image:
    found = load(path)
    assert isinstance(found, Image), path.name
    return found


TORTURE = scene_file(HERE / "torture.py")
GOLDEN = scene_file(HERE.parent / "golden" / "scene.py")
IMAGES: dict[str, Image] = {n: v for n, v in vars(TORTURE).items() if isinstance(v, Image)}
IMAGES["scene"] = [v for v in vars(GOLDEN).values() if isinstance(v, Image)][-1]
# Scenes of objects are drawn by every driver in tests/pictures.
IMAGES |= {name: image_of(gallery()[name]) for name in functions_of_a_pixel()}

ALL = [
    pytest.param(name, target, id=f"{name}-{target}")
    for name in IMAGES
    for target in (*GLSL, *WGSL)
    if (name, target) not in REFUSED
]


@cache
def compiled(name: str, target: str) -> Artifact:
    return compile(IMAGES[name], target)


@cache
def resources() -> tuple[dict[str, NDArray[np.float32]], dict[str, NDArray[Any]]]:
    random = np.random.default_rng(7)
    textures = {
        "photo": random.random((3, 5, 4), np.float32),
        "sky": random.random((6, 2, 2, 4), np.float32),
        "smoke": random.random((3, 4, 2, 4), np.float32),
    }
    buffers = {
        "heights": np.array(TORTURE.heights.data, np.float32),
        "counts": np.array(TORTURE.counts.data, np.int32),
        "places": np.array(TORTURE.places.data, np.float32),
    }
    return textures, buffers


@cache
def expected(name: str) -> NDArray[np.float32]:
    module = run_passes(lower(IMAGES[name]), get_target("numpy"))
    values = {u.name: VALUES.get(u.name, u.default) for u in module.uniforms}
    if "resolution" in values:
        values["resolution"] = SIZE
    textures, buffers = resources()
    return reference.render(module, *SIZE, values, {**textures, **buffers})


def drawn(artifact: Artifact) -> NDArray[np.float32]:
    """The picture by the driver of the artifact's language."""
    known = {entry["name"] for entry in artifact.interface["uniforms"]}
    values = {name: value for name, value in VALUES.items() if name in known}
    textures, buffers = resources()
    if artifact.interface["target"].startswith("wgsl"):
        gpu = pytest.importorskip("tests.gpu")
        try:
            return gpu.run_wgsl(artifact, SIZE, values, textures=textures, buffers=buffers)
        except gpu.GpuUnavailableError as error:
            pytest.skip(str(error))
    glsl = pytest.importorskip("tests.glsl")
    try:
        return glsl.run_glsl(artifact, SIZE, values, textures=textures, buffers=buffers)
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))


def most_mean(name: str, target: str) -> float:
    """The largest mean difference; hardware filters textures with weights of 8 bits."""
    if name != "textures":
        return 1e-4
    glsl, gpu = pytest.importorskip("tests.glsl"), pytest.importorskip("tests.gpu")
    driver = gpu.adapter_name() if target.startswith("wgsl") else glsl.egl.renderer()
    return 1e-4 if "llvmpipe" in driver else 1 / 512


@pytest.mark.parametrize(("name", "target"), ALL)
def test_draws_what_the_reference_draws(name: str, target: str) -> None:
    picture = drawn(compiled(name, target))
    difference = np.abs(picture - expected(name))
    # A pixel on an edge of the scene may fall on its other side; SEEDS allows 0.2 % of them.
    assert np.mean(difference.max(axis=-1) > 2 / 255) <= 0.002
    assert difference.mean() < most_mean(name, target)
    assert np.ptp(picture[..., :3]) > 0.05, "a picture of nothing agrees with anything"


@pytest.mark.parametrize(("name", "target"), [p for p in ALL if p.values[1] in GLSL])
def test_glslang_accepts(name: str, target: str) -> None:
    if shutil.which("glslangValidator") is None:
        pytest.skip("no glslangValidator (Debian: glslang-tools)")
    pytest.importorskip("tests.glsl").assert_valid(compiled(name, target))


@pytest.mark.parametrize(("name", "target"), REFUSED)
def test_says_what_a_target_cannot_do(name: str, target: str) -> None:
    with pytest.raises(CompileError, match=re.escape(REFUSED[name, target])):
        compile(IMAGES[name], target)


@pytest.mark.parametrize("target", [*GLSL, *WGSL])
def test_texts_are_the_same_each_time(target: str) -> None:
    again = compile(IMAGES["raymarcher"], target)
    assert again == compiled("raymarcher", target)


@pytest.mark.parametrize(("name", "target"), ALL)
def test_text_is_plain(name: str, target: str) -> None:
    artifact = compiled(name, target)
    for text in filter(None, (artifact.text, artifact.vertex)):
        assert text.isascii() and text.endswith("\n")
        code = re.sub(r"//.*", "", text)
        assert "__" not in code
        assert not re.search(r"(?<![\w.])\d+\.?f\b", code)
        assert str(HERE.parent) not in text
        assert not re.search(r"[ \t]+$", text, re.MULTILINE)
    assert len(artifact.lines) == artifact.text.count("\n")
    places = [place for place in artifact.lines if place is not None]
    assert any(file.endswith(".py") for file, _ in places)


def broken(target: str) -> tuple[Artifact, str]:
    """The golden scene with a mistake put into its text, and the author's line for that place."""
    artifact = compiled("scene", target)
    lines = artifact.text.splitlines()
    number = next(i for i, line in enumerate(lines) if "ring(p - center" in line)
    lines[number] = lines[number].replace("ring(", "nothing(")
    place = artifact.lines[number]
    assert place is not None
    return replace(artifact, text="\n".join(lines) + "\n"), f"{place[0]}:{place[1]}"


def test_mesa_and_glslang_name_the_authors_line() -> None:
    artifact, place = broken("glsl-es300")
    assert place.endswith("scene.py:53")
    glsl = pytest.importorskip("tests.glsl")
    try:
        glsl.egl.EglShader(artifact.text, vertex_text=artifact.vertex)
    except glsl.egl.ShaderRejectedError as refused:
        assert place in map_message(artifact, str(refused))
    except glsl.egl.EglUnavailableError as error:
        pytest.skip(str(error))
    else:
        pytest.fail("Mesa takes a call of nothing")
    if shutil.which("glslangValidator") is None:
        pytest.skip("no glslangValidator (Debian: glslang-tools)")
    with pytest.raises(AssertionError, match=re.escape(f"ERROR: {place}")):
        glsl.assert_valid(artifact)


def test_naga_names_the_authors_line() -> None:
    artifact, place = broken("wgsl")
    gpu = pytest.importorskip("tests.gpu")
    with pytest.raises(gpu.wgpu.GPUValidationError) as refused:
        drawn(artifact)
    assert place in map_message(artifact, str(refused.value))
