"""A type checker follows ``Scene.render`` to the device."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import distal

ROOT = Path(__file__).parents[2]
SOURCE = Path(distal.__file__).parent
# What is revealed, and the type that it must have.
CHAIN = {
    "scene.render()": "distal.images.picture.Picture",
    "image.render()": "distal.images.picture.Picture",
    "scene_module.rendering.render_scene": "def (scene: distal.scene.scene.Scene, "
    "options: distal.lang.render_options.RenderOptions) -> distal.images.picture.Picture",
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
