"""The table of pieces of a tree: leaves as rows, boxes with programs.

Input: a tree of solids. Output: the same tree, in which a node with a table takes the place of the
shapes that are joined in other ways than by a union; the tree itself if it can have none. What has
no finite box stays beside the table, as planes do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import UNION
from distal.frontend import Assembly
from distal.ir.nodes import Expr, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor
from distal.render.pieces import JOINS, MODES, RECORD
from distal.scene.lowering.part_functions import ZERO_CELL
from distal.scene.lowering.parts.box_tree import OF_PLACE
from distal.scene.lowering.parts.flatten import UnionMember, members_of
from distal.scene.lowering.parts.kind_boxes import KindBounds, columns_of
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.parts.rows import row_data, rows_of
from distal.scene.lowering.parts.table import (
    LEAST_PARTS,
    MOST_KINDS,
    PARTS,
    RARE,
    THIN,
    PartTable,
    PieceData,
    TableNode,
)
from distal.scene.lowering.pieces.box_order import PieceTree
from distal.scene.lowering.pieces.builder import ENDLESS_SOLID, PieceLimits, build
from distal.scene.lowering.pieces.emission import StepMode
from distal.scene.lowering.pieces.lone_leaves import unites_leaves
from distal.scene.lowering.pieces.operands import Floats, Whole
from distal.scene.lowering.pieces.programs import (
    MANY,
    SMALL_SUBTREE,
    PieceProgram,
    WholeSubtree,
    program_of,
)
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.lowering.union_parts import united
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

MOVING: Final = "it depends on parameters or time"
MANY_JOINS: Final = "it is joined in too many different ways"
MANY_ROWS: Final = "it has too many shapes"
DEEP: Final = "more than three values of joined shapes are needed at once"
EMPTY: Final = "it is empty"
# Limits of the numbers of a step (``render.pieces``).
MOST_JOINS: Final = JOINS
MOST_ROWS: Final = 1 << 21
MOST_ASIDE: Final = 3
LIMITS: Final = PieceLimits(interior=True)
# More distances at once are computed by compiled code.
MOST_INTERPRETED: Final = 200_000


@dataclass(frozen=True, slots=True)
class Pieced:
    """A tree with a table of pieces.

    Attributes:
        node: The tree; the given one if it has no table.
        table: The table, or None.
        whole: The leaves that join shapes and stay whole.
        reason: Why there is no table, if the tree joins many shapes; else "".
        blamed: The shape that prevents it; None if there is no single one.
    """

    node: Node
    table: PartTable | None = None
    whole: Sequence[WholeSubtree] = ()
    reason: str = ""
    blamed: Node | None = None


def pieced(root: Node, *, default_varies: bool = False) -> Pieced:
    """Return a tree with a table of pieces, if it joins many shapes in other ways than by a union.

    Args:
        root: The tree.
        default_varies: Whether the material of leaves without one depends on the place.
    """
    key = f"pieces {default_varies}"
    found: Pieced = root.derived(key, lambda: _pieced(root, default_varies=default_varies))
    return found


def _pieced(root: Node, *, default_varies: bool) -> Pieced:
    if root.flat or root.parts < LEAST_PARTS:
        return Pieced(root)
    members = members_of(root)
    beside = [m.part for m in members if _is_linear(m.part)]
    others = [m.part for m in members if not _is_linear(m.part)]
    most = SMALL_SUBTREE if len(others) >= MANY else 1
    if not any(part.parts > most for part in others):
        return Pieced(root)
    program = program_of(united(root, others), default_varies=default_varies)
    if len(program.leaves) < LEAST_PARTS or unites_leaves(program):
        return Pieced(root)
    table = _table_of(program)
    if isinstance(table, Refusal):
        return Pieced(root, None, program.whole, table.reason, table.blamed)
    children = tuple(kind.node for kind in table.kinds)
    node: Node = TableNode(PARTS, False, place=root.place, children=children, table=table)
    if beside:
        node = Node(UNION, False, (node, *beside), place=root.place)
    return Pieced(node, table, program.whole)


def _is_linear(node: Node) -> bool:
    while node.children and node.rule.linear:
        node = node.children[0]
    return node.rule.linear


class Refusal(NamedTuple):
    """Why a program has no table, and the shape that prevents it, if it is one."""

    reason: str
    blamed: Node | None = None


def _table_of(program: PieceProgram) -> PartTable | Refusal:
    """Return the table of a program, or why it can have none."""
    kinds = sorted(kinds_of(program.leaves), key=lambda kind: -len(kind.members))
    for kind in kinds:
        reason = MOVING if kind.moving else THIN if not kind.node.solid else ""
        if reason:
            return Refusal(reason, kind.members[0].source)
    if len(kinds) > MOST_KINDS:
        return Refusal(RARE)
    if len(program.joins) >= MOST_JOINS:
        return Refusal(MANY_JOINS)
    found = rows_of(kinds)
    if found.refused:
        source = {id(m): m.source for kind in kinds for m in kind.members}
        number, reason = next(iter(found.refused.items()))
        return Refusal(reason, source[number])
    rows, places = row_data(found.kinds, [])
    if len(rows) >= MOST_ROWS:
        return Refusal(MANY_ROWS)
    leaves = _LeafArrays.of(program.leaves, found.kinds, found.swept, places)
    corners = leaves.low, leaves.high
    try:
        tree = build(program, *corners, leaves.slope, leaves.distances, LIMITS, leaves.growth)
    except ValueError:
        return Refusal(ENDLESS_SOLID)
    if tree.programs.depth > MOST_ASIDE:
        return Refusal(DEEP)
    return _packed(tree, leaves, found.kinds, rows) if len(tree.box) else Refusal(EMPTY)


class _LeafArrays:
    """The leaves of a program as arrays, in the order of the program."""

    def __init__(
        self,
        kinds: Sequence[PartKind],
        bounds: Sequence[KindBounds],
        leaf: Whole,
        row: Whole,
    ) -> None:
        """Keep the arrays.

        Args:
            kinds: The kinds of leaves.
            bounds: Their bounds.
            leaf: The leaf of each row, kind by kind.
            row: The number of each row's first vec4.
        """
        count = len(leaf)
        self.low, self.high = np.empty((2, count, 3))
        self.slope, self.divisor, self.growth = np.empty((3, count))
        self.row, self._kind, self._ordinal = np.empty((3, count), np.int64)
        self.low[leaf] = np.concatenate([b.low for b in bounds])
        self.high[leaf] = np.concatenate([b.high for b in bounds])
        for name in ("slope", "divisor", "growth"):
            getattr(self, name)[leaf] = np.concatenate([getattr(b, name) for b in bounds])
        self.row[leaf] = row
        sizes = [len(kind.members) for kind in kinds]
        self._kind[leaf] = np.repeat(np.arange(len(kinds)), sizes)
        self._ordinal[leaf] = np.concatenate([np.arange(size) for size in sizes])
        self._functions = [LeafDistance(kind) for kind in kinds]
        self._columns = [columns_of(kind) for kind in kinds]

    @staticmethod
    def of(
        members: Sequence[UnionMember],
        kinds: Sequence[PartKind],
        bounds: Sequence[KindBounds],
        row: Whole,
    ) -> _LeafArrays:
        """Return the arrays of leaves."""
        number = {id(member): i for i, member in enumerate(members)}
        leaf = np.array([number[id(member)] for kind in kinds for member in kind.members])
        return _LeafArrays(kinds, bounds, leaf, row)

    def distances(self, points: Floats, leaves: Whole) -> Floats:
        """Return the values of points (n, 3) in the fields of leaves (n,)."""
        found = np.empty(len(points))
        kinds = self._kind[leaves]
        for k, function in enumerate(self._functions):
            chosen = np.flatnonzero(kinds == k)
            if not len(chosen):
                continue
            ordinal = self._ordinal[leaves[chosen]]
            columns = [points[chosen], *(column[ordinal] for column in self._columns[k])]
            if len(chosen) < MOST_INTERPRETED:
                value = executor().call(function, tuple(columns), {}, device="reference")
            else:
                value = executor().evaluate(
                    function, [np.asarray(c, np.float32) for c in columns], {}, 0.0
                )
            found[chosen] = value
        return found


class LeafDistance(Composed):
    """The distance of a point to a leaf of a kind, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"distance to {kind.node.name}"
        self._kind = kind
        columns = ((f"column_{i}", c.type) for i, c in enumerate(kind.columns))
        self.signature = (("p", VEC3), *columns)
        self.result: Type = FLOAT

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        reads: list[Expr] = [Read(name, type) for name, type in self.signature]
        self._kind.read(assembly, reads[1:])
        node = self._kind.node
        composer = ShapeComposer(assembly, [node])
        body = StatementList(taken={name for name, _ in self.signature})
        values = composer.values.all(node)
        body.statements.append(Return(composer.distance(body, node, reads[0], ZERO_CELL, values)))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("leaf_distance", params, FLOAT, body.statements)


