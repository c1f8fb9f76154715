"""The table of a union's parts: kinds, rows of numbers, a tree of boxes.

Input: a tree of shapes. Output: the same tree, in which a node with a table takes the place of many
members of the union at its root; and what stays beside the table, with the reason. A part with an
infinite box, or one that moves, stays a member of the union.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.fields.combine.joins import UNION
from distal.fields.guarantees import EXACT_OUTSIDE, Operator
from distal.frontend import Assembly
from distal.lang.lazy_module import LazyModule
from distal.lang.resources import Buffer
from distal.scene.lowering.parts.flatten import UnionMember, member_count, members_of
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.safe_parts import SafeParts
from distal.scene.lowering.union_parts import parts_of
from distal.scene.tree.node import Node

if TYPE_CHECKING:
    from distal.scene.lowering.parts import rows
    from distal.scene.lowering.pieces import brick_table as bricks
    from distal.scene.lowering.pieces import table as pieces
    from distal.scene.lowering.pieces.joins import ValueJoin
else:
    bricks = LazyModule("distal.scene.lowering.pieces.brick_table")
    pieces = LazyModule("distal.scene.lowering.pieces.table")
    rows = LazyModule("distal.scene.lowering.parts.rows")  # needs NumPy

# Fewer parts are not worth a table; more kinds would be too much code.
LEAST_PARTS: Final = 16
MOST_KINDS: Final = 64
# The most parts of a program without a table: with more, compilation takes minutes.
MOST_WITHOUT: Final = 2048

INFINITE: Final = "it has no finite box"
ENDLESS_MOTION: Final = "no finite box holds it at all times and for all values of its parameters"
ENDLESS_SLOPE: Final = (
    "no divisor of its values is known for all times and values of its parameters"
)
RARE: Final = f"there are more than {MOST_KINDS} kinds of parts"
THIN: Final = "it has no inside or is an estimate: it is as thick as a part of a pixel"

_TABLE: Final = "table"  # the name under which a tree keeps its ``Rolled``
# The rule of a node that stands for all parts of a table; its children are one tree of each kind.
PARTS: Final = Operator("parts", keeps=EXACT_OUTSIDE)


@dataclass(frozen=True, slots=True)
class BrickData:
    """Which program has the values of a tree where, in the form that ``render.bricks`` reads.

    Attributes:
        programs: The program of each brick, a buffer of whole numbers.
        counts: How many bricks lie along each axis.
        low: The low corner of all bricks.
        high: The high corner.
        growth: The growth of the sides of the box around the tree (``fields.guarantees``).
        share: The number of steps in a brick, on average, for each of the program of the whole.
        exact: Whether values outside of the bricks are those of the tree, not only bounds.
    """

    programs: Buffer
    counts: tuple[int, int, int]
    low: tuple[float, ...]
    high: tuple[float, ...]
    growth: float
    share: float
    exact: bool = False

    @property
    def per_unit(self) -> tuple[float, ...]:
        """Bricks for each unit of length along each axis."""
        sides = zip(self.counts, self.low, self.high, strict=True)
        return tuple(count / (b - a) for count, a, b in sides)


@dataclass(frozen=True, slots=True)
class ProgramData:
    """The programs of a table, in the form that ``render.pieces`` reads.

    Attributes:
        numbers: The programs and their steps, a buffer of whole numbers.
        joins: How steps join values.
        first_program: The number of the first program as a part; lower ones are rows of leaves.
        whole: That of the program of the whole tree.
        some_others: Whether some steps do something else than to join a leaf.
        bricks: Which program has the values where; None for pieces, which have boxes.
    """

    numbers: Buffer
    joins: Sequence[ValueJoin]
    first_program: int
    whole: int
    some_others: bool
    bricks: BrickData | None = None


@dataclass(frozen=True, slots=True)
class PartTable:
    """The parts of a union.

    Attributes:
        kinds: The kinds of parts.
        boxes: The tree of boxes, a buffer of vec4 (``render.part_tree``); None for bricks.
        rows: The numbers of the parts, a buffer of vec4.
        low: The low corner of the box around all parts.
        high: The high corner.
        slope: Lipschitz bound (slope) of all parts.
        divisor: The largest number that a part's values are divided by to make distances.
        programs: The programs, if parts are pieces or bricks of a tree; None if they are leaves.
    """

    kinds: Sequence[PartKind]
    boxes: Buffer | None
    rows: Buffer
    low: tuple[float, ...]
    high: tuple[float, ...]
    slope: float
    divisor: float
    programs: ProgramData | None = None

    @property
    def needs_factors(self) -> bool:
        """Whether values of some parts are not distances before they get their factors."""
        if self.programs is not None:
            return self.divisor > 1.0
        return any(kind.factor is not None for kind in self.kinds)

    @property
    def moves(self) -> bool:
        """Whether some parts depend on parameters or time."""
        return any(kind.moving for kind in self.kinds)

    @property
    def count(self) -> int:
        """The number of parts."""
        return sum(len(kind.members) for kind in self.kinds)


@dataclass(frozen=True, slots=True, eq=False)
class RowsNode(Node):
    """A node that stands for shapes whose numbers are rows of a table."""

    table: PartTable = None  # type: ignore[assignment]  # always given; the base class has defaults

    @property
    def has_rows(self) -> bool:
        """Whether the numbers of its children are rows of a table."""
        return True


class TableNode(RowsNode):
    """A node that stands for all parts of a table, which rays meet one by one."""

    __slots__ = ()


class BrickNode(RowsNode):
    """A node that stands for joined shapes: a point asks those that matter in its brick."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Rolled:
    """A tree with a table.

    Attributes:
        node: The tree; the given one if it has no table.
        table: The table, or None.
        beside: The members of the union that are not in the table, and why, in the author's order.
    """

    node: Node
    table: PartTable | None
    beside: Sequence[tuple[UnionMember, str]]


