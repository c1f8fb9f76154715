"""Print the report of ``distal doctor``.

Input: facts about the machine. Output: a table on stdout.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from distal.cli.base import answer
from distal.cli.doctor import MachineFact, State

_MARKS: Final = {
    State.READY: Text("ok", "green"),
    State.OPTIONAL: Text("--", "yellow"),
    State.BROKEN: Text("!!", "red"),
}


def show(facts: Iterable[MachineFact]) -> None:
    """Print one table: a heading for each area, and a remedy below each missing thing."""
    table = Table(box=None, show_header=False, pad_edge=False)
    for _ in range(3):
        table.add_column(overflow="fold")
    for area, rows in groupby(facts, key=lambda fact: fact.area):
        table.add_row("", Text(area, "bold"), "")
        for row in rows:
            # Text, not markup: the brackets of "distal[gpu]" must not be read as a style.
            table.add_row(_MARKS[row.state], Text(row.subject), Text(row.detail))
            if row.remedy:
                table.add_row("", "", Text(f"fix: {row.remedy}", "cyan"))
    console = Console()
    with console.capture() as text:
        console.print(table)
    answer(text.get().rstrip("\n"))
