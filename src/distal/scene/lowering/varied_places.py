"""Bounds of a shape whose numbers differ from place to place: ``Sphere(0.5 + 0.1 * place.y)``.

Input: a node with such numbers. Output: the node below the operator ``fields.place.within``, which
holds its box and its slope. Both are computed once, by intervals, for all times and all values of
the parameters in their limits.

- The box is that of the numbers' ranges: first for points anywhere, then for points in that box.
- The slope is that of the shape with constant numbers, and what it grows by because the numbers
  change: ``runtime.number_slopes``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final, NoReturn, TypeAlias

from distal.fields.boxes import given_slope
from distal.fields.guarantees import ENDLESS, UNBOUNDED, Operator, Primitive
from distal.fields.place.within import WITHIN, WITHIN_FLAT
from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import Construct, Expr, Param, Read, Return
from distal.ir.types import FLOAT, VEC2, VEC3, Struct, Type, tuple_type
from distal.lang.composed import Composed
from distal.lang.places import CELL, POINT, random_numbers_in
from distal.lang.runtime_access import executor
from distal.packages import PackageError, imported
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.varied_cells import (
    BoundsOfVaried,
    SweptBounds,
    any_cell,
    refuse_beyond,
)
from distal.scene.tree.conversion import Number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values
from distal.scene.tree.varying import VariedNumber, VaryingNumber, varied_in
from distal.tape.tape import TapeError

# How often the box is made smaller by what numbers are within it.
_ROUNDS: Final = 4
# How much larger than needed the box is, for the longest of its sides.
_MARGIN: Final = 0.01

Corner: TypeAlias = "tuple[float, ...]"


def with_bounds_of_places(node: Node) -> Node:
    """Return a shape below an operator that holds bounds for all places.

    It is the same node if none of its own numbers depends on the place.

    Raises:
        SceneValueError: A number is beyond its limit somewhere, or no bound is known.
    """
    own = [v for v in node.constants.values() if isinstance(v, VaryingNumber) and POINT in v.uses]
    if not own:
        return node
    rule = node.rule
    if isinstance(rule, Operator) and (rule.around is not None or rule.cells is not None):
        refuse(
            f"'{own[0].name} of {rule.name}' cannot depend on the place: the shape is evaluated at "
            "several points",
            "Shape.from_function, with a slope of your own",
            node.place,
        )
    try:
        np = imported("numpy")
    except PackageError:  # without NumPy, scenes are only compiled to text
        refuse(
            "numbers that depend on the place need NumPy, for the box and the slope",
            None,
            node.place,
        )
    low, high, slope = _box(node, varied_in(node), np)
    slope += _added_slope(node, own, low, high, np)
    if not slope < ENDLESS:
        _refuse_slope(own, f"the slope of '{rule.name}' has no end", node)
    type = VEC2 if node.flat else VEC3
    numbers = {
        "low": Number(type, low),
        "high": Number(type, high),
        "steepness": Number(FLOAT, max(slope, 1.0)),
    }
    around = WITHIN_FLAT if node.flat else WITHIN
    return Node(around, node.flat, (node,), numbers, place=node.place)


def _box(node: Node, varied: Sequence[VariedNumber], np: Any) -> tuple[Corner, Corner, float]:
    """Return the box of a shape, and a bound on the slope within it with constant numbers."""
    size = 2 if node.flat else 3
    function = BoundsOfVaried(node, varied, in_place=True)

    def swept(low: Corner, high: Corner) -> SweptBounds:
        return function.swept(np, any_cell(np), (np.array([low]), np.array([high])))

    low, high = (-math.inf,) * size, (math.inf,) * size
    for _ in range(_ROUNDS):
        found = swept(low, high)
        if (found.low, found.high) == (low, high):
            break
        low, high = found.low, found.high
    low, high = _widened(low, high)
    found = swept(low, high)
    in_cells = any(CELL in each.number.uses for each in varied)
    where = "where the shape may be, in any cell" if in_cells else "where the shape may be"
    refuse_beyond(varied, found.numbers, where, "a wave: sin of distal.lang")
    return low, high, found.slope


def _widened(low: Corner, high: Corner) -> tuple[Corner, Corner]:
    """Return a box that is larger by a share of its longest side that has an end.

    A ray ends a little before the surface. There the field has to be that of the shape, too, so
    that a shape that touches its box has no flat place.
    """
    ended = [b - a for a, b in zip(low, high, strict=True) if b - a < ENDLESS]
    by = _MARGIN * max(ended, default=0.0)
    return tuple(max(a - by, -UNBOUNDED) for a in low), tuple(min(b + by, UNBOUNDED) for b in high)


def _added_slope(
    node: Node, own: Sequence[VaryingNumber], low: Corner, high: Corner, np: Any
) -> float:
    """Return by how much the slope grows because numbers change from place to place."""
    children = (
        BoundsOfVaried(child, varied_in(child)).swept(np, any_cell(np)) for child in node.children
    )
    inner = [(child.slope, child.low, child.high) for child in children]
    numbers, shape = NumbersInPlace(node, own), ShapeOfNumbers(node, own)
    known = node.rule.changes if isinstance(node.rule, Operator) else {}
    changes = [known.get(number.name) for number in own]
    is_own = isinstance(node.rule, Primitive) and node.rule.slope is given_slope
    try:
        return executor().added_slope(
            numbers, shape, changes, numbers.unknown, inner, (low, high), own=is_own
        )
    except TapeError as error:
        _refuse_slope(own, f"no bound on its slope is known: {error}", node)


def _refuse_slope(own: Sequence[VaryingNumber], why: str, node: Node) -> NoReturn:
    names = " and ".join(f"'{number.name} of {node.rule.name}'" for number in own)
    refuse(
        f"{names} cannot depend on the place here: {why}",
        "limit how fast the number changes, or write Shape.from_function with a slope",
        node.place,
    )


class _OfPlace(Composed):
    """A function of a point, perhaps of numbers, the cell, and random numbers."""

    def __init__(self, node: Node, own: Sequence[VaryingNumber]) -> None:
        self.name = f"numbers of {node.rule.name}"
        self._node, self._own = node, own
        held = (number.expression for number in own)
        self._random = sorted(frozenset().union(*map(random_numbers_in, held)))
        random: list[tuple[str, Type]] = [(f"random_{i}", FLOAT) for i in range(len(self._random))]
        self._unknown: list[tuple[str, Type]] = [(CELL, VEC3), *random]
        self._point = VEC2 if node.flat else VEC3

    def _site(self) -> dict[str, Expr]:
        names = (POINT, CELL, *self._random)
        reads = (Read("p", self._point), *(Read(*slot) for slot in self._unknown))
        return dict(zip(names, reads, strict=True))


class NumbersInPlace(_OfPlace):
    """The numbers of a shape that depend on the place, as a function of the point.

    Attributes:
        unknown: The ends of the components of the other arguments: the cell, random numbers.
    """

    def __init__(self, node: Node, own: Sequence[VaryingNumber]) -> None:
        """Take the shape, and those of its numbers that depend on the place."""
        super().__init__(node, own)
        self.signature = (("p", self._point), *self._unknown)
        self.result: Type = tuple_type(tuple(number.number.type for number in own))
        random = ([(0.0, 1.0)] for _ in self._random)
        self.unknown = [[(-math.inf, math.inf)] * 3, *random]

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        params = [Param(name, type) for name, type in self.signature]
        values = Values(assembly)
        parts = tuple(number.emit(values, self._site()) for number in self._own)
        result = Return(Construct(parts, self.result))
        return assembly.define("numbers", params, self.result, (result,))


class ShapeOfNumbers(_OfPlace):
    """A shape as a function of the point and of its numbers that depend on the place.

    Shapes below an operator are values that it is called with. It returns the point at which they
    are evaluated, and the value; of a shape of the library only the value.
    """

    def __init__(self, node: Node, own: Sequence[VaryingNumber]) -> None:
        """Take the shape, and those of its numbers that depend on the place."""
        super().__init__(node, own)
        numbers = ((f"number_{i}", number.number.type) for i, number in enumerate(own))
        inner = ((f"inner_{i}", FLOAT) for i in range(len(node.children)))
        self.signature = (("p", self._point), *numbers, *self._unknown, *inner)
        moved = (VEC2 if node.children[0].flat else VEC3,) if node.children else ()
        self.result: Type = tuple_type((*moved, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        node, rule = self._node, self._node.rule
        params = [Param(name, type) for name, type in self.signature]
        values = Values(assembly, self._site())
        body = StatementList(taken={param.name for param in params})
        given, shares = values.split(node, values.all(node))
        names = {id(n): name for name, n in node.constants.items() if isinstance(n, VaryingNumber)}
        for i, number in enumerate(self._own):
            given[names[id(number)]] = Read(f"number_{i}", number.number.type)
        p = Read("p", self._point)
        given |= {"p": p, "cell": Read(CELL, VEC3)}
        if node.children:
            given |= BoundsComposer(values).given(body, node, shares)
        if isinstance(rule, Primitive):
            parts: tuple[Expr, ...] = (assembly.call(rule.distance, given),)
        else:
            parts = self._of_operator(values, body, rule, given, shares)
        body.statements.append(Return(Construct(parts, self.result)))
        return assembly.define("shape_of_numbers", params, self.result, body.statements)

    def _of_operator(
        self,
        values: Values,
        body: StatementList,
        rule: Operator,
        given: dict[str, Expr],
        shares: Sequence[Sequence[Expr]],
    ) -> tuple[Expr, ...]:
        assembly = values.assembly
        inner: Expr = given["p"]
        if rule.point is not None:
            inner = body.let("inner", assembly.call(rule.point, given))
            if isinstance(inner.type, Struct):
                inner = field(inner, "p")
        first, *others = (Read(f"inner_{i}", FLOAT) for i in range(len(self._node.children)))
        d: Expr = first
        steps = BoundsComposer(values).steps(body, self._node, shares, given)
        for other, bounds in zip(others, steps, strict=True):
            assert rule.combine is not None
            d = body.let("d", assembly.call(rule.combine, {**given, **bounds, "a": d, "b": other}))
        if rule.finish is not None:
            d = body.let("d", assembly.call(rule.finish, {**given, "d": d}))
        return inner, d
