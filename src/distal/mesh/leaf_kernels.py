"""The fields of all placed leaves of a tree, evaluated for rows of a leaf and a place.

Input: a tree, parameter values and a time. Output: boxes and slopes of the leaves, and their values
and normals. Leaves of equal structure differ in numbers only: these are columns of one compiled
function. Works for solids and for flat shapes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final

import numpy as np

from distal.fields.guarantees import ended
from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh import arithmetic
from distal.mesh.kernels import FieldKernels, as_rows
from distal.mesh.outlines import arithmetic as flat_arithmetic
from distal.mesh.parallel import is_worker
from distal.mesh.placed_leaves import PlacedLeaf, placed_leaves
from distal.mesh.requests import box_of
from distal.mesh.solid import Floats, Integers
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.kind_boxes import BoxOfKind, KindBounds, columns_of
from distal.scene.lowering.parts.kinds import PartKind, kinds_of
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node

# The names under which a tree keeps the kinds of its leaves, and a kind's functions.
_KINDS: Final = "kinds of leaves"
_Types = Sequence[tuple[str, Type]]


class FieldProbe:
    """A field at places: its values, distances of first order, and normals.

    Attributes:
        kernels: The shape.
    """

    def __init__(self, kernels: FieldKernels) -> None:
        self.kernels = kernels
        self._flat = kernels.node.flat

    def values(self, places: Floats) -> Floats:
        """Return the values at places."""
        function, types = _value_function(self._flat)
        found: Floats = self.kernels.call(function, places, types=types)
        return found

    def distances(self, places: Floats, off: float) -> tuple[Floats, Floats]:
        """Return signed distances of first order, and normals of length 1, or 0 without any.

        Args:
            places: The places.
            off: A length; normals are taken a tiny share of it beside the places.
        """
        function, types = _distance_function(self._flat)
        away, normals = self.kernels.call(function, places, np.full(len(places), off), types=types)
        return np.where(self.values(places) < 0.0, -away, away), normals


class LeafKernels:
    """The fields of the placed leaves of a tree.

    Attributes:
        leaves: The leaves, ordered by kind.
        low: The low corners of their boxes, of shape (n, 3), or (n, 2) for flat ones.
        high: The high corners.
        slope: Lipschitz bound (slope) of each.
        divisor: A positive value of it, divided by this, is at most the distance to it.
    """

    def __init__(self, node: Node, params: Mapping[str, Any], time: float) -> None:
        """Prepare the leaves of a tree.

        Args:
            node: The tree.
            params: Values of parameters by name.
            time: Seconds.
        """
        self._flat, self._params, self._time = node.flat, params, time
        self._kinds: Sequence[_LeafKind] = node.derived(_KINDS, lambda: _kinds_of(node))
        self.leaves = tuple(leaf for kind in self._kinds for leaf in kind.leaves)
        counts = [len(kind.leaves) for kind in self._kinds]
        self._ends = np.cumsum([0, *counts])
        bounds = [self._bounds(kind) for kind in self._kinds]
        self.low, self.high = (
            np.concatenate([getattr(each, name) for each in bounds]) for name in ("low", "high")
        )
        self.slope, self.divisor = (
            np.concatenate([getattr(each, name) for each in bounds])
            for name in ("slope", "divisor")
        )

    def values(self, leaf: Integers, places: Floats) -> Floats:
        """Return the value of a leaf at each place.

        Args:
            leaf: The leaf of each row, sorted.
            places: The places.
        """
        function, types = _value_function(self._flat)
        found = np.empty(len(leaf))
        for kind, rows in self._rows(leaf):
            given = (places[rows],)
            found[rows] = self._call(kind, function, types, leaf[rows], given)
        return found

    def distances(self, leaf: Integers, places: Floats, off: float) -> tuple[Floats, Floats]:
        """Return signed distances of first order to a leaf at each place, and normals.

        Args:
            leaf: The leaf of each row, sorted.
            places: The places.
            off: A length; normals are taken a tiny share of it beside the places.
        """
        function, types = _distance_function(self._flat)
        away, normals = np.empty(len(leaf)), np.empty_like(places)
        for kind, rows in self._rows(leaf):
            given = (places[rows], np.full(rows.stop - rows.start, off))
            away[rows], normals[rows] = self._call(kind, function, types, leaf[rows], given)
        values = self.values(leaf, places)
        return np.where(values < 0.0, -away, away), normals

    def _rows(self, leaf: Integers) -> Iterator[tuple[int, slice]]:
        """Yield the kinds of rows, and where they are."""
        at = np.searchsorted(leaf, self._ends)
        for kind, (start, stop) in enumerate(pairwise(at)):
            if start < stop:
                yield kind, slice(int(start), int(stop))

    def _call(
        self, number: int, function: Func, types: _Types, leaf: Integers, given: Sequence[Floats]
    ) -> Any:
        """Return the values of a function for rows of one kind.

        Args:
            number: The number of the kind.
            function: The function; its parameter ``field`` is the leaf.
            types: Names and types of its other parameters.
            leaf: The leaf of each row.
            given: The values of its other parameters.
        """
        kind = self._kinds[number]
        if kind.alone is not None:
            return FieldKernels(kind.alone, self._params, self._time).call(
                function, *given, types=types
            )
        made = kind.need(function, types)
        row = leaf - self._ends[number]
        args = [as_rows(column) for column in (*given, *(each[row] for each in kind.columns))]
        here = is_worker()
        return executor().call(made, args, {}, params=self._params, time=self._time, here=here)

    def _bounds(self, kind: _LeafKind) -> KindBounds:
        if kind.alone is not None:
            (slope, divisor), low, high = box_of(kind.alone, self._params, self._time)
            return KindBounds(low[None], high[None], np.array([slope]), np.array([divisor]))
        found = executor().call(kind.boxes, kind.columns, {}, params=self._params, time=self._time)
        low, high, slope, divisor = (np.asarray(part, np.float64) for part in found)
        return KindBounds(_ended(low), _ended(high), slope, divisor)


def _ended(corners: Floats) -> Floats:
    return np.vectorize(ended)(corners)


def _value_function(flat: bool) -> tuple[Func, _Types]:
    if flat:
        return flat_arithmetic.distance_value, (("p", VEC2),)
    return arithmetic.distance_value, (("p", VEC3),)


def _distance_function(flat: bool) -> tuple[Func, _Types]:
    if flat:
        return flat_arithmetic.distance_and_normal, (("p", VEC2), ("step", FLOAT))
    return arithmetic.distance_and_normal, (("p", VEC3), ("step", FLOAT))


class _LeafKind:
    """Leaves of equal structure.

    Attributes:
        leaves: The leaves.
        alone: The tree of the only leaf; None if there are several.
        columns: The numbers in which several differ, one row each.
        boxes: The function of their boxes.
    """

    def __init__(self, kind: PartKind, leaves: tuple[PlacedLeaf, ...]) -> None:
        self.leaves = leaves
        self.alone = leaves[0].tree if len(leaves) == 1 else None
        self.columns = columns_of(kind)
        self.boxes = BoxOfKind(kind)
        self._kind = kind
        self._functions: dict[Func, _OfKind] = {}

    def need(self, function: Func, types: _Types) -> _OfKind:
        """Return a function of the leaves of the kind; arguments as for ``FieldFunctions``."""
        made = self._functions.get(function)
        if made is None:
            made = self._functions[function] = _OfKind(self._kind, function, types)
        return made


class _OfKind(Composed):
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
        self._kind.read(assembly, list(reads.values())[len(self._types) :])
        composer = ShapeComposer(assembly, [node])
        field = composer.field(node, composer.values.all(node), ZERO_CELL)
        given = {name: reads[name] for name, _ in self._types}
        value = assembly.call(self._function, {**given, "field": field})
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define(
            self._function.name, params, value.type, (Return(value),), node.place
        )

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the leaves call."""
        return self._kind.node.functions()


def _kinds_of(node: Node) -> list[_LeafKind]:
    """Return the kinds of the leaves of a tree; equal leaves in equal places are one."""
    leaves = {id(leaf): leaf for leaf in placed_leaves(node)}
    members = [UnionMember(_plain(leaf.tree), leaf.tree) for leaf in leaves.values()]
    by_tree = {id(leaf.tree): leaf for leaf in leaves.values()}
    found = []
    for kind in kinds_of(members):
        found.append(_LeafKind(kind, tuple(by_tree[id(m.source)] for m in kind.members)))
    return found


def _plain(node: Node) -> Node:
    """Return a tree without materials and labels, which its field does not depend on."""
    children = tuple(map(_plain, node.children))
    return replace(node, children=children, material=None, cut_material=None, label="")
