"""Kinds of parts: parts of equal structure, which differ in numbers only.

Input: the parts of a union. Output: kinds, each with one tree for all its parts; the numbers that
differ from part to part are columns of a table, also the constants of expressions of parameters
and time. Numbers that are the same in all parts stay numbers of the scene, so that a parameter can
change them.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, cast

from distal.fields.guarantees import Operator, Primitive
from distal.frontend import Assembly
from distal.ir.nodes import Expr
from distal.ir.types import FLOAT, Type, Vector
from distal.lang.expressions import Expression
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.lifted import ConstantLifter, with_values
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.conversion import Number, Plain
from distal.scene.tree.node import Node, Rule
from distal.scene.tree.varying import COLUMN, VaryingNumber

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
    lifter = ConstantLifter()
    reader = _StructureReader(lifter)
    grouped: dict[Hashable, tuple[list[UnionMember], list[list[Number]]]] = {}
    for member in members:
        structure, numbers = reader.read(member.part)
        group = grouped.get(structure)
        if group is None:
            group = grouped[structure] = ([], [])
        group[0].append(member)
        group[1].append(numbers)
    return [_kind(*group, lifter) for group in grouped.values()]


class _StructureReader:
    """Reads trees once: their structure without plain numbers, and their numbers.

    A structure is a flat sequence in the order of the tree. Each list in it begins with its length,
    so that equal sequences are equal trees.
    """

    def __init__(self, lifter: ConstantLifter) -> None:
        self._lifter = lifter
        self._rules: dict[Rule, Hashable] = {}
        self._known: dict[Hashable, int] = {}

    def read(self, part: Node) -> tuple[Hashable, list[Number]]:
        """Return the structure of a tree, and its numbers in the order of the tree."""
        structure: list[Any] = []
        numbers: list[Number] = []
        self._node(part, structure, numbers)
        return tuple(structure), numbers

    def _node(self, node: Node, structure: list[Any], numbers: list[Number]) -> None:
        rule, constants, children = node.rule, node.constants, node.children
        if rule not in self._rules:
            # Rules that are equal in all that matters have one number.
            self._rules[rule] = self._known.setdefault(_rule(rule), len(self._known))
        structure += (self._rules[rule], len(node.numbers), len(constants), len(children))
        for name, number in node.numbers.items():
            self._number(name, number, structure, numbers)
        for name, value in constants.items():
            structure += (name, _constant(value))
        for material in (node.material, node.cut_material):
            if material is None:
                structure.append(None)
            else:
                self._value(material, structure, numbers)
        for child in children:
            self._node(child, structure, numbers)

    def _number(
        self, name: str, number: Number, structure: list[Any], numbers: list[Number]
    ) -> None:
        """Read a number: its type, with the structure of an expression.

        Args:
            name: Its name.
            number: The number.
            structure: Where the structure is appended.
            numbers: Where the number is appended.
        """
        numbers.append(number)
        value = number.value
        if isinstance(value, Expression):
            structure += (name, number.type, self._lifter.split(value.node)[0], value.parameters)
        else:
            structure += (name, number.type)

    def _value(self, value: Any, structure: list[Any], numbers: list[Number]) -> None:
        """Read a material, or another object among the values of a call."""
        if isinstance(value, Node):
            structure.append(Node)
            self._node(value, structure, numbers)
            return
        structure.append(type(value))
        call = value if isinstance(value, FunctionCall) else _call_of(value)
        if call is None:
            structure.append(id(value))
            return
        structure += (type(call), id(call.func), len(call.values))
        for name, inner in call.values.items():
            if isinstance(inner, Number):
                self._number(name, inner, structure, numbers)
            elif isinstance(inner, bool | int):
                structure += (name, _constant(inner))
            else:
                structure.append(name)
                self._value(inner, structure, numbers)


def _call_of(value: Any) -> FunctionCall | None:
    """Return the call that an object of the author, such as a material, consists of."""
    call = getattr(value, "call", None)
    return call if isinstance(call, FunctionCall) else None


def _rule(rule: Rule) -> Hashable:
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


def _kind(
    members: Sequence[UnionMember], every: Sequence[Sequence[Number]], lifter: ConstantLifter
) -> PartKind:
    """Return the kind of parts of equal structure.

    Args:
        members: The parts.
        every: The numbers of each.
        lifter: Splits expressions.
    """
    columns: list[Column] = []
    numbers: dict[int, ColumnNumber] = {}
    values: list[Sequence[Plain]] = []
    width = HEAD
    for i, own in enumerate(zip(*every, strict=True)):
        places: list[int | None] = []
        for type, found in _candidates(own, lifter):
            if found.count(found[0]) == len(found):
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
    # The structure of the parts says whether it is an expression in all of them.
    if not isinstance(numbers[0].value, Expression):
        yield numbers[0].type, cast("list[Plain]", [n.value for n in numbers])
        return
    nodes = [n.value.node for n in numbers if isinstance(n.value, Expression)]
    if any(node is not nodes[0] for node in nodes):
        for values in zip(*(lifter.split(node)[1] for node in nodes), strict=True):
            yield FLOAT, values


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
        """Return the copy of a node; visits numbers in the order of ``_StructureReader``."""
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


def paths_to_leaves(node: Node, above: tuple[Node, ...] = ()) -> Iterator[tuple[Node, ...]]:
    """Yield each primitive of a tree, each occurrence, after the nodes above it, in its order.

    Args:
        node: The tree.
        above: The nodes above it, outermost first.
    """
    path = (*above, node)
    if isinstance(node.rule, Primitive):
        yield path
    for child in node.children:
        yield from paths_to_leaves(child, path)


def materials_in(node: Node) -> Iterator[Any]:
    """Yield the materials of a tree, each occurrence, in the order of the tree."""
    yield from (m for m in (node.material, node.cut_material) if m is not None)
    for child in node.children:
        yield from materials_in(child)


def is_moving(node: Node) -> bool:
    """Return whether the shape of a tree depends on parameters or time."""
    return any(map(moves_itself, node.walk()))


def moves_itself(node: Node) -> bool:
    """Return whether numbers of a node, without those below it, depend on parameters or time."""
    if any(isinstance(number.value, Expression) for number in node.numbers.values()):
        return True
    return any(isinstance(v, VaryingNumber) and v.moves for v in node.constants.values())
