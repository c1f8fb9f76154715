"""What may be imported when: the compile path needs the standard library alone.

Import-linter reads the source for the same laws (``pyproject.toml``); here they are tried.
"""

import ast
import os
import queue
import subprocess
import sys
from pathlib import Path

import pytest

import distal
from distal.compiler.driver import COMPILE_TARGETS
from distal.editor.local.process import WorkerProcess

EXAMPLES = sorted(distal.gallery())

# Fails every import of what is neither in the standard library nor distal.
STANDARD_LIBRARY_ONLY = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top not in sys.stdlib_module_names and top not in ("distal", "sitecustomize"):
            raise ModuleNotFoundError(f"blocked: {name}", name=name)

sys.meta_path.insert(0, Blocker())
"""

WITHOUT_HEAVY_PACKAGES = """
import sys
for name in ("numpy", "llvmlite", "wgpu", "PIL", "moderngl"):
    sys.modules[name] = None
"""


def run(code, *words):
    # What passes leave behind is verified where their results are looked at; here imports are.
    answer = subprocess.run(
        [sys.executable, "-c", code, *words],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "DISTAL_VERIFY": ""},
        capture_output=True,
        text=True,
        timeout=400,
    )
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


def test_the_blocker_blocks():
    with pytest.raises(AssertionError, match="blocked: numpy"):
        run(STANDARD_LIBRARY_ONLY + "import numpy")


def test_importing_distal_loads_only_itself_and_little_of_it():
    code = "import sys; before = set(sys.modules); import distal; print(set(sys.modules) - before)"
    loaded = ast.literal_eval(run(code))
    assert {name.partition(".")[0] for name in loaded} <= sys.stdlib_module_names | {"distal"}
    assert len([name for name in loaded if name.startswith("distal")]) <= 4


def test_gallery_is_not_empty():
    assert "raymarcher" in EXAMPLES


# What GLSL ES 1.00 lacks it refuses: integer hashes, data. Scenes that import NumPy need it.
# One imports its neighbor, which the blocker above takes for a package.
ALONE = [
    name
    for name, path in distal.gallery().items()
    if "import numpy" not in path.read_text() and name != "sea_sphere_tracing"
]
# An image, a scene with data, and the most of shapes and materials: all scenes for one text only.
FEW = ("raymarcher", "city", "bunny")
REFUSED = dict.fromkeys(("glsl-es100", "glslcanvas", "isf"), ("catalogue", "city", "room_door"))


def test_scenes_are_among_those_that_need_nothing():
    assert {"bunny", "city", "raymarcher"} <= set(ALONE)


def scenes_for(target):
    return [
        name
        for name in ALONE
        if name not in REFUSED.get(target, ()) and (name in FEW or target == "glsl-es300")
    ]


@pytest.fixture(scope="module")
def compiled_alone():
    """What one process without other packages printed; it loads each scene once."""
    code = f"""
import distal
scenes = {{}}
for target, names in {[(target, scenes_for(target)) for target in COMPILE_TARGETS]}:
    for name in names:
        try:
            if name not in scenes:
                scenes[name] = distal.load("example:" + name)
            text = distal.compile(scenes[name], target=target).text
            print(target, name, len(text) > 100)
        except Exception as error:
            print(target, name, repr(error))
"""
    return run(STANDARD_LIBRARY_ONLY + code).splitlines()


@pytest.mark.parametrize("target", COMPILE_TARGETS)
def test_every_target_compiles_on_the_standard_library_alone(target, compiled_alone):
    lines = [line for line in compiled_alone if line.split()[0] == target]
    assert lines == [f"{target} {name} True" for name in scenes_for(target)]


def test_the_command_compiles_without_numpy_llvmlite_and_wgpu():
    code = WITHOUT_HEAVY_PACKAGES + "from distal.cli import main; main()"
    assert "fn " in run(code, "compile", "example:raymarcher", "--target", "wgsl")


def test_a_process_imports_nothing_from_the_working_folder(tmp_path, monkeypatch):
    """Else a file ``json.py`` in a folder of all users, where a command is typed, would be run."""
    for name in ("ast", "json", "numpy", "distal"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported')\n")
    (tmp_path / "scenes").mkdir()
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, sys.path)))
    monkeypatch.chdir(tmp_path)
    said = queue.SimpleQueue()
    worker = WorkerProcess(tmp_path / "scenes", said.put, said.put)
    try:
        assert said.get(timeout=60.0).startswith('{"kind":"ready"')
    finally:
        worker.kill()


def test_every_process_is_started_without_the_working_folder():
    starts = []
    for path in sorted(Path(distal.__file__).parent.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.List)
                and node.elts
                and (ast.unparse(node.elts[0]) == "sys.executable")
            ):
                starts.append((path.name, ast.unparse(node.elts[1])))
    others = [start for start in starts if start[1] != "'-P'"]
    assert others == [("local.py", "*_COMMAND")]  # which begins with it
    assert len(starts) >= 7
