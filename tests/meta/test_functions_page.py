"""The page of functions for scene code: fresh, complete, and what it says can be imported."""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

from distal.fields import noise
from distal.fields.library import PRIMITIVES

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/reference/functions.md"
ROW = re.compile(r"^\| `(\w+)` \| `(\w+)\(.*` \| `([\w.]+)` \|$", re.MULTILINE)


def test_it_is_fresh():
    command = [sys.executable, ROOT / "tools/gen_functions_page.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_shape_and_every_noise_is_in_it():
    text = PAGE.read_text(encoding="utf-8")
    assert {name for name, _, _ in ROW.findall(text)} == set(PRIMITIVES)
    headings = set(re.findall(r"^### (\w+)$", text, re.MULTILINE))
    assert set(noise.__all__) - {"Cellular", "fbm_slope"} <= headings


def test_each_function_is_where_the_page_says():
    for shape, function, module in ROW.findall(PAGE.read_text(encoding="utf-8")):
        assert getattr(importlib.import_module(module), function) is PRIMITIVES[shape].distance


def test_each_picture_is_of_the_line_beside_it():
    text = PAGE.read_text(encoding="utf-8")
    shown = re.findall(
        r"^\| !\[\w+\]\(\.\./(pictures/functions/\w+\.webp)\) \|", text, re.MULTILINE
    )
    files = {f"pictures/functions/{f.name}" for f in (ROOT / "docs/pictures/functions").iterdir()}
    assert set(shown) == files and len(shown) == len(files)
