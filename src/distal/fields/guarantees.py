"""Declarations of primitives and operators: their functions and what these guarantee.

Input: ``@func`` functions, and bounds on their slopes, boxes and growth. Output: ``Primitive`` and
``Operator`` declarations, in their order. Does not depend on the object model that reads them, or
on rendering.

Values are bound by parameter name. Some names have a fixed meaning: ``p`` the point, ``direction``
that of a line, ``d`` a distance, ``a`` and ``b`` two distances, ``field`` a function of a point,
``cell`` the index of the repetition that contains the point, ``slope``/``slope_a``/``slope_b``
Lipschitz bounds (bounds on |gradient|), ``bounds``/``bounds_a``/``bounds_b`` boxes, ``growth`` and
``side_growth`` (with ``_a``, ``_b``; without a suffix on two children: the larger) how fast the box
grows with the level, ``child_width`` the width of the child, or the least of the children's.
Every other parameter is a number of the shape, or a choice (int, bool): a plain one is fixed when
the scene is compiled, a parameter of the scene may change it later (but not ``FIXED_CHOICES``).

Growth. A box contains the surface and the inside: all points where the field is 0 or less. An
operator that moves the surface outwards by r (rounding, offsets, blends) needs a box around all
points where the field is r or less. The field may be far less than the distance there, so each
field also declares its *growth* c: for every r >= 0 these points lie within c * r of the box. In
other words: the distance of a point outside the box from the box is at most c times its value.
``growth`` measures the Euclidean distance from the box, which rotations preserve. ``side_growth``
measures how far each side must be moved outwards, which intersections preserve; boxes are enlarged
by it, and it is never above ``growth``. Both are 1 for exact fields. Both are ``UNBOUNDED`` if they
are not known: then a shape whose surface is moved outwards has no finite box.
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

# Values of the children that an operator's functions may take, by parameter name.
BOUNDS_OF_CHILD: Final = ("slope", "bounds", "growth", "side_growth")
BOUNDS_OF_CHILDREN: Final = frozenset(
    f"{name}{of}" for name in BOUNDS_OF_CHILD for of in ("", "_a", "_b")
)

# Choices by name that decide which code there is, so that no parameter can change them.
FIXED_CHOICES: Final = frozenset(("neighbors",))


@struct
class Bounds:
    """A box that contains the whole surface and the inside."""

    low: vec3
    high: vec3


@struct
class Bounds2:
    """A rectangle that contains the whole outline and the inside."""

    low: vec2
    high: vec2


@struct
class Site:
    """A place in a repetition: the point in the local space of its cell, and the cell's index."""

    p: vec3
    cell: vec3


@struct
class Site2:
    """A place in a repetition in the plane; the third component of ``cell`` is 0."""

    p: vec2
    cell: vec3


class Limit(Enum):
    """The limit of a number; the value completes the sentence "radius must be …"."""

    POSITIVE = "above 0"
    NOT_NEGATIVE = "0 or more"
    NOT_ZERO = "other than 0"
    UNIT = "a vector of length 1"
    FRACTION = "between 0 and 1"
    ANY = "finite"


# Limits of numbers by name; these names have the same meaning in the whole library.
USUAL_LIMITS: Final[Mapping[str, Limit]] = {
    **dict.fromkeys(("radius", "radii", "size", "width", "height", "thickness"), Limit.POSITIVE),
    **dict.fromkeys(("cell_size", "inradius", "major", "minor", "pitch", "angle"), Limit.POSITIVE),
    **dict.fromkeys(("length", "opening"), Limit.POSITIVE),
    **dict.fromkeys(("rounding", "chamfer", "bevel", "countersink"), Limit.NOT_NEGATIVE),
    "jitter": Limit.FRACTION,
    "normal": Limit.UNIT,
}


class Guarantee(Enum):
    """Guarantees of a field besides the bound on its slope.

    EXACT_OUTSIDE: outside, the value is the distance to the surface. EXACT_INSIDE: inside, the
    value is the negative distance. LOWER_BOUND: outside, the value is never more than the distance.
    """

    EXACT_OUTSIDE = "exact outside"
    EXACT_INSIDE = "exact inside"
    LOWER_BOUND = "lower bound"


