"""The axes of a box, seen from a shape below moves: so that boxes are not turned several times.

Input: rigid moves and scales, from the outermost. Output: the axes of the outermost box, in the
coordinates of what is below, and boxes along them. A box around a turned box is larger than the box
around the turned shape: what is below a turn is asked for its box along the axes above it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final, TypeGuard, TypeVar

from distal.fields.combine.alternatives import SELECT
from distal.fields.extents import along_axes, moved_along, overlap
from distal.fields.guarantees import Growth, Operator, signature_types
from distal.fields.repeat.varied import IN_CELLS
from distal.ir.build import compose
from distal.ir.build import number as constant_number
from distal.ir.nodes import Expr
from distal.ir.types import VEC3
from distal.lang.functions import Func
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# The most children of an operator whose bounds are composed in one function.
AT_ONCE: Final = 16
# The most intersections below each other whose boxes are asked for along two sets of axes: each
# doubles the work.
MOST_OVERLAPS: Final = 4
_NUMBERS: Final = (constant_number(0.0), constant_number(1.0))
Call = Callable[..., Expr]


@dataclass(frozen=True, slots=True)
class BoxAxes:
    """The axes of a box, seen from a shape and in its units.

    Attributes:
        x: The unit vector whose product with a point of the shape is its place along the box's x
            axis, but for ``at``.
        y: The same for the y axis.
        z: The same for the z axis.
        at: Where the shape's origin is along the three axes.
        overlaps: How many intersections above were asked for their boxes along two sets of axes.
    """

    x: Expr
    y: Expr
    z: Expr
    at: Expr
    overlaps: int = 0

    @staticmethod
    def own(overlaps: int = 0) -> BoxAxes:
        """Return the axes of the shape's own space.

        Args:
            overlaps: As the attribute.
        """
        x, y, z = (_vector(*(int(i == j) for j in range(3))) for i in range(3))
        return BoxAxes(x, y, z, _vector(0, 0, 0), overlaps)

    def inside(self, rule: Operator) -> BoxAxes:
        """Return the axes, seen from the children of a combination.

        Args:
            rule: The operator.
        """
        return replace(self, overlaps=self.overlaps + (rule.bounds is overlap))

    def below(
        self, body: StatementList, call: Call, rule: Operator, own: Mapping[str, Expr]
    ) -> BoxAxes:
        """Return the axes, seen from the child of a rigid move or a scale.

        Args:
            body: The statements to add to.
            call: Adds a call of a library function (``Assembly.call``).
            rule: The operator.
            own: Its numbers, by name.
        """
        assert rule.turn is not None
        x, y, z = (
            body.let("way", call(rule.turn, {**own, "p": way})) for way in (self.x, self.y, self.z)
        )
        origin = call(rule.point, {**own, "p": _vector(0, 0, 0)})
        factor = _NUMBERS[1]
        if rule.finish is not None:  # what it makes of a distance of 1
            factor = call(rule.finish, {**own, "d": factor})
        moved = {"at": self.at, "origin": origin, "x": x, "y": y, "z": z, "factor": factor}
        at = body.let("start", call(moved_along, moved))
        return BoxAxes(x, y, z, at, self.overlaps)

    @staticmethod
    def above(
        body: StatementList, call: Call, rule: Operator, own: Mapping[str, Expr], box: Expr
    ) -> Expr:
        """Return a box along the axes, in units above a rigid move or a scale.

        Args:
            body: The statements to add to.
            call: Adds a call of a library function (``Assembly.call``).
            rule: The operator.
            own: Its numbers, by name.
            box: The box along the axes ``below`` it.
        """
        if rule.finish is None:
            return box
        assert rule.bounds is not None
        return body.let("bounds", call(rule.bounds, {**own, "bounds": box}))

    def box(self, body: StatementList, call: Call, bounds: Expr) -> Expr:
        """Return the box along these axes around a box of the shape's own space.

        Args:
            body: The statements to add to.
            call: Adds a call of a library function (``Assembly.call``).
            bounds: The box.
        """
        given = {"bounds": bounds, "x": self.x, "y": self.y, "z": self.z, "at": self.at}
        return body.let("bounds", call(along_axes, given))


def _vector(x: int, y: int, z: int) -> Expr:
    return compose(VEC3, _NUMBERS[x], _NUMBERS[y], _NUMBERS[z])


def is_cut_twice(rule: Operator, axes: BoxAxes) -> bool:
    """Return whether a combination's box is the smaller for also being made in its own space.

    Of an intersection it may be: each of the two boxes is cut by others.

    Args:
        rule: The operator.
        axes: The axes along which its box is asked for.
    """
    return rule.bounds is overlap and axes.overlaps < MOST_OVERLAPS


def is_move(rule: object) -> TypeGuard[Operator]:
    """Return whether a rule is a rigid move or a scale."""
    return isinstance(rule, Operator) and rule.turn is not None


def names_no_axis(rule: Operator) -> bool:
    """Return whether the rules for box and growth hold along any axes: a shape stays where it is.

    Rules that hold for boxes and rectangles alike name no axis.
    """
    if isinstance(rule.growth, Func):
        return False
    if rule.bounds is None:
        return rule.point is None and rule.around is None
    return isinstance(signature_types(rule.bounds)["return"], TypeVar)


def passes_axes(node: Node) -> bool:
    """Return whether the box of a node along any axes follows from those of its children."""
    rule = node.rule
    if not isinstance(rule, Operator) or rule is SELECT or rule is IN_CELLS:
        return False
    if node.flat or node.has_rows or len(node.children) > AT_ONCE:
        return False
    return is_move(rule) or names_no_axis(rule)


def turns_boxes_again(node: Node) -> bool:
    """Return whether a node turns a shape whose box is not its own: one that is turned or combined.

    Args:
        node: The node.
    """
    turns = 0
    while passes_axes(node) and is_move(node.rule):
        turns += node.rule.growth is Growth.TURNED
        (node,) = node.children
    return turns > 1 or (turns == 1 and passes_axes(node))
