"""The shapes of a scene that emit light: where they are.

Input: the tree of a scene. Output: subtrees whose bounds contain a shape that emits light, in the
coordinates of the scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from distal.fields.guarantees import Primitive
from distal.fields.solids.round import sphere
from distal.scene.tree.node import Node

# Scenes with more lamps than this leave them to chance: each direction would ask all of them.
MOST: Final = 32


def lamps_of(root: Node, material: Any) -> list[Node]:
    """Return a subtree around each shape that may emit light; none if there are too many.

    Args:
        root: The tree of a scene.
        material: The material of shapes that have none.
    """
    found: list[Node] = root.derived(f"lamps {material.emits}", lambda: _found(root, material))
    return found


def is_ball(node: Node) -> bool:
    """Return whether a subtree is a ball that is moved, turned or scaled."""
    rule = node.rule
    if isinstance(rule, Primitive):
        return rule.distance is sphere
    return rule.turn is not None and is_ball(node.children[0])


def _found(root: Node, material: Any) -> list[Node]:
    found = []
    for lamp in _lamps(root, material):
        found.append(lamp)
        if len(found) > MOST:
            return []
    return found


def _lamps(node: Node, material: Any) -> Iterator[Node]:
    """Yield the lamps of a subtree, each with the moves above it.

    What a cut takes away from a lamp, or a blend adds, only makes its box less tight.
    """
    if node.material is not None or not node.children:
        if (node.material or material).emits:
            yield node
        return
    for child in node.children:
        for lamp in _lamps(child, material):
            yield lamp if len(node.children) > 1 else replace(node, children=(lamp,))
