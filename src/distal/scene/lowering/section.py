"""The tree of a scene that is cut open by the plane of a section.

Input: a scene's tree. Output: the tree whose solids end at a plane, which is in uniforms that a
person moves. Planes that the scene is united with, such as its floor, stay whole.
"""

from __future__ import annotations

from typing import Final

from distal.fields.combine.joins import UNION
from distal.fields.deform.offsets import SECTION
from distal.scene.lowering.ray_functions import is_linear
from distal.scene.lowering.union_parts import painted_parts_of
from distal.scene.section import NORMAL, OFFSET
from distal.scene.tree.node import Node

_NUMBERS: Final = {"normal": NORMAL, "offset": OFFSET}


def is_sectionable(root: Node) -> bool:
    """Return whether a tree has a solid that ends somewhere, besides planes."""
    return any(not is_linear(part) for part, _ in painted_parts_of(root))


def sectioned(root: Node) -> Node:
    """Return the tree whose solids end at the plane.

    Each member of the unions at the root is cut for itself, so that bodies of several priorities,
    tables of many parts and planes in closed form stay what they are.
    """
    members = [_member(node, paint) for node, paint in painted_parts_of(root)]
    if len(members) == 1:
        return members[0]
    return Node(UNION, False, tuple(members), place=root.place, label=root.label)


def _member(node: Node, paint: object) -> Node:
    own = node if paint is None else node.with_material(paint)
    if is_linear(own):
        return own
    return Node(SECTION, False, (own,), _NUMBERS, place=own.place)
