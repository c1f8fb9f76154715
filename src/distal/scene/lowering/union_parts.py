"""The parts that a scene's root unites. Input: a tree. Output: nodes, in the author's order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from distal.fields.combine.joins import UNION
from distal.scene.tree.node import Node
from distal.scene.tree.placement import is_placement


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


def placed_parts_of(root: Node) -> Iterator[tuple[Node, Node]]:
    """Yield the parts that unions unite below placements: as they are placed, and themselves."""
    stack: list[tuple[Node, tuple[Node, ...]]] = [(root, ())]
    while stack:
        node, above = stack.pop()
        if node.rule is UNION:
            stack.extend((child, above) for child in reversed(node.children))
        elif is_placed(node):
            stack.append((node.children[0], (*above, node)))
        else:
            placed = node
            for outer in reversed(above):
                placed = replace(outer, children=(placed,))
            yield placed, node


def is_placed(node: Node) -> bool:
    """Return whether a node is a union that is placed."""
    while is_placement(node.rule):
        node = node.children[0]
        if node.rule is UNION:
            return True
    return False


def united(root: Node, nodes: Sequence[Node]) -> Node:
    """Return the union of several parts of a tree."""
    return nodes[0] if len(nodes) == 1 else replace(root, rule=UNION, children=tuple(nodes))
