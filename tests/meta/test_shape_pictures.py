"""The pages of shapes and options are what the library is; each line of code and figure is true."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import distal
from distal.fields.combine.blends import BLENDS
from distal.lang import Texture2D, Texture3D

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "docs/guide/scenes.md"


def _tool(name):
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        spec = importlib.util.spec_from_file_location(name, ROOT / f"tools/{name}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return module


THUMBNAILS, OPTIONS = _tool("gen_thumbnails"), _tool("gen_options")
LINES = THUMBNAILS.code_lines()


def test_every_shape_and_operator_has_a_picture_and_all_are_small():
    assert list(THUMBNAILS.problems()) == []
    assert len(LINES) > 300


def test_the_page_of_options_is_fresh_and_says_each():
    assert OPTIONS.PAGE.read_text(encoding="utf-8") == OPTIONS.page(), "run tools/gen_options.py"
    rows = [line for line in OPTIONS.page().splitlines() if line.startswith("| `")]
    assert [row for row in rows if row.endswith("|  |")] == []
    said = " ".join(row.split("|")[1].strip(" `") for row in rows)
    assert {"far", "steps", "bounces", "fps", "title", "playing", "tolerance"} <= {*said.split()}


@pytest.fixture(scope="module")
def names():
    """What the page says the names of its lines stand for."""
    cells = THUMBNAILS.catalogue_cells
    y, x = np.mgrid[0:8, 0:8] / 8.0
    picture = Texture2D(np.repeat((x + y)[..., None], 4, axis=2).astype(np.float32), wrap="clamp")
    z, y, x = np.mgrid[-1:1:9j, -1:1:9j, -1:1:9j]
    samples = np.sqrt(x * x + y * y + z * z) - 0.7
    return {
        **{name: getattr(distal, name) for name in distal.__all__},
        **{"np": np, "points": cells.WAY, "outline": cells.OUTLINE, "balls": cells.BALLS},
        **{"image": picture, "heights": picture, "volume": Texture3D(samples)},
        **{"samples": 0.1 * samples, "ripples": cells.ripples},
        **{"a": distal.Box((1.7, 0.5, 1.4)), "b": distal.Cylinder(0.4, 1.4)},
    }


@pytest.mark.filterwarnings("ignore")
def test_each_line_makes_what_its_cell_shows(names):
    for cell in THUMBNAILS.cells():
        made = eval(LINES[cell.title], dict(names))
        assert isinstance(made, distal.Shape | distal.Shape2D), cell.title
        if cell.title == "BrickField" or cell.group == "blends":
            continue
        wanted = cell.make()
        assert made.flat == wanted.flat, cell.title
        if wanted.node.rule.name in THUMBNAILS.JOINED and " " not in cell.title:
            continue
        assert made.node.rule is wanted.node.rule, (cell.title, LINES[cell.title])


def test_the_guide_says_how_far_each_blend_moves_the_surface():
    text = SCENES.read_text(encoding="utf-8")
    table = text.partition("### Smooth")[2].partition("Other tools")[0]
    said = {}
    for line in table.splitlines():
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        if len(cells) == 3 and "`" in cells[0] and cells[0] != "`blend`":
            for name in re.findall(r"`(\w+)`", cells[0]):
                said[name] = cells[1:]
    assert said.keys() == BLENDS.keys()
    for name, (moves, width) in said.items():
        blend = BLENDS[name]
        count = (3,) if blend.counted else ()
        found = -blend.union(0.0, 0.0, 0.1, *count) / 0.1
        number = moves.split(" ")[0]
        written = 1.0 / 3.0 if number == "1/`count`" else float(number)
        assert written == pytest.approx(found, rel=5e-4), name
        if blend.width is not None:
            assert float(width.split(" ")[0]) == pytest.approx(blend.width, rel=5e-4), name
        else:
            assert not width[:1].isdigit(), name
