"""Shapes of which a parameter shows one: ``select``, ``choose`` and ``shown``.

Input: a condition or a whole number, and shapes. Output: one shape, in whose program all of them
are. A parameter that changes shows another one without a new compilation; the others cost a branch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, cast

from distal.diagnostics import Span
from distal.fields.combine.alternatives import NOTHING, NOTHING_FLAT, SELECT
from distal.frontend.problems import did_you_mean
from distal.ir.build import compare, integer
from distal.ir.nodes import CompareOp
from distal.ir.types import BOOL, INT
from distal.lang.expressions import Expression, Symbolic
from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.places import CELL
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.tree.conversion import Asked, Number, choice
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node
from distal.scene.tree.value import recorded
from distal.scene.tree.varying import varying_or_same
from distal.scene.tree.whole_numbers import whole_ends

S = TypeVar("S", bound=BaseShape)


@recorded
def choose(
    which: Parameter | Expression | int, shapes: Mapping[str, S | None] | Sequence[S | None]
) -> S:
    """Return the shape that a parameter chooses; the choice can change without a compilation.

    With ``form = choice("Form", ["ball", "cube"])``, ``choose(form, {"ball": Sphere(1.0), "cube":
    Box(1.5)})``; with ``level = integer("Level", 0, 0, 1)``, ``choose(level, [Sphere(), Box()])``.

    Args:
        which: A choice, or a whole number from 0: a parameter, or an expression with limits.
        shapes: A shape for each option by name, or a list of shapes in the order of the options.
            None is nothing. All are solids, or all are flat.

    Raises:
        SceneTypeError: ``which`` is no whole number, or there is something else among the shapes.
        SceneValueError: An option has no shape, or there is a shape for none.
    """
    place = author_place()
    listed = _listed(which, shapes, place)
    flat = _flatness("choose", listed, place)
    if not isinstance(which, Symbolic):
        number = choice(which, Asked("which", "choose", INT, place=place))
        assert isinstance(number, int)
        if not 0 <= number < len(listed):
            refuse(
                f"there is no shape {number}: choose has shapes 0 to {len(listed) - 1}", None, place
            )
        plain: S = _shape(listed[number], flat=flat)
        return plain
    held = which.as_expression()
    if held.node.type is not INT:
        _refuse_which(which, place)
    _check_reach(held, len(listed), place)
    nodes = [_node(shape, flat=flat, place=place) for shape in listed]
    made: S = BaseShape._of(_halved(held, nodes, 0, place))
    return made


@recorded
def selected(condition: Any, yes: Any, no: Any) -> Any:
    """Return ``yes`` where a condition holds, else ``no``; ``select`` of two shapes.

    Args:
        condition: A bool, a toggle, or a comparison of parameters or time.
        yes: A shape; None is nothing.
        no: Another one.

    Raises:
        SceneTypeError: The condition is none, or one of the two is no shape.
        SceneValueError: A flat shape and a solid are mixed.
    """
    place = author_place()
    flat = _flatness("select", (yes, no), place)
    asked = Asked("condition", "select", BOOL, place=place, varies=frozenset((CELL,)))
    test = choice(condition, asked)
    if not isinstance(test, Number):
        return _shape(yes if test else no, flat=flat)
    first, second = (_node(shape, flat=flat, place=place) for shape in (no, yes))
    return BaseShape._of(_of_two(first, second, test, place))


cast("Any", selected).written_as, cast("Any", selected).by_position = "select", True


def _listed(which: Any, shapes: Any, place: Span | None) -> Sequence[Any]:
    """Return the shapes in the order of the options."""
    if isinstance(shapes, Mapping):
        if not isinstance(which, Parameter) or which.kind is not ParameterKind.CHOICE:
            hint = "choose(number, [a, b, c]) for a whole number"
            refuse_kind("shapes by name need a choice, whose options are the names", hint, place)
        for name in shapes:
            if name not in which.options:
                hint = (
                    did_you_mean(str(name), which.options) or f"options: {', '.join(which.options)}"
                )
                refuse(f"the choice '{which.label}' has no option '{name!s:.40}'", hint, place)
        for option in which.options:
            if option not in shapes:
                hint = f"'{option}': None shows nothing"
                refuse(
                    f"choose has no shape for the option '{option}' of '{which.label}'", hint, place
                )
        return [shapes[option] for option in which.options]
    if isinstance(shapes, BaseShape | str) or not isinstance(shapes, Sequence) or not shapes:
        hint = "choose(form, [a, b]) or choose(form, {'ball': a, 'cube': b})"
        refuse_kind(
            f"choose takes a list of shapes, or shapes by name, not {shapes!r:.60}", hint, place
        )
    return shapes


def _check_reach(held: Expression, count: int, place: Span | None) -> None:
    """Refuse a number that may be none of the shapes."""
    ends = whole_ends(held)
    if ends is None:
        refuse(
            "'which of choose' needs a largest value, and this expression has none that is known",
            f"limit it: clamp(n, 0, {count - 1}) of distal.lang",
            place,
        )
    if ends != (0, count - 1):
        low, high = ends
        refuse(
            f"choose has {count} shapes, 0 to {count - 1}; 'which' goes from {low} to {high}",
            "give as many shapes as there are values",
            place,
        )


def _refuse_which(which: Symbolic, place: Span | None) -> None:
    kind = which.as_expression().node.type
    hint = "select(condition, a, b)" if kind is BOOL else "a choice(…) or an integer(…)"
    refuse_kind(f"'which of choose' takes a choice or a whole number, not a {kind}", hint, place)


def _flatness(what: str, shapes: Sequence[Any], place: Span | None) -> bool:
    """Return whether shapes lie in the plane, all or none."""
    found: set[bool] = set()
    for shape in shapes:
        if shape is None:
            continue
        if not isinstance(shape, BaseShape):
            refuse_kind(f"{what} takes shapes, not {shape!r:.60}", "None shows nothing", place)
        found.add(shape.flat)
    if len(found) > 1:
        refuse(
            f"{what} takes flat shapes or solids, not both",
            "make the flat one solid: .extrude(height) or .revolve()",
            place,
        )
    if not found:
        refuse_kind(f"{what} needs a shape: all of these are None", None, place)
    return found.pop()


def _node(shape: BaseShape | None, *, flat: bool, place: Span | None) -> Node:
    if shape is not None:
        return shape.node
    return Node(NOTHING_FLAT if flat else NOTHING, flat, place=place)


def _shape(shape: BaseShape | None, *, flat: bool) -> Any:
    return BaseShape._of(_node(shape, flat=flat, place=author_place())) if shape is None else shape


def _of_two(first: Node, second: Node, test: Number, place: Span | None) -> Node:
    given = varying_or_same(test, "second")
    if isinstance(given, Number):
        return Node(SELECT, first.flat, (first, second), {"second": given}, place=place)
    return Node(SELECT, first.flat, (first, second), {}, {"second": given}, place=place)


def _halved(which: Expression, nodes: Sequence[Node], first: int, place: Span | None) -> Node:
    """Return a tree of selections, as deep as the logarithm of the number of shapes.

    Args:
        which: The number of the chosen shape.
        nodes: The shapes.
        first: The number of the first of them.
        place: The author's line.
    """
    if len(nodes) == 1:
        return nodes[0]
    middle = len(nodes) // 2
    later = compare(CompareOp.GE, which.node, integer(first + middle))
    test = Number(BOOL, Expression(later, which.parameters))
    low = _halved(which, nodes[:middle], first, place)
    return _of_two(low, _halved(which, nodes[middle:], first + middle, place), test, place)
