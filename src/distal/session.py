"""What a process keeps from one compilation to the next: tables, all of them in one place.

Input: the tables of modules, which each hands over when it is imported. Output: ``SESSION``, which
can forget all of them. Two things are kept elsewhere: interned nodes and types, which are compared
by identity in the whole process, and pure memos (``functools.cache``), which are right as long as
those are.
"""

from __future__ import annotations

from typing import Final, Protocol, TypeVar


class Clearable(Protocol):
    """What can be emptied."""

    def clear(self) -> None:
        """Forget everything."""


TableT = TypeVar("TableT", bound=Clearable)


class CompilerSession:
    """The tables of the compiler.

    Threads share them without locks: a table is read and changed in single steps, and whoever does
    not find a row makes one that is as good as another thread's.

    Attributes:
        tables: By name.
    """

    def __init__(self) -> None:
        self.tables: dict[str, Clearable] = {}

    def keep(self, name: str, table: TableT) -> TableT:
        """Own a table, and return it.

        Args:
            name: What is in it.
            table: A new one.
        """
        if self.tables.setdefault(name, table) is not table:
            raise ValueError(f"there is a table '{name}' already")
        return table

    def fresh(self) -> None:
        """Forget everything, as in a new process: for tests and measurements."""
        for table in self.tables.values():
            table.clear()


SESSION: Final = CompilerSession()
