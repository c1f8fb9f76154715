"""Copies of shapes at many positions, each with its own color, size and rotation.

Input: shapes, and columns of numbers: NumPy arrays or lists with one row for each copy. Output: the
hard union of the copies. All copies of a shape have the same structure and differ in numbers alone,
so that they can be drawn as one kind with rows of numbers.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import repeat
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import Span
from distal.fields.combine import joins
from distal.fields.guarantees import Limit, Operator
from distal.fields.place import solid as placing
from distal.ir.types import FLOAT, INT, VEC3, VEC4, Type
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.objects.materials import Material, as_material
from distal.scene.objects.shape_values import PLAIN
from distal.scene.objects.turns import LEAST_DEGREES, STEP_OF_DEGREES, warn_of_degrees
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.columns import choices, column, rows_of
from distal.scene.tree.conversion import NO_VALUES, Asked, Number, is_scalar, number, unwrapped
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node
from distal.scene.tree.value import CallRecord, recorded, value_of
from distal.scene.tree.varying import varied_in

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Columns, Vector
    from distal.scene.objects.shape import Shape

_UP: Final = (0.0, 1.0, 0.0)
# The operator of a rotation for each number of columns: about y, about x then y then z, quaternion.
_ROTATIONS: Final[dict[int, tuple[Operator, str, Type, Limit]]] = {
    1: (placing.ROTATE_Y, "angle", FLOAT, Limit.ANY),
    3: (placing.ROTATE_EULER, "angles", VEC3, Limit.ANY),
    4: (placing.ROTATE_QUATERNION, "quaternion", VEC4, Limit.UNIT),
}


@recorded
def copies(
    shapes: Shape | Iterable[Shape],
    positions: Columns,
    *,
    which: Columns | None = None,
    colors: Columns | None = None,
    scale: Columns | float | None = None,
    rotation: Columns | float | None = None,
    align: Columns | None = None,
    axis: Vector = _UP,
) -> Shape:
    """Return the union of copies of several shapes, one copy for each position.

    Each copy is scaled, rotated, aligned and then moved. Columns are lists or NumPy arrays with one
    row for each position.

    Args:
        shapes: The shapes to copy.
        positions: Positions of the shapes' origins, an (n, 3) array.
        which: Index of the shape of each copy; None takes the shapes in turn.
        colors: Color of each copy: linear (n, 3), or "#rrggbb" and names. The other numbers of the
            shape's material are kept. None keeps the material.
        scale: Size of each copy: one factor for all, (n,), or (n, 3) factors along the axes.
        rotation: Rotation of each copy in radians: one angle about y for all, (n,) angles about y,
            (n, 3) angles about x, y, z as for ``rotate``, or (n, 4) unit quaternions.
        align: Direction to which the shape's ``axis`` is turned, an (n, 3) array, such as normals.
        axis: The direction of the shape that ``align`` turns.

    Raises:
        SceneTypeError: A row has the wrong type.
        SceneValueError: Columns have different lengths, or a number is beyond its limit.
    """
    place = author_place()
    listed = (shapes,) if isinstance(shapes, BaseShape) else tuple(shapes)
    if not listed:
        refuse_kind("copies needs at least one shape", "copies([a, b], positions)", place)
    columns = CopyColumns(positions, which, colors, scale, rotation, align, axis)
    made: Shape = copied("copies", listed, columns, place)
    return made


@dataclass(frozen=True, slots=True)
class CopyColumns:
    """The author's columns, by the names of the arguments of ``copies``."""

    positions: Any
    which: Any = None
    colors: Any = None
    scale: Any = None
    rotation: Any = None
    align: Any = None
    axis: Any = _UP


