"""The gallery shows every example, and the catalogue sheet every row of the library."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from distal.example_files import all_examples, posters
from distal.fields.guarantees import UNBOUNDED

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs/pictures"
MOST_BYTES = 150_000
SHOWN = sorted(all_examples())


@pytest.fixture
def tools(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module


def test_the_page_is_fresh_and_no_picture_is_missing():
    command = [sys.executable, ROOT / "tools/gen_gallery.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_example_has_a_poster_that_shows_it():
    command = [sys.executable, ROOT / "tools/gen_posters.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert sorted(posters()) == SHOWN


def test_every_sheet_of_the_catalogue_has_every_cell():
    command = [sys.executable, ROOT / "tools/gen_catalogue_sheet.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


def test_every_example_is_listed_once():
    lines = (ROOT / "docs/gallery.md").read_text().splitlines()
    shown = [line for line in lines if line.startswith("![") and "catalogue_" not in line]
    assert sorted(shown) == [f"![{name}](pictures/{name}.png)" for name in SHOWN]


@pytest.mark.parametrize("example", SHOWN)
def test_every_picture_is_small_and_shows_something(example):
    path = PICTURES / f"{example}.png"
    picture = Image.open(path).convert("RGB")
    assert picture.size == (480, 360)
    assert path.stat().st_size <= MOST_BYTES
    assert np.asarray(picture).std() > 5.0


def test_a_command_of_the_page_renders(tmp_path):
    lines = (ROOT / "docs/gallery.md").read_text().splitlines()
    (command,) = [line for line in lines if line.startswith("    distal render example:room_door ")]
    _, *words = command.split()
    at = words.index("--size") + 1
    words[at] = "48x36"
    run = "import sys; from distal.cli import main; sys.exit(main())"
    done = subprocess.run(
        [sys.executable, "-c", run, *words], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert Image.open(tmp_path / "room_door.png").size == (48, 36)


def test_every_row_of_the_library_has_a_cell(tools):
    cells = tools("catalogue_cells")
    library = tools("distal.fields.library")
    titles = {group: [c.title for c in cells.cells([group])] for group in cells.GROUPS}
    assert sorted(titles["solids"] + titles["flats"]) == sorted(library.PRIMITIVES)
    assert sorted(titles["operators"] + titles["blends"]) == sorted(library.OPERATORS)


def test_every_cell_can_be_made_and_has_a_bounded_slope(tools):
    cells = tools("catalogue_cells")
    known_bounds_of = tools("distal.scene.lowering.known_bounds").known_bounds_of
    for cell in cells.cells():
        assert known_bounds_of(cell.make().node).slope < UNBOUNDED / 1000.0, cell.title
