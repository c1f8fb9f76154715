"""Declarations of primitives and operators: their functions and what these guarantee.

Input: ``@func`` functions, and bounds on their slopes, boxes and growth. Output: ``Primitive`` and
``Operator`` declarations, in their order. Does not depend on the object model that reads them, or
on rendering.

Values are bound by parameter name. Some names have a fixed meaning:
``p`` the point, ``d`` a distance, ``a`` and ``b`` two distances, ``field`` a function of a point,
``cell`` the index of the repetition the point lies in, ``slope``/``slope_a``/``slope_b`` bounds on
|gradient|, ``bounds``/``bounds_a``/``bounds_b`` boxes, ``growth`` and ``side_growth`` (with ``_a``,
``_b``; of two children without either: the larger) how fast the box grows with the level. Every
other parameter is a number of the shape, or a choice (int, bool) fixed when it is compiled.

Growth. A box holds the surface and the inside: all points where the field is 0 or less. An operator
that moves the surface out by r (rounding, offsets, blends) needs a box around all points where the
field is r or less. A field may be far below the distance there, so each field also declares its
*growth* c: for every r >= 0 these points lie within c * r of the box. In other words: a point
outside the box is at most c times its value away from it. ``growth`` measures the Euclidean
distance from the box, which rotations keep. ``side_growth`` measures how far each side must be
moved out, which intersections keep; boxes are grown by it, and it is never above ``growth``. Both
are 1 for exact fields. Both are ``UNBOUNDED`` where they are not known: then a shape whose surface
is moved out has no box.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from typing import Any, Final, TypeAlias, TypeVar, get_args, get_type_hints

from distal.lang import Func as SceneFunction
from distal.lang import func, struct, vec2, vec3
from distal.lang.functions import Func

# Represents infinity in boxes: finite, so that it can be added and rotated. A side beyond a
# thousandth of it is infinite.
UNBOUNDED: Final = 1e18
ENDLESS: Final = UNBOUNDED / 1000.0

# What an operator's functions may take of its one child, or of its two children.
BOUNDS_OF_CHILD: Final = ("slope", "bounds", "growth", "side_growth")
BOUNDS_OF_CHILDREN: Final = frozenset(
    f"{name}{of}" for name in BOUNDS_OF_CHILD for of in ("", "_a", "_b")
)


@struct
class Bounds:
    """A box that holds the whole surface and the inside."""

    low: vec3
    high: vec3


@struct
class Bounds2:
    """A rectangle that holds the whole outline and the inside."""

    low: vec2
    high: vec2


@struct
class Site:
    """A place in a repetition: the point in its cell's own space, and which cell."""

    p: vec3
    cell: vec3


@struct
class Site2:
    """A place in a repetition in the plane; ``cell`` has its third number 0."""

    p: vec2
    cell: vec3


class Limit(Enum):
    """What a number must be; the value finishes the sentence "radius must be …"."""

    POSITIVE = "above 0"
    NOT_NEGATIVE = "0 or more"
    NOT_ZERO = "other than 0"
    UNIT = "a vector of length 1"
    FRACTION = "between 0 and 1"
    ANY = "finite"


# What numbers of a shape must be whose names have one meaning in the whole library.
USUAL_LIMITS: Final[Mapping[str, Limit]] = {
    **dict.fromkeys(("radius", "radii", "size", "width", "height", "thickness"), Limit.POSITIVE),
    **dict.fromkeys(("cell_size", "apothem", "major", "minor", "pitch", "angle"), Limit.POSITIVE),
    **dict.fromkeys(("rounding", "chamfer"), Limit.NOT_NEGATIVE),
    "jitter": Limit.FRACTION,
    "normal": Limit.UNIT,
}


class Guarantee(Enum):
    """What a field may guarantee besides a bound on its slope.

    EXACT_OUTSIDE: outside, the value is the distance to the surface. EXACT_INSIDE: inside, it is
    minus that. LOWER_BOUND: outside, it is never more than the distance.
    """

    EXACT_OUTSIDE = "exact outside"
    EXACT_INSIDE = "exact inside"
    LOWER_BOUND = "lower bound"


EXACT: Final = frozenset(Guarantee)  # all three
EXACT_OUTSIDE: Final = frozenset({Guarantee.EXACT_OUTSIDE, Guarantee.LOWER_BOUND})
# What the largest of several plane distances keeps: a convex shape's inside is exact.
INSIDE_AND_BOUND: Final = frozenset({Guarantee.EXACT_INSIDE, Guarantee.LOWER_BOUND})
LOWER_BOUND: Final = frozenset({Guarantee.LOWER_BOUND})
NOTHING: Final[frozenset[Guarantee]] = frozenset()  # the slope's bound alone