def copied(what: str, shapes: Sequence[BaseShape], given: CopyColumns, place: Span | None) -> Any:
    """Return the union of copies.

    Args:
        what: The name in messages.
        shapes: The shapes to copy.
        given: The columns.
        place: The author's line.

    Raises:
        SceneTypeError: A row has the wrong type, or a shape is none.
        SceneValueError: Columns have different lengths, or a number is beyond its limit.
    """
    for shape in shapes:
        if not isinstance(shape, BaseShape):
            refuse_kind(f"{what} takes shapes, not {shape!r:.60}", place=place)
        if shape.flat:
            refuse(f"{what} takes solid shapes", ".extrude(height) first", place)
        if varied := varied_in(shape.node):
            refuse(
                f"'{varied[0].label}' depends on the cell, and copies with columns have none",
                "array(positions) alone has cells; or give each copy its number in a column",
                place,
            )
    with _garbage_collection_paused():
        return PLAIN[False]._of(_union(what, shapes, given, place))


def _union(what: str, shapes: Sequence[BaseShape], given: CopyColumns, place: Span | None) -> Node:
    """Return the node of ``copied``."""
    rows = _CopyRows(
        what, place, rows_of(given.positions, Asked("positions", what, VEC3, place=place))
    )
    nodes = rows.chosen([shape.node for shape in shapes], given.which)
    colors = rows.colors(given.colors)
    painted = [node.material for node in nodes]
    nodes = rows.scaled(nodes, given.scale)
    nodes = rows.rotated(nodes, given.rotation)
    if given.align is not None:
        nodes = rows.aligned(nodes, given.align, given.axis)
    moves = rows.column(rows.values, "positions", VEC3)
    materials: Iterable[Any] = repeat(None)
    if colors is not None:
        materials = _recolored(painted, colors, place)
    moved = [
        Node(placing.TRANSLATE, False, (node,), {"offset": move}, place=place, material=material)
        for node, move, material in zip(nodes, moves, materials, strict=False)
    ]
    return moved[0] if len(moved) == 1 else Node(joins.UNION, False, tuple(moved), place=place)


