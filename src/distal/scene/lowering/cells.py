"""A check that materials and numbers that depend on the cell are inside a repetition.

Input: a shape's tree. Output: an error if a material depends on the cell of a repetition but paints
the repetition as a whole, or if an operator around the repetition has a number that depends on it:
all copies would be like the first.
"""

from __future__ import annotations

from distal.fields.guarantees import Operator
from distal.lang.places import CELL
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.varying import VaryingNumber


def check_cells(root: Node) -> None:
    """Refuse materials and numbers that depend on the cell but are outside the repetition.

    Raises:
        CompileError: At the line of the material, or of the operator with the number.
    """
    seen: set[tuple[int, bool]] = set()
    stack = [(root, False)]
    while stack:
        node, inside = stack.pop()
        if (id(node), inside) in seen:
            continue
        seen.add((id(node), inside))
        for material in (node.material, node.cut_material):
            if material is not None and not inside and CELL in material.uses and _repeats(node):
                refuse(
                    "this material tells cells apart, but it paints what is repeated already",
                    "paint first, then repeat: shape.paint(by_cell()).repeat(2.0)",
                    material.call.place or node.place,
                )
        for name, value in node.constants.items():
            varies = isinstance(value, VaryingNumber) and CELL in value.uses
            if varies and not inside and _repeats(node):
                refuse(
                    f"'{name} of {node.rule.name}' depends on the cell, but stands after the "
                    "repetition",
                    "first change the shape, then repeat: shape.rotate(y=cell.x).repeat(2.0)",
                    node.place,
                )
        inner = inside or (isinstance(node.rule, Operator) and node.rule.repeats)
        stack.extend((child, inner) for child in node.children)


def _repeats(node: Node) -> bool:
    return any(isinstance(n.rule, Operator) and n.rule.repeats for n in node.walk())
