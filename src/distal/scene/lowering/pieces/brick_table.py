"""Trees whose joined shapes have bricks, so that any point can be asked for its value.

Input: a tree. Output: the same tree, in which a node with a table of bricks takes the place of each
subtree that joins many solids; and why other such subtrees have none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.fields.combine.joins import UNION
from distal.fields.guarantees import Operator
from distal.lang.resources import Buffer
from distal.scene.lowering.parts.flatten import members_of, reads_cell
from distal.scene.lowering.parts.kinds import is_moving
from distal.scene.lowering.parts.table import (
    LEAST_PARTS,
    BrickData,
    BrickNode,
    PartTable,
    ProgramData,
)
from distal.scene.lowering.pieces.bricks import BrickLimits, BrickPrograms, build_bricks
from distal.scene.lowering.pieces.cell_programs import ENDLESS_SOLID
from distal.scene.lowering.pieces.programs import values_of
from distal.scene.lowering.pieces.table import (
    DEEP,
    DENSE,
    LARGEST_SHARE,
    MOST_ASIDE,
    LeafArrays,
    Refusal,
    is_worth_programs,
    joined_shapes,
    leaves_of,
    records,
)
from distal.scene.lowering.safe_parts import SafeParts
from distal.scene.tree.node import Node

LIMITS: Final = BrickLimits()
# Rays ask fewer shapes at once faster than through bricks; their code takes long to compile, which
# is more than meshes and numbers wait for.
LEAST_DRAWN: Final = 64
# The rule of a node that stands for joined shapes; its children are one tree of each kind.
JOINED: Final = Operator("joined shapes")


@dataclass(frozen=True, slots=True)
class WholeShapes:
    """Joined shapes without bricks.

    Attributes:
        node: What joins them.
        count: How many there are.
        reason: Why.
        blamed: The shape that prevents it; None if there is no single one.
    """

    node: Node
    count: int
    reason: str
    blamed: Node | None


@dataclass(frozen=True, slots=True)
class BrickedTree:
    """A tree with bricks.

    Attributes:
        node: The tree; the given one if it has none.
        tables: The nodes with bricks.
        whole: The joined shapes that have none.
    """

    node: Node
    tables: Sequence[BrickNode]
    whole: Sequence[WholeShapes]


def bricked(root: Node, *, exact: bool, default_varies: bool = False) -> BrickedTree:
    """Return a tree with bricks for its joined shapes.

    Args:
        root: The tree.
        exact: Whether values outside of the bricks are those of the tree, not only bounds.
        default_varies: Whether the material of shapes without one depends on the place.
    """
    key = f"bricks {exact} {default_varies}"
    found: BrickedTree = root.derived(
        key, lambda: _Insertion(draws=not exact, default_varies=default_varies).tree(root)
    )
    return found


class _Insertion:
    """Puts bricks in place of joined shapes."""

    def __init__(self, *, draws: bool, default_varies: bool) -> None:
        self._draws = draws
        self._least = LEAST_DRAWN if draws else LEAST_PARTS
        self._default_varies = default_varies
        self._tables: list[BrickNode] = []
        self._whole: list[WholeShapes] = []
        self._safe = SafeParts()

    def tree(self, root: Node) -> BrickedTree:
        """Return a tree with bricks."""
        node = self._of(root, exact=not self._draws, in_cells=False)
        return BrickedTree(node, self._tables, self._whole)

    def _of(self, node: Node, *, exact: bool, in_cells: bool) -> Node:
        """Return a tree with bricks.

        Args:
            node: The root of the tree.
            exact: Whether values outside of bricks must be those of the tree: what is above has its
                surface elsewhere than where they are 0.
            in_cells: Whether a repetition is above.
        """
        if node.parts < self._least or node.has_rows:
            return node
        shapes, table = joined_shapes(node), None
        if shapes is not None and not (in_cells and reads_cell(node)):
            varies = self._default_varies
            table = shapes.node.derived(
                f"table of bricks {varies}", lambda: self._table_of(shapes.node)
            )
            if isinstance(table, PartTable) and self._draws and _is_dense(table):
                table = Refusal(DENSE)
            if isinstance(table, PartTable):
                return shapes.with_shapes(self._inserted(shapes.node, table, exact=exact))
        found = self._below(node, exact=exact, in_cells=in_cells)
        # Members of a union say it for themselves.
        if isinstance(table, Refusal) and found.parts >= self._least and len(members_of(node)) == 1:
            self._whole.append(WholeShapes(node, found.parts, table.reason, table.blamed))
        return found

    def _table_of(self, node: Node) -> PartTable | Refusal | None:
        """Return the table of joined shapes, why they can have none, or None if they need none."""
        program = values_of(node, default_varies=self._default_varies)
        whole = {id(w.node): w for w in program.whole if w.node.parts >= self._least}
        if not is_worth_programs(program):
            first = next(iter(whole.values()), None)
            return None if first is None else Refusal(first.reason, first.node)
        # What is not taken apart may have bricks within.
        inner = {key: self._below(w.node, exact=True, in_cells=False) for key, w in whole.items()}
        if inner:
            node = _replaced(node, inner)
            program = values_of(node, default_varies=self._default_varies)
        leaves = leaves_of(program)
        if isinstance(leaves, Refusal):
            return leaves
        corners = leaves.low, leaves.high
        try:
            grid = build_bricks(
                program, *corners, leaves.slope, leaves.distances, LIMITS, leaves.growth
            )
        except ValueError:
            return Refusal(ENDLESS_SOLID)
        return Refusal(DEEP) if grid.programs.depth > MOST_ASIDE else _packed(grid, leaves)

    def _below(self, node: Node, *, exact: bool, in_cells: bool) -> Node:
        """Return a tree that has no bricks as a whole, with bricks for what is below its root."""
        node = _still_first(node)
        exact = exact or not self._safe.keeps_surfaces(node)
        in_cells = in_cells or (isinstance(node.rule, Operator) and node.rule.repeats)
        children = tuple(self._of(c, exact=exact, in_cells=in_cells) for c in node.children)
        same = all(a is b for a, b in zip(children, node.children, strict=True))
        return node if same else replace(node, children=children)

    def _inserted(self, node: Node, table: PartTable, *, exact: bool) -> BrickNode:
        made = _table_node(node, table, exact=exact)
        self._tables.append(made)
        return made


def _is_dense(table: PartTable) -> bool:
    """Return whether pictures are drawn faster without the bricks."""
    data = table.programs
    assert data is not None and data.bricks is not None
    return data.bricks.share > LARGEST_SHARE


def _replaced(node: Node, others: Mapping[int, Node]) -> Node:
    """Return a tree with other nodes in place of some, by the ids of these."""
    if id(node) in others:
        return others[id(node)]
    children = tuple(_replaced(child, others) for child in node.children)
    same = all(a is b for a, b in zip(children, node.children, strict=True))
    return node if same else replace(node, children=children)


def _still_first(node: Node) -> Node:
    """Return a node that joins many shapes, with those before the first that moves as one shape."""
    children = node.children
    if len(children) < LEAST_PARTS or node.rule is UNION:
        return node
    still = next((i for i, child in enumerate(children) if is_moving(child)), 0)
    if still < LEAST_PARTS or still == len(children):
        return node
    first = replace(node, children=children[:still], material=None, cut_material=None, label="")
    return replace(node, children=(first, *children[still:]))


def _table_node(node: Node, table: PartTable, *, exact: bool) -> BrickNode:
    data = table.programs
    assert data is not None and data.bricks is not None
    own = replace(data, bricks=replace(data.bricks, exact=exact))
    made: dict[str, Any] = {
        "children": tuple(kind.node for kind in table.kinds),
        "table": replace(table, programs=own),
        "constants": {"bricks": data.bricks.programs},  # tells tables of equal kinds apart
    }
    return BrickNode(JOINED, False, place=node.place, label=node.label, **made)


def _packed(grid: BrickPrograms, leaves: LeafArrays) -> PartTable:
    """Return a table in the form that ``render.bricks`` and ``render.pieces`` read."""
    programs, first = grid.programs, len(leaves.rows)
    every = np.arange(len(programs.start))
    numbers = records(programs, every, np.full(len(every), -1), leaves)
    # A leaf alone is a part by itself.
    start = programs.start
    is_lone = programs.count == 1
    part = np.where(is_lone, leaves.row[programs.steps[start, 1]], first + every)
    bricks = BrickData(
        Buffer(part[grid.program].astype(np.int32)),
        grid.counts,
        _corner(grid.low),
        _corner(grid.high),
        grid.growth,
        grid.share,
    )
    data = ProgramData(numbers, grid.joins, first, first + grid.whole, programs.has_others, bricks)
    corners = _corner(grid.solid_low), _corner(grid.solid_high)
    slope, divisor = float(leaves.slope.max()), float(leaves.divisor.max())
    return PartTable(leaves.kinds, None, Buffer(leaves.rows), *corners, slope, divisor, data)


def _corner(values: NDArray[Any]) -> tuple[float, ...]:
    return tuple(map(float, values))