EXACT: Final = frozenset(Guarantee)  # all three
EXACT_OUTSIDE: Final = frozenset({Guarantee.EXACT_OUTSIDE, Guarantee.LOWER_BOUND})
# The guarantees of the maximum of several plane distances: exact inside a convex shape.
INSIDE_AND_BOUND: Final = frozenset({Guarantee.EXACT_INSIDE, Guarantee.LOWER_BOUND})
LOWER_BOUND: Final = frozenset({Guarantee.LOWER_BOUND})
NOTHING: Final[frozenset[Guarantee]] = frozenset()  # only the bound on the slope


class Growth(Enum):
    """How an operator changes the growth of its children; see the module's docstring.

    KEPT: The growth does not change; of two children, the larger is used.
    FIRST: The growth of the first child does not change.
    TURNED: The box is rotated: ``side_growth`` becomes the child's ``growth``.
    CORNERED: ``side_growth`` does not change (of two children, the larger is used). At a corner a
        point may be outside all sides by that much, so ``growth`` is larger by the square root of
        the number of dimensions.
    HELD: Both are 1: the value is at least the distance to the operator's box, or there is none.
    UNKNOWN: No bound is known.
    """

    KEPT = "kept"
    FIRST = "of the first"
    TURNED = "turned"
    CORNERED = "cornered"
    HELD = "held"
    UNKNOWN = "unknown"


# Returns why numbers contradict each other, or None. Called with plain floats by name.
Requirement: TypeAlias = "Callable[..., str | None]"
# A number, or a @func of some of the shape's numbers (and slope, bounds) that returns a float.
Rule: TypeAlias = "float | Func"


