"""A check that operators have a bound on their slope; a ray cannot be marched through other fields.

Input: a shape's tree. Output: an error at the place where the bound is lost, such as a twist of an
infinite shape. An operator is checked on construction for the parameters' defaults; other values
and times are checked when the scene is rendered (``scene.checks.warnings``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NoReturn, TypeAlias

from distal.fields.guarantees import ENDLESS, Operator, Primitive
from distal.ir.types import INT
from distal.lang.expressions import Expression
from distal.lang.runtime_access import executor
from distal.packages import PackageError, imported
from distal.scene.lowering.derived import GradientOf
from distal.scene.lowering.known_bounds import bounds_with, known_bounds_of
from distal.scene.tree.conversion import Number
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node
from distal.scene.tree.whole_numbers import whole_ends

# The low and the high corner.
Box: TypeAlias = "tuple[tuple[float, ...], tuple[float, ...]]"

# The number of places where a gradient is looked for, and how far out along axes without an end.
PLACES: Final = 64
REACH: Final = 2.0


def check_slope(node: Node) -> None:
    """Raise an error if the slope of an operator, applied to its children, has no bound.

    Raises:
        SceneValueError: At the operator's line.
    """
    if not may_be_endless(node):
        return
    try:
        slope = known_bounds_of(node).slope
    except PackageError:  # without NumPy, scenes are only compiled to text
        return
    if not slope < ENDLESS:
        boxes = [known_bounds_of(child) for child in node.children]
        refuse_steepness(node, [(box.low, box.high) for box in boxes])
    for name, number in node.numbers.items():
        if number.type is INT:
            _check_slope_at_ends(node, name, number)


def _check_slope_at_ends(node: Node, name: str, number: Number) -> None:
    """Refuse a count at whose largest or smallest value an operator has no bound on its slope."""
    assert isinstance(number.value, Expression)
    ends = whole_ends(number.value)
    assert ends is not None, "checked on conversion"
    for end in ends:
        if not bounds_with(node, name, end).slope < ENDLESS:
            boxes = [known_bounds_of(child) for child in node.children]
            corners = [(box.low, box.high) for box in boxes]
            refuse_steepness(node, corners, f" where '{name}' is {end}")


def check_gradient(node: Node) -> None:
    """Raise an error if an author's function has no gradient by which to divide its values.

    It is evaluated at some points, for the defaults of parameters at time 0.

    Raises:
        SceneValueError: At the line of the function's shape.
    """
    try:
        np = imported("numpy")  # only what runs scene code needs it
    except PackageError:
        return
    assert isinstance(node.rule, Primitive)
    known = known_bounds_of(node)
    size = 2 if node.flat else 3
    low, high = (np.clip(corner[:size], -REACH, REACH) for corner in (known.low, known.high))
    points = np.random.default_rng(0).uniform(low, high, (PLACES, size))
    unchanged = GradientOf(replace(node, rule=replace(node.rule, normalize=None)))
    found = np.asarray(executor().call(unchanged, (points,), {}, device="reference"))
    if not (np.isfinite(found) & (found != 0.0)).any():
        message = (
            f"'{node.name}' has no gradient at any of {PLACES} places, so it cannot be normalized"
        )
        hint = "return a value that changes gradually, not one made by floor, round or comparisons"
        refuse(message, hint, node.place)


def may_be_endless(node: Node) -> bool:
    """Return whether a node is an operator that has a slope only for some children."""
    return isinstance(node.rule, Operator) and node.rule.needs is not None


def loses_slope(slope: float, inner: Sequence[float]) -> bool:
    """Return whether an operator itself has no bound on its slope, although its children have.

    A shape that is used several times comes before and after the operators around it in any order
    of the tree, so the operator to report is found by its children, not by its place in this order.

    Args:
        slope: The operator's slope.
        inner: The slopes of its children.
    """
    return not slope < ENDLESS and all(of_child < ENDLESS for of_child in inner)


def refuse_steepness(node: Node, boxes: Sequence[Box], where: str = "") -> NoReturn:
    """Raise the error for an operator on children with these boxes, at its line.

    Args:
        node: The operator.
        boxes: The boxes.
        where: For which value of a number, with a space before it; "" for all.
    """
    assert isinstance(node.rule, Operator)
    message = f"{node.rule.name} gives this shape no bound on its slope{where}"
    hint = f"{node.rule.name} needs {node.rule.needs}{_boxed(boxes)}"
    refuse(message, hint, node.place)


def _boxed(boxes: Sequence[Box]) -> str:
    """Describe the box that the rule checked; "" if it is infinite, as the rule says so."""
    if len(boxes) != 1 or any(abs(c) >= ENDLESS for corner in boxes[0] for c in corner):
        return ""
    low, high = map(_corner, boxes[0])
    return f"; its box goes from {low} to {high}"


def _corner(place: tuple[float, ...]) -> str:
    return f"({', '.join(f'{c:.3g}' for c in place)})"
