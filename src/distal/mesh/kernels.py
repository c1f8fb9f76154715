"""Functions of scene code that need a shape's field, compiled for this shape.

Input: a shape's tree, parameter values and a time. Output: arrays, one row for each edge, cell or
triangle, in 64 bits. Does not depend on topology.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from distal.forking import new_lock
from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.mesh.parallel import is_worker
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer

if TYPE_CHECKING:
    from distal.scene.tree.node import Node


# To start a thread takes longer than to compute so few rows.
_FEW_ROWS: Final = 1 << 12
# The name under which a tree keeps the functions of its field.
FIELD_FUNCTIONS: Final = "functions of the field"


class FieldFunctions(dict[Func, Composed]):
    """The functions of a tree's field that were called so far.

    Args:
        node: The tree.
    """

    def __init__(self, node: Node) -> None:
        super().__init__()
        self._node = node

    def need(self, function: Func, types: Sequence[tuple[str, Type]]) -> Composed:
        """Return a function of the field.

        Args:
            function: The function; its parameter ``field`` is the shape.
            types: Names and types of its other parameters.
        """
        made = self.get(function)
        if made is None:
            made = self[function] = OfField(self._node, function, types)
        return made


class OfField(Composed):
    """A function of scene code whose parameter ``field`` is a shape's field."""

    def __init__(self, node: Node, function: Func, types: Sequence[tuple[str, Type]]) -> None:
        self._node = node
        self._function = function
        self.name = f"{function.name} of {node.name}"
        self.signature = tuple(types)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node = rolled_for(assembly, self._node, exact=True)
        composer = ShapeComposer(assembly, [node])
        shape = composer.field(node, composer.values.all(node), ZERO_CELL)
        given = {name: Read(name, type) for name, type in self.signature}
        value = assembly.call(self._function, {**given, "field": shape})
        params = tuple(Param(name, type) for name, type in self.signature)
        return assembly.define(
            self._function.name, params, value.type, (Return(value),), node.place
        )

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()


@dataclass(slots=True)
class FieldKernels:
    """Evaluates functions of a shape's field; several threads may use it.

    Attributes:
        node: The shape's tree.
        params: Values of parameters by name.
        time: Seconds.
        rows: How many rows have been evaluated so far.
    """

    node: Node
    params: Mapping[str, Any]
    time: float
    rows: int = 0
    _lock: Any = field(default_factory=new_lock)

    def call(self, function: Func, *columns: Any, types: Sequence[tuple[str, Type]]) -> Any:
        """Return the values of a function for many rows.

        Args:
            function: The function; its parameter ``field`` is the shape.
            columns: The values of its other parameters.
            types: Their names and types.
        """
        with self._lock:
            known = self.node.derived(FIELD_FUNCTIONS, lambda: FieldFunctions(self.node))
            made = known.need(function, types)
            self.rows += len(columns[0])
        args = [as_rows(column) for column in columns]
        return executor().call(
            made, args, {}, params=self.params, time=self.time, here=are_computed_here(args)
        )


def rows_of(function: Func, *columns: Any) -> Any:
    """Return the values of a function that needs no field, for many rows."""
    args = [as_rows(column) for column in columns]
    return executor().call(function, args, {}, here=are_computed_here(args))


def are_computed_here(columns: Sequence[Any]) -> bool:
    """Return whether this thread computes rows alone: it is one of several, or they are few."""
    return is_worker() or (len(columns) > 0 and len(columns[0]) < _FEW_ROWS)


def as_rows(column: Any) -> Any:
    """Return a column as numbers of 64 bits; truth values stay."""
    array = np.asarray(column)
    return array if array.dtype == np.bool_ else np.asarray(array, np.float64)
