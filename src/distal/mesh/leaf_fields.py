"""The fields of a shape and of its leaves at places: values, normals, slopes, boxes and widths.

Input: a tree, parameter values and a time. Output: arrays, one row for each leaf, or for each pair
of a leaf and a place. Leaves of equal structure are one kind: one function computes them all, and
the numbers that differ are columns, so that hundreds of bores are compiled once. Works for solids
and for flat shapes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, pairwise
from typing import Any, Final

import numpy as np

from distal.fields.guarantees import ENDLESS, ended
from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Type, tuple_type
from distal.lang.chosen_values import by_key
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh import arithmetic
from distal.mesh.kernels import FieldKernels, are_computed_here, as_rows
from distal.mesh.outlines import arithmetic as flat_arithmetic
from distal.mesh.solid import Bools, Floats, Integers
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.kind_boxes import columns_of
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.placed_leaves import PlacedLeaf, placed_leaves
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.widths import SurfaceBounds, WidthComposer, has_width
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values

# The name under which a tree keeps the kinds of its leaves.
_KINDS: Final = "kinds of leaves"
# Each kind is compiled. Leaves of more kinds, the rarest ones, are not looked at.
MOST_KINDS: Final = 64
_Types = Sequence[tuple[str, Type]]
_ENDED: Final = np.vectorize(ended, otypes=[np.float64])
# Functions of a field, and the types of their other parameters, for solids and for flat shapes.
_VALUES: Final[dict[bool, tuple[Func, _Types]]] = {
    False: (arithmetic.distance_value, (("p", VEC3),)),
    True: (flat_arithmetic.distance_value, (("p", VEC2),)),
}
_DISTANCES: Final[dict[bool, tuple[Func, _Types]]] = {
    False: (arithmetic.distance_and_normal, (("p", VEC3), ("step", FLOAT))),
    True: (flat_arithmetic.distance_and_normal, (("p", VEC2), ("step", FLOAT))),
}


class FieldProbe:
    """The field of a shape at places.

    Args:
        kernels: The shape.
    """

    def __init__(self, kernels: FieldKernels) -> None:
        self._kernels = kernels
        self._flat = kernels.node.flat

    def values(self, places: Floats) -> Floats:
        """Return the values at places."""
        function, types = _VALUES[self._flat]
        found: Floats = self._kernels.call(function, places, types=types)
        return found

    def distances(self, places: Floats, off: float) -> tuple[Floats, Floats]:
        """Return signed distances of first order, and normals of length 1, or 0 without any.

        Args:
            places: The places.
            off: A length; normals are taken a tiny share of it beside the places.
        """
        function, types = _DISTANCES[self._flat]
        offs = np.full(len(places), off)
        away, normals = self._kernels.call(function, places, offs, types=types)
        return np.where(self.values(places) < 0.0, -away, away), normals


@dataclass(frozen=True, slots=True)
class LeafNumbers:
    """Numbers of leaves, one row for each.

    Attributes:
        slope: A bound of the gradient.
        divisor: A positive value, divided by this, is at most the distance.
        low: The lowest corners of the boxes around their surfaces.
        high: The highest corners.
        width: The side of the largest cells that find them; infinite without a second surface near.
        known: Whether it is known.
    """

    slope: Floats
    divisor: Floats
    low: Floats
    high: Floats
    width: Floats
    known: Bools


class LeafFields:
    """The fields of the leaves of a shape.

    Args:
        kernels: The shape.

    Attributes:
        leaves: The leaves, those of one kind in a row; last those of too many kinds.
        kinds: How many kinds there are.
    """

    def __init__(self, kernels: FieldKernels) -> None:
        node = kernels.node
        kept: Sequence[_LeafKind] = node.derived(_KINDS, lambda: _kinds_of(placed_leaves(node)))
        self.kinds = len(kept)
        self._seen = kept[:MOST_KINDS]
        self._kernels, self._flat = kernels, node.flat
        self.leaves = tuple(chain.from_iterable(kind.leaves for kind in kept))
        self._ends = np.cumsum([0, *(len(kind.leaves) for kind in self._seen)])

    @property
    def unseen(self) -> tuple[PlacedLeaf, ...]:
        """The leaves of too many kinds, which are not looked at: they have no place."""
        return self.leaves[self._ends[-1] :]

    @cached_property
    def numbers(self) -> LeafNumbers:
        """The numbers of all leaves."""
        count = len(self.leaves)
        slope, divisor, width = np.zeros(count), np.ones(count), np.full(count, np.inf)
        # Leaves that are not looked at are nowhere.
        size = 2 if self._flat else 3
        low, high = np.full((count, size), np.inf), np.full((count, size), -np.inf)
        known = np.zeros(count, np.bool_)
        for kind, (start, stop) in zip(self._seen, pairwise(self._ends), strict=True):
            rows = slice(int(start), int(stop))
            # One row for each: compiling it would take longer.
            found = self._evaluated(kind.numbers, kind.columns, device="reference")
            slope[rows], divisor[rows], low[rows], high[rows], width[rows] = found
            known[rows] = kind.known
        # Surfaces without an inside have no width; nothing of them is meshed.
        width = np.where((width > ENDLESS) | (width <= 0.0), np.inf, width)
        low, high = _ENDED(low), _ENDED(high)
        return LeafNumbers(slope, divisor, low, high, width, known)

    def values(self, leaf: Integers, places: Floats) -> Floats:
        """Return the value of a leaf at each place.

        Args:
            leaf: The leaf of each row.
            places: The places.
        """
        function, types = _VALUES[self._flat]
        found = np.empty(len(leaf))
        for kind, rows, columns in self._rows(leaf):
            made = kind.need(function, types)
            found[rows] = self._evaluated(made, [places[rows], *columns])
        return found

    def distances(self, leaf: Integers, places: Floats, off: float) -> tuple[Floats, Floats]:
        """Return signed distances of first order to a leaf at each place, and normals.

        Args:
            leaf: The leaf of each row.
            places: The places.
            off: A length; normals are taken a tiny share of it beside the places.
        """
        function, types = _DISTANCES[self._flat]
        away, normals = np.empty(len(leaf)), np.empty_like(places)
        for kind, rows, columns in self._rows(leaf):
            made = kind.need(function, types)
            offs = np.full(len(rows), off)
            away[rows], normals[rows] = self._evaluated(made, [places[rows], offs, *columns])
        return np.where(self.values(leaf, places) < 0.0, -away, away), normals

    def _rows(self, leaf: Integers) -> Iterator[tuple[_LeafKind, Integers, list[Floats]]]:
        """Yield kinds, the rows of their leaves, and the columns of these."""
        order = np.argsort(leaf, kind="stable")
        at = np.searchsorted(leaf[order], self._ends)
        for kind, first, (start, stop) in zip(self._seen, self._ends, pairwise(at), strict=False):
            if start < stop:
                rows = order[start:stop]
                own = leaf[rows] - first
                yield kind, rows, [column[own] for column in kind.columns]

    def _evaluated(
        self, function: Composed, columns: Sequence[Floats], device: str | None = None
    ) -> Any:
        kernels, args = self._kernels, [as_rows(column) for column in columns]
        if args:
            kernels.rows += len(args[0])
        given = _read_by(function, kernels.params)
        call = executor().call
        if device is not None:
            return call(function, args, {}, params=given, time=kernels.time, device=device)
        here = are_computed_here(args)
        return call(function, args, {}, params=given, time=kernels.time, here=here)


def _read_by(function: Composed, params: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the values of the parameters that a function reads; others would be refused."""
    if not params:
        return params
    known = by_key(function.parameters())
    return {key: value for key, value in params.items() if key in known}


