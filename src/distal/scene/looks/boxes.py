"""The box of what a picture shows, as plain numbers, computed with the standard library alone.

Input: a tree of shapes, values of its parameters, a time. Output: the corners of a finite box. The
bounds of a tree are scene code: here they are compiled with every number as a constant, and the
compiler's own folding computes them (5 ms for a shape, 0.1 s for a bunny of twenty).
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from distal.compiler.constant_functions import evaluate
from distal.fields.guarantees import ended
from distal.frontend import Assembly, lower
from distal.ir.build import field
from distal.ir.nodes import FRAME_TIME, Construct, Expr, Return, Uniform
from distal.ir.types import VEC3, Type, tuple_type
from distal.ir.walk import nodes_in, substitute
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.runtime_access import executor
from distal.packages import PackageError
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.parts.table import rolled, with_boxes
from distal.scene.lowering.union_parts import is_placed, parts_of, placed_parts_of
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values

# Length at which an infinite shape is cut, along each axis, if the scene has no finite one.
REACH: Final = 2.0

# The boxes of more parts are not folded, but computed together by NumPy.
MOST_FOLDED: Final = 255

Corners: TypeAlias = "tuple[tuple[float, ...], tuple[float, ...]]"


@dataclass(frozen=True, slots=True, eq=False)
class SubjectBox:
    """The box of what a picture shows.

    Attributes:
        low: Lower corner.
        high: Upper corner.
        endless: The parts of the scene that are infinite, such as planes: each as it is placed,
            and itself.
        cut: Whether the box is that of an infinite part, cut.
        parts: The finite parts and their boxes; none if they are too many to look at each.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    endless: tuple[tuple[Node, Node], ...]
    cut: bool
    parts: tuple[tuple[Node, Corners], ...] = ()

    @property
    def middle(self) -> tuple[float, ...]:
        """The middle of the box."""
        return tuple((a + b) / 2.0 for a, b in zip(self.low, self.high, strict=True))

    @property
    def half_size(self) -> tuple[float, ...]:
        """Half of its size."""
        return tuple((b - a) / 2.0 for a, b in zip(self.low, self.high, strict=True))

    @property
    def radius(self) -> float:
        """Half of its diagonal; above 0."""
        return max(math.dist(self.low, self.high) / 2.0, 1e-9)


def subject_box(root: Node, params: Mapping[str, Any], time: float) -> SubjectBox:
    """Return the box around the finite parts of a scene.

    Parts are the members of the union at the root, also below a placement if one is infinite. If
    all of them are infinite, the box of the whole is cut.

    Args:
        root: The scene's shape; not flat.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
    """
    if root.parts > MOST_FOLDED:
        root = with_boxes(root)
    parts = sources = list(parts_of(root))
    if root.parts > MOST_FOLDED and (table := rolled(root)).table is not None:
        parts = list(parts_of(table.node))
        sources = [table.node, *(member.source for member, _ in table.beside)]
    known = list(zip(sources, _boxes(parts, params, time), strict=True))
    own: dict[int, Node] = {}
    placed = [p for p, box in known if box is not None and not _is_finite(*box) and is_placed(p)]
    if placed:
        pairs = [pair for part in placed for pair in placed_parts_of(part)]
        own = {id(member): node for member, node in pairs}
        members = [member for member, _ in pairs]
        whole = set(map(id, placed))
        known = [(part, box) for part, box in known if id(part) not in whole]
        known += zip(members, _boxes(members, params, time), strict=True)
    parts_there = [(part, box) for part, box in known if box is not None and _is_finite(*box)]
    finite = [box for _, box in parts_there]
    infinite = [part for part, box in known if box is not None and not _is_finite(*box)]
    endless = tuple((part, own.get(id(part), part)) for part in infinite)
    if finite:
        low = tuple(map(min, zip(*(low for low, _ in finite), strict=True)))
        high = tuple(map(max, zip(*(high for _, high in finite), strict=True)))
        few = () if root.parts > MOST_FOLDED else tuple(parts_there)
        return SubjectBox(low, high, endless, cut=False, parts=few)
    around = _boxes([root], params, time)[0] or ((-math.inf,) * 3, (math.inf,) * 3)
    sides = [_cut(a, b) for a, b in zip(*around, strict=True)]
    return SubjectBox(tuple(a for a, _ in sides), tuple(b for _, b in sides), endless, cut=True)


