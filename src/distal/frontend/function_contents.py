"""What a scene function consists of: its text, and the values that it reads by name.

Input: a recorded ``Overload``. Output: its syntax tree as text, and the values of the names in it:
of its closure, of the function around it, of its module. For digests and pickles.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import CodeType, ModuleType
from typing import Any

from distal.frontend.parsing import parse
from distal.frontend.signatures.signatures import definition_of
from distal.lang.functions import Overload


@dataclass(frozen=True, slots=True)
class ValuesRead:
    """The values that a function reads, by name.

    Attributes:
        closure: Of the variables of functions around it; those without a value are left out.
        enclosing: Of names that only its annotations use, in the function around it.
        module: Of the global names.
        attributes: The attributes that are read of each name: ``{"math": {"pi"}}``.
    """

    closure: dict[str, Any] = field(default_factory=dict)
    enclosing: dict[str, Any] = field(default_factory=dict)
    module: dict[str, Any] = field(default_factory=dict)
    attributes: dict[str, set[str]] = field(default_factory=dict)

    def items(self) -> Iterator[tuple[str, Any]]:
        """Yield all names and values."""
        for part in (self.closure, self.enclosing, self.module):
            yield from part.items()


def text_of(overload: Overload) -> str:
    """Return the definition as text, without comments and decorators.

    Raises:
        CompileError: The source text is not available.
    """
    node = definition_of(overload).node
    parts = [ast.unparse(node.args), *map(ast.unparse, node.body)]
    returns = "" if node.returns is None else ast.unparse(node.returns)
    return "\n".join([node.name, *parts, returns])


def values_read(overload: Overload) -> ValuesRead:
    """Return the values that a function reads.

    A name of its own variables counts only where an annotation has it.

    Raises:
        CompileError: The source text is not available.
    """
    node, python, found = definition_of(overload).node, overload.python, ValuesRead()
    cells = dict(zip(python.__code__.co_freevars, python.__closure__ or (), strict=True))
    in_annotations = _annotation_names(node)
    in_body: set[str] = set()
    for part in (node.args, *node.body, *([node.returns] if node.returns else [])):
        for each in ast.walk(part):
            if isinstance(each, ast.Name):
                in_body.add(each.id)
            elif isinstance(each, ast.Attribute) and isinstance(each.value, ast.Name):
                found.attributes.setdefault(each.value.id, set()).add(each.attr)
    for name in sorted(in_annotations | in_body & _code_names(python.__code__)):
        if name in cells:
            try:
                found.closure[name] = cells[name].cell_contents
            except ValueError:  # it has no value yet
                continue
        elif name in in_annotations and name in overload.enclosing:
            found.enclosing[name] = overload.enclosing[name]
        elif name in python.__globals__:
            found.module[name] = python.__globals__[name]
    return found


def attributes_of(module: ModuleType, names: set[str]) -> dict[str, Any]:
    """Return attributes of a module, those that it has."""
    return {name: vars(module)[name] for name in sorted(names) if name in vars(module)}


def _code_names(code: CodeType) -> set[str]:
    """Return the names of a code object and of those in it that are not its own variables."""
    found, waiting = set(code.co_freevars), [code]
    while waiting:
        each = waiting.pop()
        found.update(each.co_names)
        waiting.extend(c for c in each.co_consts if isinstance(c, CodeType))
    return found


def _annotation_names(node: ast.FunctionDef) -> set[str]:
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
    found: set[str] = set()
    while waiting:
        annotation = waiting.pop()
        for each in ast.walk(annotation) if annotation is not None else ():
            if isinstance(each, ast.Name):
                found.add(each.id)
            elif isinstance(each, ast.Constant) and isinstance(each.value, str):
                try:
                    waiting.append(parse(each.value, mode="eval"))
                except (SyntaxError, ValueError):
                    continue  # it is no annotation: the compiler says so
    return found
