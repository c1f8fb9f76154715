"""What a scene function consists of: its text, and the values that it reads by name.

Input: a recorded ``Overload``. Output: its syntax tree as text, and the values of the names in it:
of its closure, of the function around it, of its module. For digests and pickles.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from types import CodeType, ModuleType
from typing import Any
from weakref import WeakKeyDictionary

from distal.frontend.parsing import parse
from distal.frontend.signatures.signatures import definition_of
from distal.lang.functions import Overload
from distal.session import SESSION


@dataclass(frozen=True, slots=True)
class FunctionContents:
    """What the text of a function says.

    Attributes:
        text: The definition, without comments and decorators.
        names: The names that its body reads and that are not its own variables.
        in_annotations: The names in its annotations.
        attributes: The attributes that are read of each name: ``{"math": {"pi"}}``.
    """

    text: str
    names: frozenset[str]
    in_annotations: frozenset[str]
    attributes: Mapping[str, set[str]]


_contents: WeakKeyDictionary[Overload, FunctionContents] = SESSION.keep(
    "function contents", WeakKeyDictionary()
)


def contents_of(overload: Overload) -> FunctionContents:
    """Return what the text of a function says, read at the first call.

    Raises:
        CompileError: The source text is not available.
    """
    contents = _contents.get(overload)
    if contents is None:
        contents = _contents.setdefault(overload, _read(overload))
    return contents


def _read(overload: Overload) -> FunctionContents:
    node = definition_of(overload).node
    parts = [node.args, *node.body, *([node.returns] if node.returns else [])]
    names: set[str] = set()
    attributes: dict[str, set[str]] = {}
    for each in (each for part in parts for each in ast.walk(part)):
        if isinstance(each, ast.Name):
            names.add(each.id)
        elif isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name):
            attributes.setdefault(each.value.id, set()).add(each.attr)
    text = "\n".join([node.name, *map(ast.unparse, parts)])
    read = names & _code_names(overload.python.__code__)
    return FunctionContents(text, frozenset(read), _annotation_names(node), attributes)


def values_read(overload: Overload) -> dict[str, Any]:
    """Return the values that a function reads, by name in the order of the alphabet.

    They are of its closure, of the function around it (for annotations), of its module. Names
    without a value are left out.

    Raises:
        CompileError: The source text is not available.
    """
    contents, python = contents_of(overload), overload.python
    cells = dict(zip(python.__code__.co_freevars, python.__closure__ or (), strict=True))
    values = {}
    for name in sorted(contents.names | contents.in_annotations):
        if name in cells:
            with suppress(ValueError):  # it has no value yet
                values[name] = cells[name].cell_contents
        elif name in contents.in_annotations and name in overload.enclosing:
            values[name] = overload.enclosing[name]
        elif name in python.__globals__:
            values[name] = python.__globals__[name]
    return values


def attributes_read(overload: Overload, name: str, module: ModuleType) -> dict[str, Any]:
    """Return the attributes of a module that a function reads by the module's name in it."""
    names = sorted(contents_of(overload).attributes.get(name, ()))
    return {name: vars(module)[name] for name in names if name in vars(module)}


def _code_names(code: CodeType) -> set[str]:
    """Return the names of a code object and of those in it that are not its own variables."""
    names, waiting = set(code.co_freevars), [code]
    while waiting:
        each = waiting.pop()
        names.update(each.co_names)
        waiting.extend(c for c in each.co_consts if isinstance(c, CodeType))
    return names


def _annotation_names(node: ast.FunctionDef) -> frozenset[str]:
    """Return the names in the annotations of a function and in it, also in those given as text."""
    waiting: list[ast.AST | None] = []
    for each in ast.walk(node):
        match each:
            case ast.FunctionDef():
                waiting.append(each.returns)
            case ast.arg() | ast.AnnAssign():
                waiting.append(each.annotation)
            case _:
                pass
    names: set[str] = set()
    while waiting:
        annotation = waiting.pop()
        for each in ast.walk(annotation) if annotation is not None else ():
            if isinstance(each, ast.Name):
                names.add(each.id)
            elif isinstance(each, ast.Constant) and isinstance(each.value, str):
                try:
                    waiting.append(parse(each.value, mode="eval"))
                except (SyntaxError, ValueError):
                    continue  # it is no annotation: the compiler says so
    return frozenset(names)