def rolled(root: Node) -> Rolled:
    """Return a tree with a table of the parts that its root unites, if there are many."""
    return root.derived(_TABLE, lambda: _rolled(root))


def keep_table(root: Node, changed: Node) -> None:
    """Let a tree in which parts beside the table have other materials use the same table.

    Args:
        root: A tree. If it has no table yet, nothing is kept.
        changed: The tree with other nodes in place of some parts.
    """
    found: Rolled | None = root.known(_TABLE)
    if found is None or found.table is None or any(r is RARE for _, r in found.beside):
        return
    pairs = zip(parts_of(root), parts_of(changed), strict=True)
    others = {id(old): new for old, new in pairs if old is not new}
    beside = []
    for member, reason in found.beside:
        new = others.pop(id(member.source), None)
        if new is not None and (member.part is not member.source or member.repetition is not None):
            return
        beside.append((member if new is None else UnionMember(new, new), reason))
    if others:
        return  # a part in the table has changed
    table, _ = split_table(found.node)
    assert table is not None
    node = _with_table(changed, table, beside)
    changed.derived(_TABLE, lambda: Rolled(node, found.table, beside))


def _rolled(root: Node) -> Rolled:
    try:
        return _roll(root)
    except RecursionError:
        return Rolled(root, None, ())  # lowering reports a tree that is too deep


def rolled_for(assembly: Assembly, root: Node, *, exact: bool = False) -> Node:
    """Return the tree with a table and with bricks of joined shapes, if a program can have them.

    Args:
        assembly: The program.
        root: The tree.
        exact: Whether values far from joined shapes are those of the tree, not only bounds.

    Raises:
        CompileError: The target has no buffers for a table, and the parts are too many without one;
            or too many joined shapes can have no bricks.
    """
    if assembly.table_from is not None:
        root = bricked_for(assembly, root, exact=exact)
        return rolled(root).node if has_table(assembly, root) else root
    if root.parts > MOST_WITHOUT:
        raise CompileError.at(
            ErrorCode.TARGET,
            f"{root.parts:,} parts of '{root.name}' need a table, and this target has no buffers",
            root.place,
            f"take a target with buffers; {MOST_WITHOUT:,} parts are possible without",
        )
    return root


