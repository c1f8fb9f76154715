"""A shape's text in a notebook or a debugger: its numbers, its parts, the author's line.

Input: a node. Output: one line, such as
``<Shape translate(offset=(1, 2, 3)) of union of Sphere, Box, scene.py:4>``.
"""

from __future__ import annotations

from typing import Final

from distal.fields.repeat.varied import IN_CELLS
from distal.scene.tree.node import Node
from distal.scene.tree.shown_numbers import listed, placed
from distal.scene.tree.varying import holds

_MOST_CHILDREN: Final = 4
_DEEPEST: Final = 3


def described(kind: str, node: Node) -> str:
    """Return the text of a shape.

    Args:
        kind: The name of its class.
        node: Its tree.
    """
    what = _of(node, _DEEPEST)
    own = "" if node.rule.name == kind else f"{kind} "
    label = f" '{node.label}'" if node.label else ""
    place = "" if node.place is None else f", {placed(node.place)}"
    return f"<{own}{what}{label}{place}>"


def _of(node: Node, depth: int) -> str:
    if node.rule is IN_CELLS or holds(node.rule):
        return _of(node.children[0], depth)
    numbers = listed(node.numbers, node.constants)
    if not node.children:
        return f"{node.rule.name}{numbers}"
    count = len(node.children)
    if depth == 0 or count > _MOST_CHILDREN:
        return f"{node.rule.name}{numbers} of {count} shape{'s' * (count > 1)}"
    children = ", ".join(_of(child, depth - 1) for child in node.children)
    return f"{node.rule.name}{numbers} of {children}"
