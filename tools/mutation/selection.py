"""Which tests are run for a mutation, and in which order.

Input: a mutation, recorded tests. Output: tests that ran the mutated function, the most
specific first. A test that runs few functions is specific to them; one that runs thousands draws
a whole picture.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable
from functools import cached_property

from tools.mutation.operators import Mutation
from tools.mutation.project import MODULE_LEVEL, Project, mentioned
from tools.mutation.recording import Test


class Selection:
    """Chooses tests by what they ran."""

    def __init__(self, project: Project, tests: list[Test], seconds: float) -> None:
        self.project, self.seconds = project, seconds
        self.recorded = tests

    @cached_property
    def _by_function(self) -> dict[str, list[Test]]:
        found: dict[str, list[Test]] = defaultdict(list)
        for test in sorted(self.recorded, key=_order):
            for function in test.functions:
                found[function].append(test)
        return found

    @cached_property
    def _mentions(self) -> dict[str, list[str]]:
        """The functions of the whole source that mention a name."""
        found: dict[str, list[str]] = defaultdict(list)
        for path in sorted(self.project.source.rglob("*.py")):
            file = self.project.name(path)
            for function, names in self.project.index(file).names.items():
                for name in names:
                    found[name].append(f"{file}:{function}")
        return found

    def tests(self, mutation: Mutation) -> list[Test]:
        """Tests for a mutation, in order, as many as the time allows; at least one, if any is."""
        chosen: list[Test] = []
        left = self.seconds
        for test in self._all(mutation):
            if test.seconds <= left or not chosen:
                chosen.append(test)
                left -= test.seconds
        return chosen

    def _all(self, mutation: Mutation) -> list[Test]:
        if mutation.function == MODULE_LEVEL:
            return self._of(self._users(mutation))
        key = f"{mutation.file}:{mutation.function}"
        # What no test ran may be new, or run when a module is imported: tests of those who name it.
        name = mutation.function.rpartition(".")[2]
        return self._by_function.get(key) or self._of(self._mentions.get(name, []))

    def _of(self, functions: Iterable[str]) -> list[Test]:
        found = {t.id: t for key in functions for t in self._by_function.get(key, [])}
        return sorted(found.values(), key=_order)

    def _users(self, mutation: Mutation) -> set[str]:
        """The functions that a module-level statement is about.

        They mention what it defines, or it mentions them, as a table or a registration does; if
        there are none, all functions of the file.
        """
        index = self.project.index(mutation.file)
        statement = index.statement(mutation.line)
        known = {key for key in self._by_function if key.startswith(f"{mutation.file}:")}
        used = {f"{mutation.file}:{name}" for name in mentioned(statement)}
        defined = _defined(statement)
        users = {key for name in defined for key in self._mentions.get(name, [])}
        if isinstance(statement, ast.ClassDef):
            users |= {key for key in known if key.startswith(f"{mutation.file}:{statement.name}.")}
        return ((users | used) & self._by_function.keys()) or known


def _order(test: Test) -> tuple[float, str]:
    return (0.1 + test.seconds) * (20 + len(test.functions)), test.id


def _defined(statement: ast.stmt) -> set[str]:
    if isinstance(statement, ast.ClassDef):
        return {statement.name}
    stored = (n for n in ast.walk(statement) if isinstance(n, ast.Name))
    return {n.id for n in stored if isinstance(n.ctx, ast.Store)}
