"""Operators that programs of pieces take apart, and why others stay whole.

Input: the declarations of operators and blends. Output: for a node, how it changes or joins the
values of its children (``ValueJoin``), whether it only moves the point, or why it stays whole.

========================  ====================================================================
operators                 in a program
========================  ====================================================================
hard joins, clearance     steps
local blends of a width   steps; others differ from the minimum everywhere, or their difference
                          alone does not say where: they stay whole
complement, offsets,      steps
shells
splits                    an intersection or a difference with a half space
moves without ``finish``  in the leaves: rigid moves, mirrors, symmetries, elongation, revolution;
                          the field is that of the children at another point
uniform scales            in the leaves, and in the sizes of all steps below
deformations              in the leaves, if all below is finite and hard joins, and nothing above
                          depends on values: the solid is the same, values off its surface are not
others                    whole
========================  ====================================================================
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import Final

from distal.fields.combine.blends import BLENDS, COMBINATIONS
from distal.fields.combine.joins import (
    CLEARANCE,
    COMPLEMENT,
    DIFFERENCE,
    INTERSECTION,
    UNION,
)
from distal.fields.deform.offsets import (
    DILATE,
    ERODE,
    OFFSET,
    ROUND,
    SHELL_CENTER,
    SHELL_INNER,
    SHELL_OUTER,
    SPLIT_ABOVE,
    SPLIT_BELOW,
)
from distal.fields.deform.solid import (
    ATTRACT,
    BEND,
    BEND_LINEAR,
    BEND_RADIAL,
    REPEL,
    TAPER,
    TWIST,
)
from distal.fields.guarantees import (
    BOUNDS_OF_CHILDREN,
    ENDLESS,
    OPERATORS,
    Operator,
    Primitive,
    signature_types,
)
from distal.fields.place.flat import SCALE_FLAT
from distal.fields.place.mirrors import SYMMETRY_PLANES, SYMMETRY_PLANES_FLAT
from distal.fields.place.solid import SCALE, SHEAR, STRETCH
from distal.lang.expressions import Expression
from distal.lang.functions import Func
from distal.lang.runtime_access import executor
from distal.lang.value_of import ValueOf
from distal.scene.tree.conversion import Number
from distal.scene.tree.node import Node
from distal.scene.tree.varying import VaryingNumber

MOVING_SIZE: Final = "its size depends on parameters or time"
MOVING_SCALE: Final = "the scale of a shape with blends or offsets depends on parameters or time"
VARYING: Final = "its numbers differ from place to place"
SEVERAL_PLACES: Final = "it repeats its shape, or computes it at several points"
OTHER_JOIN: Final = "'{}' is no union, intersection or difference"
MOVING_BLEND: Final = "the size of its blend has no largest value for all parameters and times"
EVERYWHERE: Final = "the blend '{}' differs from the minimum everywhere"
BOTH: Final = "where the blend '{}' differs from the minimum depends on more than the difference"
OTHER_CHANGE: Final = "'{}' does not only move the point or the surface"
DEFORMED: Final = "a deformed shape with blends, offsets or a shape without end stays whole"


class JoinCode(IntEnum):
    """What a step does to values; ``ValueJoin`` has the numbers."""

    UNION = 0
    INTERSECTION = 1
    DIFFERENCE = 2
    COMPLEMENT = 3
    SHIFT = 4
    SHELL = 5

    @property
    def is_binary(self) -> bool:
        """Whether it joins two values."""
        return self <= JoinCode.DIFFERENCE


@dataclass(frozen=True, slots=True)
class ValueJoin:
    """How a step joins two values, or changes one.

    Attributes:
        code: What it does.
        rule: The operator whose function computes it: ``combine(a, b, **numbers)`` for two values,
            ``finish(d, **numbers)`` for one.
        numbers: The numbers of the function by name, in the units of the whole tree; of one that
            depends on parameters or time the largest.
        moving: A number of the function that depends on them: its name, it, the factor of its unit.
        width: For two values: from which difference on the blend is the minimum or maximum.
        settles: Whether the effect of a value on a chain of such blends fades at each further
            blend. Not that of stairs, whose treads depend on one value alone.
        shift: For one value d: a shift is d - shift, a shell is |d - shift| - half.
        half: For a shell: half of its thickness.
        mix: The share of the second operand's material, with the parameters of ``combine``; None
            for that of the nearer operand.
        shows_cutter: For a difference: whether its faces have the material of the second operand
            (which its leaves have, and which is the cutter's ``cut_material``), or keep that of the
            first.
    """

    code: JoinCode
    rule: Operator
    numbers: tuple[tuple[str, float | int], ...] = ()
    moving: tuple[str, Number, float] | None = None
    width: float = 0.0
    settles: bool = True
    shift: float = 0.0
    half: float = 0.0
    mix: Func | None = None
    shows_cutter: bool = False

    @property
    def is_hard(self) -> bool:
        """Whether it is the minimum or the maximum itself."""
        return self.width == 0.0


@dataclass(frozen=True, slots=True)
class _ValueChange:
    """How an operator changes a value: signs of its number in ``ValueJoin.shift`` and ``half``."""

    code: JoinCode
    number: str = ""
    shift: float = 0.0
    half: float = 0.0


_HARD: Final[Mapping[Operator, JoinCode]] = {
    UNION: JoinCode.UNION,
    INTERSECTION: JoinCode.INTERSECTION,
    DIFFERENCE: JoinCode.DIFFERENCE,
}
_BLENDED: Final[Mapping[Operator, tuple[JoinCode, str]]] = {
    rule: (JoinCode[kind.upper()], name)
    for (kind, name), rule in COMBINATIONS.items()
    if name in BLENDS and kind.upper() in JoinCode.__members__
}
_CHANGES: Final[Mapping[Operator, _ValueChange]] = {
    COMPLEMENT: _ValueChange(JoinCode.COMPLEMENT),
    ROUND: _ValueChange(JoinCode.SHIFT, "radius", 1.0),
    OFFSET: _ValueChange(JoinCode.SHIFT, "distance", 1.0),
    DILATE: _ValueChange(JoinCode.SHIFT, "distance", 1.0),
    ERODE: _ValueChange(JoinCode.SHIFT, "distance", -1.0),
    SHELL_INNER: _ValueChange(JoinCode.SHELL, "thickness", -0.5, 0.5),
    SHELL_CENTER: _ValueChange(JoinCode.SHELL, "thickness", 0.0, 0.5),
    SHELL_OUTER: _ValueChange(JoinCode.SHELL, "thickness", 0.5, 0.5),
}
# Splits are joins with a half space behind the plane; ``first_shows``: they have no material.
SPLITS: Final[Mapping[Operator, JoinCode]] = {
    SPLIT_BELOW: JoinCode.INTERSECTION,
    SPLIT_ABOVE: JoinCode.DIFFERENCE,
}
SYMMETRIES: Final = frozenset((SYMMETRY_PLANES, SYMMETRY_PLANES_FLAT))
DEFORMATIONS: Final = frozenset(
    (TWIST, BEND, BEND_LINEAR, BEND_RADIAL, TAPER, ATTRACT, REPEL, STRETCH, SHEAR)
)
SCALES: Final = frozenset((SCALE, SCALE_FLAT))
JOINING: Final = frozenset((*_HARD, *_BLENDED, CLEARANCE))
HARD_RULES: Final = {code: rule for rule, code in _HARD.items()}


def is_change(node: Node) -> bool:
    """Return whether a node changes the values of its child by a step."""
    return node.rule in _CHANGES


@lru_cache(maxsize=1024)
def only_moves(rule: Primitive | Operator) -> bool:
    """Return whether the field of an operator is that of its child at another point.

    The point must depend on the operator's numbers alone: the box of a child is not that of the
    leaves below.
    """
    if not isinstance(rule, Operator) or rule.point is None or rule.repeats:
        return False
    if any(f is not None for f in (rule.finish, rule.combine, rule.around)):
        return False
    if OPERATORS.get(rule.name) is not rule and rule not in SYMMETRIES:
        return False  # an author's operator
    return not BOUNDS_OF_CHILDREN & set(signature_types(rule.point))


def deforms(rule: Primitive | Operator) -> bool:
    """Return whether an operator moves the points of a solid and only scales or cuts its values.

    Then the solid of a hard join is the join of the solids, if each is within its own box.
    """
    return rule in DEFORMATIONS


def varies(node: Node) -> bool:
    """Return whether numbers of a node's own differ from place to place."""
    return any(isinstance(value, VaryingNumber) for value in node.constants.values())


def join_of(node: Node, factor: float | None) -> ValueJoin | str:
    """Return how a node joins the values of its children, or why it stays whole.

    Args:
        node: The node.
        factor: The scale of what is above it; None if it is not fixed.
    """
    rule = node.rule
    assert isinstance(rule, Operator)
    if rule is CLEARANCE:
        # ``max(a, gap - b)`` is the difference with the second shape, moved outwards by the gap.
        return ValueJoin(JoinCode.DIFFERENCE, DIFFERENCE, mix=rule.mix)
    if rule in _HARD:
        return ValueJoin(_HARD[rule], rule, mix=rule.mix)
    code, name = _BLENDED[rule]
    blend = BLENDS[name]
    if not blend.local:
        return EVERYWHERE.format(name)
    if blend.width is None:
        return BOTH.format(name)
    if varies(node):
        return VARYING
    number = node.numbers["smooth"]
    size = _largest(number)
    if not size < ENDLESS:
        return MOVING_BLEND
    if factor is None:
        return MOVING_SCALE
    numbers = {"smooth": factor * size, **_choices(node)}
    return ValueJoin(
        code,
        rule,
        tuple(numbers.items()),
        None if number.plain is not None else ("smooth", number, factor),
        width=blend.width * factor * size,
        settles=not blend.counted,
        mix=rule.mix,
    )


def change_of(node: Node, factor: float | None) -> ValueJoin | str:
    """Return how a node changes the values of its child, or why it stays whole.

    Arguments as for ``join_of``.
    """
    rule = node.rule
    assert isinstance(rule, Operator)
    change = _CHANGES[rule]
    if not change.number:
        return ValueJoin(change.code, rule)
    return _sized(change, rule, change.number, node, factor)


def gap_of(node: Node, factor: float | None) -> ValueJoin | str:
    """Return how a clearance moves the second shape outwards; arguments as for ``join_of``."""
    found = _sized(_CHANGES[OFFSET], OFFSET, "gap", node, factor)
    if isinstance(found, str):
        return found
    return ValueJoin(found.code, OFFSET, (("distance", found.shift),), shift=found.shift)


def _sized(
    change: _ValueChange, rule: Operator, name: str, node: Node, factor: float | None
) -> ValueJoin | str:
    if varies(node):
        return VARYING
    size = node.numbers[name].plain
    if not isinstance(size, float | int):
        return MOVING_SIZE
    if factor is None:
        return MOVING_SCALE
    size = factor * size
    return ValueJoin(
        change.code, rule, ((name, size),), shift=change.shift * size, half=change.half * size
    )


def _largest(number: Number) -> float:
    """Return the largest value of a number, at any time and for any values of its parameters."""
    value = number.value
    if not isinstance(value, Expression):
        assert isinstance(value, float | int)
        return value
    ((_, high),) = executor().sweep(ValueOf(value), ())
    return max(float(high), 0.0)


def _choices(node: Node) -> dict[str, int]:
    """Return the counts of a node: whole numbers that its function takes."""
    return {name: int(getattr(v, "value", v)) for name, v in node.constants.items()}


def why_whole(node: Node) -> str:
    """Return why a node that joins shapes is no step of a program."""
    rule = node.rule
    if varies(node):
        return VARYING
    if not isinstance(rule, Operator) or rule.around is not None or rule.repeats:
        return SEVERAL_PLACES
    if rule.combine is not None:
        return OTHER_JOIN.format(rule.name)
    return DEFORMED if deforms(rule) else OTHER_CHANGE.format(rule.name)
