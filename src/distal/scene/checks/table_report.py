"""What a check says of the table of a union's parts: its kinds, and what is beside it, and why.

Input: a tree. Output: a ``TableReport``, and a tree with one part of each kind, which stands for
all of them in the other checks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from distal.diagnostics import Span, place_json
from distal.fields.combine.joins import UNION
from distal.scene.lowering.parts.kinds import paths_to_leaves
from distal.scene.lowering.parts.table import rolled
from distal.scene.tree.node import Node


@dataclass(frozen=True, slots=True)
class KindReport:
    """A kind of parts.

    Attributes:
        name: The name of the first part.
        count: How many parts there are.
        columns: How many floats differ from part to part.
        place: The author's line of the first part.
    """

    name: str
    count: int
    columns: int
    place: Span | None


@dataclass(frozen=True, slots=True)
class BesideReport:
    """A part that is not in the table.

    Attributes:
        name: Its name.
        reason: Why it is not.
        place: The author's line.
    """

    name: str
    reason: str
    place: Span | None


@dataclass(frozen=True, slots=True)
class TableReport:
    """A table of parts, which are drawn through a tree of boxes."""

    kinds: tuple[KindReport, ...]
    beside: tuple[BesideReport, ...]

    @property
    def count(self) -> int:
        """The number of parts in the table."""
        return sum(kind.count for kind in self.kinds)

    def as_json(self) -> dict[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "parts": self.count,
            "kinds": [
                {
                    "name": k.name,
                    "count": k.count,
                    "columns": k.columns,
                    "place": place_json(k.place),
                }
                for k in self.kinds
            ],
            "beside": [
                {"name": b.name, "reason": b.reason, "place": place_json(b.place)}
                for b in self.beside
            ],
        }


def _name(node: Node) -> str:
    """Return the name that the author gave a part, else that of its first primitive."""
    return node.label or next(paths_to_leaves(node))[-1].name


def table_of(root: Node) -> tuple[TableReport | None, Node]:
    """Return the report on the table of a tree, and the tree with one part of each kind.

    Returns:
        None and the tree itself if it has no table.
    """
    found = rolled(root)
    if found.table is None:
        return None, root
    kinds = tuple(
        KindReport(_name(first), len(kind.members), kind.floats, first.place)
        for kind in found.table.kinds
        for first in (kind.members[0].source,)
    )
    beside = tuple(BesideReport(_name(m.source), why, m.source.place) for m, why in found.beside)
    chosen = [kind.members[0] for kind in found.table.kinds] + [m for m, _ in found.beside]
    tree = chosen[0].part
    if len(chosen) > 1:
        tree = Node(UNION, root.flat, tuple(m.part for m in chosen), place=root.place)
    return TableReport(kinds, beside), tree
