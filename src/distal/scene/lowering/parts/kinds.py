"""Kinds of parts: parts of equal structure, which differ in numbers only.

Input: the parts of a union. Output: kinds, each with one tree for all its parts; the numbers that
differ from part to part are columns of a table, also the constants of expressions of parameters
and time. Numbers that are the same in all parts stay numbers of the scene, so that a parameter can
change them.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from distal.fields.guarantees import Operator, Primitive
from distal.frontend import Assembly
from distal.ir.nodes import Expr
from distal.ir.types import FLOAT, Type, Vector
from distal.lang.expressions import Expression
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.lifted import ConstantLifter, with_values
from distal.scene.tree.calls import COLUMN, FunctionCall
from distal.scene.tree.conversion import Number, Plain
from distal.scene.tree.node import Node

# A row begins with the number of its kind and that of the part among those of the kind.
HEAD: Final = 2


@dataclass(frozen=True, slots=True)
class Column:
    """A number that differs from part to part.

    Attributes:
        first: The place of its first float in a row.
        type: float, or a vector of floats.
    """

    first: int
    type: Type

    @property
    def floats(self) -> int:
        """The number of its floats."""
        return self.type.size if isinstance(self.type, Vector) else 1


@dataclass(frozen=True, slots=True)
class ColumnNumber:
    """A number of a kind's tree that has columns: one of its own, or some of its expression.

    Attributes:
        number: The number.
        places: The column of each constant of its expression, None for one that all parts share;
            for a plain number its own column alone.
    """

    number: Number
    places: Sequence[int | None]


@dataclass(frozen=True, slots=True)
class PartKind:
    """Parts of equal structure.

    Attributes:
        node: A tree like those of the parts. Its numbers that have columns are its own objects.
        members: The parts.
        columns: The numbers that differ.
        numbers: The numbers of the tree that have columns.
        width: The number of floats of a row, with its head.
        values: The values of each part, one for each column.
        factor: The place in a row of a number that makes distances of the part's values, if they
            need a divisor.
        moving: Whether the shapes depend on parameters or time.
    """

    node: Node
    members: Sequence[UnionMember]
    columns: Sequence[Column]
    numbers: Sequence[ColumnNumber]
    width: int
    values: Sequence[Sequence[Plain]]
    factor: int | None = None
    moving: bool = False

    @property
    def floats(self) -> int:
        """The number of floats that differ from part to part."""
        return sum(column.floats for column in self.columns)

    @property
    def stride(self) -> int:
        """The number of vec4 of a row."""
        return -(-self.width // 4)

    def with_factor(self) -> PartKind:
        """Return the kind with one more float in its rows, the factor."""
        return replace(self, factor=self.width, width=self.width + 1)

    def read(self, assembly: Assembly, columns: Sequence[Expr]) -> None:
        """Let a program read the numbers that differ from these expressions, one each column."""
        lifter = ConstantLifter()
        for of in self.numbers:
            value = of.number.value
            if isinstance(value, Expression):
                reads = iter([None if i is None else columns[i] for i in of.places])
                found = with_values(assembly.expression(value), reads, lifter)
            else:
                (place,) = of.places
                assert place is not None
                found = columns[place]
            assembly.made[COLUMN, id(of.number)] = found


def kinds_of(members: Sequence[UnionMember]) -> list[PartKind]:
    """Return the kinds of parts, in the order of the first part of each."""
    structures = _Structures()
    grouped: dict[int, list[UnionMember]] = {}
    for member in members:
        grouped.setdefault(structures.key(member.part), []).append(member)
    return [_kind(group) for group in grouped.values()]


class _Structures:
    """Numbers that are equal for trees which differ only in plain numbers."""

    def __init__(self) -> None:
        self._known: dict[Hashable, int] = {}
        self._of_object: dict[int, int] = {}
        self._lifter = ConstantLifter()

    def key(self, value: Any) -> int:
        """Return the number of the structure of a node, a material or one of its values."""
        found = self._of_object.get(id(value))
        if found is None:
            found = self._known.setdefault(self._structure(value), len(self._known))
            self._of_object[id(value)] = found
        return found

    def _structure(self, value: Any) -> Hashable:
        match value:
            case Node():
                numbers = tuple((n, self._number(v)) for n, v in value.numbers.items())
                constants = tuple((n, _constant(v)) for n, v in value.constants.items())
                paints = tuple(
                    None if m is None else self.key(m) for m in (value.material, value.cut_material)
                )
                children = tuple(map(self.key, value.children))
                return (_rule(value.rule), numbers, constants, paints, children)
            case FunctionCall():
                values = tuple((n, self._value(v)) for n, v in value.values.items())
                return (type(value), id(value.func), values)
            case _ if (call := _call_of(value)) is not None:
                return (type(value), self.key(call))
            case _:
                return (type(value), id(value))

    def _value(self, value: Any) -> Hashable:
        if isinstance(value, Number):
            return self._number(value)
        return _constant(value) if isinstance(value, bool | int) else self.key(value)

    def _number(self, number: Number) -> Hashable:
        """Return the type of a plain number, with the structure of an expression."""
        if isinstance(number.value, Expression):
            structure = self._lifter.split(number.value.node)[0]
            return (number.type, structure, number.value.parameters)
        return number.type


def _call_of(value: Any) -> FunctionCall | None:
    """Return the call that an object of the author, such as a material, consists of."""
    call = getattr(value, "call", None)
    return call if isinstance(call, FunctionCall) else None


def _rule(rule: Primitive | Operator) -> Hashable:
    """Return what distinguishes a rule; shapes of one author's function have rules of their own."""
    if isinstance(rule, Operator):
        return id(rule)
    declared = (rule.distance, rule.slope, rule.bounds, rule.growth, rule.normalize)
    return (*(d if isinstance(d, float) else id(d) for d in declared), rule.claims)


