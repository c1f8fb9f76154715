"""The parts of a tree that a safe field divides by their own divisors.

Input: nodes and the guarantees of their rules. Output: whether a subtree needs a divisor, whether
its children may have their own, how many such parts it has. The answers are the same for all values
of the parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from distal.fields.boxes import given_slope
from distal.fields.combine.alternatives import SELECT
from distal.fields.combine.joins import DIFFERENCE, INTERSECTION, UNION, XOR
from distal.fields.guarantees import Guarantee, Primitive
from distal.fields.place.flat import SCALE_FLAT
from distal.fields.place.solid import SCALE
from distal.ir.nodes import Expr
from distal.lang.functions import Func
from distal.scene.tree.node import Node

# The operators whose zero set depends only on the signs of their children, and those that only
# scale the child's value: to divide a child by its own divisor does not move the surface.
SIGNS_ONLY: Final = frozenset((UNION, INTERSECTION, DIFFERENCE, XOR, SELECT))
SCALES_VALUE: Final = frozenset((SCALE, SCALE_FLAT))


class SafeParts:
    """What the rules of a tree's nodes say about divisors, computed once for each node."""

    def __init__(self) -> None:
        self._unit_slope: dict[int, bool] = {}
        self._safe_values: dict[int, bool] = {}
        self._splits: dict[int, bool] = {}
        self._counts: dict[int, int] = {}
        self._alive: list[Node] = []  # keys are ids, so the nodes must stay alive

    def has_unit_slope(self, node: Node) -> bool:
        """Return whether the rules alone say that a subtree's slope is at most 1."""
        found = self._unit_slope.get(id(node))
        if found is None:
            slope = node.rule.slope
            if slope is given_slope:
                steep = node.numbers["slope"].may_exceed(1.0)
            else:
                steep = isinstance(slope, Func) or (slope is not None and slope > 1.0)
            found = not steep and all(map(self.has_unit_slope, node.children))
            self._unit_slope[id(node)] = found
            self._alive.append(node)
        return found

    def has_safe_values(self, node: Node) -> bool:
        """Return whether the rules alone say that a subtree needs no divisor."""
        found = self._safe_values.get(id(node))
        if found is None:
            rule = node.rule
            kept = rule.claims if isinstance(rule, Primitive) else rule.keeps
            found = (
                all(map(self.has_safe_values, node.children))
                if Guarantee.LOWER_BOUND in kept
                else self.has_unit_slope(node)
            )
            self._safe_values[id(node)] = found
            self._alive.append(node)
        return found

    def splits(self, node: Node) -> bool:
        """Return whether a safe field divides each child of a node by the child's own divisor.

        Smooth unions and deformations are divided as a whole: to divide their children would move
        the surface.
        """
        found = self._splits.get(id(node))
        if found is None:
            found = self._splits[id(node)] = self._may_split(node)
            self._alive.append(node)
        return found

    def _may_split(self, node: Node) -> bool:
        if not self.keeps_surfaces(node):
            return False
        return len(node.children) > 1 or self.splits(node.children[0])

    def keeps_surfaces(self, node: Node) -> bool:
        """Return whether the surface of an operator depends only on its children's surfaces."""
        rule = node.rule
        if isinstance(rule, Primitive) or rule.around is not None:
            return False
        if len(node.children) > 1:
            return rule in SIGNS_ONLY
        moves_only = rule.slope is None and rule.finish is None and not rule.repeats
        isometry = Guarantee.LOWER_BOUND in rule.keeps and moves_only
        return isometry or rule in SCALES_VALUE

    def count(self, node: Node) -> int:
        """Return the number of parts of a subtree that have their own divisors."""
        found = self._counts.get(id(node))
        if found is None:
            found = 0
            if not self.has_safe_values(node):
                found = sum(map(self.count, node.children)) if self.splits(node) else 1
            self._counts[id(node)] = found
            self._alive.append(node)
        return found

    def shared_out(self, node: Node, factors: Sequence[Expr] | None) -> list[Sequence[Expr]]:
        """Return the factors of each child of a node, from those of the node."""
        shares: list[Sequence[Expr]] = []
        at = 0
        for child in node.children:
            count = self.count(child) if factors else 0
            shares.append(factors[at : at + count] if factors else ())
            at += count
        return shares

    def factor_names(self, node: Node, taken: Sequence[str]) -> list[str]:
        """Return parameter names for the factors of a subtree that are not in ``taken``."""
        names: list[str] = []
        n = 0
        while len(names) < self.count(node):
            n += 1
            if f"factor_{n}" not in taken:
                names.append(f"factor_{n}")
        return names
