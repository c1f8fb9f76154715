"""What editors and ``import distal`` know of the shapes' classes is what the library has."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _tool():
    spec = importlib.util.spec_from_file_location("stubs", ROOT / "tools/gen_shapes_stub.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("path", "text"), _tool().FILES.items(), ids=lambda it: getattr(it, "name", "")
)
def test_it_is_fresh(path, text):
    assert path.read_text(encoding="utf-8") == text(), "run tools/gen_shapes_stub.py"
