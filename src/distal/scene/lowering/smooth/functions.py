"""Functions of a smooth union with a grid: its distance, its attributes.

Input: a grid. Output: expressions of the IR. The functions of a member take the number of the
member's row; the way through the grid is scene code (``render.smooth_cells``).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from distal.ir.build import boolean, compare, number, select
from distal.ir.nodes import CompareOp, Construct, Expr, FunctionRef, Read
from distal.ir.types import FLOAT, INT, VEC3, FunctionType, Type
from distal.render import smooth_cells
from distal.scene.lowering.part_functions import POINT, ZERO_CELL, OfKind, PartFunctions
from distal.scene.lowering.parts.kinds import PartKind
from distal.scene.lowering.parts.table import PartTable
from distal.scene.lowering.smooth.cells import MemberGrid
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer

# The distance of what is joined before a member.
BEFORE = Read("before", FLOAT)


class MemberFunctions:
    """Makes the functions of one smooth union with a grid."""

    def __init__(self, composer: ShapeComposer, grid: MemberGrid) -> None:
        self._composer = composer
        table = PartTable(grid.kinds, None, grid.rows, grid.low, grid.high, grid.slope, 1.0)
        self._parts = PartFunctions(composer, table)
        assembly, fixed = composer.assembly, composer.values.fixed
        corners = (
            fixed("grid_low", VEC3, grid.low),
            fixed("grid_high", VEC3, grid.high),
            fixed("cells_per_unit", FLOAT, grid.per_unit),
            fixed("grid_across", INT, grid.blocks[0]),
            fixed("grid_up", INT, grid.blocks[1]),
            fixed("grid_all", INT, grid.all),
        )
        self._given: dict[str, Expr | FunctionRef] = {
            "cells": assembly.resource(grid.cells, "smooth_cells"),
            "grid": Construct(corners, assembly.struct(smooth_cells.CellGrid)),
            "steepest": number(grid.slope),
            "distance": self._parts.distance_of,
            "joined": self._of_pair("member_joined", "combine"),
        }
        self._share: FunctionRef | None = None

    @property
    def ordinal(self) -> Expr:
        """The number of the member among those of its kind, as a float."""
        return self._parts.ordinal

    def _of_pair(self, name: str, rule: str) -> FunctionRef:
        """Return a function of a member and of the distance of what is joined before it.

        Args:
            name: The preferred name.
            rule: The function of the union that it calls: "combine" or "mix".
        """

        def make(body: StatementList, kind: PartKind) -> Expr:
            composer, node = self._composer, kind.node
            values = composer.values.all(node)
            given, shares = composer.given(body, node, POINT, ZERO_CELL, values)
            member = node.children[0]
            d = composer.distance(body, member, POINT, ZERO_CELL, shares[0])
            function = getattr(node.rule, rule)
            if function is None:  # a hard union shows the nearer shape
                return select(compare(CompareOp.LT, d, BEFORE), number(1.0), number(0.0))
            return composer.call(function, {**given, "a": BEFORE, "b": d})

        params: list[tuple[str, Type]] = [("p", VEC3), ("part", INT), (BEFORE.name, FLOAT)]
        return self._parts.of_part(name, params, FLOAT, make)

    def distance(self, p: Expr, *, exact: bool) -> Expr:
        """Return the distance of a point to the union.

        Args:
            p: The point.
            exact: Whether values outside of the grid are those of the union.
        """
        given = {**self._given, "p": p, "exact": boolean(exact)}
        return self._composer.call(smooth_cells.distance_by_cells, given)

    def attribute(
        self, name: str, result: Type, p: Expr, given: Mapping[str, Expr], make: OfKind
    ) -> Expr:
        """Return an attribute of the union at a point.

        Args:
            name: The preferred name of the function of a member.
            result: The type of the attribute: a ``Surface`` or a number.
            p: The point.
            given: The other values that ``make`` reads, by name.
            make: Adds the statements of one kind, and returns the attribute of a member.
        """
        if self._share is None:
            self._share = self._of_pair("member_share", "mix")
        free: list[tuple[str, Type]] = [("p", VEC3), ("part", INT)]
        params = [*free, *((name, value.type) for name, value in given.items())]
        of_part = self._parts.of_part(name, params, result, make)
        shown = FunctionRef(of_part.name, tuple(given.values()), FunctionType((VEC3, INT), result))
        numbers = result is FLOAT
        function = smooth_cells.number_by_cells if numbers else smooth_cells.surface_by_cells
        values = {**self._given, "share": self._share, "shown": shown, "p": p}
        return self._composer.call(function, values)
