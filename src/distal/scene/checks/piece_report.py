"""What a check says of joined shapes: how they are cut into pieces or bricks, what stays whole.

Input: a tree. Output: a ``PieceReport`` if pictures draw it as pieces; else a ``BrickReport`` for
each subtree of joined shapes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from distal.diagnostics import Span, place_json
from distal.render.pieces import RECORD
from distal.scene.lowering.parts.kinds import paths_to_leaves
from distal.scene.lowering.parts.table import PartTable, ProgramData
from distal.scene.lowering.pieces.brick_table import bricked
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


@dataclass(frozen=True, slots=True)
class BrickReport:
    """Joined shapes in a tree that pictures do not draw as pieces.

    Attributes:
        count: The number of shapes.
        reason: Why they have no bricks, so that each is asked at each point; "" if they have.
        bricks: The number of bricks.
        longest: The number of steps of the longest program.
        mean: The mean number of steps of programs.
        bytes: The size of bricks, programs and numbers of shapes.
        place: The author's line.
    """

    count: int
    reason: str
    bricks: int
    longest: int
    mean: float
    bytes: int
    place: Span | None

    def as_json(self) -> Mapping[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "count": self.count,
            "reason": self.reason or None,
            "bricks": self.bricks,
            "longest": self.longest,
            "mean": self.mean,
            "bytes": self.bytes,
            "place": place_json(self.place),
        }


def bricks_of(root: Node) -> tuple[BrickReport, ...]:
    """Return the reports on joined shapes of a tree that has no pieces."""
    if pieced(root).table is not None:
        return ()
    found = bricked(root, exact=False)
    reports = [_report_of_bricks(node.table, node.place) for node in found.tables]
    reports += [
        BrickReport(w.count, w.reason, 0, 0, 0.0, 0, (w.blamed or w.node).place)
        for w in found.whole
    ]
    return tuple(reports)


def _report_of_bricks(table: PartTable, place: Span | None) -> BrickReport:
    data = table.programs
    assert data is not None and data.bricks is not None
    count, steps, size = math.prod(data.bricks.counts), _steps(data), _bytes(table)
    return BrickReport(
        table.count, "", count, int(steps[:-1].max()), float(steps[:-1].mean()), size, place
    )


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
    assert table is not None and table.programs is not None
    steps, size = _steps(table.programs)[:-1], _bytes(table)
    return PieceReport(len(steps), int(steps.max()), float(steps.mean()), size, whole)


def _steps(data: ProgramData) -> Any:
    """Return the number of steps of each program; the last is that of the whole."""
    count = data.whole - data.first_program + 1
    return np.asarray(data.numbers.data)[1 : RECORD * count : RECORD]


def _bytes(table: PartTable) -> int:
    """Return the size of a table's buffers."""
    data = table.programs
    assert data is not None
    tree = table.boxes if data.bricks is None else data.bricks.programs
    assert tree is not None
    return sum(4 * np.asarray(buffer.data).size for buffer in (tree, table.rows, data.numbers))


def _name(node: Node) -> str:
    """Return the name that the author gave a shape, else that of its first primitive."""
    return node.label or next(paths_to_leaves(node))[-1].name
