"""A type checker follows ``Scene.render`` to the device; each option has one declaration."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from dataclasses import MISSING, fields
from pathlib import Path

import pytest

import distal
from distal.export.page_options import PageOptions
from distal.lang import Image
from distal.lang.presentable import ExportOptions, ShowOptions, VideoOptions
from distal.lang.render_options import RenderOptions
from distal.scene.scene import Scene
from distal.scene.view_options import ViewOptions
from distal.video import recording

ROOT = Path(__file__).parents[2]
SOURCE = Path(distal.__file__).parent
# What is revealed, and the type that it must have.
CHAIN = {
    "scene.render()": "distal.images.picture.Picture",
    "image.render()": "distal.images.picture.Picture",
    "scene_module.rendering.render_scene": "def (scene: distal.scene.scene.Scene, view: "
    "distal.scene.view_options.ViewOptions, options: distal.lang.render_options.RenderOptions) -> "
    "distal.images.picture.Picture",
    "executor()": "distal.runtime.executor.PythonExecutor",
    "executor().render": "def (image: distal.lang.functions.Image | "
    "distal.lang.composed.Composed, options: distal.lang.render_options.RenderOptions) -> "
    "distal.images.picture.Picture",
    "executor().kernels.kernel": "def (lowered: distal.runtime.lowered.Lowered, device: str, "
    "precision: int, *, is_long: bool =) -> distal.devices.base.Kernel",
    "kernels.DEVICES": "typing.Mapping[str, def (distal.ir.nodes.Module, int, str | None, bool) -> "
    "distal.devices.base.Kernel]",
    "kernels.cpu.prepare(module)": "distal.devices.cpu.CpuKernel",
    "kernels.gpu.prepare(module)": "distal.devices.gpu.GpuKernel",
    "kernel.render(4, 3, {}, {})": "numpy.ndarray[tuple[Any, ...], "
    "numpy.dtype[numpy.floating[numpy._typing._nbit_base._32Bit]]]",
    "scene.video('a.mp4', duration=1.0)": "distal.video.recording.FinishedSequence",
    "scene.export('a.html')": "distal.export.exported.Exported",
    "scene.show()": "distal.notebook.widget.LiveView",
}
PROGRAM = """
from distal.devices.base import Kernel
from distal.ir.nodes import Module
from distal.lang.functions import Image
from distal.lang.runtime_access import executor
from distal.runtime import kernels
from distal.scene import scene as scene_module
from distal.scene.scene import Scene

def follow(scene: Scene, image: Image, kernel: Kernel, module: Module) -> None:
"""


# Names that a module imports are read from outside of it here. The option changes how all is read
# that it is given for: given for two modules, mypy reads the rest from what `make lint` left.
REEXPORTED = """
[[tool.mypy.overrides]]
module = ["distal.scene.scene", "distal.runtime.kernels"]
implicit_reexport = true
"""


@pytest.fixture(scope="module")
def revealed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("typed")
    file, settings = folder / "follow.py", folder / "pyproject.toml"
    file.write_text(PROGRAM + "".join(f"    reveal_type({e})\n" for e in CHAIN), "utf-8")
    settings.write_text((ROOT / "pyproject.toml").read_text("utf-8") + REEXPORTED, "utf-8")
    config = ["--config-file", str(settings)]
    # In a process of its own: mypy raises Python's recursion limit and leaves it so.
    command = [sys.executable, "-m", "mypy", *config, str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)
    types = re.findall(r'note: Revealed type is "(.*)"', done.stdout)
    assert len(types) == len(CHAIN), done.stdout + done.stderr
    return dict(zip(CHAIN, types, strict=True))


@pytest.mark.parametrize("expression", CHAIN)
def test_the_type_is_known(revealed, expression):
    assert revealed[expression] == CHAIN[expression]


def declared(*classes):
    return {field.name: field for one in classes for field in fields(one)}


def default_of(field):
    return None if field.default is MISSING else field.default


@pytest.mark.parametrize(
    ("method", "options"),
    [
        (Image.render, declared(RenderOptions)),
        (Scene.render, declared(RenderOptions, ViewOptions)),
    ],
)
def test_a_public_method_takes_the_declared_options(method, options):
    parameters = dict(inspect.signature(method).parameters)
    del parameters["self"]
    for name, parameter in parameters.items():
        assert parameter.default == default_of(options[name]), name
    # The numbers of a scene are set by the views that read them.
    # A section is what a person cuts away in a window.
    # Hosts that draw frame after frame set the date and the frames so far. A scene reads no keys.
    left_out = {"settings", "refinement", "date", "history"}
    of_images = {"keys", "buttons", "delta"}
    left_out |= {"section", *of_images} if method is Scene.render else {"freeze"}
    assert options.keys() - parameters.keys() == left_out


def entries(documented, section):
    """The entries of a section of a docstring, by name, with folded white space."""
    text = inspect.getdoc(documented) or ""
    section = text.partition(f"{section}:\n")[2].partition("\n\n")[0]
    found = re.findall(r"^    (\w+): (.*(?:\n {6,}.*)*)", section, re.MULTILINE)
    return {name: " ".join(words.split()) for name, words in found}


@pytest.mark.parametrize("method", [Image.render, Scene.render])
def test_a_public_method_documents_options_as_they_are_declared(method):
    texts = {**entries(RenderOptions, "Attributes"), **entries(ViewOptions, "Attributes")}
    documented = entries(method, "Args")
    assert documented.keys() == inspect.signature(method).parameters.keys() - {"self"}
    assert documented == {name: texts[name] for name in documented}


def test_exports_take_the_options_of_pages():
    assert ExportOptions.__annotations__.keys() == declared(PageOptions).keys()


def test_videos_and_widgets_take_the_options_of_what_makes_them():
    video = inspect.signature(recording.video).parameters.keys()
    assert VideoOptions.__annotations__.keys() == video - {"obj", "path", "duration"}
    widget = pytest.importorskip("distal.notebook.widget")
    live_view = inspect.signature(widget.LiveView).parameters.keys()
    assert ShowOptions.__annotations__.keys() == live_view - {"obj"}


def test_nothing_passes_untyped_options():
    """``**options: Any`` would hide from a type checker what is passed on."""
    found = []
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.args.kwarg is not None:
                annotation = node.args.kwarg.annotation
                if node.args.kwarg.arg == "options" and ast.unparse(annotation) == "Any":
                    found.append(f"{path.relative_to(SOURCE)}:{node.name}")
    # Options of Python's own parser, and those with which NumPy calls.
    assert found == ["frontend/parsing.py:parse", "lang/expressions.py:__array_ufunc__"]
