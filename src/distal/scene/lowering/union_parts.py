"""The parts that a scene's root unites. Input: a tree. Output: nodes, in the author's order."""

from __future__ import annotations

from collections.abc import Iterator

from distal.fields.combine.joins import UNION
from distal.scene.tree.node import Node


def parts_of(root: Node) -> Iterator[Node]:
    """Yield the members of the unions at the root of a tree."""
    stack = [root]
    while stack:
        node = stack.pop()
        if node.rule is UNION:
            stack.extend(reversed(node.children))
        else:
            yield node
