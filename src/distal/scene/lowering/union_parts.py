"""The parts that a scene's root unites. Input: a tree. Output: nodes, in the author's order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from distal.fields.combine.joins import UNION
from distal.scene.tree.node import Node


def parts_of(root: Node) -> Iterator[Node]:
    """Yield the members of the unions at the root of a tree."""
    return (node for node, _ in painted_parts_of(root))


def painted_parts_of(root: Node) -> Iterator[tuple[Node, Any]]:
    """Yield these members, each with the paint of the unions around it; None if there is none."""
    stack: list[tuple[Node, Any]] = [(root, None)]
    while stack:
        node, outer = stack.pop()
        if node.rule is UNION:
            paint = node.material if outer is None else outer
            stack.extend((child, paint) for child in reversed(node.children))
        else:
            yield node, outer


def united(root: Node, nodes: Sequence[Node]) -> Node:
    """Return the union of several parts of a tree."""
    return nodes[0] if len(nodes) == 1 else replace(root, rule=UNION, children=tuple(nodes))
