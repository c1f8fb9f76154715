"""Fillets and chamfers: the edges of a shape's last operator, shaped afterwards.

Input: the node of a shape. Output: a node with the same children, whose operator shapes the edge;
for a combination with a blend, the operator that suits its shapes. Does not depend on the public
classes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.combine import joins
from distal.fields.combine.blends import COMBINATIONS, FLAT_UNIONS, PRISMS
from distal.fields.guarantees import Limit, Operator, Primitive
from distal.fields.lift import extrude
from distal.fields.place import solid as placing
from distal.fields.place.flat import UPRIGHT_TURNS
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.lang.places import CELL
from distal.scene.objects.binding import bound
from distal.scene.tree.conversion import Asked, Number, number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.varying import VaryingNumber

# The blend of each word, and the operator that replaces a plain extrusion, with its number.
_BLENDS: Final[Mapping[str, str]] = {"fillet": "round", "chamfer": "chamfer"}
_EXTRUDED: Final[Mapping[str, tuple[Operator, str]]] = {
    "fillet": (extrude.EXTRUDE_ROUNDED, "radius"),
    "chamfer": (extrude.EXTRUDE_CHAMFERED, "chamfer"),
}
_SHARP: Final = (joins.UNION, joins.INTERSECTION, joins.DIFFERENCE)
# The rotation that lays what is extruded along z into the floor: y points to -z.
PLAN: Final = {"right": (1.0, 0.0, 0.0), "up": (0.0, 0.0, -1.0), "back": (0.0, 1.0, 0.0)}
# The shapes that have the edge as one of their numbers.
_INSTEAD: Final[Mapping[str, Mapping[str, str]]] = {
    "fillet": {
        "Box": "RoundBox(size, rounding)",
        "Cylinder": "RoundedCylinder(radius, height, rounding)",
        "Rectangle": "RoundedRectangle(size, radii)",
        "Polygon": "RoundedPolygon(points, radius)",
    },
    "chamfer": {
        "Box": "ChamferBox(size, bevel)",
        "Rectangle": "ChamferedRectangle(size, bevel)",
    },
}


def shaped_edge(node: Node, word: str, size: Any, place: Span | None) -> Node:
    """Return the node whose last operator is replaced by the one that shapes its edge.

    Args:
        node: The shape; materials and names are kept.
        word: "fillet" or "chamfer".
        size: The author's number.
        place: The author's line.

    Raises:
        SceneValueError: The last operator is no plain union, intersection, difference or
            extrusion, or the size is beyond its limit.
    """
    rule = node.rule
    if rule in _SHARP:
        shaped = COMBINATIONS[rule.name, _BLENDS[word]]
        name = _EXTRUDED[word][1]
        varies = frozenset((CELL,))
        number(size, Asked(name, word, FLOAT, Limit.NOT_NEGATIVE, place=place, varies=varies))
        numbers, constants = bound(shaped, (size,), {}, place)
        shaped, more = suited(shaped, node.children, numbers)
        return _replaced(node, shaped, {**numbers, **more}, constants, place)
    if rule is extrude.EXTRUDE:
        shaped, name = _EXTRUDED[word]
        height = (node.numbers.get("height") or node.constants["height"].number).value
        numbers, constants = bound(shaped, (), {"height": height, name: size}, place)
        return _replaced(node, shaped, numbers, constants, place)
    if _is_plan(node):
        return replace(node, children=(shaped_edge(node.children[0], word, size, place),))
    found = _INSTEAD[word].get(rule.name)
    if found is None and not node.children:
        found = "round(radius), which moves the whole surface outwards"
    refuse(
        f"a {word} shapes the edge of a union, intersection, difference or extrusion; the last "
        f"operation of this shape is '{rule.name}'",
        found or f"call {word} right after the operator: (a - b).{word}({size!r:.20}).translate(…)",
        place,
    )


def _is_plan(node: Node) -> bool:
    """Return whether a shape was extruded to a plan: its edges are those of the extrusion."""
    if node.rule is not placing.ROTATE_MATRIX or node.children[0].rule is not extrude.EXTRUDE:
        return False
    return {name: vector.plain for name, vector in node.numbers.items()} == PLAN


def suited(
    rule: Operator, children: Sequence[Node], numbers: Mapping[str, Number]
) -> tuple[Operator, Mapping[str, Number]]:
    """Return the operator for these shapes in place of a combination, and its further numbers.

    Args:
        rule: The combination, for solids.
        children: The shapes.
        numbers: The numbers of the combination.
    """
    flat = children[0].flat
    if rule in PRISMS and len(children) == 2 and "smooth" in numbers:
        common = _prism_axes(children[0]) & _prism_axes(children[1])
        if common:
            along = tuple(float(axis in common) for axis in "xyz"[: 2 if flat else 3])
            return PRISMS[rule][flat], {"along": Number(VEC2 if flat else VEC3, along)}
    return (FLAT_UNIONS.get(rule, rule) if flat else rule), {}


def _prism_axes(node: Node) -> frozenset[str]:
    """Return the axes along which a shape is a prism that ends at the sides of its box."""
    while True:
        rule = node.rule
        if any(isinstance(value, VaryingNumber) for value in node.constants.values()):
            return frozenset()
        if isinstance(rule, Primitive) or rule.along:
            return frozenset(rule.along)
        if rule.turn not in UPRIGHT_TURNS:
            return frozenset()
        node = node.children[0]


def _replaced(
    node: Node,
    rule: Operator,
    numbers: Mapping[str, Any],
    constants: Mapping[str, Any],
    place: Span | None,
) -> Node:
    return Node(
        rule,
        node.flat,
        node.children,
        numbers,
        constants,
        place,
        node.material,
        node.cut_material,
        node.label,
    )
