"""The programs and tables by which a page makes the mesh of a shape by itself.

Input: a tree. Output: images that compute rows of a mesh (``printable_rows``), one for each pass,
and the tables of topology as bytes. Does not depend on pages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np

from distal.deflating import deflated
from distal.frontend import Assembly
from distal.ir.build import field, swizzle
from distal.ir.nodes import Construct, EntryKind, Expr, Param, Read, Return
from distal.ir.types import FLOAT, FRAME, VEC3
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.mesh import printable_lattice, printable_rows
from distal.mesh.coloring import changes_abruptly, surface_at
from distal.mesh.tables import EDGES, cell_tables
from distal.mesh.topology import neighbor_tables
from distal.scene.lowering.attributes import paints
from distal.scene.lowering.bounds import BoundsComposer
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList, Values

# The uniforms of the lattice, which the page sets from what the first pass returns.
CELLS: Final = "Print_cells"
ORIGIN: Final = "Print_origin"
STEP: Final = "Print_step"
COUNTS: Final = "Print_counts"
MARGIN: Final = "Print_margin"
TOLERANCE: Final = "Print_tolerance"
ASKED: Final = "Print_asked"

Compose = Callable[[Assembly, StatementList, Node, Expr], Expr]

# The buffers that the page fills, by the names that it has for them.
BUFFERS: Final[Mapping[str, Any]] = {
    "edges": printable_rows.EDGES,
    "values": printable_rows.VALUES,
    "roots": printable_rows.ROOTS,
    "kept": printable_rows.KEPT,
    "slopes": printable_rows.SLOPES,
    "cells": printable_rows.CELLS,
    "uses": printable_rows.USES,
    "planes": printable_rows.PLANES,
    "points": printable_rows.POINTS,
    "faces": printable_rows.FACES,
    "ends": printable_rows.ENDS,
    "around": printable_rows.AROUND,
    "places": printable_rows.PLACES,
    "triangles": printable_rows.TRIANGLES,
}


class PrintPass(Composed):
    """One pass: an image in which each pixel is a row."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)

    def __init__(self, node: Node, name: str, compose: Compose, *, exact: bool = True) -> None:
        """Make the pass.

        Args:
            node: The tree.
            name: What the pass computes.
            compose: Adds statements and returns the pixel, from the tree and the row's number.
            exact: Whether the pass needs the exact field.
        """
        self.name = f"{name} of {node.name}"
        self._node, self._pass, self._compose, self._exact = node, name, compose, exact

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        node = rolled_for(assembly, self._node, exact=self._exact)
        body, frame = StatementList(taken={"frame"}), Read("frame", FRAME)
        place: dict[str, Expr] = {
            "coord": field(frame, "coord"),
            "width": swizzle(field(frame, "resolution"), "x"),
        }
        row = body.let("row", assembly.call(printable_lattice.row_at, place))
        pixel = self._compose(assembly, body, node, row)
        self.result = pixel.type
        body.statements.append(Return(pixel))
        params = (Param("frame", FRAME),)
        return assembly.define(self._pass, params, pixel.type, body.statements, node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self._node.functions()


def _lattice(tolerance: float) -> Compose:
    """Return what composes the lattice over the box of the tree; a row is not used."""

    def compose(assembly: Assembly, body: StatementList, node: Node, row: Expr) -> Expr:
        values = Values(assembly)
        bounds = BoundsComposer(values).of(body, node, values.all(node))
        given = {
            "bounds": body.let("box", bounds.bounds),
            "slope": body.let("slope", bounds.slope),
            "cells": assembly.number(CELLS, FLOAT, 64.0),
            "tolerance": assembly.number(ASKED, FLOAT, tolerance),
        }
        return assembly.call(printable_lattice.lattice_over, given)

    return compose


def _of_field(function: Func) -> Compose:
    """Return what composes a pixel by a function of the field, the lattice and the row."""

    def compose(assembly: Assembly, body: StatementList, node: Node, row: Expr) -> Expr:
        composer = ShapeComposer(assembly, [node])
        shape = composer.field(node, composer.values.all(node), ZERO_CELL)
        lattice = Construct(
            (
                assembly.number(ORIGIN, VEC3, (0.0, 0.0, 0.0)),
                assembly.number(STEP, FLOAT, 1.0),
                assembly.number(COUNTS, VEC3, (2.0, 2.0, 2.0)),
                assembly.number(MARGIN, FLOAT, 0.001),
                assembly.number(TOLERANCE, FLOAT, 0.001),
            ),
            assembly.struct(printable_lattice.PrintLattice),
        )
        return assembly.call(function, {"field": shape, "lattice": lattice, "row": row})

    return compose


def _of_surface(place: Func) -> Compose:
    """Return what composes a pixel with the color at the place of a row."""

    def compose(assembly: Assembly, body: StatementList, node: Node, row: Expr) -> Expr:
        p = body.let("p", assembly.call(place, {"row": row}))
        surface = surface_at(assembly, body, node, p)
        return assembly.call(printable_rows.color_codes, {"surface": surface})

    return compose


@dataclass(frozen=True, slots=True)
class PrintPasses:
    """The passes of a shape's mesh.

    Attributes:
        images: The programs by name.
        is_sharp: Whether colors are those of triangles; else those of points.
    """

    images: Mapping[str, PrintPass]
    is_sharp: bool


def print_passes(node: Node, tolerance: float | None = None) -> PrintPasses:
    """Return the passes of a mesh; "colors" is left out where nothing is painted.

    Args:
        node: The tree.
        tolerance: How far the mesh may be from the surface, in scene units.
    """
    rows = printable_rows
    images = {"plan": PrintPass(node, "plan", _lattice(tolerance or 0.0), exact=False)}
    for name, function in (
        ("values", rows.value_row),
        ("lost", rows.lost_row),
        ("middles", rows.middle_row),
        ("roots", rows.root_row),
        ("points", rows.point_row),
        ("faces", rows.face_row),
        ("diagonals", rows.diagonal_row),
        ("misses", rows.miss_row),
    ):
        images[name] = PrintPass(node, name, _of_field(function))
    is_sharp = changes_abruptly(node)
    if paints(node):
        place = rows.middle_of_row if is_sharp else rows.point_of_row
        images["colors"] = PrintPass(node, "colors", _of_surface(place), exact=False)
    return PrintPasses(images, is_sharp)


def packed_tables() -> tuple[list[int], bytes]:
    """Return the lengths of the tables of topology, and all of them as 16-bit integers, deflated.

    They are the fields of ``CellTables`` in their order, the axis and the first corner of each
    edge, and ``neighbor_tables``.
    """
    tables = cell_tables()
    parts = [getattr(tables, name) for name in tables.__slots__]
    parts += [np.array(EDGES), *neighbor_tables()]
    numbers = [np.asarray(part, "<i2").reshape(-1) for part in parts]
    return [len(part) for part in numbers], deflated(np.concatenate(numbers).tobytes())
