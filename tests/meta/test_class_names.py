"""A class name means one thing in the whole package."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src/distal"

# The same idea on two levels, under the name that the field gives it.
SHARED = {
    "Buffer": "what an author declares, and its type",
    "Frame": "what an author's image takes, and a call's frame in the interpreter",
}


def test_a_class_name_is_defined_once():
    places = defaultdict(list)
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                places[node.name.lstrip("_")].append(path.relative_to(SOURCE).as_posix())
    several = {name: paths for name, paths in places.items() if len(paths) > 1}
    assert {name: paths for name, paths in several.items() if name not in SHARED} == {}
