"""The table "Where do I add" in ARCHITECTURE.md says how many files each addition takes."""

from __future__ import annotations

import importlib.util
import re
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
LINE = re.compile(r"^\| (an? [^|]+?) \| (\d+) \|", re.MULTILINE)


def _tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("additions", ROOT / "tools/count_additions.py")
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = tool
    spec.loader.exec_module(tool)
    return tool


TOOL = _tool()
STATED = {
    what: int(number) for what, number in LINE.findall((ROOT / "ARCHITECTURE.md").read_text())
}


@cache
def counted() -> dict[str, list[str]]:
    """Reading the source takes seconds: only the process that runs these tests does."""
    return TOOL.count(ROOT)


@pytest.mark.parametrize("what", [addition.what for addition in TOOL.ADDITIONS])
def test_the_stated_number_is_the_counted_one(what):
    assert len(counted()[what]) == STATED[what], counted()[what]


def test_every_example_is_found():
    assert all(counted().values())


def test_comments_and_docstrings_do_not_count():
    text = '"""About twist."""\n# twist\nx = "not twisted"\n'
    assert "twist" not in TOOL.code_words(text)
    assert "twist" in TOOL.code_words('operator("twist")\n')
