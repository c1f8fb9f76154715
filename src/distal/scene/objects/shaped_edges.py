"""Fillets and chamfers: the edges of a shape's last operator, shaped afterwards.

Input: the node of a shape. Output: a node with the same children, whose operator shapes the edge.
Does not depend on the public classes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.combine import joins
from distal.fields.combine.blends import COMBINATIONS, IN_PLANE
from distal.fields.guarantees import Limit, Operator
from distal.fields.lift import extrude
from distal.ir.types import FLOAT
from distal.lang.places import CELL
from distal.scene.objects.binding import bound
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node

# The blend of each word, and the operator that replaces a plain extrusion, with its number.
_BLENDS: Final[Mapping[str, str]] = {"fillet": "round", "chamfer": "chamfer"}
_EXTRUDED: Final[Mapping[str, tuple[Operator, str]]] = {
    "fillet": (extrude.EXTRUDE_ROUNDED, "radius"),
    "chamfer": (extrude.EXTRUDE_CHAMFERED, "chamfer"),
}
_SHARP: Final = (joins.UNION, joins.INTERSECTION, joins.DIFFERENCE)
# The shapes that have the edge as one of their numbers.
_INSTEAD: Final[Mapping[str, Mapping[str, str]]] = {
    "fillet": {
        "Box": "RoundBox(size, rounding)",
        "Cylinder": "RoundedCylinder(radius, height, rounding)",
        "Rectangle": "RoundedRectangle(size, radii)",
        "Polygon": "RoundedPolygon(points, radius)",
    },
    "chamfer": {
        "Box": "ChamferBox(size, chamfer)",
        "Rectangle": "ChamferedRectangle(size, chamfer)",
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
        if node.flat:
            shaped = IN_PLANE.get(shaped, shaped)
        name = _EXTRUDED[word][1]
        varies = frozenset((CELL,))
        number(size, Asked(name, word, FLOAT, Limit.NOT_NEGATIVE, place=place, varies=varies))
        numbers, constants = bound(shaped, (size,), {}, place)
        return _replaced(node, shaped, numbers, constants, place)
    if rule is extrude.EXTRUDE:
        shaped, name = _EXTRUDED[word]
        height = (node.numbers.get("height") or node.constants["height"].number).value
        numbers, constants = bound(shaped, (), {"height": height, name: size}, place)
        return _replaced(node, shaped, numbers, constants, place)
    found = _INSTEAD[word].get(rule.name)
    if found is None and not node.children:
        found = "round(radius), which moves the whole surface outwards"
    refuse(
        f"a {word} shapes the edge of a union, intersection, difference or extrusion; the last "
        f"operation of this shape is '{rule.name}'",
        found or f"call {word} right after the operator: (a - b).{word}({size!r:.20}).translate(…)",
        place,
    )


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