def _constant(value: Any) -> Hashable:
    if isinstance(value, bool | int):
        return (type(value), value)
    plain = getattr(value, "value", None)
    return (getattr(value, "type", None), plain) if plain is not None else id(value)


def _kind(members: Sequence[UnionMember]) -> PartKind:
    lifter = ConstantLifter()
    every = [list(numbers_in(member.part)) for member in members]
    columns: list[Column] = []
    numbers: dict[int, ColumnNumber] = {}
    values: list[Sequence[Plain]] = []
    width = HEAD
    for i in range(len(every[0])):
        own = [row[i] for row in every]
        places: list[int | None] = []
        for type, found in _candidates(own, lifter):
            if all(value == found[0] for value in found):
                places.append(None)
                continue
            size = type.size if isinstance(type, Vector) else 1
            # A vector lies within one vec4.
            width += -width % 4 if width % 4 + size > 4 else 0
            places.append(len(columns))
            columns.append(Column(width, type))
            values.append(found)
            width += size
        if any(place is not None for place in places):
            numbers[i] = ColumnNumber(_largest(own), places)
    node = members[0].part
    if numbers:
        node = _Copying({i: of.number for i, of in numbers.items()}).node(node)
    rows = list(zip(*values, strict=True)) if values else [()] * len(members)
    made = tuple(numbers.values())
    return PartKind(node, members, columns, made, width, rows, moving=is_moving(node))


def _largest(numbers: Sequence[Number]) -> Number:
    """Return a new number for those of all parts: what it may exceed, one of them may exceed."""
    first = numbers[0]
    if first.type is FLOAT and not isinstance(first.value, Expression):
        return Number(FLOAT, max([n.value for n in numbers]))
    return Number(first.type, first.value)


def _candidates(
    numbers: Sequence[Number], lifter: ConstantLifter
) -> Iterator[tuple[Type, Sequence[Plain]]]:
    """Yield the values of one number of all parts that may be a column: type, one value a part."""
    nodes = [n.value.node for n in numbers if isinstance(n.value, Expression)]
    if not nodes:
        yield numbers[0].type, [n.value for n in numbers if not isinstance(n.value, Expression)]
    elif any(node is not nodes[0] for node in nodes):
        for values in zip(*(lifter.split(node)[1] for node in nodes), strict=True):
            yield FLOAT, values


def numbers_in(value: Any) -> Iterator[Number]:
    """Yield the numbers of a tree and of its materials, in an order that its structure decides."""
    match value:
        case Number():
            yield value
        case Node():
            yield from value.numbers.values()
            for material in (value.material, value.cut_material):
                yield from numbers_in(material)
            for child in value.children:
                yield from numbers_in(child)
        case FunctionCall():
            for inner in value.values.values():
                yield from numbers_in(inner)
        case _ if (call := _call_of(value)) is not None:
            yield from numbers_in(call)


class _Copying:
    """Copies a tree, with some of its numbers replaced."""

    def __init__(self, numbers: Mapping[int, Number]) -> None:
        self._numbers = numbers
        self._at = 0

    def _number(self, number: Number) -> Number:
        found = self._numbers.get(self._at, number)
        self._at += 1
        return found

    def node(self, node: Node) -> Node:
        """Return the copy of a node; visits numbers in the order of ``numbers_in``."""
        numbers = {name: self._number(value) for name, value in node.numbers.items()}
        material, cut = self._value(node.material), self._value(node.cut_material)
        children = tuple(map(self.node, node.children))
        return replace(
            node, numbers=numbers, material=material, cut_material=cut, children=children
        )

    def _value(self, value: Any) -> Any:
        match value:
            case Number():
                return self._number(value)
            case FunctionCall():
                inner = {name: self._value(v) for name, v in value.values.items()}
                return replace(value, values=inner)
            case _ if (call := _call_of(value)) is not None:
                return value.with_call(self._value(call))
            case _:
                return value


def leaves_of(node: Node) -> Iterator[Node]:
    """Yield the primitives of a tree, each occurrence, in the order of the tree."""
    if isinstance(node.rule, Primitive):
        yield node
    for child in node.children:
        yield from leaves_of(child)


def materials_in(node: Node) -> Iterator[Any]:
    """Yield the materials of a tree, each occurrence, in the order of the tree."""
    yield from (m for m in (node.material, node.cut_material) if m is not None)
    for child in node.children:
        yield from materials_in(child)


def is_moving(node: Node) -> bool:
    """Return whether the shape of a tree depends on parameters or time."""
    return any(
        isinstance(number.value, Expression)
        for inner in node.walk()
        for number in inner.numbers.values()
    )
