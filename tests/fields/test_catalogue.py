"""The page of shapes and operators: fresh in all that is not measured."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Final

from tests.fields.library import operators, primitives

ROOT: Final = Path(__file__).parents[2]
PAGE: Final = ROOT / "docs/reference/catalogue.md"


def test_it_is_fresh():
    command = [sys.executable, ROOT / "tools/gen_catalogue.py", "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_every_row_is_in_it_and_was_measured():
    text = PAGE.read_text()
    rows = re.findall(r"^\| \*\*(.+?)\*\*.*\| (\S[^|]*) \| (\S[^|]*) \|$", text, re.MULTILINE)
    assert {name for name, _, _ in rows} == {*primitives(), *operators()}
    for name, error, steepest in rows:
        assert steepest == "-" or float(steepest) <= 1.001, name
        assert error in ("-", "< 1e-12") or float(error) < 1e-5, name
    assert "reference/catalogue.md" in (ROOT / "docs/README.md").read_text()
