"""The leaves of a tree, each below the operators that place it.

Input: a tree. Output: for each leaf a tree of its own: the operators of one child above it, in
their order, down to the leaf. Wherever the tree has a surface, one of these trees is 0. The tree is
made of them by booleans alone, so that its sign follows from theirs; what is blended is one leaf.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from distal.fields.combine.joins import COMPLEMENT, DIFFERENCE
from distal.fields.deform.offsets import (
    DILATE,
    ERODE,
    OFFSET,
    ROUND,
    SHELL_CENTER,
    SHELL_INNER,
    SHELL_OUTER,
)
from distal.fields.guarantees import Primitive
from distal.scene.lowering.safe_parts import SIGNS_ONLY
from distal.scene.tree.node import Node
from distal.scene.tree.part_names import PlacedPart

# Operators that move a surface outwards: what is cut out, they make smaller.
_OFFSETS: Final = frozenset((ROUND, OFFSET, DILATE, ERODE, SHELL_INNER, SHELL_CENTER, SHELL_OUTER))
# The name under which a tree keeps its leaves.
LEAVES: Final = "placed leaves"


@dataclass(frozen=True, slots=True, eq=False)
class PlacedLeaf:
    """A leaf below its operators.

    Attributes:
        tree: The operators above the leaf, each with one child, and the leaf. It is negative where
            the leaf adds to the solid: what is subtracted is complemented, below the offsets and
            shells that follow, but above all other operators, which are of the shape itself.
        leaf: The primitive, or the combination that is no boolean, as it is in the author's tree.
    """

    tree: Node
    leaf: Node

    @property
    def text(self) -> str:
        """The author's name of the leaf, its kind and line, for messages."""
        label = next((node.label for node in reversed(list(self.chain())) if node.label), "")
        return PlacedPart(self.leaf, label).text

    @property
    def cuts(self) -> bool:
        """Whether it is cut out of the solid."""
        return sum(node.rule is COMPLEMENT for node in self.chain()) % 2 == 1

    def chain(self) -> Iterator[Node]:
        """Yield the nodes of ``tree``, from the outermost operator to the leaf."""
        node = self.tree
        while node is not self.leaf:
            yield node
            node = node.children[0]
        yield node


def placed_leaves(root: Node) -> tuple[PlacedLeaf, ...]:
    """Return the leaves of a tree in the author's order; a part used twice is there twice."""
    return root.derived(LEAVES, lambda: tuple(_below(root)))


def _below(root: Node) -> Iterator[PlacedLeaf]:
    # Nodes with the operators above them, the innermost last.
    stack: list[tuple[Node, tuple[Node, ...]]] = [(root, ())]
    while stack:
        node, above = stack.pop()
        rule = node.rule
        if rule in SIGNS_ONLY:
            children = [(child, above) for child in node.children]
            if rule is DIFFERENCE:
                turned = _turned(above, node)
                children[1:] = [(child, turned) for child in node.children[1:]]
            stack.extend(reversed(children))
        elif isinstance(rule, Primitive) or len(node.children) != 1:
            tree = node
            for operator in reversed(above):
                tree = _with_child(operator, tree)
            yield PlacedLeaf(tree, node)
        else:
            stack.append((node.children[0], (*above, node)))


def _turned(above: tuple[Node, ...], node: Node) -> tuple[Node, ...]:
    """Return the operators above what a node subtracts, the innermost last."""
    at = len(above)
    while at and above[at - 1].rule not in _OFFSETS:
        at -= 1
    if at < len(above) and above[at].rule is COMPLEMENT:
        return (*above[:at], *above[at + 1 :])
    flat = above[at].flat if at < len(above) else node.flat
    return (*above[:at], Node(COMPLEMENT, flat, (node,), place=node.place), *above[at:])


def _with_child(operator: Node, child: Node) -> Node:
    return Node(
        operator.rule,
        operator.flat,
        (child,),
        operator.numbers,
        operator.constants,
        operator.place,
        label=operator.label,
    )
