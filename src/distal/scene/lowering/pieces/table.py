"""The table of pieces of a tree: leaves as rows, boxes with programs.

Input: a tree of solids. Output: the same tree, in which a node with a table takes the place of the
shapes that are joined in other ways than by a union; the tree itself if it can have none. What has
no finite box stays beside the table, as planes do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from distal.fields.combine.joins import UNION
from distal.frontend import Assembly
from distal.ir.nodes import Expr, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor
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
    PartTable,
    PieceData,
    TableNode,
)
from distal.scene.lowering.pieces.box_order import PieceTree
from distal.scene.lowering.pieces.builder import PieceLimits, build
from distal.scene.lowering.pieces.emission import StepMode
from distal.scene.lowering.pieces.lone_leaves import unites_leaves
from distal.scene.lowering.pieces.operands import Floats, Whole
from distal.scene.lowering.pieces.programs import MANY, SMALL_SUBTREE, PieceProgram, program_of
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.lowering.union_parts import united
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# Limits of the numbers of a step (``render.pieces``).
MOST_JOINS: Final = 127
MOST_ROWS: Final = 1 << 21
MOST_ASIDE: Final = 3
LIMITS: Final = PieceLimits(interior=True)
# More distances at once are computed by compiled code.
MOST_INTERPRETED: Final = 200_000


def pieced(root: Node, *, default_varies: bool) -> Node:
    """Return a tree with a table of pieces; the tree itself if it can have none.

    Args:
        root: The tree.
        default_varies: Whether the material of leaves without one depends on the place.
    """
    key = f"pieces {default_varies}"
    found: Node = root.derived(key, lambda: _pieced(root, default_varies=default_varies))
    return found


def _pieced(root: Node, *, default_varies: bool) -> Node:
    if root.flat or root.parts < LEAST_PARTS:
        return root
    members = members_of(root)
    beside = [m for m in members if _is_linear(m.part)]
    others = [m for m in members if not _is_linear(m.part)]
    most = SMALL_SUBTREE if len(others) >= MANY else 1
    if not any(m.part.parts > most for m in others):
        return root
    node = united(root, [m.part for m in others])
    program = program_of(node, default_varies=default_varies)
    if len(program.leaves) < LEAST_PARTS or unites_leaves(program):
        return root
    table = _table_of(program)
    if table is None:
        return root
    children = tuple(kind.node for kind in table.kinds)
    made = TableNode(PARTS, False, place=root.place, children=children, table=table)
    if not beside:
        return made
    return Node(UNION, False, (made, *(m.part for m in beside)), place=root.place)


def _is_linear(node: Node) -> bool:
    while node.children and node.rule.linear:
        node = node.children[0]
    return node.rule.linear


def _table_of(program: PieceProgram) -> PartTable | None:
    """Return the table of a program; None if it can have none."""
    kinds = sorted(kinds_of(program.leaves), key=lambda kind: -len(kind.members))
    solid = all(kind.node.solid and not kind.moving for kind in kinds)
    if not solid or len(kinds) > MOST_KINDS or len(program.joins) >= MOST_JOINS:
        return None
    found = rows_of(kinds)
    if found.refused:
        return None
    rows, places = row_data(found.kinds, [])
    if len(rows) >= MOST_ROWS:
        return None
    leaves = _LeafArrays.of(program.leaves, found.kinds, found.swept, places)
    try:
        tree = build(program, leaves.low, leaves.high, leaves.slope, leaves.distances, LIMITS)
    except ValueError:
        return None
    if tree.programs.depth > MOST_ASIDE or not len(tree.box):
        return None
    return _packed(tree, leaves, found.kinds, rows)


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
        self.slope, self.divisor = np.empty((2, count))
        self.row, self._kind, self._ordinal = np.empty((3, count), np.int64)
        self.low[leaf] = np.concatenate([b.low for b in bounds])
        self.high[leaf] = np.concatenate([b.high for b in bounds])
        self.slope[leaf] = np.concatenate([b.slope for b in bounds])
        self.divisor[leaf] = np.concatenate([b.divisor for b in bounds])
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
    first_piece = len(rows)
    steps = tree.programs.steps.astype(np.int64)
    own = np.where(steps[:, 1] >= 0, leaves.row[steps[:, 1]], 0)
    is_one = steps[:, 0] == StepMode.ONE
    own = np.where(is_one, np.where(steps[:, 1] >= 0, own + 1, 0), own)
    code = (own << 10) | (np.maximum(steps[:, 2], 0) << 3) | steps[:, 0]
    count = len(tree.box) + 1
    program = np.append(tree.program, tree.whole)
    records = np.stack(
        [
            3 * count + tree.programs.start[program],
            tree.programs.count[program],
            np.append(np.where(tree.is_cut, tree.box, -1), -1),
        ],
        axis=1,
    )
    numbers = np.concatenate([records.reshape(-1), code]).astype(np.int32)
    # A leaf alone, and whole, is a part by itself.
    first = tree.programs.start[tree.program]
    lone = (tree.programs.count[tree.program] == 1) & ~tree.is_cut
    part = np.where(lone, own[first], first_piece + np.arange(len(tree.box)))
    boxes = np.empty((len(tree.skip), 8), np.float32)
    margin = OF_PLACE * np.maximum(np.abs(tree.low), np.abs(tree.high))
    boxes[:, :3], boxes[:, 4:7] = tree.low - margin, tree.high + margin
    boxes[:, 3] = tree.skip
    boxes[tree.box, 7] = part
    inner = np.flatnonzero(tree.axis >= 0)
    around = np.zeros(len(tree.skip), np.int64)
    around[inner + 1] = inner
    around[tree.skip[inner + 1]] = inner
    boxes[inner, 7] = -1 - (tree.axis[inner] + 4 * around[inner])
    low, high = (tuple(map(float, c[0])) for c in (tree.low, tree.high))
    data = PieceData(Buffer(numbers), tree.joins, first_piece, first_piece + count - 1)
    return PartTable(
        kinds,
        Buffer(boxes.reshape(-1, 4)),
        Buffer(rows),
        low,
        high,
        float(leaves.slope.max()),
        float(leaves.divisor.max()),
        data,
    )