@dataclass(frozen=True, slots=True)
class Proven:
    """What was proved of an author's function, and where.

    Attributes:
        names: "slope", "box".
        low: The lower corner of the region.
        high: Its upper corner.
    """

    names: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Approximation:
    """What a shape replaces by simpler pieces; its other guarantees are about these pieces.

    Attributes:
        of: What is replaced: "a cubic Bézier curve".
        error: The largest distance between the curve and the pieces that replace it, as a fraction
            of the shape's size, for default numbers (measured).
    """

    of: str
    error: float


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """A shape of the library.

    Attributes:
        name: Name of the class in the object model: "CappedTorus".
        distance: ``(p, *numbers) -> float``; p is a vec3 for a solid, a vec2 for a flat shape. The
            defaults of its parameters are the shape's defaults; its docstring is the shape's. What
            follows ``*`` is passed by name only, also to the shape.
        claims: The guarantees besides the bound on the slope.
        slope: Lipschitz bound (slope): a bound on |gradient| everywhere; a number, or a function of
            the shape's numbers.
        bounds: ``(*numbers) -> Bounds`` (``Bounds2``), or None for an infinite shape.
        growth: Bound on the growth; a number, or a function of the shape's numbers. None: 1 if the
            field is exact outside or has no box, otherwise not known.
        side_growth: The same for the sides alone, if it is less; None: ``growth``.
        limits: The limits of numbers, by name; other numbers must only be finite.
        requires: Returns why numbers contradict each other, or None.
        measured: Numbers that authors do not pass, because they follow from the shape's data: the
            name of a vec2, and the name of the texture whose largest differences of neighboring
            texels (first channel, along each axis) it holds. Measured once, on construction.
        approximates: What the shape replaces by simpler pieces, or None.
        normalize: For an author's function: ``(field, p, …) -> float``, whose value is used instead
            of that of ``distance``, which it receives as ``field``.
        proved: For an author's function: what was proved of it, or None.
        signed: False for surfaces and curves without an inside; for an author's function, what
            finds out of a node whether it has one.
        estimate: True for fractals, whose slope is an estimate.
        tier: The tier in the catalogue: 1, 2 or 3.
        linear: Whether the value is linear in p, as for a plane: rays meet it in closed form.
        chord: For a convex solid: ``(p, direction, *numbers) -> vec2``, the distances at which the
            line through p in a unit direction enters and leaves it (``fields.chords``), in closed
            form; x > y if the line misses it. None if it is not known.
        endless: The names of sizes whose components may be infinite: they are ``UNBOUNDED`` then.
        width: The side of the largest cubic cells that find it, wherever and however it lies: their
            corners tell its topology (``fields.widths``). A number, or a function of the shape's
            numbers; ``UNBOUNDED`` for a surface without a second one near it. None if no closed
            form is known: a mesh then says to what width it is sure.
        along: The axes along which it is a prism, "y" or "xyz": every section across the axis is
            the same, from side to side of the box.
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
    signed: bool | Callable[[Any], bool] = True
    estimate: bool = False
    tier: int = 1
    linear: bool = False
    measured: Mapping[str, str] = field(default_factory=dict)
    approximates: Approximation | None = None
    normalize: Func | None = None
    proved: Proven | None = None
    chord: Func | None = None
    endless: tuple[str, ...] = ()
    width: Rule | None = None
    along: str = ""

    @property
    def flat(self) -> bool:
        """Whether the shape lies in the plane."""
        return signature_types(self.distance)["p"] is vec2


@dataclass(frozen=True, slots=True, eq=False)
class Operator:
    """An operator that makes a shape from one or two others.

    There are four kinds, distinguished by the functions that are declared:

    * ``point`` and/or ``finish``: the child is evaluated at ``point(p, …)`` (a vec3, a vec2 or a
      ``Site``), and ``finish(d[, p], …) -> float`` changes its value ``d``. ``p`` is the operator's
      own point, before ``point`` moved it.
    * ``combine(a, b[, p], …) -> float``: for two children; ``mix`` takes the same parameters and
      returns the share of b's material, 0 to 1 (None: that of the nearer child, by ``b < a``).
    * ``around(field, p, …) -> float``: evaluates the child at several points. ``site(field, p, …)``
      returns the place (vec3 or ``Site``) whose material is shown at p. If it is a ``Site``,
      ``field`` is a function of the point and the cell.

    All of these may also take the parameters that the rules take: the ``bounds`` and the ``slope``
    of the child (``bounds_a``, ``slope_b`` …), computed once per frame.

    Attributes:
        name: The name in messages: "twist".
        cells: For a repetition: ``(*numbers) -> Bounds``, the least and the largest index of the
            cells, all of which are whole. None: it has no cells, or they have no end.
        copies: ``(*numbers) -> struct``: a value that depends on the numbers alone and that the
            other functions take by the name ``copies``: the copies of a repetition.
        fixed: Values of parameters of the other functions that are not numbers of the operator.
        keeps: The guarantees that hold if they hold for all children. Others are lost (but a slope
            of at most 1 always makes a lower bound).
        keeps_exact: Further guarantees that hold if all children are exact inside and outside: a
            difference is exact inside only if the subtracted shape is exact outside.
        slope: None if the slope does not change (for two children: the larger); a number multiplies
            it; a function of ``slope`` (``slope_a``, ``slope_b``), ``bounds`` and numbers returns
            it.
        bounds: None if the box does not change (for two children: the box around both); else a
            function of ``bounds`` (``bounds_a``, ``bounds_b``) and numbers; ``no_bounds`` for an
            infinite result.
        growth: How the growth changes, or a function of ``growth``, ``slope``, ``bounds`` and
            numbers that returns it. UNKNOWN by default.
        limits: As for a primitive.
        requires: As for a primitive.
        needs: What the children must be for a slope to exist; completes the message "twist needs
            …", shown if the slope's rule returns ``UNBOUNDED``. None if it never does.
        cuts: Whether the second shape is subtracted, so that its ``cut_material`` is shown.
        fills: Whether the result has an inside where its child has none: it moves outwards.
        local: Whether it changes the shapes only where they meet.
        linear: Whether the value is linear in p if that of the child is.
        turn: For a rigid move or a uniform scale: ``(p, …) -> vec3``, as ``point`` for a unit
            direction p. Chords of the child are those of the result, with ``finish`` for lengths.
        within: For two children that may both be turned: ``(d, p, axes) -> float`` changes the
            value so that nothing of the result is outside ``axes``, the ``TurnedBox`` around both
            along the axes of the first. Not called if one of them is not turned.
        changes: How much the value changes at most for each unit of a number, by the number's name;
            of others it is found by intervals where a number differs from place to place.
        approximates: What the operator replaces by simpler pieces, or None.
        width: The width of the result, as of a primitive: a function of ``child_width``, ``slope``,
            ``bounds`` and numbers. None: the least of the children's.
        along: The axes along which the result is a prism whatever the child is, as for a primitive.
    """

    name: str
    cells: Func | None = None
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
    fills: bool = False
    local: bool = True
    linear: bool = False
    turn: Func | None = None
    within: Func | None = None
    changes: Mapping[str, float] = field(default_factory=dict)
    approximates: Approximation | None = None
    width: Func | None = None
    along: str = ""

    @property
    def number_functions(self) -> tuple[Func, ...]:
        """Return the functions whose parameters are the operator's numbers."""
        found = (self.copies, self.point, self.combine, self.around, self.finish)
        return tuple(function for function in found if function is not None)

    @property
    def point_functions(self) -> tuple[Func, ...]:
        """Return the functions that are called for each point."""
        found = (
            *(self.point, self.finish, self.combine, self.mix, self.around, self.site),
            self.within,
        )
        return tuple(function for function in found if function is not None)

    def lies_flat(self, child: bool) -> bool:
        """Return whether the result lies in the plane.

        It does if the operator's own point is a vec2.

        Args:
            child: Whether the child lies in the plane; used if no function takes a point.
        """
        for function in (self.point, self.around, self.finish, self.combine):
            if function is not None and "p" in signature_types(function):
                return bool(signature_types(function)["p"] is vec2)
        return child

    @property
    def repeats(self) -> bool:
        """Whether the child receives the index of its cell."""
        return _repeats(self)

    def takes_flat(self, lies: bool) -> bool:
        """Return whether the operator takes flat children.

        ``lies`` says whether its result lies in the plane.
        """
        if self.around is not None:
            return bool(get_args(signature_types(self.around)["field"])[0][0] is vec2)
        if self.point is not None:
            return signature_types(self.point)["return"] in (vec2, Site2)
        return lies


