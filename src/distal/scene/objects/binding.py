"""Binding of arguments to primitives and operators; an author's function as a primitive.

Input: primitives and operators, Python arguments. Output: checked numbers and constants, nodes.
Does not depend on the public classes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, cast

from distal.diagnostics import Span
from distal.fields import boxes
from distal.fields import normalize as normalizing
from distal.fields.guarantees import EXACT, NOTHING, Limit, Primitive, Proven
from distal.frontend.problems import must_be
from distal.frontend.signatures.signatures import read_signature
from distal.ir.types import FLOAT, VEC2, VEC3, Vector
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.lang.places import PLACES
from distal.lang.resources import Texture2D
from distal.scene.lowering.insides import has_inside
from distal.scene.tree.arguments import RESERVED, RESERVED_OF_SHAPES, arguments
from distal.scene.tree.calls import result_of
from distal.scene.tree.conversion import Number, shown
from distal.scene.tree.errors import refuse
from distal.scene.tree.node import Node, Rule

if TYPE_CHECKING:
    from distal.scene.objects import measuring
else:
    measuring = LazyModule("distal.scene.objects.measuring")


# What numbers of shapes may depend on.
_VARIES: Final = PLACES
# The functions that normalize, by ``flat`` and by whether there are bounds.
_NORMALIZED: Final[Mapping[tuple[bool, bool], Func]] = {
    (False, False): normalizing.normalized,
    (False, True): normalizing.normalized_within,
    (True, False): normalizing.normalized_flat,
    (True, True): normalizing.normalized_within_flat,
}


def bound(
    rule: Rule, args: Sequence[Any], kwargs: Mapping[str, Any], place: Span | None
) -> tuple[dict[str, Number], dict[str, Any]]:
    """Return the numbers and the constants of a primitive or operator, from the arguments.

    Args:
        rule: The primitive or operator.
        args: Arguments by position.
        kwargs: Arguments by name.
        place: The author's line.

    Raises:
        SceneTypeError: An argument is unknown, missing or of another type.
        SceneValueError: A number is beyond its limit.
    """
    functions, reserved = _parameters_of(rule)
    given = arguments(
        functions,
        args,
        kwargs,
        what=rule.name,
        limits=rule.limits,
        requires=rule.requires,
        place=place,
        reserved=reserved,
        changing=True,
        varies=_VARIES,
        endless=rule.endless if isinstance(rule, Primitive) else (),
    )
    if isinstance(rule, Primitive):
        for name, texture in rule.measured.items():
            data = given[texture]
            assert isinstance(data, Texture2D)
            given[name] = Number(VEC2, measuring.largest_rise(data, rule.name, place))
    if all([type(value) is Number for value in given.values()]):
        return cast("dict[str, Number]", given), {}
    numbers = {name: value for name, value in given.items() if isinstance(value, Number)}
    constants = {name: value for name, value in given.items() if name not in numbers}
    return numbers, constants


@lru_cache(maxsize=1024)
def _parameters_of(rule: Rule) -> tuple[tuple[Func, ...], frozenset[str]]:
    """Return the functions with a rule's numbers, and the parameters that the author never sets."""
    if isinstance(rule, Primitive):
        return (rule.distance,), frozenset(RESERVED_OF_SHAPES | {*rule.measured})
    return rule.number_functions, frozenset(RESERVED | {*rule.fixed})


def own_node(
    function: Any,
    numbers: Mapping[str, Any],
    place: Span | None,
    *,
    slope: Any,
    bounds: Any,
    exact: bool,
    growth: Any,
    normalize: bool = False,
    proved: Proven | None = None,
    signed: bool | None = None,
) -> Node:
    """Return the node of an author's own function; see ``BaseShape.from_function``.

    Args:
        function: The author's ``@func``.
        numbers: Values of its parameters, by name.
        place: The author's line.
        slope: Bound on |gradient| everywhere; None is 1, an estimate if ``normalize``.
        bounds: Corners (low, high) of a box around the surface, or None.
        exact: Whether the value is the true distance.
        growth: Bound on the growth of the box, or None.
        normalize: Whether values are divided by the gradient.
        proved: What was proved of the slope and the bounds, or None.
        signed: Whether it has an inside; None: found by samples.

    Raises:
        SceneTypeError: The function is not a ``@func`` of a point that returns a float.
        SceneValueError: A number is beyond its limit.
    """
    if not isinstance(function, Func):
        refuse(
            f"a shape is made from a @func, not from {_named(function)}",
            "write @func above it",
            place,
        )
    flat = _is_flat(function, place)
    name, box = function.name, None
    gives = result_of(function)
    if gives is not None and gives is not FLOAT:
        hint = f"def {name}(p: {VEC2 if flat else VEC3}) -> float"
        refuse(must_be(f"the distance of '{name}'", FLOAT, gives), hint, place)
    claims = EXACT if exact else NOTHING
    rule = Primitive(name, function, claims, signed=has_inside if signed is None else signed)
    own, constants = bound(rule, (), numbers, place)
    found: dict[str, Any] = dict(own)
    limits = {"slope": Limit.POSITIVE}
    declared = 1.0 if slope is None else slope
    found |= arguments(
        boxes.given_slope, (declared,), {}, what=name, limits=limits, place=place, reserved=()
    )
    if bounds is not None:
        box = boxes.given_bounds2 if flat else boxes.given_bounds
        corners = _corners(bounds, place)
        found |= arguments(box, corners, {}, what=name, requires=_ordered, place=place)
    rule = replace(rule, slope=boxes.given_slope, bounds=box, proved=proved)
    if growth is not None:
        found |= arguments(
            boxes.given_growth, (growth,), {}, what=name, requires=_grows, place=place, reserved=()
        )
        rule = replace(rule, growth=boxes.given_growth)
    if normalize:
        if exact:
            refuse(f"'{name}' cannot be both exact and normalized", "leave out one of them", place)
        rule = replace(rule, normalize=_NORMALIZED[flat, box is not None], estimate=slope is None)
    return Node(rule, flat, (), found, constants, place)


def _named(given: Any) -> str:
    name = getattr(given, "__name__", "")
    return f"the function '{name}'" if name.isidentifier() else f"{given!r:.60}"


def _corners(bounds: Any, place: Span | None) -> tuple[Any, Any]:
    try:
        low, high = bounds
    except (TypeError, ValueError):
        hint = "bounds=((-1, -1, -1), (1, 1, 1))"
        refuse(f"bounds are two corners, (low, high), not {bounds!r:.60}", hint, place)
    return low, high


def _ordered(low: tuple[float, ...], high: tuple[float, ...]) -> str | None:
    if all(a < b for a, b in zip(low, high, strict=True)):
        return None
    return f"nothing lies between bounds {shown(low)} and {shown(high)}: the low corner comes first"


def _grows(growth: float) -> str | None:
    return None if growth >= 1.0 else "growth must be 1 or more"


def _is_flat(function: Func, place: Span | None) -> bool:
    slots = read_signature(function.overloads[0]).parameters
    annotation = next((s.annotation for s in slots if s.name == "p"), None)
    type = getattr(annotation, "__distal_type__", None)
    if not isinstance(type, Vector) or type not in (VEC2, VEC3):
        refuse(
            f"'{function.name}' is no field: it needs a parameter p: vec3 (or vec2)",
            f"def {function.name}(p: vec3) -> float",
            place,
        )
    return type is VEC2
