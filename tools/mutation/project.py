"""What is mutated: a source tree, its tests, and the functions its files define.

Input: folders. Output: paths, module names and the outermost function or method
that a line belongs to. Knows nothing of mutations or of running.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

MODULE_LEVEL = "<module>"


@dataclass(frozen=True)
class Project:
    """A source tree and its tests.

    Attributes:
        root: The folder that tests run in.
        source: The folder that holds the packages.
        tests: Test files and folders, relative to the root.
        preload: Modules imported once, before the fork; none of them may import the source.
    """

    root: Path
    source: Path
    tests: tuple[str, ...]
    preload: tuple[str, ...] = ()
    _indexes: dict[str, Index] = field(default_factory=dict, compare=False, repr=False)

    def files(self, pattern: str) -> list[Path]:
        """Python files below the source that a glob names; a folder means all files in it."""
        found = [path for match in sorted(self.source.glob(pattern)) for path in _python(match)]
        return [path for path in found if path.name != "__init__.py"]

    def name(self, path: Path) -> str:
        """The path relative to the source folder, as in lists."""
        return path.relative_to(self.source).as_posix()

    def module(self, name: str) -> str:
        """The dotted name of a file's module."""
        return name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")

    def index(self, name: str) -> Index:
        """The functions of a file, by the name that ``name`` gave it."""
        if name not in self._indexes:
            self._indexes[name] = Index((self.source / name).read_text("utf-8"))
        return self._indexes[name]


def _python(path: Path) -> list[Path]:
    if path.is_dir():
        return sorted(path.rglob("*.py"))
    return [path] if path.suffix == ".py" else []


class Index:
    """The functions and the module-level statements of one text."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tree = ast.parse(text)

    @cached_property
    def functions(self) -> dict[str, ast.FunctionDef | ast.AsyncFunctionDef]:
        """Outermost functions and methods by qualified name; of several, the last."""
        found: dict[str, ast.FunctionDef | ast.AsyncFunctionDef] = {}
        waiting: list[tuple[str, list[ast.stmt]]] = [("", self.tree.body)]
        while waiting:
            prefix, body = waiting.pop()
            for node in body:
                if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                    found[prefix + node.name] = node
                elif isinstance(node, ast.ClassDef):
                    waiting.append((f"{prefix}{node.name}.", node.body))
        return found

    @cached_property
    def _owners(self) -> dict[int, str]:
        owners: dict[int, str] = {}
        for name, node in self.functions.items():
            first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
            owners.update(dict.fromkeys(range(first, (node.end_lineno or first) + 1), name))
        return owners

    def owner(self, line: int) -> str:
        """The outermost function that contains a line, decorators included."""
        return self._owners.get(line, MODULE_LEVEL)

    def statement(self, line: int) -> ast.stmt:
        """The module-level statement that contains a line."""
        for node in self.tree.body:
            if node.lineno <= line <= (node.end_lineno or node.lineno):
                return node
        raise LookupError(f"no statement at line {line}")

    @cached_property
    def names(self) -> dict[str, frozenset[str]]:
        """What each function mentions."""
        return {name: mentioned(node) for name, node in self.functions.items()}


def mentioned(node: ast.AST) -> frozenset[str]:
    """Every plain name and attribute below a node."""
    names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
    return frozenset(names | {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)})