class _LeafKind:
    """Leaves of equal structure.

    Attributes:
        leaves: The leaves.
        columns: The numbers that differ, one row for each leaf.
        numbers: The function of their slopes, boxes and widths.
        known: Whether their widths are known.
    """

    def __init__(self, kind: PartKind, leaves: tuple[PlacedLeaf, ...]) -> None:
        self.leaves = leaves
        self.columns = columns_of(kind)
        self.numbers = _NumbersOf(kind)
        self.known = has_width(kind.node)
        self._kind = kind
        self._functions: dict[Func, _FunctionOfKind] = {}

    def need(self, function: Func, types: _Types) -> _FunctionOfKind:
        """Return a function of the leaves of the kind; arguments as for ``FieldFunctions``."""
        made = self._functions.get(function)
        if made is None:
            made = self._functions[function] = _FunctionOfKind(self._kind, function, types)
        return made


def _kinds_of(leaves: Sequence[PlacedLeaf]) -> list[_LeafKind]:
    """Return the kinds of leaves, those with the most leaves first."""
    members = [UnionMember(_plain(leaf.tree), leaf.leaf) for leaf in leaves]
    of_member = dict(zip(map(id, members), leaves, strict=True))
    kinds = sorted(kinds_of(members), key=lambda kind: -len(kind.members))
    return [_LeafKind(kind, tuple(of_member[id(m)] for m in kind.members)) for kind in kinds]


def _plain(node: Node) -> Node:
    """Return a tree without materials and labels, which its field does not depend on."""
    children = tuple(map(_plain, node.children))
    return replace(node, children=children, material=None, cut_material=None, label="")


class _FunctionOfKind(Composed):
    """A function whose parameter ``field`` is the field of a leaf, from the numbers of its row."""

    def __init__(self, kind: PartKind, function: Func, types: _Types) -> None:
        self._kind, self._function, self._types = kind, function, types
        self.name = f"{function.name} of leaves like {kind.node.name}"
        columns = ((f"column_{i}", column.type) for i, column in enumerate(kind.columns))
        self.signature = (*types, *columns)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = self._kind.node
        reads = {name: Read(name, type) for name, type in self.signature}
        if self._kind.columns:
            self._kind.read(assembly, list(reads.values())[len(self._types) :])
        else:
            node = rolled_for(assembly, node, exact=True)
        composer = ShapeComposer(assembly, [node])
        shape = composer.field(node, composer.values.all(node), ZERO_CELL)
        given = {name: reads[name] for name, _ in self._types}
        value = assembly.call(self._function, {**given, "field": shape})
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define(
            self._function.name, params, value.type, (Return(value),), node.place
        )

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the leaves call."""
        return self._kind.node.functions()


class _NumbersOf(Composed):
    """Slope, divisor, box and width of a leaf of a kind, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        self.name = f"numbers of {kind.node.name}"
        self._kind = kind
        self.signature = tuple((f"column_{i}", c.type) for i, c in enumerate(kind.columns))
        corner = VEC2 if kind.node.flat else VEC3
        self.result: Type = tuple_type((FLOAT, FLOAT, corner, corner, FLOAT))

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
        parts = (found.slope, found.divisor, field(box, "low"), field(box, "high"), width)
        body.statements.append(Return(Construct(parts, self.result)))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("leaf_numbers", params, self.result, body.statements)
