"""Deep trees made shallow: chains of placements become one placement, nested unions one union.

Input: a tree, such as a turtle's, that moves and turns all that it has drawn so far with each step.
Output: a tree of the same shape, whose depth does not grow with the number of steps. Translations,
rotations, scales, mirror images and symmetries of constant numbers are folded to one row of planes
of symmetry, one translation, one rotation and one scale; those of a union become those of its
members. Values agree within rounding, so trees that are not deep remain as the author wrote them.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from distal.diagnostics import Span
from distal.fields.combine.blends import UNION_BLENDS
from distal.fields.combine.joins import UNION
from distal.fields.guarantees import Operator
from distal.fields.place import flat as in_plane
from distal.fields.place import mirrors, solid
from distal.ir.types import FLOAT, VEC2, VEC3
from distal.lang.resources import Buffer
from distal.scene.tree.conversion import Number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.placement import AXES, AffinePlacement, Vector, placement_of

# Trees are folded when they become this deep, and again each time they have grown by _STEP.
FOLDED_FROM: Final = 64
_STEP: Final = 32
# One call of a method may add several operators: a tree is looked at this often in each step.
_LOOKS: Final = 3
# The largest depth of a tree that cannot be folded. Lowering takes some of Python's frames for each
# operator, and some of them lie on the thread's stack: 1 MB is enough for twice as many.
MOST_NESTED: Final = 300
_FRAMES: Final = 16
# The most members to which a placement is moved down: below, a tree may share its branches.
_MOST_MEMBERS: Final = 20_000


def _placed(node: Node, placement: AffinePlacement, place: Span | None) -> Node:
    """Return a shape with a placement."""
    flat = node.flat
    size = 2 if flat else 3
    vector = VEC2 if flat else VEC3

    def under(rule: Any, numbers: Mapping[str, Number]) -> Node:
        return Node(rule, flat, (node,), numbers, place=place)

    if not placement.is_uniform:
        factors = Number(vector, placement.factors[:size])
        node = under(in_plane.STRETCH_FLAT if flat else solid.STRETCH, {"factors": factors})
    elif placement.factors[0] != 1.0:
        factor = Number(FLOAT, placement.factors[0])
        node = under(in_plane.SCALE_FLAT if flat else solid.SCALE, {"factor": factor})
    if (placement.right, placement.up, placement.back) != AXES:
        if flat:
            if placement.right[0] * placement.up[1] < placement.right[1] * placement.up[0]:
                axes = {"x": False, "y": True}
                node = Node(in_plane.REFLECT_FLAT, flat, (node,), constants=axes, place=place)
            angle = Number(FLOAT, math.atan2(placement.right[1], placement.right[0]))
            node = under(in_plane.ROTATE_FLAT, {"angle": angle})
        else:
            columns = {"right": placement.right, "up": placement.up, "back": placement.back}
            numbers = {name: Number(VEC3, axis) for name, axis in columns.items()}
            node = under(solid.ROTATE_MATRIX, numbers)
    if any(placement.offset):
        offset = Number(vector, placement.offset[:size])
        node = under(in_plane.TRANSLATE_FLAT if flat else solid.TRANSLATE, {"offset": offset})
    if placement.planes:
        rule = mirrors.SYMMETRY_PLANES_FLAT if flat else mirrors.SYMMETRY_PLANES
        planes = Buffer(_unlinked(placement.planes))
        node = Node(rule, flat, (node,), constants={"planes": planes}, place=place)
    return node


def _unlinked(planes: tuple[Any, ...]) -> list[Vector]:
    """Return the planes of a linked list, the outermost first."""
    found = []
    while planes:
        planes, plane = planes
        found.append(plane)
    return found[::-1]


def shallow(node: Node) -> Node:
    """Return a tree whose depth is limited: the given one, unless it is deep.

    Raises:
        SceneValueError: It is too deep, and its operators cannot be folded.
    """
    if node.nesting < FOLDED_FROM:
        return node
    # Lowering descends by recursion. A limit that is too high only delays an error.
    frames = 1000 + _FRAMES * min(node.nesting, MOST_NESTED)
    if sys.getrecursionlimit() < frames:
        sys.setrecursionlimit(frames)
    if node.nesting % _STEP < _LOOKS:
        node = _folded(node, {})
    deep = _operators(node) if node.nesting > MOST_NESTED else 0
    if deep > MOST_NESTED:
        refuse(
            f"this {node.name} is the last of {deep} operators, each on the result of the one "
            f"before; at most {MOST_NESTED} are possible",
            "unite shapes that are placed each by itself; moves, rotations, scales, mirror images "
            "and symmetries by constant numbers, and unions, are not counted",
            node.place,
        )
    return node


def _operators(node: Node) -> int:
    """Return how many operators are below each other, without unions: chains of them are flat."""
    count = 0
    while node.children:
        count += not (node.rule is UNION or node.rule in UNION_BLENDS)
        node = max(node.children, key=lambda child: child.nesting)
    return count


def _folded(root: Node, known: dict[int, Node]) -> Node:
    """Return a tree with its placements and unions folded.

    Args:
        root: The tree.
        known: What is folded already, by the id of its root.
    """
    if root.nesting < _STEP:
        return root
    found = known.get(id(root))
    if found is not None:
        return found
    spreads = root.parts <= _MOST_MEMBERS
    members: list[Node] = []
    stack: list[tuple[Node, AffinePlacement, Span | None]] = [(root, AffinePlacement(), root.place)]
    while stack:
        node, placement, place = stack.pop()
        is_bare = node is root or not (node.material or node.cut_material or node.label)
        if is_bare and node.rule is UNION and (spreads or len(node.children) == 1):
            stack.extend((child, placement, place) for child in reversed(node.children))
            continue
        inner = None
        if is_bare and isinstance(node.rule, Operator) and _is_constant(node):
            inner = placement_of(node.rule, node.numbers, node.constants, placement)
        if inner is not None:
            stack.append((node.children[0], inner, node.place))
            continue
        if node.children and node.nesting >= _STEP:
            children = tuple(_folded(child, known) for child in node.children)
            if any(new is not old for new, old in zip(children, node.children, strict=True)):
                node = replace(node, children=children)
        members.append(_placed(node, placement, place))
    made = members[0]
    if len(members) > 1:
        made = Node(UNION, root.flat, tuple(members), place=root.place)
    if root.material or root.cut_material or root.label:
        made = replace(
            made,
            material=root.material or made.material,
            cut_material=root.cut_material or made.cut_material,
            label=root.label or made.label,
        )
    known[id(root)] = made
    return made


def _is_constant(node: Node) -> bool:
    return all(number.plain is not None for number in node.numbers.values()) and all(
        isinstance(value, bool | Buffer) for value in node.constants.values()
    )
