"""Public names: each stands for one thing, and examples import nothing else.

Public is what ``distal`` and ``distal.lang`` offer, and what ``docs/reference/functions.md`` lists.
"""

from __future__ import annotations

import ast
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import distal
import distal.fields.noise
import distal.lang

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/reference/functions.md").read_text(encoding="utf-8")
FILES = sorted(p for d in ("examples", "lessons") for p in (ROOT / d).rglob("*.py"))
STARRED = (distal, distal.lang, distal.fields.noise)


def listed() -> set[tuple[str, str]]:
    """The modules and names that the page of functions lists."""
    found = {(m, name) for name, m in re.findall(r"`(\w+)`, from\s`([\w.]+)`", PAGE)}
    found |= {
        (m, n) for n, m in re.findall(r"^\| `\w+` \| `(\w+)\(.*\| `([\w.]+)` \|$", PAGE, re.M)
    }
    module = ""
    for line in PAGE.splitlines():
        told = re.match(r"(?:Import from|From) `([\w.]+)`", line)
        module = told[1] if told else module
        if line.startswith("### "):
            found.add((module, line[4:]))
    return found


LISTED = listed()


def imports(path: Path) -> Iterator[tuple[str, str]]:
    """The modules and names of the package that a file imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "distal":
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            found = (alias.name for alias in node.names)
            yield from ((name, "*") for name in found if name.split(".")[0] == "distal")


def is_public(module: str, name: str) -> bool:
    """Whether a name may be imported from a module."""
    if module in ("distal", "distal.lang"):
        public = importlib.import_module(module)
        return name == "*" or name in (*public.__all__, *getattr(public, "_NOT_STARRED", ()))
    return (module, name) in LISTED


def test_examples_import_public_names_alone():
    found = {(module, name) for path in FILES for module, name in imports(path)}
    assert len(found) > 100
    assert {pair for pair in found if not is_public(*pair)} == set()


def test_what_the_page_lists_is_there():
    assert {("distal.fields.noise", "lattice_hash"), ("distal", "Surface")} <= LISTED
    assert ("distal.lang", "pcg") in LISTED
    for module, name in LISTED:
        assert hasattr(importlib.import_module(module), name), f"{module}.{name}"
    assert not is_public("distal.render.material", "Surface")


def test_no_public_name_stands_for_two_things():
    meanings: dict[str, set[int]] = {}
    for module in STARRED:
        for name in module.__all__:
            meanings.setdefault(name, set()).add(id(getattr(module, name)))
    assert [name for name, found in meanings.items() if len(found) > 1] == []


def test_a_name_that_was_of_two_things_is_refused_with_both():
    with pytest.raises(AttributeError) as caught:
        distal.gradient  # noqa: B018
    assert "'linear_gradient'" in str(caught.value)
    assert "the derivative is that of distal.lang" in str(caught.value)
