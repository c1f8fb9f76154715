"""Bounds of a shape whose numbers differ from cell to cell, for all cells of a repetition.

Input: the shape, and the repetition that is applied to it. Output: the shape below an operator that
holds one box, slope and growth for all cells. They are computed once, by intervals: for each cell
if there are few, else for all at once; for all times and all values of the parameters in their
limits. The same intervals check the limits of the numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.fields.guarantees import ENDLESS, UNBOUNDED, Operator
from distal.fields.repeat.flat import REPEAT_MIRRORED_FLAT
from distal.fields.repeat.grid import REPEAT_MIRRORED
from distal.fields.repeat.varied import BOUNDS_IN_CELLS, IN_CELLS
from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Kind, Type, Vector, component_count, tuple_type
from distal.lang.composed import Composed
from distal.lang.places import CELL, random_numbers_in
from distal.lang.runtime_access import executor
from distal.packages import PackageError, imported
from distal.scene.lowering.bounds import BoundsComposer, packed_types
from distal.scene.tree.conversion import Number, complaint
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values
from distal.scene.tree.varying import VariedNumber, varied_in

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

# The most cells that are each looked at by themselves.
_MOST_CELLS: Final = 4096


def with_bounds_of_cells(
    child: Node,
    rule: Operator,
    numbers: Mapping[str, Number],
    constants: Mapping[str, Any],
    place: Span | None,
) -> Node:
    """Return a shape that is repeated, with bounds that hold in all cells of the repetition.

    It is the same node if none of its numbers depends on the cell.

    Args:
        child: The shape.
        rule: The repetition.
        numbers: The numbers of the repetition.
        constants: Its choices.
        place: The author's line.

    Raises:
        SceneValueError: A number is beyond its limit in some cell, or its range is not known.
    """
    varied = varied_in(child)
    if not varied:
        return child
    if rule in (REPEAT_MIRRORED, REPEAT_MIRRORED_FLAT):
        refuse(
            f"mirrored copies match only if all are alike; '{varied[0].label}' depends on the cell",
            "leave out mirrored=True; neighbours=1 for a shape that is larger than its cell",
            place,
        )
    try:
        np = imported("numpy")
    except PackageError:  # without NumPy, scenes are only compiled to text
        refuse(
            "numbers that depend on the cell need NumPy, for the box around all cells", None, place
        )
    around = Node(rule, rule.lies_flat(child.flat), (child,), numbers, constants, place)
    function = _BoundsInCells(child, varied)
    ends = executor().sweep(function, (_cells(around, np), *function.random_columns(np)))
    spans = [(_least(np, low), _most(np, high)) for low, high in ends]
    count = sum(component_count(type) for type in packed_types(child.flat))
    _check(varied, spans[count:], rule, place)
    found = _bounds(spans[:count], flat=child.flat)
    return Node(IN_CELLS, child.flat, (child,), found, place=child.place)


def _least(np: Any, ends: Any) -> float:
    return float(np.min(ends))


def _most(np: Any, ends: Any) -> float:
    return float(np.max(ends))


def _cells(around: Node, np: Any) -> Any:
    """Return the cells of a repetition: one row each, or the two ends of all as one row."""
    low, high = [-math.inf] * 3, [math.inf] * 3
    rule = around.rule
    assert isinstance(rule, Operator)
    if rule.cells is not None:
        ends = executor().sweep(_CellsOf(around), ())
        low = [_least(np, end) for end, _ in ends[:3]]
        high = [_most(np, end) for _, end in ends[3:]]
    low = [a if abs(a) < ENDLESS else -math.inf for a in low]
    high = [b if abs(b) < ENDLESS else math.inf for b in high]
    sides = [b - a + 1.0 for a, b in zip(low, high, strict=True)]
    if math.prod(sides) <= _MOST_CELLS:
        ranges = [range(round(a), round(b) + 1) for a, b in zip(low, high, strict=True)]
        return np.array(list(product(*ranges)), np.float64)
    return np.array([low]), np.array([high])


def _check(
    varied: Sequence[VariedNumber], spans: Sequence[tuple[float, float]], rule: Operator, place: Any
) -> None:
    """Refuse numbers that are beyond their limit in some cell, or may be infinite."""
    at = 0
    for each in varied:
        type = each.number.number.type
        if not _is_float(type):
            at += 1
            continue
        for low, high in spans[at : at + component_count(type)]:
            for word, end in (("down", low), ("up", high)):
                if not abs(end) < ENDLESS:
                    refuse(
                        f"'{each.label}' has no known limit in the cells of {rule.name}",
                        "limit it: clamp(…, low, high) of distal.lang, or % for a pattern that "
                        "returns; a parameter needs low= and high=",
                        each.node.place,
                    )
                wrong = complaint(end, each.limit)
                if wrong is not None:
                    refuse(
                        f"'{each.label}' must be {wrong}; in the cells of {rule.name} it goes "
                        f"{word} to {end:.6g}",
                        None,
                        each.node.place,
                    )
        at += component_count(type)


def _is_float(type: Type) -> bool:
    return type is FLOAT or (isinstance(type, Vector) and type.kind is Kind.FLOAT)


def _bounds(spans: Sequence[tuple[float, float]], *, flat: bool) -> dict[str, Number]:
    """Return the numbers of the operator ``IN_CELLS`` from the ends of the packed bounds."""
    found: dict[str, Number] = {}
    at = 0
    for name, type in zip(BOUNDS_IN_CELLS, packed_types(flat), strict=True):
        size = component_count(type)
        side = 0 if name == "low" else 1
        ends = [_bounded(span[side]) for span in spans[at : at + size]]
        found[name] = Number(type, ends[0] if size == 1 else tuple(ends))
        at += size
    return found


def _bounded(end: float) -> float:
    return end if abs(end) < UNBOUNDED else math.copysign(UNBOUNDED, end)


class _BoundsInCells(Composed):
    """The bounds of a shape and its numbers that differ, as a function of the cell."""

    def __init__(self, node: Node, varied: Sequence[VariedNumber]) -> None:
        self.name = f"bounds of {node.rule.name} in its cells"
        self._node, self._varied = node, varied
        expressions = (each.number.expression for each in varied)
        self._random = sorted(frozenset().union(*map(random_numbers_in, expressions)))
        random = ((f"random_{i}", FLOAT) for i in range(len(self._random)))
        self.signature = ((CELL, VEC3), *random)
        numbers = (each.number.number.type for each in varied)
        self.result: Type = tuple_type((*packed_types(node.flat), *numbers))

    def random_columns(self, np: Any) -> Sequence[Any]:
        """Return the ends of the parameters that stand for random numbers."""
        return ((np.zeros(1), np.ones(1)),) * len(self._random)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        params = [Param(name, type) for name, type in self.signature]
        cell, *random = (Read(param.name, param.type) for param in params)
        site = {CELL: cell, **dict(zip(self._random, random, strict=True))}
        values = Values(assembly, site)
        body = StatementList(taken={param.name for param in params})
        found = BoundsComposer(values).of(body, self._node, values.all(self._node))
        packed = body.let("packed", found.packed(body))
        count = len(packed_types(self._node.flat))
        parts = [field(packed, f"item{i}") for i in range(count)]
        parts += [each.number.emit(values, site) for each in self._varied]
        body.statements.append(Return(Construct(tuple(parts), self.result)))
        return assembly.define("in_cells", params, self.result, body.statements)


class _CellsOf(Composed):
    """The least and the largest index of the cells of a repetition."""

    signature = ()
    result = tuple_type((VEC3, VEC3))

    def __init__(self, node: Node) -> None:
        self.name = f"cells of {node.rule.name}"
        self._node = node

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        rule = self._node.rule
        assert isinstance(rule, Operator) and rule.cells is not None
        values, body = Values(assembly), StatementList()
        own, _ = values.split(self._node, values.all(self._node))
        cells = body.let("cells", assembly.call(rule.cells, own))
        parts = field(cells, "low"), field(cells, "high")
        body.statements.append(Return(Construct(parts, self.result)))
        return assembly.define("cells", (), self.result, body.statements)
