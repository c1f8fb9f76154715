"""Lay out tables of literals in buffers, and represent locations in tables.

Input: tables, as trees of literals; indices and fields that select a part. Output: reads of
buffers, and the buffers' declarations with their values. There is one buffer for each of three
element types: float, vec4 (for float vectors and the columns of matrices), int (for ints, uints and
bools). Does not depend on functions and statements.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, Final, TypeAlias

from distal.ir.build import add, cast, integer, literal_components, multiply, select, swizzle
from distal.ir.nodes import (
    Compare,
    CompareOp,
    Compose,
    Const,
    Construct,
    Expr,
    Index,
    Resource,
    ResourceDeclaration,
    Splat,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    VEC4,
    Array,
    Buffer,
    Kind,
    Matrix,
    Scalar,
    Struct,
    Type,
    Vector,
    component_count,
)
from distal.ir.walk import nodes_in
from distal.passes.naming import FreshNames

_LARGEST_FLOAT: Final = 3.4028234663852886e38
_SORTS: Final[dict[Type, str]] = {
    FLOAT: "float_table",
    VEC4: "vector_table",
    INT: "int_table",
}


def numbers_in(type: Type) -> int:
    """Return the number of scalars in a value of a type.

    Raises:
        AssertionError: The type is not a value type.
    """
    match type:
        case Scalar() | Vector() | Matrix():
            return component_count(type)
        case Array(element, length):
            return length * numbers_in(element)
        case Struct(_, fields):
            return sum(numbers_in(t) for _, t in fields)
        case _:
            raise AssertionError(f"{type} is no value")


def holds_table(type: Type, largest: int) -> bool:
    """Return whether a value of the type is or contains an array of over ``largest`` scalars."""
    match type:
        case Array():
            return numbers_in(type) > largest
        case Struct(_, fields):
            return any(holds_table(t, largest) for _, t in fields)
        case _:
            return False


@cache
def _slots(type: Type, sort: Type) -> int:
    """Return the number of slots with element type ``sort`` that a value needs."""
    match type:
        case Scalar(kind):
            return int(sort is (FLOAT if kind is Kind.FLOAT else INT))
        case Vector(Kind.FLOAT):
            return int(sort is VEC4)
        case Vector(_, size):
            return size if sort is INT else 0
        case Matrix(size):
            return size if sort is VEC4 else 0
        case Array(element, length):
            return length * _slots(element, sort)
        case Struct(_, fields):
            return sum(_slots(t, sort) for _, t in fields)
        case _:
            raise AssertionError(f"{type} is no value")


def is_large_literal(e: Expr, largest: int) -> bool:
    """Return whether ``e`` is or contains a large table, with only literals that fit 32 bits."""
    if not isinstance(e, Construct) or not holds_table(e.type, largest):
        return False
    for part in nodes_in(*e.parts):
        match part:
            case Const(value):
                if isinstance(value, float) and not abs(value) <= _LARGEST_FLOAT:
                    return False
            case Splat() | Compose() | Construct():
                pass
            case _:
                return False
    return True


@dataclass(frozen=True)
class Location:
    """A part of a table.

    Attributes:
        table: The whole table's literals.
        type: The part's type.
        start: For each buffer, the number of slots before the part when all computed indices are 0.
        steps: For each computed index, the type of the element that it counts.
        indices: The computed indices.
    """

    table: Expr
    type: Type
    start: tuple[int, ...]
    steps: tuple[Type, ...] = ()
    indices: tuple[Expr, ...] = ()

    @property
    def operands(self) -> tuple[Expr, ...]:
        """The expressions that are computed at run time."""
        return self.indices

    def with_operands(self, operands: Sequence[Expr]) -> Location:
        """Return the same location with other indices."""
        return replace(self, indices=tuple(operands))

    def element(self, index: Expr) -> Location:
        """Return the location of the element with this index, which must be in range."""
        assert isinstance(self.type, Array)
        inner = self.type.element
        if isinstance(index, Const):
            here = int(index.value)
            return replace(self, type=inner, start=self._after(inner, here))
        return replace(self, type=inner, steps=(*self.steps, inner), indices=(*self.indices, index))

    def field(self, name: str) -> Location:
        """Return the location of a field.

        Raises:
            AssertionError: There is no such field.
        """
        assert isinstance(self.type, Struct)
        found, start = self, self.start
        for field_name, type in self.type.fields:
            if field_name == name:
                return replace(found, type=type)
            start = found._after(type, 1)
            found = replace(found, start=start)
        raise AssertionError(f"{self.type} has no {name}")

    def _after(self, type: Type, count: int) -> tuple[int, ...]:
        return tuple(
            s + count * _slots(type, sort) for s, sort in zip(self.start, _SORTS, strict=True)
        )


@dataclass(frozen=True)
class Choice:
    """One of two locations, selected at run time."""

    condition: Expr
    yes: TablePlace
    no: TablePlace

    @property
    def type(self) -> Type:
        """The type of both locations."""
        return self.yes.type

    @property
    def operands(self) -> tuple[Expr, ...]:
        """The expressions that are computed at run time."""
        return (self.condition, *self.yes.operands, *self.no.operands)

    def with_operands(self, operands: Sequence[Expr]) -> Choice:
        """Return the same choice with other operands."""
        middle = 1 + len(self.yes.operands)
        yes = self.yes.with_operands(operands[1:middle])
        return Choice(operands[0], yes, self.no.with_operands(operands[middle:]))

    def element(self, index: Expr) -> Choice:
        """Return the location of the element with this index, which must be in range."""
        return Choice(self.condition, self.yes.element(index), self.no.element(index))

    def field(self, name: str) -> Choice:
        """Return the location of a field."""
        return Choice(self.condition, self.yes.field(name), self.no.field(name))


TablePlace: TypeAlias = Location | Choice


def whole(table: Expr) -> Location:
    """Return the location of a whole table."""
    return Location(table, table.type, (0,) * len(_SORTS))


@dataclass
class Tables:
    """The buffers; tables are added when they are first read."""

    names: FreshNames
    _values: dict[Type, list[Any]] = field(default_factory=lambda: {sort: [] for sort in _SORTS})
    _starts: dict[Expr, tuple[int, ...]] = field(default_factory=dict)
    _spelled: dict[Type, str] = field(default_factory=dict)

    def declarations(self) -> Iterator[ResourceDeclaration]:
        """Yield the declarations of the buffers that are read."""
        for sort, values in self._values.items():
            if values:
                name, type = self._name(sort), Buffer(sort)
                yield ResourceDeclaration(name, type, None, "clamp", values=tuple(values))

    def value(self, place: TablePlace) -> Expr:
        """Return the value at a location: reads of the buffers, or the literals of a whole table.

        Raises:
            AssertionError: The type is not a value type.
        """
        if isinstance(place, Choice):
            return select(place.condition, self.value(place.yes), self.value(place.no))
        if place.type is place.table.type and not place.indices:
            return place.table
        match place.type:
            case Array(_, length):
                parts = (self.value(place.element(integer(i))) for i in range(length))
                return Construct(tuple(parts), place.type)
            case Struct(_, fields):
                parts = (self.value(place.field(name)) for name, _ in fields)
                return Construct(tuple(parts), place.type)
            case Matrix(size):
                columns = (self._vector(place, size, i) for i in range(size))
                return Compose(tuple(columns), place.type)
            case Vector(Kind.FLOAT, size):
                return self._vector(place, size, 0)
            case Vector(kind, size):
                lanes = (self._scalar(place, kind, i) for i in range(size))
                return Compose(tuple(lanes), place.type)
            case Scalar(kind):
                return self._scalar(place, kind, 0)
            case _:
                raise AssertionError(f"{place.type} is no value")

    def _vector(self, place: Location, size: int, further: int) -> Expr:
        value = self._slot(place, VEC4, further)
        return value if size == 4 else swizzle(value, "xyzw"[:size])

    def _scalar(self, place: Location, kind: Kind, further: int) -> Expr:
        value = self._slot(place, FLOAT if kind is Kind.FLOAT else INT, further)
        if kind is Kind.BOOL:
            return Compare(CompareOp.NE, value, integer(0), BOOL)
        return cast(value, kind)

    def _slot(self, place: Location, sort: Type, further: int) -> Expr:
        """Return a read of the slot that is ``further`` slots after the start of a location."""
        position = list(_SORTS).index(sort)
        start = self._start(place.table)[position] + place.start[position] + further
        at: Expr | None = None
        for index, step in zip(place.indices, place.steps, strict=True):
            stride = _slots(step, sort)
            term = index if stride == 1 else multiply(index, integer(stride))
            at = term if at is None else add(at, term)
        if at is None:
            at = integer(start)
        elif start:
            at = add(at, integer(start))
        return Index(Resource(self._name(sort), Buffer(sort)), at, sort)

    def _name(self, sort: Type) -> str:
        if sort not in self._spelled:
            self._spelled[sort] = self.names.fresh(_SORTS[sort])
        return self._spelled[sort]

    def _start(self, table: Expr) -> tuple[int, ...]:
        """Return where a table starts in each buffer; the first call stores its values."""
        if table not in self._starts:
            self._starts[table] = tuple(len(self._values[sort]) for sort in _SORTS)
            self._store(table)
        return self._starts[table]

    def _store(self, e: Expr) -> None:
        match e.type:
            case Array() | Struct():
                assert isinstance(e, Construct)
                for part in e.parts:
                    self._store(part)
            case Matrix():
                assert isinstance(e, Compose)
                for column in e.parts:
                    self._store(column)
            case Vector(Kind.FLOAT):
                lanes = _numbers(e)
                self._values[VEC4].append((*lanes, *(0.0,) * (4 - len(lanes))))
            case Scalar(Kind.FLOAT):
                self._values[FLOAT] += _numbers(e)
            case _:
                self._values[INT] += map(_signed, _numbers(e))


def _numbers(e: Expr) -> tuple[Any, ...]:
    found = literal_components(e)
    assert found is not None, f"{e.__class__.__name__} is no literal"
    return found


def _signed(value: bool | int) -> int:
    """Return the int with the same 32 bits."""
    return (int(value) + 2**31) % 2**32 - 2**31
