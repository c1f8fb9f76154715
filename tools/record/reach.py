"""Which recorded tests a change can reach, and why.

Input: a record, a revision. Output: tests by reason. A function has changed if its text has; a
statement of a module stands for the functions that mention what it defines, and for those that it
mentions itself, or else for all functions of the file.
"""

from __future__ import annotations

import ast
import hashlib
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from tools.mutation.project import Project
from tools.record.rows import ROOT, Record

# What is not Python of the package, by its beginning: the tests that read it.
OTHERS: Final[dict[str, tuple[str, ...]]] = {
    "web/": ("tests/page", "tests/editor", "tests/site", "tests/notebook", "tests/lessons"),
    "lessons/": ("tests/lessons",),
    "docs/": ("tests/meta", "tests/names", "tests/errors"),
    "README.md": ("tests/meta",),
    "ARCHITECTURE.md": ("tests/meta",),
    "examples/": ("tests/pictures", "tests/meta", "tests/golden"),
    "tools/": ("tests/meta", "tests/mutation", "tests/record", "tests/site"),
    "pyproject.toml": ("tests/meta", "tests/unit/test_packages.py"),
}


def parts(text: str) -> tuple[dict[str, str], dict[str, ast.stmt]]:
    """Return the text of each function by name, and the other statements of a module by text."""
    functions: dict[str, str] = {}
    others: dict[str, ast.stmt] = {}
    lines = text.splitlines()

    def first(node: ast.stmt) -> int:
        return min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))]) - 1

    def source(node: ast.stmt) -> str:
        return "\n".join(lines[first(node) : node.end_lineno])

    def walk(body: list[ast.stmt], prefix: str) -> None:
        for node in body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                name = prefix + node.name  # overloads of one name are one function
                functions[name] = functions.get(name, "") + source(node)
            elif isinstance(node, ast.ClassDef):
                walk(node.body, f"{prefix}{node.name}.")
                head = lines[first(node) : max(first(node.body[0]), node.lineno)]
                others[prefix + "\n".join(head)] = node
            elif not isinstance(node, ast.Import | ast.ImportFrom) and not _is_docstring(node):
                others[prefix + source(node)] = node

    walk(ast.parse(text).body, "")
    return functions, others


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def digests() -> dict[str, str]:
    """Return a short hash of each function of the source, by "file:qualified name"."""
    source, found = ROOT / "src", {}
    for path in sorted(source.rglob("*.py")):
        file = path.relative_to(source).as_posix()
        for name, text in parts(path.read_text("utf-8"))[0].items():
            found[f"{file}:{name}"] = hashlib.sha256(text.encode()).hexdigest()[:8]
    return found


def tests_for(record: Record, revision: str) -> dict[str, set[str]]:
    """Return the tests that a change since a revision can reach, by the reason.

    Args:
        record: The record.
        revision: A commit; uncommitted changes count.

    Raises:
        SystemExit: There is no such revision.
    """
    files = (
        _git("diff", "--name-only", revision).split()
        + _git("ls-files", "--others", "--exclude-standard").split()
    )
    direct, about = _changed(record, revision, [f for f in files if f.startswith("src/")])
    now = digests()
    stale = {n for n, d in record.digests.items() if now.get(n, "") != d}
    edited = {f for f in files if f.startswith("tests/") and f.endswith(".py")}
    others = [
        t for start, tests in OTHERS.items() for f in files if f.startswith(start) for t in tests
    ]
    return {
        "run a function that has changed": record.running(direct),
        "run a function that a changed statement is about": record.running(about),
        "were recorded before a function changed that they run": record.running(stale),
        "are in a test file that has changed": _in_files(record, edited),
        "read another file that has changed": _in_files(record, others),
    }


def _in_files(record: Record, places: Iterable[str]) -> set[str]:
    """Return the tests in files and folders; a helper's are those of its folder."""
    found: set[str] = set()
    for place in places:
        is_helper = place.endswith(".py") and not Path(place).name.startswith("test_")
        start = str(Path(place).parent) if is_helper else place
        found |= {name for name in record.rows if name.startswith((f"{start}/", f"{start}::"))}
    return found


def _changed(record: Record, revision: str, files: Iterable[str]) -> tuple[set[str], set[str]]:
    """Return the changed functions, and those about which a changed statement is.

    A function that no test runs by itself may run while a module is imported: it stands for the
    functions that depend on that.
    """
    project, run = Project(ROOT, ROOT / "src", ()), set(record.functions)
    direct: set[str] = set()
    about: set[str] = set()
    for path in (file for file in files if file.endswith(".py")):
        old_functions, old_others = parts(_git_text(revision, path))
        now = ROOT / path
        new_functions, new_others = parts(now.read_text("utf-8") if now.exists() else "")
        file = path.removeprefix("src/")
        names = old_functions.keys() | new_functions.keys()
        changed = {n for n in names if old_functions.get(n) != new_functions.get(n)}
        direct |= {f"{file}:{n}" for n in changed}
        for name in changed:
            if f"{file}:{name}" not in run:
                about |= project.importers(name)
        for key in old_others.keys() ^ new_others.keys():
            users = project.users(file, old_others.get(key) or new_others[key]) & run
            about |= users or {name for name in run if name.startswith(f"{file}:")}
    return direct, about


def _git_text(revision: str, path: str) -> str:
    """Return a file of a revision; "" if it had none."""
    return _git("show", f"{revision}:{path}") if _git("ls-tree", revision, path) else ""


def _git(*words: str) -> str:
    made = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    if made.returncode:
        raise SystemExit(f"git {' '.join(words)}: {made.stderr.strip()}")
    return made.stdout
