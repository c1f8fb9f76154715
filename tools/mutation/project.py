"""What is mutated: a source tree, its tests, and the functions its files define.

Input: folders. Output: paths, module names and the outermost function or method
that a line belongs to. Knows nothing of mutations or of running.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

MODULE_LEVEL = "<module>"
_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom)


@dataclass(frozen=True)
class Project:
    """A source tree and its tests.

    Attributes:
        root: The folder that tests run in.
        source: The folder that holds the packages.
        tests: Test files and folders, relative to the root.
        preload: Modules imported once, before the fork; none of them may import the source.
        paths: Further folders that tests import from.
    """

    root: Path
    source: Path
    tests: tuple[str, ...]
    preload: tuple[str, ...] = ()
    paths: tuple[str, ...] = ()
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

    @cached_property
    def mentions(self) -> dict[str, list[str]]:
        """The functions of the whole source that mention a name: "file:qualified name"."""
        found: dict[str, list[str]] = defaultdict(list)
        for path in sorted(self.source.rglob("*.py")):
            file = self.name(path)
            for function, names in self.index(file).names.items():
                for name in names:
                    found[name].append(f"{file}:{function}")
        return found

    @cached_property
    def _statements(self) -> dict[str, list[tuple[str, ast.stmt]]]:
        """The module-level statements of the whole source that mention a name."""
        found: dict[str, list[tuple[str, ast.stmt]]] = defaultdict(list)
        for path in sorted(self.source.rglob("*.py")):
            file = self.name(path)
            for statement in self.index(file).tree.body:
                if not isinstance(statement, _DEFINITIONS):
                    for name in mentioned(statement):
                        found[name].append((file, statement))
        return found

    def importers(self, function: str) -> set[str]:
        """The functions that depend on a function which runs while a module is imported."""
        name = function.rpartition(".")[2]
        users = set(self.mentions.get(name, ()))
        return users.union(*(self.users(*each) for each in self._statements.get(name, ())))

    def users(self, file: str, statement: ast.stmt) -> set[str]:
        """The functions that a module-level statement is about: "file:qualified name".

        They mention what it defines, or it mentions them, as a table or a registration does. Of a
        class they are its methods, too.
        """
        users = {f"{file}:{name}" for name in mentioned(statement)}
        users.update(key for name in _defined(statement) for key in self.mentions.get(name, []))
        if isinstance(statement, ast.ClassDef):
            start = f"{statement.name}."
            users |= {f"{file}:{n}" for n in self.index(file).functions if n.startswith(start)}
        return users


def _defined(statement: ast.stmt) -> set[str]:
    if isinstance(statement, ast.ClassDef):
        return {statement.name}
    stored = (n for n in ast.walk(statement) if isinstance(n, ast.Name))
    return {n.id for n in stored if isinstance(n.ctx, ast.Store)}


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
