"""The leaves of a tree as rows: their values at points, their slopes, boxes and widths.

Input: a tree. Output: arrays. Leaves of equal structure are one kind: one function computes them
all, and the numbers that differ are columns, so that hundreds of bores are compiled once.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.fields.guarantees import ENDLESS
from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, VEC4, Type, tuple_type
from distal.lang.chosen_values import by_key
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh.arithmetic import value_and_slope
from distal.mesh.placed_leaves import PlacedLeaf, placed_leaves
from distal.mesh.solid import Bools, Floats, Integers
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.kind_boxes import columns_of
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.widths import SurfaceBounds, WidthComposer, has_width
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values

# The name under which a tree keeps the kinds of its leaves.
KINDS: Final = "kinds of leaves"
# Each kind is compiled. Leaves of more kinds are not looked at, the rarest ones.
MOST_KINDS: Final = 64


@dataclass(frozen=True, slots=True)
class LeafKind:
    """Leaves of equal structure.

    Attributes:
        kind: Their tree and their numbers.
        rows: Which leaves of the tree they are.
        columns: The numbers that differ, one row for each leaf.
        values: The function of their values and gradients.
        numbers: The function of their slopes, boxes and widths.
    """

    kind: PartKind
    rows: Integers
    columns: tuple[Floats, ...]
    values: Composed
    numbers: Composed


@dataclass(frozen=True, slots=True)
class LeafNumbers:
    """Numbers of leaves, one row for each.

    Attributes:
        slope: A bound of the gradient.
        low: The lowest corners of their boxes.
        high: The highest corners.
        width: The side of the largest cells that find them; infinite without a second surface near.
        known: Whether it is known.
    """

    slope: Floats
    low: Floats
    high: Floats
    width: Floats
    known: Bools


@dataclass(frozen=True, slots=True)
class LeafKinds:
    """The leaves of a tree, by kinds.

    Attributes:
        leaves: The leaves, in the author's order.
        kinds: Their kinds, those with the most leaves first.
    """

    leaves: tuple[PlacedLeaf, ...]
    kinds: tuple[LeafKind, ...]

    def numbers(self, params: Mapping[str, Any], time: float) -> LeafNumbers:
        """Return the numbers of all leaves.

        Args:
            params: Values of parameters by name.
            time: Seconds.
        """
        count = len(self.leaves)
        slope, width = np.zeros(count), np.full(count, np.inf)
        # Leaves that are not looked at are nowhere.
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        known = np.zeros(count, np.bool_)
        for own in self.kinds:
            rows = own.rows
            # One row for each: compiling it would take longer.
            given = _read_by(own.numbers, params)
            found = executor().call(
                own.numbers, own.columns, {}, params=given, time=time, device="reference"
            )
            slope[rows], low[rows], high[rows], width[rows] = found
            known[rows] = has_width(own.kind.node)
        # Surfaces without an inside have no width; nothing of them is meshed.
        width = np.where((width > ENDLESS) | (width <= 0.0), np.inf, width)
        return LeafNumbers(slope, low, high, width, known)

    def at(
        self, leaf: Integers, places: Floats, params: Mapping[str, Any], time: float
    ) -> tuple[Floats, Floats]:
        """Return the value and the gradient of one leaf at each place.

        Args:
            leaf: The leaves.
            places: Of shape (n, 3).
            params: Values of parameters by name.
            time: Seconds.
        """
        found = np.empty((len(leaf), 4))
        kind_of, row_of = self._kind_of()
        order = np.argsort(kind_of[leaf], kind="stable")
        ends = np.searchsorted(kind_of[leaf][order], np.arange(len(self.kinds) + 1))
        for own, first, last in zip(self.kinds, ends[:-1], ends[1:], strict=True):
            some = order[first:last]
            if len(some):
                columns = [column[row_of[leaf[some]]] for column in own.columns]
                args = [places[some], *columns]
                given = _read_by(own.values, params)
                found[some] = executor().call(own.values, args, {}, params=given, time=time)
        return found[:, 0], found[:, 1:]

    def _kind_of(self) -> tuple[Integers, Integers]:
        """Return the kind of each leaf, and its row among those of the kind."""
        kind, row = np.zeros((2, len(self.leaves)), np.int64)
        for number, own in enumerate(self.kinds):
            kind[own.rows], row[own.rows] = number, np.arange(len(own.rows))
        return kind, row


def _read_by(function: Composed, params: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the values of the parameters that a function reads; others would be refused."""
    if not params:
        return params
    known = by_key(function.parameters())
    return {key: value for key, value in params.items() if key in known}


def leaf_kinds(root: Node) -> LeafKinds:
    """Return the leaves of a tree, by kinds; they live as long as the tree."""
    return root.derived(KINDS, lambda: _leaf_kinds(placed_leaves(root)))


def _leaf_kinds(leaves: tuple[PlacedLeaf, ...]) -> LeafKinds:
    members = [UnionMember(_unpainted(leaf.tree), leaf.leaf) for leaf in leaves]
    number = {id(member): i for i, member in enumerate(members)}
    kinds = []
    most = sorted(kinds_of(members), key=lambda kind: -len(kind.members))[:MOST_KINDS]
    for kind in most:
        rows = np.array([number[id(member)] for member in kind.members])
        columns = tuple(columns_of(kind))
        kinds.append(LeafKind(kind, rows, columns, _ValuesOf(kind), _NumbersOf(kind)))
    return LeafKinds(leaves, tuple(kinds))


def _unpainted(node: Node) -> Node:
    """Return a tree without materials: they make no kinds."""
    children = tuple(map(_unpainted, node.children))
    return Node(node.rule, node.flat, children, node.numbers, node.constants, node.place)


class _ValuesOf(Composed):
    """The value and the gradient of a leaf of a kind, from a point and the leaf's numbers."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"values of {kind.node.name}"
        self._kind = kind
        columns = ((f"column_{i}", c.type) for i, c in enumerate(kind.columns))
        self.signature = (("p", VEC3), *columns)
        self.result: Type = VEC4

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = self._kind.node
        if self._kind.columns:
            self._kind.read(assembly, [Read(name, type) for name, type in self.signature[1:]])
        else:
            node = rolled_for(assembly, node, exact=True)
        composer = ShapeComposer(assembly, [node])
        shape = composer.field(node, composer.values.all(node), ZERO_CELL)
        value = assembly.call(value_and_slope, {"p": Read("p", VEC3), "field": shape})
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define("leaf_values", params, VEC4, (Return(value),), node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the leaf calls."""
        return self._kind.node.functions()


class _NumbersOf(Composed):
    """The slope, the box and the width of a leaf of a kind, from the leaf's numbers."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"numbers of {kind.node.name}"
        self._kind = kind
        self.signature = tuple((f"column_{i}", c.type) for i, c in enumerate(kind.columns))
        self.result: Type = tuple_type((FLOAT, VEC3, VEC3, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        self._kind.read(assembly, [Read(name, type) for name, type in self.signature])
        values = Values(assembly)
        body = StatementList(taken={name for name, _ in self.signature})
        node = self._kind.node
        composer = SurfaceBounds(values)
        found = composer.of(body, node, values.all(node))
        box = body.let("box", found.bounds)
        width = WidthComposer(values, composer).of(body, node, values.all(node))
        parts = (found.slope, field(box, "low"), field(box, "high"), width)
        body.statements.append(Return(Construct(parts, self.result)))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("leaf_numbers", params, self.result, body.statements)
