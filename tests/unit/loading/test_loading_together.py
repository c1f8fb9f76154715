"""Files of one folder that several threads load at the same time."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

import distal
from distal import Scene

WAITS = """
import pathlib, time
while not (pathlib.Path(__file__).parent / "imports").exists():
    time.sleep(0.005)
from distal import Scene, Sphere
scene = Scene(Sphere())
"""
PARTS = """
import pathlib, time
(pathlib.Path(__file__).parent / "imports").touch()
while not (pathlib.Path(__file__).parent / "loaded").exists():
    time.sleep(0.005)
from distal import Sphere
thing = Sphere()
"""
IMPORTS = "from parts import thing\nfrom distal import Scene\nscene = Scene(thing)\n"


def test_a_load_that_ends_leaves_modules_that_another_one_imports(tmp_path: Path):
    for name, text in (("waits", WAITS), ("parts", PARTS), ("imports_parts", IMPORTS)):
        (tmp_path / f"{name}.py").write_text(text)
    found: dict[str, object] = {}

    def load(name: str) -> None:
        try:
            found[name] = distal.load(tmp_path / f"{name}.py")
        except Exception as error:  # a thread's own errors are not seen
            found[name] = error
        (tmp_path / "loaded").touch()

    threads = [threading.Thread(target=load, args=(n,)) for n in ("waits", "imports_parts")]
    threads[0].start()
    while "distal_scene_waits" not in sys.modules:
        pass
    threads[1].start()
    for thread in threads:
        thread.join(30.0)
    assert all(isinstance(scene, Scene) for scene in found.values()), found