def _packed(
    tree: PieceTree, leaves: _LeafArrays, kinds: Sequence[PartKind], rows: Floats
) -> PartTable:
    """Return a table in the form that ``render.part_tree`` and ``render.pieces`` read."""
    steps, first_piece = tree.programs.steps.astype(np.int64), len(rows)
    row = np.where(steps[:, 1] >= 0, leaves.row[steps[:, 1]], -1)
    # A change has a row only if it names the leaf that is shown; 0 is none.
    row = np.where(steps[:, 0] == StepMode.ONE, row + 1, row)
    code = row * (MODES * JOINS) + np.maximum(steps[:, 2], 0) * MODES + steps[:, 0]
    program = np.append(tree.program, tree.whole)
    start, count = tree.programs.start[program], tree.programs.count[program]
    box = np.append(np.where(tree.is_cut, tree.box, -1), -1)
    records = np.stack([RECORD * len(program) + start, count, box], axis=1)
    numbers = np.concatenate([records.reshape(-1), code]).astype(np.int32)
    # A leaf alone, and whole, is a part by itself.
    is_lone = (count[:-1] == 1) & ~tree.is_cut
    part = np.where(is_lone, row[start[:-1]], first_piece + np.arange(len(tree.box)))
    data = PieceData(Buffer(numbers), tree.joins, first_piece, first_piece + len(tree.box))
    low, high = (tuple(map(float, corners[0])) for corners in (tree.low, tree.high))
    slope, divisor = float(leaves.slope.max()), float(leaves.divisor.max())
    boxes = Buffer(_boxes_of(tree, part))
    return PartTable(kinds, boxes, Buffer(rows), low, high, slope, divisor, data)


def _boxes_of(tree: PieceTree, part: Whole) -> NDArray[np.float32]:
    """Return the tree of boxes, as ``BoxTree.filled``; ``part`` is that of each piece."""
    margin = OF_PLACE * np.maximum(np.abs(tree.low), np.abs(tree.high))
    boxes = np.empty((len(tree.skip), 8), np.float32)
    boxes[:, :3], boxes[:, 4:7] = tree.low - margin, tree.high + margin
    boxes[:, 3] = tree.skip
    boxes[tree.box, 7] = part
    inner = np.flatnonzero(tree.axis >= 0)
    around = np.zeros(len(tree.skip), np.int64)
    around[inner + 1] = inner
    around[tree.skip[inner + 1]] = inner
    boxes[inner, 7] = -1 - (tree.axis[inner] + 4 * around[inner])
    return boxes.reshape(-1, 4)
