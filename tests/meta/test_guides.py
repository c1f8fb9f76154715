"""Every Python block of the front page and the guides runs as it is printed.

Blocks of one page run in order in one folder, each as a file of its own. A block that loads a file
finds the block before it there. Blocks of the notebook guide are cells: they know the names of the
cells before. Pictures are made small; nothing else is changed.
"""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import distal
from distal import Scene, Shape
from distal.lang.functions import Image

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs/guide").glob("*.md"))]
SOUND = ROOT / "examples/frames/arpeggio.wav"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LOADED = re.compile(r'load\("(\w+\.py)"')
SIZE = re.compile(r"\b640, 480\b")


def blocks(page: Path) -> list[str]:
    return [SIZE.sub("32, 24", text) for text in BLOCK.findall(page.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p)], ids=lambda page: page.name)
def test_its_blocks_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if SOUND.name in page.read_text(encoding="utf-8"):
        shutil.copy(SOUND, tmp_path)
    are_cells = page.name == "notebook.md"
    if are_cells:
        pytest.importorskip("anywidget", reason="widgets need it: pip install 'distal[notebook]'")
    made = {}
    for number, text in enumerate(blocks(page)):
        file = tmp_path / f"block_{number}.py"
        file.write_text(text, encoding="utf-8")
        made = runpy.run_path(str(file), made if are_cells else None)
        if not LOADED.search(text):
            for name in LOADED.findall(page.read_text(encoding="utf-8")):
                (tmp_path / name).write_text(text, encoding="utf-8")
        for value in made.values():
            if isinstance(value, Scene | Image):
                picture = value.render((32, 24))
                assert picture.array[..., :3].std() > 0.01, f"a blank picture: block {number}"
            elif isinstance(value, Shape):
                assert value.slope > 0.0


def test_what_the_guide_to_scenes_names_is_there():
    text = BLOCK.sub("", (ROOT / "docs/guide/scenes.md").read_text(encoding="utf-8"))
    code = [re.sub(r'"[^"]*"', "", part) for part in re.findall(r"`([^`]+)`", text)]
    assert code
    classes = {name for part in code for name in re.findall(r"\b[A-Z][a-z]\w+", part)}
    classes -= {"True", "False", "None"}
    assert {name for name in classes if not hasattr(distal, name)} == set()
    methods = {name for part in code for name in re.findall(r"\.([a-z_]+)\b", part)}
    owners = (distal.Shape, distal.Shape2D, distal.Picture, distal.Group, distal.Camera)
    known = {*dir(distal), *(name for owner in owners for name in dir(owner))}
    assert methods - known <= {"lang", "py", "png", "sin"}  # a module, ends of files, and NumPy's


def test_there_are_blocks():
    assert {page.name for page in PAGES if blocks(page)} >= {"README.md", "scenes.md"}


def test_the_table_of_printable_examples_has_every_part():
    found = subprocess.run(
        [sys.executable, "tools/gen_printing.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (found.returncode, found.stdout) == (0, "")


def test_the_scenes_of_other_tools_have_lines_and_pictures():
    found = subprocess.run(
        [sys.executable, "tools/gen_rebuilt.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (found.returncode, found.stdout) == (0, "")
