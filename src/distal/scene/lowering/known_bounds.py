"""Bounds of shapes as plain numbers, available on construction of a shape.

Input: a node. Output: its slope, box and growth for the parameters' defaults. The bounds of each
operator are computed from those of its children, once for each node, by a function that all
operators of the same kind share: making a shape does not compile its children again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final
from weakref import WeakKeyDictionary

from distal.fields.combine.alternatives import NOTHINGS, SELECT
from distal.fields.guarantees import Bounds, Bounds2, Primitive
from distal.frontend import Assembly
from distal.ir.nodes import Construct, Param, Read, Return
from distal.ir.types import Type, tuple_type
from distal.lang.composed import Composed
from distal.lang.expressions import Expression
from distal.lang.resources import Buffer, TextureValue
from distal.lang.runtime_access import executor
from distal.packages import imported
from distal.scene.lowering.bounds import PACKED, BoundsComposer, ShapeBounds, packed_types
from distal.scene.tree.conversion import NO_VALUES
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values
from distal.session import SESSION

# Size of the cache of functions; those of nodes with textures or buffers are not cached.
MOST_KEPT: Final = 512


@dataclass(frozen=True, slots=True)
class KnownBounds:
    """Bounds as plain numbers; see ``bounds.ShapeBounds``."""

    slope: float
    divisor: float
    low: tuple[float, ...]
    high: tuple[float, ...]
    growth: float
    side_growth: float


_known: WeakKeyDictionary[Node, KnownBounds] = SESSION.keep("bounds", WeakKeyDictionary())
_bounds_steps: dict[Any, _BoundsStep] = SESSION.keep("steps of bounds", {})


def known_bounds_of(node: Node) -> KnownBounds:
    """Return a node's bounds for the parameters' defaults at time 0.

    Raises:
        PackageError: NumPy is missing or broken.
    """
    # Children first, without recursion: a chain can be longer than Python's recursion limit.
    for part in reversed(list(node.walk())):
        if part not in _known:
            _known[part] = _computed(part)
    return _known[node]


def bounds_with(node: Node, name: str, value: float) -> KnownBounds:
    """Return a node's bounds with another value of one of its numbers.

    Args:
        node: The node, an operator on one shape.
        name: The name of the number.
        value: Its value.
    """
    return _call(node, [known_bounds_of(child) for child in node.children], {name: value})


def _computed(node: Node) -> KnownBounds:
    if (shown := _shown(node)) is not None:
        return known_bounds_of(shown)
    inner = [known_bounds_of(child) for child in node.children]
    if len(inner) < 2:
        return _call(node, inner)
    # Combine many children pairwise, as in a program.
    result = inner[0]
    for other in inner[1:]:
        result = _call(node, [result, other])
    return result


def _shown(node: Node) -> Node | None:
    """Return the shape that is selected, or nothing is: a shape is checked as if it were shown."""
    if node.rule is not SELECT:
        return None
    first, second = node.children
    if first.rule in NOTHINGS:
        return second
    return first if second.rule in NOTHINGS else None


def _call(
    node: Node, inner: Sequence[KnownBounds], changed: Mapping[str, float] = NO_VALUES
) -> KnownBounds:
    np = imported("numpy")  # only what runs scene code needs it

    args: list[Any] = []
    for bounds in inner:
        args += [getattr(bounds, part) for part in PACKED]
    args += [changed.get(n, _plain(number.value)) for n, number in node.numbers.items()]
    doubles = tuple(np.asarray(arg, _dtype(arg, np))[None] for arg in args)
    found = executor().call(_bounds_step(node, len(inner)), doubles, {}, device="reference")
    # A shape without numbers is a function without arguments: its results have no axis of rows.
    first = [np.asarray(part, np.float64)[0 if doubles else ...].tolist() for part in found]
    slope, divisor, low, high, growth, side_growth = first
    return KnownBounds(slope, divisor, tuple(low), tuple(high), growth, side_growth)


def _dtype(value: Any, np: Any) -> Any:
    if isinstance(value, bool):
        return np.bool_
    return np.int32 if isinstance(value, int) else np.float64


def _plain(value: Any) -> Any:
    if not isinstance(value, Expression):
        return value
    found = executor().value(value, {}, 0.0)
    return found if isinstance(found, float | int) else tuple(found)


def _bounds_step(node: Node, count: int) -> _BoundsStep:
    """Return the function for nodes of this kind."""
    data = any(isinstance(v, Buffer | TextureValue) for v in node.constants.values())
    choices = tuple((n, getattr(v, "value", v)) for n, v in node.constants.items())
    types = tuple((n, number.type) for n, number in node.numbers.items())
    key = (node.rule, count, node.flat, types, choices)
    if data:
        return _BoundsStep(node, count)
    found = _bounds_steps.get(key)
    if found is None:
        if len(_bounds_steps) >= MOST_KEPT:
            _bounds_steps.clear()
        found = _bounds_steps[key] = _BoundsStep(node, count)
    return found


class _BoundsStep(Composed):
    """The bounds of a primitive from its numbers, or of an operator from its children's bounds."""

    def __init__(self, node: Node, count: int) -> None:
        flat_inner = [child.flat for child in node.children[:count]]
        own = {name: number.type for name, number in node.numbers.items()}
        self.name = f"bounds of {node.rule.name}"
        self._rule, self._constants = node.rule, node.constants
        self._flat, self._flat_inner, self._own = node.flat, flat_inner, own
        inner = [p for i, flat in enumerate(flat_inner) for p in _signature(f"_{i}", flat)]
        self.signature = (*inner, *own.items())
        self.result = tuple_type(packed_types(node.flat))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        values = Values(assembly)
        body = StatementList(taken={name for name, _ in self.signature})
        numbers = {name: Read(name, type) for name, type in self._own.items()}
        own = values.complete(self._rule, numbers, self._constants, self.name)
        inner = [_read(assembly, f"_{i}", flat) for i, flat in enumerate(self._flat_inner)]
        composer = BoundsComposer(values)
        if isinstance(self._rule, Primitive):
            found = composer.of_primitive(body, self._rule, own, flat=self._flat)
        else:
            found = composer.of_operator(body, self._rule, inner, own)
        body.statements.append(Return(found.packed(body)))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("bounds", params, self.result, body.statements)


def _signature(suffix: str, flat: bool) -> list[tuple[str, Type]]:
    parts = zip(PACKED, packed_types(flat), strict=True)
    return [(f"child_{part}{suffix}", type) for part, type in parts]


def _read(assembly: Assembly, suffix: str, flat: bool) -> ShapeBounds:
    slope, divisor, low, high, growth, side_growth = (
        Read(name, type) for name, type in _signature(suffix, flat)
    )
    box = Construct((low, high), assembly.struct(Bounds2 if flat else Bounds))
    return ShapeBounds(slope, divisor, box, growth, side_growth)
