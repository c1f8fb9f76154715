"""Bounds of a shape whose numbers differ from cell to cell, for all cells of a repetition.

Input: the shape, and the repetition that is applied to it. Output: the shape below an operator that
holds one box, slope and growth for all cells. They are computed once, by intervals: for each cell
if there are few, else for all at once; for all times and all values of the parameters in their
limits. The same intervals check the limits of the numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from distal.diagnostics import Span
from distal.fields.guarantees import ENDLESS, UNBOUNDED, Operator
from distal.fields.repeat.flat import REPEAT_MIRRORED_FLAT
from distal.fields.repeat.grid import REPEAT_MIRRORED
from distal.fields.repeat.varied import BOUNDS_IN_CELLS, IN_CELLS
from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Expr, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Kind, Type, Vector, component_count, tuple_type
from distal.lang.composed import Composed
from distal.lang.places import CELL, POINT, random_numbers_in
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

Spans: TypeAlias = "Sequence[tuple[float, float]]"

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
            "leave out mirrored=True; neighbors=1 for a shape that is larger than its cell",
            place,
        )
    try:
        np = imported("numpy")
    except PackageError:  # without NumPy, scenes are only compiled to text
        refuse(
            "numbers that depend on the cell need NumPy, for the box around all cells", None, place
        )
    around = Node(rule, rule.lies_flat(child.flat), (child,), numbers, constants, place)
    function = BoundsOfVaried(child, varied)
    swept = function.swept(np, _cells(around, np))
    refuse_beyond(varied, swept.numbers, f"in the cells of {rule.name}")
    found = _bounds(swept.bounds, flat=child.flat)
    return Node(IN_CELLS, child.flat, (child,), found, place=child.place)


def _cells(around: Node, np: Any) -> Any:
    """Return the cells of a repetition: one row each, or the two ends of all as one row."""
    low: Sequence[float] = [-math.inf] * 3
    high: Sequence[float] = [math.inf] * 3
    rule = around.rule
    assert isinstance(rule, Operator)
    if rule.cells is not None:
        ends = executor().sweep(_CellsOf(around), ())
        low = [float(np.min(end)) for end, _ in ends[:3]]
        high = [float(np.max(end)) for _, end in ends[3:]]
    low, high = _open_ended(low), _open_ended(high, math.inf)
    sides = [b - a + 1.0 for a, b in zip(low, high, strict=True)]
    if math.prod(sides) <= _MOST_CELLS:
        ranges = [range(round(a), round(b) + 1) for a, b in zip(low, high, strict=True)]
        return np.array(list(product(*ranges)), np.float64)
    return np.array([low]), np.array([high])


def _open_ended(ends: Iterable[float], without: float = -math.inf) -> tuple[float, ...]:
    """Return ends, infinite (``without``) where there is none."""
    return tuple(end if abs(end) < ENDLESS else without for end in ends)


def any_cell(np: Any) -> Any:
    """Return the two ends of all cells that there are."""
    return np.full((1, 3), -math.inf), np.full((1, 3), math.inf)


def refuse_beyond(
    varied: Sequence[VariedNumber],
    spans: Spans,
    where: str,
    instead: str = "% for a pattern that returns",
) -> None:
    """Refuse numbers that are beyond their limit somewhere, or may be infinite.

    Args:
        varied: The numbers.
        spans: The ends of each of their components.
        where: Where the numbers are between these ends.
        instead: For the hint: another way to limit them than ``clamp``.

    Raises:
        SceneValueError: At the line of the shape with the number.
    """
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
                        f"'{each.label}' has no known limit {where}",
                        f"limit it: clamp(…, low, high) of distal.lang, or {instead}; a parameter "
                        "needs low= and high=",
                        each.node.place,
                    )
                wrong = complaint(end, each.limit)
                if wrong is not None:
                    refuse(
                        f"'{each.label}' must be {wrong}; {where} it goes {word} to {end:.6g}",
                        None,
                        each.node.place,
                    )
        at += component_count(type)


def _is_float(type: Type) -> bool:
    return type is FLOAT or (isinstance(type, Vector) and type.kind is Kind.FLOAT)


def _bounds(spans: Spans, *, flat: bool) -> dict[str, Number]:
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


@dataclass(frozen=True, slots=True)
class SweptBounds:
    """What the bounds of a shape and its numbers are between.

    Attributes:
        bounds: The ends of the components of the packed bounds.
        numbers: The ends of the components of the numbers.
        size: The number of axes.
    """

    bounds: Spans
    numbers: Spans
    size: int

    @property
    def slope(self) -> float:
        """The largest slope."""
        return self.bounds[0][1]

    @property
    def low(self) -> tuple[float, ...]:
        """The lower corner of a box around all boxes; -inf where it has no end."""
        return _open_ended(a for a, _ in self.bounds[2 : 2 + self.size])

    @property
    def high(self) -> tuple[float, ...]:
        """The upper corner; inf where it has no end."""
        corner = self.bounds[2 + self.size : 2 + 2 * self.size]
        return _open_ended((b for _, b in corner), math.inf)


class BoundsOfVaried(Composed):
    """The bounds of a shape and its numbers that differ, as a function of the cell and the point.

    Args:
        node: The shape.
        varied: The numbers.
        in_place: Whether the numbers may depend on the point.
    """

    def __init__(
        self, node: Node, varied: Sequence[VariedNumber], *, in_place: bool = False
    ) -> None:
        self.name = f"bounds of {node.rule.name}"
        self._node, self._varied = node, varied
        expressions = (each.number.expression for each in varied)
        self._random = sorted(frozenset().union(*map(random_numbers_in, expressions)))
        point = ((POINT, VEC2 if node.flat else VEC3),) if in_place else ()
        random = ((f"random_{i}", FLOAT) for i in range(len(self._random)))
        self.signature = ((CELL, VEC3), *point, *random)
        numbers = (each.number.number.type for each in varied)
        self.result: Type = tuple_type((*packed_types(node.flat), *numbers))

    def swept(self, np: Any, *columns: Any) -> SweptBounds:
        """Return what the bounds and the numbers are between.

        Args:
            np: NumPy.
            columns: The cells, and the points.
        """
        random = ((np.zeros(1), np.ones(1)),) * len(self._random)
        ends = executor().sweep(self, (*columns, *random))
        spans = [(float(np.min(low)), float(np.max(high))) for low, high in ends]
        count = sum(map(component_count, packed_types(self._node.flat)))
        return SweptBounds(spans[:count], spans[count:], 2 if self._node.flat else 3)

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        params = [Param(name, type) for name, type in self.signature]
        names = (CELL, *((POINT,) if POINT in dict(self.signature) else ()), *self._random)
        reads = (Read(param.name, param.type) for param in params)
        site: dict[str, Expr] = dict(zip(names, reads, strict=True))
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