@cache
def _repeats(operator: Operator) -> bool:
    places = (f for f in (operator.point, operator.site) if f is not None)
    return any(signature_types(place)["return"] in (Site, Site2) for place in places)


@cache
def signature_types(function: Func) -> Mapping[str, Any]:
    """Return the types in a library function's signature; the result's name is "return"."""
    return get_type_hints(function.python_function)


PRIMITIVES: Final[dict[str, Primitive]] = {}
OPERATORS: Final[dict[str, Operator]] = {}

F = TypeVar("F", bound=Func)


def ended(value: float) -> float:
    """Return a computed bound as a number; infinite if it is beyond ``ENDLESS``."""
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
    linear: bool = False,
    measured: Mapping[str, str] | None = None,
    approximates: Approximation | None = None,
    chord: Func | None = None,
    endless: tuple[str, ...] = (),
    width: Rule | None = None,
    along: str = "",
) -> Callable[[F], F]:
    """Declare the ``@func`` below as a shape of the library; see ``Primitive`` for the attributes.

    Args:
        name: Name of the shape's class.
        claims: The guarantees besides the bound on the slope.
        slope: Bound on |gradient|.
        bounds: The function of the box, or None for an infinite shape.
        growth: Bound on the growth, or None for the default.
        side_growth: Bound on the growth of the sides, or None for ``growth``.
        limits: Only limits that differ from ``USUAL_LIMITS``.
        requires: Returns why numbers contradict each other, or None.
        signed: Whether the shape has an inside.
        estimate: Whether the slope is an estimate.
        tier: The tier in the catalogue.
        linear: Whether the value is linear in p.
        measured: The numbers that are measured from the shape's data.
        approximates: What the shape replaces by simpler pieces.
        chord: The function of the part of a line inside of a convex solid.
        endless: The names of sizes that may be infinite.
        width: The side of the largest cells that find it.
        along: The axes along which it is a prism.
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
            linear,
            measured or {},
            approximates,
            chord=chord,
            endless=endless,
            width=width,
            along=along,
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
    """Return scene code from a generated Python function, with a name for emitted text."""
    function.__name__ = name
    function.__qualname__ = name
    return func(function)


@func
def no_bounds(bounds: Bounds) -> Bounds:
    """Return the box of an operator whose result is infinite."""
    return Bounds(vec3(-UNBOUNDED), vec3(UNBOUNDED))


@func
def no_bounds2(bounds: Bounds2) -> Bounds2:
    """Return the rectangle of an operator whose result is infinite."""
    return Bounds2(vec2(-UNBOUNDED), vec2(UNBOUNDED))
