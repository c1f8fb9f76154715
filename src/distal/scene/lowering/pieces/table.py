"""The tables of a tree's programs: leaves as rows; pieces with boxes, or bricks.

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
from distal.render.pieces import JOIN_AT, JOIN_MASK, RECORD, ROW_AT
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
    ProgramData,
    TableNode,
)
from distal.scene.lowering.pieces.box_order import PieceTree
from distal.scene.lowering.pieces.builder import PieceLimits, build
from distal.scene.lowering.pieces.cell_programs import ENDLESS_SOLID
from distal.scene.lowering.pieces.emission import EmittedPrograms, StepMode
from distal.scene.lowering.pieces.joins import JoinCode
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

MOVED: Final = "it moves joined shapes by parameters or time"
FAR: Final = "shapes move so far that boxes that have them at all times overlap"
MANY_JOINS: Final = "it is joined in too many different ways"
MANY_ROWS: Final = "it has too many shapes"
DEEP: Final = "more than three values of joined shapes are needed at once"
EMPTY: Final = "it is empty"
DENSE: Final = "boxes have most of its shapes: they overlap, or their blends are wide"
# Limits of the numbers of a step (``render.pieces``).
MOST_JOINS: Final = JOIN_MASK + 1
MOST_ROWS: Final = 1 << 21
MOST_ASIDE: Final = 3
LIMITS: Final = PieceLimits(interior=True)
# Fewer shapes without blends are drawn faster as they are.
LEAST_HARD: Final = 32
# More distances at once are computed by compiled code.
MOST_INTERPRETED: Final = 200_000
# Where programs have more of the whole's steps than this, on average, the tree itself is faster.
LARGEST_SHARE: Final = 0.6
# In how many boxes of shapes that move a point may be, on average.
MOST_MOVING: Final = 3.0


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
    found = joined_shapes(root)
    if found is None:
        return Pieced(root)
    program = program_of(found.node, default_varies=default_varies)
    blends = any(not join.is_hard for join in program.joins)
    least = LEAST_PARTS if blends else LEAST_HARD
    if len(program.leaves) < least or not is_worth_programs(program):
        return Pieced(root)
    table = _table_of(program)
    if isinstance(table, Refusal):
        return Pieced(root, None, program.whole, table.reason, table.blamed)
    children = tuple(kind.node for kind in table.kinds)
    node: Node = TableNode(PARTS, False, place=root.place, children=children, table=table)
    return Pieced(found.with_shapes(node), table, program.whole)


@dataclass(frozen=True, slots=True)
class JoinedShapes:
    """The shapes of a tree that may have programs, and the members of its union that have none.

    Attributes:
        node: The tree without those members.
        beside: They: shapes without end, such as planes.
    """

    node: Node
    beside: Sequence[Node]

    def with_shapes(self, node: Node) -> Node:
        """Return the tree with another node in place of the shapes."""
        if not self.beside:
            return node
        return Node(UNION, False, (node, *self.beside), place=self.node.place)


def joined_shapes(root: Node) -> JoinedShapes | None:
    """Return the shapes of a tree that may have programs; None if they are few, or only united."""
    if root.flat or root.parts < LEAST_PARTS:
        return None
    members = members_of(root)
    beside = [m.part for m in members if _is_linear(m.part)]
    others = [m.part for m in members if not _is_linear(m.part)]
    most = SMALL_SUBTREE if len(others) >= MANY else 1
    if not any(part.parts > most for part in others):
        return None
    return JoinedShapes(united(root, others), beside)


def is_worth_programs(program: PieceProgram) -> bool:
    """Return whether a program joins many leaves, in other ways than by a union."""
    only_united = all(j.code is JoinCode.UNION and j.is_hard for j in program.joins)
    return len(program.leaves) >= LEAST_PARTS and not only_united


def _is_linear(node: Node) -> bool:
    while node.children and node.rule.linear:
        node = node.children[0]
    return node.rule.linear


class Refusal(NamedTuple):
    """Why a program has no table, and the shape that prevents it, if it is one."""

    reason: str
    blamed: Node | None = None


def _table_of(program: PieceProgram) -> PartTable | Refusal:
    """Return the table of pieces of a program, or why it can have none."""
    leaves = leaves_of(program)
    if isinstance(leaves, Refusal):
        return leaves
    try:
        tree = build(
            program, leaves.low, leaves.high, leaves.slope, leaves.distances, LIMITS, leaves.growth
        )
    except ValueError:
        return Refusal(ENDLESS_SOLID)
    if tree.programs.depth > MOST_ASIDE:
        return Refusal(DEEP)
    if not len(tree.box):
        return Refusal(EMPTY)
    return Refusal(DENSE) if tree.share > LARGEST_SHARE else _packed(tree, leaves)


def leaves_of(program: PieceProgram) -> LeafArrays | Refusal:
    """Return the leaves of a program as rows, or why they can be none."""
    if program.mover is not None:
        return Refusal(MOVED, program.mover)
    kinds = sorted(kinds_of(program.leaves), key=lambda kind: -len(kind.members))
    for kind in kinds:
        if not kind.node.solid:
            return Refusal(THIN, kind.members[0].source)
    if len(kinds) > MOST_KINDS:
        return Refusal(RARE)
    if len(program.joins) >= MOST_JOINS:
        return Refusal(MANY_JOINS)
    found = rows_of(kinds)
    if found.refused:
        source = {id(m): m.source for kind in kinds for m in kind.members}
        number, reason = next(iter(found.refused.items()))
        return Refusal(reason, source[number])
    leaves = LeafArrays(program.leaves, found.kinds, found.swept)
    if len(leaves.rows) >= MOST_ROWS:
        return Refusal(MANY_ROWS)
    return Refusal(FAR) if leaves.moving_boxes() > MOST_MOVING else leaves


class LeafArrays:
    """The leaves of a program as arrays, in the order of the program.

    What bounds leaves that move holds at all times and for all values of the parameters.

    Attributes:
        kinds: Their kinds.
        rows: The numbers of all leaves, as vec4.
        low: The low corners of their boxes (n, 3).
        high: The high corners.
        slope: Lipschitz bound (slope) of each (n,).
        divisor: The number that makes distances of its values.
        growth: The growth of the sides of its box.
        row: The number of its first vec4.
    """

    def __init__(
        self,
        members: Sequence[UnionMember],
        kinds: Sequence[PartKind],
        bounds: Sequence[KindBounds],
    ) -> None:
        number = {id(member): i for i, member in enumerate(members)}
        leaf = np.array([number[id(member)] for kind in kinds for member in kind.members])
        count = len(leaf)
        self.kinds = kinds
        self.rows, places = row_data(kinds, [])
        self.low, self.high = np.empty((2, count, 3))
        self.slope, self.divisor, self.growth = np.empty((3, count))
        self.row, self._kind, self._ordinal = np.empty((3, count), np.int64)
        self.low[leaf] = np.concatenate([b.low for b in bounds])
        self.high[leaf] = np.concatenate([b.high for b in bounds])
        for name in ("slope", "divisor", "growth"):
            getattr(self, name)[leaf] = np.concatenate([getattr(b, name) for b in bounds])
        self.row[leaf] = places
        sizes = [len(kind.members) for kind in kinds]
        self._kind[leaf] = np.repeat(np.arange(len(kinds)), sizes)
        self._ordinal[leaf] = np.concatenate([np.arange(size) for size in sizes])
        self._functions = [LeafDistance(kind) for kind in kinds]
        self._columns = [columns_of(kind) for kind in kinds]

    def moving_boxes(self) -> float:
        """Return the number of boxes of moving leaves that a point is in, on average."""
        moves = np.array([kind.moving for kind in self.kinds])[self._kind]
        if not moves.any():
            return 0.0
        each = (self.high[moves] - self.low[moves]).prod(axis=1).sum()
        around = (self.high.max(axis=0) - self.low.min(axis=0)).prod()
        return float(each / (around or 1.0))

    def distances(self, points: Floats, leaves: Whole) -> tuple[Floats, Floats]:
        """Return the least and the largest values of points (n, 3) in the fields of leaves (n,)."""
        least, largest = np.empty((2, len(points)))
        kinds = self._kind[leaves]
        for k, function in enumerate(self._functions):
            chosen = np.flatnonzero(kinds == k)
            if not len(chosen):
                continue
            ordinal = self._ordinal[leaves[chosen]]
            columns = [points[chosen], *(column[ordinal] for column in self._columns[k])]
            if self.kinds[k].moving:
                ((low, high),) = executor().sweep(function, columns)
                low = np.maximum(low, self._outside(points[chosen], leaves[chosen]))
            else:
                low = high = _values(function, columns)
            least[chosen], largest[chosen] = low, high
        return least, largest

    def _outside(self, points: Floats, leaves: Whole) -> Floats:
        """Return how large values are at least because points are outside of boxes."""
        beyond = np.maximum(self.low[leaves] - points, points - self.high[leaves]).max(axis=1)
        growth = np.maximum(self.growth[leaves], 1.0)
        found: Floats = np.where(beyond > 0.0, beyond / growth, -np.inf)
        return found


def _values(function: LeafDistance, columns: Sequence[Floats]) -> Floats:
    """Return the results of a function, one for each row of its arguments."""
    if len(columns[0]) < MOST_INTERPRETED:
        values = executor().call(function, tuple(columns), {}, device="reference")
    else:
        rows = [np.asarray(column, np.float32) for column in columns]
        values = executor().evaluate(function, rows, {}, 0.0)
    return np.asarray(values, np.float64)


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


def _packed(tree: PieceTree, leaves: LeafArrays) -> PartTable:
    """Return a table in the form that ``render.part_tree`` and ``render.pieces`` read."""
    programs, first_piece = tree.programs, len(leaves.rows)
    program = np.append(tree.program, tree.whole)
    box = np.append(np.where(tree.is_cut, tree.box, -1), -1)
    numbers = records(programs, program, box, leaves)
    # A leaf alone, and whole, is a part by itself.
    start, count = programs.start[tree.program], programs.count[tree.program]
    row = leaves.row[programs.steps[start, 1]]
    is_lone = (count == 1) & ~tree.is_cut
    part = np.where(is_lone, row, first_piece + np.arange(len(tree.box)))
    data = ProgramData(
        numbers, tree.joins, first_piece, first_piece + len(tree.box), programs.has_others
    )
    low, high = (tuple(map(float, corners[0])) for corners in (tree.low, tree.high))
    slope, divisor = float(leaves.slope.max()), float(leaves.divisor.max())
    boxes = Buffer(_boxes_of(tree, part))
    return PartTable(leaves.kinds, boxes, Buffer(leaves.rows), low, high, slope, divisor, data)


def records(programs: EmittedPrograms, program: Whole, box: Whole, leaves: LeafArrays) -> Buffer:
    """Return programs and their steps in the form that ``render.pieces`` reads.

    Args:
        programs: The programs.
        program: The program of each record.
        box: The box that cuts each; -1 for none.
        leaves: The leaves.
    """
    steps = programs.steps.astype(np.int64)
    row = np.where(steps[:, 1] >= 0, leaves.row[steps[:, 1]], -1)
    # A change has a row only if it names the leaf that is shown; 0 is none.
    row = np.where(steps[:, 0] == StepMode.ONE, row + 1, row)
    code = (row << ROW_AT) + (np.maximum(steps[:, 2], 0) << JOIN_AT) + steps[:, 0]
    start, count = programs.start[program], programs.count[program]
    found = np.stack([RECORD * len(program) + start, count, box], axis=1)
    return Buffer(np.concatenate([found.reshape(-1), code]).astype(np.int32))


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