def plain_number(number: Number, params: Mapping[str, Any], time: float) -> Any:
    """Return a number's value for values of its parameters and a time: a float or a tuple.

    Args:
        number: The number.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
    """
    if number.plain is not None:
        return number.plain
    found = _computed(_NumberAt(number, params, time))
    return 0.0 if found is None else found


def _is_finite(low: tuple[float, ...], high: tuple[float, ...]) -> bool:
    return all(map(math.isfinite, (*low, *high)))


def _cut(low: float, high: float) -> tuple[float, float]:
    """Return the sides of a box along one axis, cut where they are infinite."""
    if math.isfinite(low) and math.isfinite(high):
        return low, high
    if math.isfinite(high):
        return high - REACH, high
    return (low, low + REACH) if math.isfinite(low) else (-REACH, REACH)


def _boxes(nodes: Sequence[Node], params: Mapping[str, Any], time: float) -> list[Corners | None]:
    """Return the corners of subtrees' boxes; None if nothing is in one, or it is not known."""
    found = _computed(_BoxesAt(nodes, params, time))
    if found is None:
        return [None] * len(nodes)
    corners = [tuple(map(ended, corner)) for corner in found]
    pairs = zip(corners[::2], corners[1::2], strict=True)
    return [(a, b) if all(map(operator.le, a, b)) else None for a, b in pairs]


def _computed(program: Composed) -> Any:
    """Return the value of a function without arguments; None if it is not known.

    Boxes of data, such as of a height field, need NumPy.
    """
    found = evaluate(lower(program))
    if found is not None:
        return found
    try:
        return executor().call(program, (), {}, device="reference")
    except PackageError:
        return None


class _ConstantValues(Values):
    """The numbers of nodes as constants, at one time and for one set of parameter values."""

    def __init__(self, assembly: Assembly, params: Mapping[str, Any], time: float) -> None:
        super().__init__(assembly)
        self._params, self._time = params, time

    def own(self, node: Node) -> tuple[Expr, ...]:
        """Return the values of a node's own numbers."""
        return tuple(self.constant(number) for number in node.numbers.values())

    def fixed(self, stem: str, type: Type, value: Any) -> Expr:
        """Return a number that no author can change as a constant."""
        return self.assembly.constant(value, type)

    def constant(self, number: Number) -> Expr:
        """Return a number as a constant."""
        value = number.value
        if not isinstance(value, Expression):
            return self.assembly.constant(value, number.type)
        known = {p.name: self._params_value(p) for p in value.parameters}
        found = self.assembly.expression(value)
        replacements: dict[Expr, Expr] = {}
        for e in nodes_in(found):
            if isinstance(e, Uniform):
                held = self._time if e.name == FRAME_TIME else known[e.name]
                replacements[e] = self.assembly.constant(held, e.type)
        return substitute(found, replacements, {})

    def _params_value(self, parameter: Any) -> Any:
        given = self._params.get(parameter.name, self._params.get(parameter.label))
        return parameter.default if given is None else parameter.check(given)


class _BoxesAt(Composed):
    """The corners of several boxes, as a function without arguments or uniforms."""

    name, signature = "boxes", ()

    def __init__(self, nodes: Sequence[Node], params: Mapping[str, Any], time: float) -> None:
        self._nodes, self._params, self._time = nodes, params, time
        self.result = tuple_type((VEC3, VEC3) * len(nodes))

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        body = StatementList()
        values = _ConstantValues(assembly, self._params, self._time)
        composer = BoundsComposer(values)
        corners: list[Expr] = []
        for node in self._nodes:
            found = composer.of(body, node, values.all(node)).emptied(body, assembly.call)
            box = body.let("box", found.bounds)
            corners += [field(box, "low"), field(box, "high")]
        body.statements.append(Return(Construct(tuple(corners), self.result)))
        return assembly.define(self.name, (), self.result, body.statements)


class _NumberAt(Composed):
    """A number's value, as a function without arguments or uniforms."""

    name, signature = "number", ()

    def __init__(self, number: Number, params: Mapping[str, Any], time: float) -> None:
        self._number, self._params, self._time = number, params, time
        self.result: Type = number.type

    def compose(self, assembly: Assembly) -> str:
        """Add the function, and return its name."""
        values = _ConstantValues(assembly, self._params, self._time)
        body = (Return(values.constant(self._number)),)
        return assembly.define(self.name, (), self.result, body)
