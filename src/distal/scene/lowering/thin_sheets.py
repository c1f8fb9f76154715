"""Thickness for sheets and lines, which have no inside, where rays are followed through solids.

Input: the tree of a scene. Output: a tree whose surfaces all have an inside. A ray from a surface
meets another one only where the sign of the distance changes (``render.segment``).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from distal.fields.deform.offsets import ROUND
from distal.fields.guarantees import Primitive
from distal.ir.types import FLOAT
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node

# Half the thickness of a sheet, in scene units.
RADIUS: Final = 1e-3


def with_insides(root: Node) -> Node:
    """Return the tree with shapes without an inside replaced by thin solids."""
    found: Node = root.derived("with insides", lambda: _thickened(root))
    return found


def _thickened(node: Node) -> Node:
    if node.signed:
        return node
    if isinstance(node.rule, Primitive):
        numbers = {"radius": Number(FLOAT, RADIUS)}
        return Node(ROUND, node.flat, (node,), numbers, place=node.place)
    return replace(node, children=tuple(_thickened(child) for child in node.children))