def bricked_for(
    assembly: Assembly, root: Node, *, exact: bool = False, default_varies: bool = False
) -> Node:
    """Return the tree with bricks for its joined shapes, if a program can have them.

    Other arguments, and errors, as for ``rolled_for``.

    Args:
        assembly: The program.
        root: The tree.
        exact: Whether values far from joined shapes are those of the tree.
        default_varies: Whether the material of shapes without one depends on the place.
    """
    if assembly.table_from is None:
        return root
    try:
        found = bricks.bricked(root, exact=exact, default_varies=default_varies)
    except RecursionError:
        return root  # lowering reports a tree that is too deep
    except ImportError:  # also of the module itself
        if root.parts > MOST_WITHOUT:
            raise
        return root  # texts are compiled without NumPy too
    for shapes in found.whole:
        if shapes.count > MOST_WITHOUT:
            raise CompileError.at(
                ErrorCode.TARGET,
                f"{shapes.count:,} joined shapes need programs for boxes, but {shapes.reason}",
                (shapes.blamed or shapes.node).place,
                f"without them, {MOST_WITHOUT:,} shapes are possible",
            )
    return found.node


def pieced_for(assembly: Assembly, root: Node, *, default_varies: bool) -> Node:
    """Return the tree with a table of pieces, if a program can have one and the tree needs it.

    Args:
        assembly: The program.
        root: The tree.
        default_varies: Whether the material of shapes without one depends on the place.
    """
    if assembly.table_from is None:
        return root
    try:
        return pieces.pieced(root, default_varies=default_varies).node
    except (ImportError, RecursionError):
        return root  # without NumPy; lowering reports a tree that is too deep


def with_boxes(root: Node) -> Node:
    """Return the tree with pieces or bricks, which have boxes of their own, if it can have some."""
    try:
        found = pieces.pieced(root)
        return found.node if found.table is not None else bricks.bricked(root, exact=False).node
    except (ImportError, RecursionError):
        return root


def has_table(assembly: Assembly, root: Node) -> bool:
    """Return whether ``rolled_for`` may make a table of a tree."""
    return assembly.table_from is not None and member_count(root) >= assembly.table_from


def split_table(root: Node) -> tuple[TableNode | None, Node | None]:
    """Return the table at the root of a tree, and the union of what is beside it; None if none."""
    if isinstance(root, TableNode):
        return root, None
    if root.rule is not UNION or not isinstance(root.children[0], TableNode):
        return None, root
    others = root.children[1:]
    beside = others[0] if len(others) == 1 else replace(root, children=others)
    return root.children[0], beside


def _roll(root: Node) -> Rolled:
    nothing = Rolled(root, None, ())
    if root.flat or member_count(root) < LEAST_PARTS:
        return nothing
    members = members_of(root)
    if len(members) < LEAST_PARTS:
        return nothing
    every = sorted(kinds_of(members), key=lambda kind: -len(kind.members))
    kinds = [kind for kind in every if kind.node.solid]
    reasons = {id(m): THIN for kind in every if not kind.node.solid for m in kind.members}
    reasons |= {id(m): RARE for kind in kinds[MOST_KINDS:] for m in kind.members}
    safe = SafeParts()
    kinds = [k if safe.has_safe_values(k.node) else k.with_factor() for k in kinds[:MOST_KINDS]]
    try:
        found = rows.rows_of(kinds)
    except ImportError:  # also of the module itself
        if root.parts > MOST_WITHOUT:
            raise
        return nothing  # texts are compiled without NumPy too
    reasons |= found.refused
    if found.count < LEAST_PARTS:
        return nothing
    table = found.table()
    beside = _whole([(m, reasons[id(m)]) for m in members if id(m) in reasons])
    made: dict[str, Any] = {"children": tuple(k.node for k in table.kinds), "table": table}
    node = TableNode(PARTS, root.flat, place=root.place, **made)
    return Rolled(_with_table(root, node, beside), table, beside)


def _with_table(root: Node, table: TableNode, beside: Sequence[tuple[UnionMember, str]]) -> Node:
    """Return the union of a table and of what is beside it."""
    if not beside:
        return table
    return Node(UNION, root.flat, (table, *(m.part for m, _ in beside)), place=root.place)


def _whole(beside: Sequence[tuple[UnionMember, str]]) -> list[tuple[UnionMember, str]]:
    """Return the members beside a table, with a repetition in place of its copies."""
    found: dict[int, tuple[UnionMember, str]] = {}
    for member, reason in beside:
        if member.repetition is None:
            found[id(member)] = (member, reason)
        else:
            whole = UnionMember(member.repetition, member.source)
            found.setdefault(id(member.repetition), (whole, reason))
    return list(found.values())
