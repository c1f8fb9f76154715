"""The public interface documents its parameters, and uses plain words."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from enum import Enum
from pathlib import Path
from typing import Any

import pytest

import distal
import distal.lang

ROOT = Path(__file__).parents[2]
ARGS = re.compile(r"(?:Args|Attributes):\n(.*?)(?:\n\n|\Z)", re.DOTALL)
# One method has the text for its siblings: "Arguments as for ``union``."
ELSEWHERE = re.compile(r"[Aa]rguments as for")
# Words that mean something else elsewhere, or nothing to a newcomer (the style guide lists them).
# "row" and "kind" are not here: each has a plain meaning too.
JARGON = re.compile(
    r"\b(rooms|house|wish|wishes|doubts|hopeless|hands? on|mend|mends|what flows|told|survey)\b",
    re.IGNORECASE,
)
# What a class inherits from Python.
INHERITED = {"from_bytes", "to_bytes"}


def public_callables() -> Iterator[tuple[str, Callable[..., Any]]]:
    """What users call: names of ``distal`` and ``distal.lang``, and methods of their classes."""
    seen: set[int] = set()
    for module in (distal, distal.lang):
        for name in module.__all__:
            value = getattr(module, name)
            if not callable(value) or id(value) in seen:
                continue
            if inspect.isclass(value) and issubclass(value, Enum):
                continue  # its members are its documentation
            seen.add(id(value))
            yield name, value
            if inspect.isclass(value):
                for attribute in dir(value):
                    method = getattr(value, attribute)
                    own = not attribute.startswith("_") and attribute not in INHERITED
                    key = getattr(method, "__func__", method)
                    if own and callable(method) and id(key) not in seen:
                        seen.add(id(key))
                        yield f"{name}.{attribute}", method


def undocumented(function: Callable[..., Any]) -> list[str]:
    """The parameters that are missing in the docstring of a function of three or more."""
    try:
        parameters = list(inspect.signature(function).parameters)
    except (TypeError, ValueError):
        return []
    parameters = [name for name in parameters if name not in ("self", "cls")]
    if len(parameters) < 3:
        return []
    doc = inspect.getdoc(function) or ""
    if ELSEWHERE.search(doc):
        return []
    found = ARGS.search(doc)
    text = found.group(1) if found else ""
    return [name for name in parameters if not re.search(rf"^\s*\**{name}\b", text, re.MULTILINE)]


def test_three_or_more_parameters_are_documented():
    missing = {name: undocumented(function) for name, function in public_callables()}
    assert {name: names for name, names in missing.items() if names} == {}


def test_a_missing_parameter_is_found():
    def placed(x, y, z):
        """Place it.

        Args:
            x: To the right.
            z: To the viewer.
        """

    assert undocumented(placed) == ["y"]


@pytest.mark.parametrize("folder", ["src/distal", "docs/guide", "examples"])
def test_words_are_plain(folder):
    found = []
    for path in sorted((ROOT / folder).rglob("*")):
        if path.suffix in (".py", ".pyi", ".md"):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if JARGON.search(line):
                    found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert found == []
