"""The whole field library, imported: its rows and their docstrings.

Input: the package's modules. Output: rows by name, measured lines of docstrings.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from distal import fields
from distal.fields.guarantees import OPERATORS, PRIMITIVES, Operator, Primitive
from distal.lang import Func


def modules() -> list[Any]:
    """All modules of ``distal.fields``."""
    names = sorted(m.name for m in pkgutil.walk_packages(fields.__path__, "distal.fields."))
    return [importlib.import_module(name) for name in names]


MODULES = modules()


def primitives() -> Mapping[str, Primitive]:
    """Every declared shape."""
    return PRIMITIVES


def operators() -> Mapping[str, Operator]:
    """Every declared operator."""
    return OPERATORS


def docstring(func: Func) -> str:
    """A function's docstring, its margin taken off."""
    return inspect.cleandoc(func.__doc__ or "")


@dataclass(frozen=True, slots=True)
class Measured:
    """A measured line of a docstring: what was asked, and what it gives."""

    text: str
    function: str
    args: tuple[Any, ...]
    kwargs: Mapping[str, Any]
    value: float


def measured(func: Func) -> list[Measured]:
    """The lines under ``Measured:``."""
    found = []
    parts = re.split(r"^Measured:\s*$", docstring(func), flags=re.MULTILINE)
    block = parts[1] if len(parts) > 1 else ""
    for line in block.splitlines():
        if line.strip() and not line.startswith(" "):
            break  # the next section
        if line.strip():
            found.append(_read(line.strip()))
    return found


def _read(line: str) -> Measured:
    call, _, value = line.rpartition(" = ")
    tree = ast.parse(call, mode="eval").body
    assert isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name), line
    args = tuple(_value(a) for a in tree.args)
    kwargs = {str(k.arg): _value(k.value) for k in tree.keywords}
    return Measured(line, tree.func.id, args, kwargs, float(ast.literal_eval(value)))


def _value(node: ast.expr) -> Any:
    """A literal; ``Buffer([…])`` and ``Texture2D([…])`` are the lists in them."""
    if isinstance(node, ast.Call):
        (node,) = node.args
    return ast.literal_eval(node)