class Growth(Enum):
    """What an operator makes of the growth of its children; see the module's text.

    KEPT: It stays; of two children: the larger.
    FIRST: That of the first child stays.
    TURNED: The box is turned: the sides grow as fast as the distance from the box.
    CORNERED: The growth of sides stays (of two: the larger). A point may be as far past all sides
        of a corner, which is the root of the number of dimensions times as far from the box.
    HELD: Both are 1: the value is at least the distance to the operator's box, or it has no box.
    UNKNOWN: No bound is known.
    """

    KEPT = "kept"
    FIRST = "of the first"
    TURNED = "turned"
    CORNERED = "cornered"
    HELD = "held"
    UNKNOWN = "unknown"


# Returns a reason why numbers do not go together, or None. Called with plain floats by name.
Requirement: TypeAlias = "Callable[..., str | None]"
# A number, or a @func of some of the shape's numbers (and slope, bounds) that gives a float.
Rule: TypeAlias = "float | Func"


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """A shape of the library.

    Attributes:
        name: The class's name in the object model: "CappedTorus".
        distance: ``(p, *numbers) -> float``; the point's type is vec3 for a solid, vec2 for a flat
            shape. Defaults of its
            parameters are the shape's defaults; its docstring is the shape's.
        claims: Its guarantees besides the bound on its slope.
        slope: Bound on |gradient| everywhere; a number, or a function of the shape's numbers.
        bounds: ``(*numbers) -> Bounds`` (``Bounds2``), or None for a shape without end.
        growth: Bound on the growth; a number, or a function of the shape's numbers. None: 1 where
            the field is exact outside or has no box, else not known.
        side_growth: The same for the sides alone, where it is less; None: ``growth``.
        limits: What each number must be; a number not named is any finite one.
        requires: Returns why numbers do not go together, or None.
        signed: False for surfaces and curves without an inside.
        estimate: True for fractals and the like, whose slope is an estimate.
        tier: 1, 2 or 3, the catalogue's.
    """

    name: str
    distance: Func
    claims: frozenset[Guarantee]
    slope: Rule = 1.0
    bounds: Func | None = None
    growth: Rule | None = None
    side_growth: Rule | None = None
    limits: Mapping[str, Limit] = field(default_factory=dict)
    requires: Requirement | None = None
    signed: bool = True
    estimate: bool = False
    tier: int = 1

    @property
    def flat(self) -> bool:
        """Whether it lies in the plane."""
        return signature_types(self.distance)["p"] is vec2


@dataclass(frozen=True, slots=True, eq=False)
class Operator:
    """A way to make a shape of one or two others.

    One of four kinds, by what is given:

    * ``point`` and/or ``finish``: the child is evaluated at ``point(p, …)`` (a vec3, a vec2 or a
      ``Site``), and its value ``d`` goes through ``finish(d[, p], …) -> float``. ``p`` is the
      operator's own point, before ``point`` moved it.
    * ``combine(a, b[, p], …) -> float``: of two children; ``mix`` gives with the same parameters
      the share of b's material, 0 to 1 (None: whichever child is nearer by ``b < a``).
    * ``around(field, p, …) -> float``: evaluates the child at several points. ``site(field, p, …)``
      gives the place (vec3 or ``Site``) whose material shows at p.

    All of these may also take what the rules take, by the same names: the ``bounds`` and the
    ``slope`` of the child (``bounds_a``, ``slope_b`` …), computed once per frame.

    Attributes:
        name: What messages call it: "twist".
        copies: ``(*numbers) -> struct``: a value of the numbers alone, which the other functions
            take by the name ``copies``: which copies a repetition has.
        fixed: Values of parameters of the other functions that are no numbers of the operator.
        keeps: The guarantees that hold when they hold for all children. The others are lost (a
            slope of at most 1 makes a lower bound in any case).
        keeps_exact: The guarantees that hold, besides those, when all children are exact inside and
            outside: a difference is exact inside only if what it takes away is exact outside.
        slope: None where the slope stays (of two: the larger); a number multiplies it; a function
            of ``slope`` (``slope_a``, ``slope_b``), ``bounds`` and numbers gives it.
        bounds: None where the box stays (of two: the box around both); else a function of
            ``bounds`` (``bounds_a``, ``bounds_b``) and numbers; ``no_bounds`` for no box.
        growth: What becomes of the growth, or a function of ``growth``, ``slope``, ``bounds`` and
            numbers that gives it. Not known where an operator says nothing.
        limits: As for a primitive.
        requires: As for a primitive.
        needs: What the children must be for a slope to exist; finishes the sentence "twist needs
            …", said when the slope's rule answers ``UNBOUNDED``. None where it never does.
        cuts: Whether the second shape is taken away, and its ``cut_material`` shows.
        local: Whether it changes shapes only where they meet.
    """

    name: str
    copies: Func | None = None
    point: Func | None = None
    finish: Func | None = None
    combine: Func | None = None
    mix: Func | None = None
    around: Func | None = None
    site: Func | None = None
    fixed: Mapping[str, int | bool] = field(default_factory=dict)
    keeps: frozenset[Guarantee] = NOTHING
    slope: Rule | None = None
    bounds: Func | None = None
    growth: Growth | Func = Growth.UNKNOWN
    limits: Mapping[str, Limit] = field(default_factory=dict)
    requires: Requirement | None = None
    keeps_exact: frozenset[Guarantee] = NOTHING
    needs: str | None = None
    cuts: bool = False
    local: bool = True

    @property
    def number_functions(self) -> tuple[Func, ...]:
        """The functions whose parameters are the operator's numbers."""
        found = (self.copies, self.point, self.combine, self.around, self.finish)
        return tuple(function for function in found if function is not None)

    @property
    def point_functions(self) -> tuple[Func, ...]:
        """The functions that are called for each point."""
        found = (self.point, self.finish, self.combine, self.mix, self.around, self.site)
        return tuple(function for function in found if function is not None)

    def lies_flat(self, child: bool) -> bool:
        """Whether the result lies in the plane: where the operator's own point does.

        Args:
            child: Whether what it works on does, which decides where no function takes a point.
        """
        for function in (self.point, self.around, self.finish, self.combine):
            if function is not None and "p" in signature_types(function):
                return bool(signature_types(function)["p"] is vec2)
        return child

    @property
    def repeats(self) -> bool:
        """Whether what it works on is given its cell."""
        places = (function for function in (self.point, self.site) if function is not None)
        return any(signature_types(place)["return"] in (Site, Site2) for place in places)

    def takes_flat(self, lies: bool) -> bool:
        """Whether it works on flat shapes, where its result lies in the plane or not."""
        if self.around is not None:
            return bool(get_args(signature_types(self.around)["field"])[0] == [vec2])
        if self.point is not None:
            return signature_types(self.point)["return"] in (vec2, Site2)
        return lies


