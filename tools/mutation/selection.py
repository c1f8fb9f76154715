"""Which tests are run for a mutation, and in which order.

Input: a mutation, the record of the tests. Output: tests that ran the mutated function, the most
specific first. A test that runs few functions is specific to them; one that runs thousands draws
a whole picture.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from tools.mutation.operators import Mutation
from tools.mutation.project import MODULE_LEVEL, Project
from tools.record.rows import Record, Row


class Selection:
    """Chooses tests by what they ran.

    Args:
        project: What is mutated.
        record: Its tests.
        places: Beginnings of the names of those that may run.
        seconds: Of tests for a mutation.
    """

    def __init__(
        self, project: Project, record: Record, places: tuple[str, ...], seconds: float
    ) -> None:
        self.project, self.record, self.seconds = project, record, seconds
        rows = ((name, row) for name, row in record.rows.items() if name.startswith(places))
        self._rows = sorted(rows, key=_order)
        self._known = frozenset(record.functions)

    def tests(
        self, mutation: Mutation, may_run: Callable[[str], bool] = lambda name: True
    ) -> dict[str, float]:
        """Tests for a mutation, in order, as many as the time allows; at least one, if any is.

        Args:
            mutation: The mutation.
            may_run: Whether a test may be among them.
        """
        chosen: dict[str, float] = {}
        left = self.seconds
        for name, row in self.all(mutation):
            if may_run(name) and (row.seconds <= left or not chosen):
                chosen[name] = row.seconds
                left -= row.seconds
        return chosen

    def all(self, mutation: Mutation) -> list[tuple[str, Row]]:
        """All tests for a mutation, in order."""
        if mutation.function == MODULE_LEVEL:
            return self._of(self._about(mutation))
        # What no test ran may be new, or run when a module is imported.
        found = self._of([f"{mutation.file}:{mutation.function}"])
        return found or self._of(self.project.importers(mutation.function))

    def _about(self, mutation: Mutation) -> set[str]:
        """The recorded functions that a module-level statement is about, or all of the file."""
        statement = self.project.index(mutation.file).statement(mutation.line)
        users = self.project.users(mutation.file, statement) & self._known
        start = f"{mutation.file}:"
        return users or {name for name in self._known if name.startswith(start)}

    def _of(self, functions: Iterable[str]) -> list[tuple[str, Row]]:
        mask = self.record.mask(functions)
        return [(name, row) for name, row in self._rows if row.functions & mask]


def _order(test: tuple[str, Row]) -> tuple[float, str]:
    name, row = test
    return (0.1 + row.seconds) * (20 + row.functions.bit_count()), name
