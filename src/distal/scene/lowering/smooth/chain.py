"""The members of a smooth union, in the order in which they are joined.

Input: a tree whose root is a smooth union. Output: its members and how each is joined to those
before it. ``union([a, b, c], smooth=k)`` and ``a.union(b, smooth=k).union(c, smooth=m)`` are both
chains; so is a smooth union with hard unions inside of it, if these come first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from distal.fields.combine.blends import UNION_BLENDS
from distal.fields.combine.joins import UNION
from distal.lang.expressions import Expression
from distal.scene.lowering.parts.flatten import UnionMember
from distal.scene.lowering.parts.kinds import is_moving
from distal.scene.tree.node import Node
from distal.scene.tree.varying import VaryingNumber

MOVING: Final = "its shape depends on parameters or time"
MOVING_BLEND: Final = "the size of its blend depends on parameters or time"
EVERYWHERE: Final = "the blend '{}' differs from the minimum everywhere"
BOTH: Final = "where the blend '{}' differs from the minimum depends on more than the difference"


@dataclass(frozen=True, slots=True)
class Link:
    """A member of a smooth union.

    Attributes:
        node: The member.
        join: The union that joins it to the members before it; that of the second one for the
            first.
    """

    node: Node
    join: Node

    @property
    def member(self) -> UnionMember:
        """The member as a part: below a union of one shape, which has the numbers of the blend."""
        join = self.join
        return UnionMember(
            Node(join.rule, join.flat, (self.node,), join.numbers, join.constants, join.place),
            self.node,
        )


def is_smooth_union(node: Node) -> bool:
    """Return whether a node is a smooth union of solids."""
    return node.rule in UNION_BLENDS and not node.flat


def chain_of(root: Node) -> list[Link]:
    """Return the members of a smooth union, in the order in which they are joined."""
    backwards: list[Link] = []
    node = join = root
    while node is root or (_joins(node) and _is_plain(node)):
        join = node
        backwards.extend(Link(child, node) for child in reversed(node.children[1:]))
        node = node.children[0]
    backwards.append(Link(node, join))
    return backwards[::-1]


def _joins(node: Node) -> bool:
    return len(node.children) > 1 and (node.rule is UNION or node.rule in UNION_BLENDS)


def _is_plain(node: Node) -> bool:
    """Return whether a union inside of a chain has no material and no name of its own."""
    return node.material is None and node.cut_material is None and not node.label


def width_of(link: Link) -> float:
    """Return from which difference of two distances on the blend of a link is the minimum."""
    if link.join.rule is UNION:
        return 0.0
    width = UNION_BLENDS[link.join.rule].width  # type: ignore[index]  # a union is an operator
    size = link.join.numbers["smooth"].plain
    assert width is not None and isinstance(size, float | int)
    return width * float(size)


def first_linear(links: list[Link]) -> tuple[int, str]:
    """Return the first link that cannot be in a grid, and why; the number of links if all can."""
    for i, link in enumerate(links):
        join = link.join
        if join.rule is not UNION:
            blend = UNION_BLENDS[join.rule]  # type: ignore[index]  # a union is an operator
            name = join.rule.name.removeprefix("union ")
            if not blend.local:
                return i, EVERYWHERE.format(name)
            if blend.width is None:
                return i, BOTH.format(name)
            changes = any(isinstance(number.value, Expression) for number in join.numbers.values())
            if changes or any(isinstance(v, VaryingNumber) for v in join.constants.values()):
                return i, MOVING_BLEND
        if is_moving(link.node):
            return i, MOVING
    return len(links), ""


def joined(links: list[Link], nodes: list[Node]) -> Node:
    """Return a smooth union of other shapes than those of its links.

    Args:
        links: How the shapes are joined.
        nodes: The shapes, one for each member.
    """
    made = nodes[0]
    at = 1
    while at < len(links):
        join = links[at].join
        end = at
        while end < len(links) and links[end].join is join:
            end += 1
        made = replace(join, children=(made, *nodes[at:end]))
        at = end
    return made
