"""What a check says of large smooth unions: their lists for cells, or why they have none.

Input: a tree. Output: a ``SmoothReport`` for each such union, and a tree with one shape of each
kind in place of the members of those that have lists.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from distal.diagnostics import Span, place_json
from distal.scene.lowering.smooth.cells import CellNode, MemberGrid, celled
from distal.scene.tree.node import Node


@dataclass(frozen=True, slots=True)
class SmoothReport:
    """A smooth union of many shapes.

    Attributes:
        count: The number of shapes.
        reason: Why these shapes are in no lists; "" if they are.
        cells: The number of cells.
        longest: The number of shapes in the longest list.
        mean: The mean number of shapes in a list.
        bytes: The size of the lists and of the shapes' numbers.
        place: The author's line.
    """

    count: int
    reason: str
    cells: int
    longest: int
    mean: float
    bytes: int
    place: Span | None

    def as_json(self) -> Mapping[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "count": self.count,
            "reason": self.reason or None,
            "cells": self.cells,
            "longest": self.longest,
            "mean": self.mean,
            "bytes": self.bytes,
            "place": place_json(self.place),
        }


def smooth_unions_of(root: Node) -> tuple[tuple[SmoothReport, ...], Node]:
    """Return the reports on the large smooth unions of a tree, and the tree with fewer shapes."""
    found = celled(root)
    grids = {id(node.grid): node for node in found.grids}
    reports = [_report(node.grid, node.place) for node in grids.values()]
    reports += [
        SmoothReport(count, reason, 0, 0, 0.0, 0, node.place)
        for node, count, reason in found.linear
    ]
    return tuple(reports), root if found.node is root else _with_fewer(found.node)


def _report(grid: MemberGrid, place: Span | None) -> SmoothReport:
    return SmoothReport(grid.count, "", grid.cell_count, grid.longest, grid.mean, grid.bytes, place)


def _with_fewer(node: Node) -> Node:
    """Return a tree in which unions with lists have one shape of each kind, at least two."""
    if not isinstance(node, CellNode):
        children = tuple(map(_with_fewer, node.children))
        same = all(a is b for a, b in zip(children, node.children, strict=True))
        return node if same else replace(node, children=children)
    kinds = node.grid.kinds
    chosen = [kind.members[0] for kind in kinds]
    if len(chosen) == 1:
        chosen.append(kinds[0].members[1])
    return replace(node.source, children=tuple(_with_fewer(m.source) for m in chosen))
