"""Distances to the members of a smooth union, and their bounds, for arrays of numbers.

Input: a kind of members. Output: functions that the executor runs for many members at once.
"""

from __future__ import annotations

from distal.frontend import Assembly
from distal.ir.build import field, number
from distal.ir.nodes import Construct, Expr, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Type, tuple_type
from distal.lang.composed import Composed
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.parts.kind_boxes import Floats, columns_of
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.values import StatementList, Values


class _OfKind(Composed):
    """A function of the columns of a kind that its shape depends on (not its materials).

    Attributes:
        shape_columns: The numbers of these columns, in the order of the parameters.
    """

    def __init__(self, kind: PartKind) -> None:
        self._kind = kind
        of_shape = {id(n) for node in kind.node.walk() for n in node.numbers.values()}
        places = {i for n in kind.numbers if id(n.number) in of_shape for i in n.places}
        self.shape_columns = sorted(i for i in places if i is not None)
        self._columns = tuple((f"column_{i}", kind.columns[i].type) for i in self.shape_columns)

    def _read_columns(self, assembly: Assembly) -> None:
        # Materials have columns too, which nothing here reads.
        columns: list[Expr] = [number(0.0, column.type) for column in self._kind.columns]
        for i, (name, type) in zip(self.shape_columns, self._columns, strict=True):
            columns[i] = Read(name, type)
        self._kind.read(assembly, columns)

    def arguments(self) -> list[Floats]:
        """Return the columns that are parameters, one row for each member."""
        columns = columns_of(self._kind)
        return [columns[i] for i in self.shape_columns]


class DistanceOfKind(_OfKind):
    """The distance of a point to a member, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        super().__init__(kind)
        self.name = f"distance to {kind.node.children[0].name}"
        self.signature = (("p", VEC3), *self._columns)
        self.result: Type = FLOAT

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        self._read_columns(assembly)
        node = self._kind.node
        composer = ShapeComposer(assembly, [node])
        body = StatementList(taken={name for name, _ in self.signature})
        p = Read("p", VEC3)
        d: Expr = composer.distance(body, node, p, ZERO_CELL, composer.values.all(node))
        body.statements.append(Return(d))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("member_distance", params, FLOAT, body.statements)


class BoundsOfKind(_OfKind):
    """Corners, slope, growth and side growth of a member, from the numbers of its row."""

    def __init__(self, kind: PartKind) -> None:
        super().__init__(kind)
        self.name = f"bounds of {kind.node.children[0].name}"
        self.signature = self._columns
        self.result: Type = tuple_type((VEC3, VEC3, FLOAT, FLOAT, FLOAT))

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        self._read_columns(assembly)
        values = Values(assembly)
        body = StatementList(taken={name for name, _ in self.signature})
        member = self._kind.node.children[0]
        found = BoundsComposer(values).of(body, member, values.all(member))
        box = body.let("box", found.bounds)
        numbers = (found.slope, found.growth, found.side_growth)
        packed = Construct((field(box, "low"), field(box, "high"), *numbers), self.result)
        body.statements.append(Return(packed))
        params = [Param(name, type) for name, type in self.signature]
        return assembly.define("member_bounds", params, self.result, body.statements)
