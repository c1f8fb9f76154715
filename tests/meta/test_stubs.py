"""What editors, type checkers and ``import distal`` know of the public names is what there is."""

from __future__ import annotations

import importlib.util
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import typing
from pathlib import Path

import jedi
import pytest

import distal
import distal.lang

ROOT = Path(__file__).parents[2]
WELL_TYPED = ROOT / "tests/unit/lang/well_typed_scene.py"  # of functions; compiled beside it

CORRECT = """
import numpy as np

import distal
from distal import *
from distal import time
from distal.lang import Texture3D, color, func, slider, vec3

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
    Sphere() | Box().paint(metal(linear_gradient("#fff", noise()))),
    lights=[PointLight((1, 2, 3)), Sky()],
    camera=OrbitCamera(4, azimuth=size),
    background=Sky(light=True),
).render((64, 48))
picture.save("picture.png")

# Placement, by numbers, parameters, vectors and arrays.
moved = Sphere(0.5).translate(1, 2, 3).translate((size, 0, time)).translate(x=1)
moved = moved.translate(np.ones(3))
turned = moved.rotate(x=size).rotate(0.5, axis=(0, 1, 0)).rotate(matrix=np.eye(3)).scale(2)
turned = turned.scale(1, 2, 1).mirror("x").mirror(across=(1, 0, 0)).scale(-1, 1, 1)
turned = turned.symmetry("xz").symmetry(across=(1, 0, 0)).repeat(2).repeat((1, 2, 3))
turned = turned.repeat(1.0, 2.0, 1.0, count=(3, 1, 3)).twist(size).elongate(1, 2, 3).shell(0.1)
turned = turned.array(np.zeros((5, 3)), colors=["#fff"] * 5, scale=0.2).on(Box(), gap=size)
joined = moved.union(Box(1, 2, 3), [Cone()], smooth=0.1, blend="stairs", count=3) - Cylinder(0.1, 2)
joined = (joined & ~Box()).paint("red").paint(glass()).paint(checker("#fff", "#000")).paint(0.5)
joined |= Torus()
for _ in range(3):
    joined = joined | Sphere().translate(x=1)
solid: Shape = Circle(1).extrude(1, rounding=0.1) | Circle(1).offset(0.1).revolve(2)
flat: Shape2D = solid.slice() - Text("a").translate(0.5, 0)
flat.fill((32, 32), box=((-1, -1), (1, 1)), inside="red").save("flat.png")
every: Shape = union(shapes, smooth=0.1) | union(part for part in [solid, joined])
wave: Shape = Shape.from_function(rising, height=2.0, bounds=((-1, -1, -1), (1, 1, 1)))
data: Shape = Shape.from_volume(np.zeros((3, 4, 5)), axes="xyz", spacing=(1, 1, 2))
data = data | Shape.from_mesh(np.zeros((3, 3)), [(0, 1, 2)])
Texture3D(np.zeros((3, 4, 5)), axes="xyz", wrap="clamp")

# Values.
near: float = moved((0.0, 0.0, 0.0), params={"Size": 0.2}) + moved(vec3(0.0))
many: float = float(moved(np.zeros((4, 3))).min()) + float(moved([(0, 0, 0), (1, 1, 1)]).max())
up: float = moved.gradient((0, 0, 0)).y + Circle().gradient((0.0, 0.0)).x
low, high = moved.bounds(params={"Size": 1})
width: float = high[0] - low[0]
points, tangents = points_along(helix_path(), 30)
points = points_in(((0, 0, 0), (1, 1, 1)), 10)
normals = points_on(moved, 10, within=((0, 0, 0), (1, 1, 1)))[1] @ np.eye(3)
first, second = mesh_gears(Gear(1, 12), Rack(1, 7), turn=0.5 * time)
first.render((32, 24)).save("gear.png")
distal.load("scene.py")
"""
# A wrong line, and what mypy and pyright call its mistake.
WRONG = {
    'Sphere("large")': ("arg-type", "reportArgumentType"),
    "Sphere(diameter=1.0)": ("call-arg", "reportCallIssue"),
    'Box("large")': ("arg-type", "reportArgumentType"),
    "PointLight()": ("call-arg", "reportCallIssue"),
    'PointLight(("a", 2, 3))': ("arg-type", "reportArgumentType"),
    "PointLight((1, 2, 3), brightness=2)": ("call-arg", "reportCallIssue"),
    'Camera(fov_deg="wide")': ("arg-type", "reportArgumentType"),
    "matte(PointLight((1, 2, 3)))": ("arg-type", "reportArgumentType"),
    "Scene(PointLight((1, 2, 3)))": ("arg-type", "reportArgumentType"),
    "Ball()": ("name-defined", "reportUndefinedVariable"),
    "Sphere().rendr()": ("attr-defined", "reportAttributeAccessIssue"),
    'Sphere().twist("x")': ("arg-type", "reportArgumentType"),
    "Sphere().translate(q=3)": ("call-overload", "reportCallIssue"),
    'Sphere().translate("x", 0, 0)': ("call-overload", "reportArgumentType"),
    "Sphere().union(Box(), smoth=3)": ("call-arg", "reportCallIssue"),
    "Sphere().union(3)": ("arg-type", "reportArgumentType"),
    "Sphere().render(parms={})": ("call-arg", "reportCallIssue"),
    "Sphere().extrude(2)": ("attr-defined", "reportAttributeAccessIssue"),
    "Circle().twist(2)": ("attr-defined", "reportAttributeAccessIssue"),
    "_ = Sphere() | 3": ("operator", "reportOperatorIssue"),
    "_ = Sphere() + Sphere()": ("operator", "reportOperatorIssue"),
    "Sphere().paint(Sphere())": ("arg-type", "reportArgumentType"),
    'Shape.from_volume("a.npy", axes="xyw")': ("arg-type", "reportArgumentType"),
    "union(3)": ("arg-type", "reportArgumentType"),
    'Nut("M6", gap="wide")': ("arg-type", "reportArgumentType"),
    "distal.Sphere().blend(2)": ("attr-defined", "reportAttributeAccessIssue"),
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
    assert {*distal.__all__, "compile", "time"} == TOOL.PUBLIC | {"__version__"}
    for name in TOOL.PUBLIC:
        assert getattr(distal, name) is not None


def typical_code(folder):
    """Write the right and the wrong code, and return the lines of the latter."""
    lines = ["import distal", "from distal import *", *WRONG]
    (folder / "correct.py").write_text(CORRECT, encoding="utf-8")
    (folder / "wrong.py").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return lines


def test_mypy_accepts_what_is_correct_and_refuses_what_is_not(tmp_path):
    lines = typical_code(tmp_path)
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
    assert found == {line: code for line, (code, _) in WRONG.items()}, answer.stdout + answer.stderr


@pytest.mark.skipif(shutil.which("node") is None, reason="pyright runs in Node: install nodejs")
def test_pyright_accepts_what_is_correct_and_refuses_what_is_not(tmp_path):
    lines = typical_code(tmp_path)
    # Else a folder of an environment that is none is searched; the version is that of the package.
    settings = {"typeCheckingMode": "standard", "extraPaths": [str(ROOT / "src")]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable]
    answer = subprocess.run(
        [*command, "--project", str(tmp_path)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "PYRIGHT_PYTHON_IGNORE_WARNINGS": "1"},
    )
    report = json.loads(answer.stdout)
    assert report["summary"]["filesAnalyzed"] == 2
    found = {}
    for entry in report["generalDiagnostics"]:
        if entry["severity"] == "error":
            assert Path(entry["file"]).name == "wrong.py", entry
            found[lines[entry["range"]["start"]["line"]]] = entry["rule"]
    assert found == {line: rule for line, (_, rule) in WRONG.items()}


# What jedi, the completion of notebooks and many editors, must offer at the end of a text.
COMPLETED = {
    "from distal import Sph": "Sphere",
    "import distal\ndistal.OrbitC": "OrbitCamera",
    "from distal.lang import smooths": "smoothstep",
    "from distal import *\nSphere(0.5).tw": "twist",
    "from distal import *\nSphere().translate(1, 2, 3).scale(2).rotate(x=1).tw": "twist",
    "from distal import Sphere, Box\na = Sphere() | Box(1)\na.tw": "twist",
    "from distal import *\n(Sphere(1) - Box(1)).paint('red').tw": "twist",
    "from distal import *\nunion([Sphere(), Box()]).tw": "twist",
    "from distal import *\nShape.from_mesh('a.stl').tw": "twist",
    "from distal import *\nCircle(1).extrude(2).tw": "twist",
    "from distal import *\nCircle(1).rotate(2).ext": "extrude",
    "from distal import *\nScene(Sphere()).render().sa": "save",
}


@pytest.mark.parametrize("text", COMPLETED, ids=lambda text: text.splitlines()[-1])
def test_jedi_completes(text):
    script = jedi.Script(text, project=jedi.Project(ROOT / "src"))
    last = text.splitlines()[-1]
    assert COMPLETED[text] in [c.name for c in script.complete(text.count("\n") + 1, len(last))]


def test_jedi_shows_the_arguments():
    text = "from distal import *\nSphere("
    (found,) = jedi.Script(text, project=jedi.Project(ROOT / "src")).get_signatures(2, 7)
    assert found.to_string() == "Sphere(radius: Number=1.0)"


def test_dir_shows_what_is_public():
    assert {*dir(distal)} == {*distal.__all__, "compile", "time"}
    assert {*dir(distal.lang)} == {*distal.lang.__all__}


# Arguments and results of any type, each with its reason.
UNTYPED = {
    "Placed.apply": "the operator's name decides whether the result is flat",
    "pattern": "the author's function decides whether it is a pattern or a material",
    "Look.__getitem__": "a number, a tuple or an expression",
    "Scene.program": "what a window passes to the view it names",
    "Picture.with_provenance": "the fields of a dataclass",
    "Composed.compose": "the compiler's own",
    "AuthorObject.replace": "each object takes arguments of its own",
}


def untyped(function):
    """Return whether a signature has an argument or a result of any type."""
    signature = inspect.signature(function)
    parameters = [p for n, p in signature.parameters.items() if n not in ("self", "cls")]
    written = [*(p.annotation for p in parameters), signature.return_annotation]
    return any(w is inspect.Signature.empty or re.search(r"\bAny\b(?!\])", str(w)) for w in written)


def public_functions():
    """Yield the public functions and methods that are written by hand, with their names."""
    classes = set()
    for name in sorted(TOOL.PUBLIC):
        value = getattr(distal, name)
        if isinstance(value, type):
            classes |= {c for c in value.__mro__ if c.__module__.startswith("distal.")}
        elif inspect.isfunction(value):
            yield name, value
    for cls in sorted(classes, key=lambda c: c.__name__):
        for name, value in vars(cls).items():
            value = getattr(value, "__func__", getattr(value, "fget", value))
            # What Python calls itself, and constructors that the stub declares, are left out.
            by_hand = inspect.isfunction(value) and value.__qualname__.startswith(cls.__name__)
            if by_hand and (
                not name.startswith("_") or name in ("__call__", "__or__", "__getitem__")
            ):
                yield f"{cls.__name__}.{name}", value


def test_public_functions_have_types():
    found = set()
    for name, function in public_functions():
        forms = typing.get_overloads(function) or [inspect.unwrap(function)]
        if any(map(untyped, forms)):
            found.add(name)
    assert found == {*UNTYPED}