@contextmanager
def _garbage_collection_paused() -> Iterator[None]:
    """Pause the collection of reference cycles: nodes have none.

    Searching for them takes two thirds of the time in which 100,000 copies are made.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@dataclass(frozen=True, slots=True)
class _CopyRows:
    """The rows of an array: one for each position.

    Attributes:
        what: The name in messages.
        place: The author's line.
        values: The positions, unchecked.
    """

    what: str
    place: Span | None
    values: Sequence[Any]

    def _rows(self, given: Any, name: str) -> Sequence[Any]:
        asked = Asked(name, self.what, VEC3, place=self.place)
        return rows_of(given, asked, len(self.values))

    def column(
        self, rows: Sequence[Any], name: str, type: Type, limit: Limit = Limit.ANY
    ) -> list[Number]:
        """Return rows as numbers of a type."""
        is_color = name == "colors"
        return column(rows, Asked(name, self.what, type, limit, is_color, place=self.place))

    def chosen(self, nodes: Sequence[Node], which: Any) -> list[Node]:
        """Return the node of each copy."""
        count = len(self.values)
        if which is None:
            return [nodes[at % len(nodes)] for at in range(count)]
        asked = Asked("which", self.what, INT, place=self.place)
        return [nodes[i] for i in choices(self._rows(which, "which"), asked, len(nodes))]

    def colors(self, given: Any) -> list[Number] | None:
        """Return the color of each copy, or None."""
        if given is None:
            return None
        return self.column(self._rows(given, "colors"), "colors", VEC3)

    def scaled(self, nodes: list[Node], given: Any) -> list[Node]:
        """Return the copies, each scaled."""
        if given is None:
            return nodes
        if is_scalar(given):
            asked = Asked("scale", self.what, FLOAT, Limit.POSITIVE, place=self.place)
            return self._alike(placing.SCALE, nodes, {"factor": number(given, asked)})
        rows = self._rows(given, "scale")
        if _size_of(rows[0]) == 1:
            factors = self.column(rows, "scale", FLOAT, Limit.POSITIVE)
            return self._each(placing.SCALE, nodes, "factor", factors)
        factors = self.column(rows, "scale", VEC3, Limit.POSITIVE)
        return self._each(placing.STRETCH, nodes, "factors", factors)

    def rotated(self, nodes: list[Node], given: Any) -> list[Node]:
        """Return the copies, each rotated."""
        if given is None:
            return nodes
        if is_scalar(given):
            asked = Asked("rotation", self.what, FLOAT, place=self.place)
            warn_of_degrees(self.place, unwrapped(given))
            return self._alike(placing.ROTATE_Y, nodes, {"angle": number(given, asked)})
        rows = self._rows(given, "rotation")
        size = _size_of(rows[0])
        if size not in _ROTATIONS:
            refuse_kind(
                f"'rotation[0] of {self.what}' takes one, three or four numbers, not {size}",
                "an angle about y, angles about x, y and z, or a quaternion (x, y, z, w)",
                self.place,
            )
        operator, name, type, limit = _ROTATIONS[size]
        numbers = self.column(rows, "rotation", type, limit)
        _warn_of_degrees_in(numbers, self.place)
        return self._each(operator, nodes, name, numbers)

    def aligned(self, nodes: list[Node], given: Any, axis: Any) -> list[Node]:
        """Return the copies, each turned so that ``axis`` has the given direction."""
        source = number(axis, Asked("axis", self.what, VEC3, place=self.place))
        targets = self.column(self._rows(given, "align"), "align", VEC3)
        for at, made in enumerate((source, *targets)):
            if made.value == (0.0, 0.0, 0.0):
                name = f"align[{at - 1}]" if at else "axis"
                refuse(f"'{name} of {self.what}' has no direction: it is zero", place=self.place)
        operator, place = placing.ORIENT, self.place
        return [
            Node(operator, False, (node,), {"source": source, "target": target}, NO_VALUES, place)
            for node, target in zip(nodes, targets, strict=True)
        ]

    def _alike(
        self, operator: Operator, nodes: list[Node], numbers: dict[str, Number]
    ) -> list[Node]:
        """Apply an operator with the same numbers to all copies: once to each shape."""
        made: dict[int, Node] = {}
        for node in nodes:
            if id(node) not in made:
                made[id(node)] = Node(operator, False, (node,), numbers, {}, self.place)
        return [made[id(node)] for node in nodes]

    def _each(
        self, operator: Operator, nodes: list[Node], name: str, numbers: list[Number]
    ) -> list[Node]:
        """Apply an operator with a number of its own to each copy."""
        place = self.place
        return [
            Node(operator, False, (node,), {name: value}, NO_VALUES, place)
            for node, value in zip(nodes, numbers, strict=True)
        ]


def _size_of(row: Any) -> int:
    """Return how many numbers a row has; 1 if it is no sequence."""
    row = unwrapped(row)
    return len(row) if isinstance(row, Sequence) and not isinstance(row, str) else 1


def _recolored(
    painted: Iterable[Material | None], colors: Iterable[Number], place: Span | None
) -> list[Material]:
    """Return a material for each copy: that of its shape with another color.

    A shape without a material, or whose color is a pattern, gets a matte one.

    Args:
        painted: The material of the shape of each copy.
        colors: The color of each copy.
        place: The author's line.
    """
    plain = as_material((1.0, 1.0, 1.0), place)
    templates: dict[int, Material] = {}
    found = []
    for material, color in zip(painted, colors, strict=True):
        template = templates.get(id(material))
        if template is None:
            own = None if material is None else material.call.values.get("color")
            template = material if material is not None and isinstance(own, Number) else plain
            templates[id(material)] = template
        call = template.call
        values = {**call.values, "color": color}
        made = Material.of(
            FunctionCall(call.what, call.func, values, place),
            reflects=template.reflects,
            refracts=template.refracts,
            emits=template.emits,
            priority=template.priority,
        )
        if (origin := template._origin_or_none) is not None:
            given = {**origin.given, "color": value_of(color)}
            made._record(CallRecord(origin.factory, (), given, Material))
        found.append(made)
    return found


def _warn_of_degrees_in(numbers: Iterable[Number], place: Span | None) -> None:
    """Warn if all angles of a column are multiples of 15, some of them large: degrees."""
    largest = 0.0
    for made in numbers:
        angles = made.value if isinstance(made.value, tuple) else (made.value,)
        for angle in angles:
            if not isinstance(angle, float) or angle % STEP_OF_DEGREES != 0.0:
                return
            largest = max(largest, abs(angle))
    if largest >= LEAST_DEGREES:
        warn_of_degrees(place, largest)
