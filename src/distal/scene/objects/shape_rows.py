"""Shapes in pickles: their trees as rows, each node once and after its children.

Input: values with shapes in them. Output: rows and the values, with references to rows in place of
shapes; and from both the values again. Trees may be deep: nothing here follows them by recursion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple, TypeAlias

from distal.ir.types import FLOAT, VEC2, VEC3, VEC4
from distal.library_stamp import check_stamp, library_stamp
from distal.scene.objects.shape_values import ORIGIN, ShapeValue
from distal.scene.tree.conversion import NO_VALUES, Number
from distal.scene.tree.node import Node
from distal.scene.tree.rules import name_of, rules
from distal.scene.tree.value import CallRecord, state_of

Row: TypeAlias = tuple[Any, ...]
_VECTORS: Final = {2: VEC2, 3: VEC3, 4: VEC4}


class ShapeReference(NamedTuple):
    """A shape: its class, the row of its node, its other attributes."""

    kind: type[ShapeValue]
    row: int
    state: Mapping[str, Any]


class PackedShapes(NamedTuple):
    """Values with shapes in them.

    Attributes:
        stamp: Which library has packed them.
        rows: The nodes of all their shapes.
        value: The values, with references in place of shapes.
    """

    stamp: str
    rows: Sequence[Row]
    value: Any


def packed(value: Any) -> PackedShapes:
    """Return a value that may contain shapes, for a pickle."""
    writer = _RowWriter()
    return PackedShapes(library_stamp(), writer.rows, writer.referring(value))


def unpacked(packed: PackedShapes) -> Any:
    """Return what was packed.

    Raises:
        UnpicklingError: Another version of distal has packed it.
    """
    check_stamp(packed.stamp)
    nodes: list[Node] = []
    for row in packed.rows:
        nodes.append(_node_of(row, nodes))
    return _with_shapes(packed.value, nodes)


class _RowWriter:
    """Rows of nodes; a node that several shapes share has one."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self._numbers: dict[int, int] = {}

    def referring(self, value: Any) -> Any:
        """Return a value with references in place of shapes, whose rows are written."""
        for shape in _shapes_in(value):
            self._write(shape.node)
        return _mapped(value, self._reference)

    def _reference(self, value: Any) -> Any:
        if not isinstance(value, ShapeValue):
            return tuple(value) if isinstance(value, Iterator) else value  # it is used up
        return ShapeReference(type(value), self._numbers[id(value.node)], state_of(value))

    def _write(self, root: Node) -> None:
        waiting = [root]
        while waiting:
            node = waiting[-1]
            if id(node) in self._numbers:
                waiting.pop()
                continue
            missing = [n for n in _below(node) if id(n) not in self._numbers]
            if missing:
                waiting.extend(reversed(missing))
                continue
            waiting.pop()
            self._numbers[id(node)] = len(self.rows)
            self.rows.append(self._row(node))

    def _row(self, node: Node) -> Row:
        origin: CallRecord | None = node.known(ORIGIN)
        return (
            name_of(node.rule) or node.rule,
            node.flat,
            [self._numbers[id(child)] for child in node.children],
            {name: _plain(number) for name, number in node.numbers.items()},
            dict(node.constants) or None,
            node.place,
            node.material,
            node.cut_material,
            node.label,
            None if origin is None else _mapped(origin.parts, self._reference),
        )


def _below(node: Node) -> Iterator[Node]:
    """Yield a node's children, and the nodes of shapes that the call which made it was given."""
    yield from node.children
    origin = node.known(ORIGIN)
    if origin is not None:
        yield from (shape.node for shape in _shapes_in(origin.parts))


def _shapes_in(value: Any) -> Iterator[ShapeValue]:
    if isinstance(value, ShapeValue):
        yield value
    elif type(value) in (tuple, list):
        for each in value:
            yield from _shapes_in(each)
    elif isinstance(value, Mapping):
        yield from _shapes_in(list(value.values()))


def _mapped(value: Any, change: Callable[[Any], Any]) -> Any:
    """Return a value with what is in its tuples, lists and mappings changed."""
    if type(value) in (tuple, list):
        return type(value)(_mapped(each, change) for each in value)
    if isinstance(value, Mapping):
        return {name: _mapped(each, change) for name, each in value.items()}
    return change(value)


def _plain(number: Any) -> Any:
    """Return a constant number as a float or a tuple; another one as it is."""
    is_plain = type(number) is Number and type(number.value) in (float, tuple)
    return number.value if is_plain else number


def _number_of(value: Any) -> Any:
    if type(value) is float:
        return Number(FLOAT, value)
    return Number(_VECTORS[len(value)], value) if type(value) is tuple else value


def _node_of(row: Row, nodes: Sequence[Node]) -> Node:
    rule, flat, children, numbers, constants, *others, parts = row
    node = Node(
        rules()[rule] if isinstance(rule, str) else rule,
        flat,
        tuple([nodes[child] for child in children]),
        {name: _number_of(value) for name, value in numbers.items()},
        NO_VALUES if constants is None else constants,
        *others,
    )
    if parts is not None:
        origin = CallRecord.of_parts(*_with_shapes(parts, nodes))
        node.derived(ORIGIN, lambda: origin)
    return node


def _with_shapes(value: Any, nodes: Sequence[Node]) -> Any:
    """Return a value with shapes in place of references."""
    if isinstance(value, ShapeReference):
        return value.kind._of_tree(nodes[value.row], value.state)
    if type(value) in (tuple, list):
        return type(value)(_with_shapes(each, nodes) for each in value)
    if type(value) is dict:
        return {name: _with_shapes(each, nodes) for name, each in value.items()}
    return value
