"""What editors, type checkers and ``import distal`` know of the public names is what there is."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

import distal

ROOT = Path(__file__).parents[2]
WELL_TYPED = ROOT / "tests/unit/lang/well_typed_scene.py"  # of functions; compiled beside it

CORRECT = """
import numpy as np

from distal import *
from distal.lang import color, func, slider, vec3

size = slider("Size", 0.5)


@func
def rising(p: vec3, height: float) -> float:
    return p.y * height


PointLight((1, 2, 3), intensity=2)
PointLight(vec3(1.0), intensity=size, color="#fff")
PointLight(np.array([1.0, 2.0, 3.0]), intensity=np.float32(2.0))
PointLight((time, 2.0, size))
shapes = [Sphere(0.5), Sphere(radius=size), Box(1, 2, 3), Box((1, 2, 3)), Box(1.0), Plane(y=-1.0)]
Camera((0, 1, 5), fov_deg=40)
Camera.yaw_pitch_roll((0, 1, 5), 0.2, fov=0.7)
paint: Material = checker(matte("#fff"), glass(1.3, color("Tint")))
plastic(checker("#fff", (0.1, 0.2, 0.3), size=size), roughness=pattern(rising, height=2.0))
picture = Scene(
    Sphere() | Box().paint(metal(gradient("#fff", noise()))),
    lights=[PointLight((1, 2, 3)), Sky()],
    camera=OrbitCamera(4, azimuth=size),
    background=Sky(light=True),
).render((64, 48))
picture.save("picture.png")
"""
WRONG = {
    'Sphere("large")': "arg-type",
    "Sphere(diameter=1.0)": "call-arg",
    'Box("large")': "arg-type",
    "PointLight()": "call-arg",
    'PointLight(("a", 2, 3))': "arg-type",
    "PointLight((1, 2, 3), brightness=2)": "call-arg",
    'Camera(fov_deg="wide")': "arg-type",
    "matte(PointLight((1, 2, 3)))": "arg-type",
    "Scene(PointLight((1, 2, 3)))": "arg-type",
    "Ball()": "name-defined",
}


def _tool():
    spec = importlib.util.spec_from_file_location("stubs", ROOT / "tools/gen_stubs.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


TOOL = _tool()


@pytest.mark.parametrize(
    ("path", "text"), TOOL.FILES.items(), ids=lambda it: getattr(it, "name", "")
)
def test_it_is_fresh(path, text):
    assert path.read_text(encoding="utf-8") == text(), "run tools/gen_stubs.py"


def test_every_public_name_is_there():
    assert {*distal.__all__, "compile"} == TOOL.PUBLIC | {"__version__"}
    for name in TOOL.PUBLIC:
        assert getattr(distal, name) is not None


def test_a_type_checker_accepts_what_is_correct_and_refuses_what_is_not(tmp_path):
    pytest.importorskip("mypy")
    lines = ["from distal import *", *WRONG]
    (tmp_path / "correct.py").write_text(CORRECT)
    (tmp_path / "wrong.py").write_text("\n".join(lines) + "\n")
    # The cache of the project's own check makes this quick.
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary"]
    files = [tmp_path / "correct.py", tmp_path / "wrong.py", WELL_TYPED]
    answer = subprocess.run(
        [*command, *map(str, files)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
    )
    found = {}
    for line in answer.stdout.splitlines():
        if ": error: " in line:
            place, _, message = line.partition(": error: ")
            file, number = place.rsplit(":", 1)
            assert Path(file).name == "wrong.py", line
            found[lines[int(number) - 1]] = message.rpartition("[")[2].rstrip("]")
    assert found == WRONG, answer.stdout + answer.stderr