@cache
def signature_types(function: Func) -> Mapping[str, Any]:
    """The types in a library function's signature, by parameter; that of its result: "return"."""
    return get_type_hints(function.python_function)


PRIMITIVES: Final[dict[str, Primitive]] = {}
OPERATORS: Final[dict[str, Operator]] = {}

F = TypeVar("F", bound=Func)


def ended(value: float) -> float:
    """A computed bound as a number, infinite where there is no bound."""
    return float(value) if abs(value) < ENDLESS else math.copysign(math.inf, value)


def primitive(
    name: str,
    claims: frozenset[Guarantee],
    *,
    slope: Rule = 1.0,
    bounds: Func | None = None,
    growth: Rule | None = None,
    side_growth: Rule | None = None,
    limits: Mapping[str, Limit] | None = None,
    requires: Requirement | None = None,
    signed: bool = True,
    estimate: bool = False,
    tier: int = 1,
) -> Callable[[F], F]:
    """Declare the ``@func`` below as a shape of the library; see ``Primitive``.

    ``limits`` names only what differs from ``USUAL_LIMITS``.
    """

    def declare(distance: F) -> F:
        assert name not in PRIMITIVES, f"two shapes are called {name}"
        PRIMITIVES[name] = Primitive(
            name,
            distance,
            claims,
            slope,
            bounds,
            growth,
            side_growth,
            _limits(distance, limits or {}),
            requires,
            signed,
            estimate,
            tier,
        )
        return distance

    return declare


def _limits(distance: Func, given: Mapping[str, Limit]) -> dict[str, Limit]:
    code = distance.python_function.__code__
    usual = {n: USUAL_LIMITS[n] for n in code.co_varnames[: code.co_argcount] if n in USUAL_LIMITS}
    return {name: limit for name, limit in {**usual, **given}.items() if limit is not Limit.ANY}


def operator(name: str, **declared: Any) -> Operator:
    """Declare an operator; see ``Operator``."""
    assert name not in OPERATORS, f"two operators are called {name}"
    OPERATORS[name] = Operator(name, **declared)
    return OPERATORS[name]


def named(name: str, function: Callable[..., Any]) -> SceneFunction[..., Any]:
    """Scene code that a Python function makes, under the name that emitted text shows."""
    function.__name__ = name
    function.__qualname__ = name
    return func(function)


@func
def no_bounds(bounds: Bounds) -> Bounds:
    """The box of an operator whose result has no end."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


@func
def no_bounds2(bounds: Bounds2) -> Bounds2:
    """The rectangle of an operator whose result has no end."""
    return Bounds2(vec2(-UNBOUNDED), vec2(UNBOUNDED))
