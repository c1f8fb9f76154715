"""What a check says of a tree that pictures draw as pieces: how it was cut, and what stays whole.

Input: a tree. Output: a ``PieceReport``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal.diagnostics import Span, place_json
from distal.render.pieces import RECORD
from distal.scene.lowering.parts.kinds import paths_to_leaves
from distal.scene.lowering.pieces.table import Pieced, pieced
from distal.scene.tree.node import Node


@dataclass(frozen=True, slots=True)
class WholeReport:
    """A shape that joins others, and is not taken apart.

    Attributes:
        name: Its name.
        reason: Why.
        place: The author's line.
    """

    name: str
    reason: str
    place: Span | None


@dataclass(frozen=True, slots=True)
class PieceReport:
    """Joined shapes as pieces.

    Attributes:
        count: The number of pieces; 0 if there are none.
        longest: The number of steps of the longest program.
        mean: The mean number of steps.
        bytes: The size of boxes, programs and numbers of shapes.
        whole: The shapes that are not taken apart.
    """

    count: int
    longest: int
    mean: float
    bytes: int
    whole: tuple[WholeReport, ...]

    def as_json(self) -> Mapping[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "count": self.count,
            "longest": self.longest,
            "mean": self.mean,
            "bytes": self.bytes,
            "whole": [
                {"name": w.name, "reason": w.reason, "place": place_json(w.place)}
                for w in self.whole
            ],
        }


def pieces_of(root: Node) -> PieceReport | None:
    """Return the report on the pieces of a tree; None if it needs none."""
    found = pieced(root)
    whole = [WholeReport(_name(w.node), w.reason, w.node.place) for w in found.whole]
    if found.reason:
        blamed = found.blamed or root
        whole.insert(0, WholeReport(_name(blamed), found.reason, blamed.place))
    if found.table is None:
        return PieceReport(0, 0, 0.0, 0, tuple(whole)) if found.reason else None
    return _report(found, tuple(whole))


def _report(found: Pieced, whole: tuple[WholeReport, ...]) -> PieceReport:
    table = found.table
    assert table is not None and table.pieces is not None and table.boxes is not None
    count = table.pieces.whole - table.pieces.first_piece
    steps = np.asarray(table.pieces.numbers.data)[1 : RECORD * count : RECORD]
    arrays = (table.boxes.data, table.rows.data, table.pieces.numbers.data)
    size = sum(4 * np.asarray(a).size for a in arrays)
    return PieceReport(count, int(steps.max()), float(steps.mean()), size, whole)


def _name(node: Node) -> str:
    """Return the name that the author gave a shape, else that of its first primitive."""
    return node.label or next(paths_to_leaves(node))[-1].name
