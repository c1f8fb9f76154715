"""Blends by name: each smooth minimum and shaped edge, for unions, intersections and differences.

Input: unions from ``smooth`` and ``edge_profiles``. Output: ``BLENDS``, and an operator for each
combination with each blend (``COMBINATIONS``; for some shapes ``FLAT_UNIONS`` and ``PRISMS``). The
other combinations follow from the union: an intersection is the complement of the union of the
complements; a difference is the intersection with a complement.

A blend of two distances moves outwards wherever both are small, also where two faces lie in one
plane and there is no edge. The unions of fillets and chamfers are cut by the box around both
shapes, and if both are turned also by that along the axes of the first: what they add ends at the
faces that lie in its sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from distal.fields.combine import edge_profiles, smooth
from distal.fields.combine import joins as combine
from distal.fields.combine.prisms import (
    cut_at_ends,
    cut_at_ends_flat,
    moved_inwards,
    moved_inwards_flat,
)
from distal.fields.extents import (
    Boxes,
    at_least_one,
    box_distance,
    hull_of,
    moved_out,
    overlap,
    rectangle_distance,
)
from distal.fields.guarantees import (
    UNBOUNDED,
    Bounds,
    Bounds2,
    Growth,
    Limit,
    Operator,
    named,
    operator,
)
from distal.fields.turned_boxes import within_axes, within_flat_axes
from distal.fields.widths import groove_width, pipe_width
from distal.lang import Func, exp2, func, length, max, min, vec2, vec3

# Limit of an exponent; 2 to this power is larger than any size.
MOST_DOUBLINGS: Final = 60.0
# Scene code with two distances and the numbers of a blend as parameters.
Shared: TypeAlias = Callable[..., float]


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """A blend of two surfaces.

    Attributes:
        union: ``(a, b, smooth[, count]) -> float``.
        mix: The share of b's material, 0 to 1, with the same parameters.
        counted: Whether it takes ``count``, the number of parts.
        local: Whether it is the hard minimum if the two distances differ enough.
        steep: Whether its slope may be sqrt(slope_a^2 + slope_b^2) instead of the larger of the
            two.
        change: How much the value changes at most for each unit of ``smooth``.
        width: It equals the hard minimum where the distances differ by ``width * smooth`` or more.
            None if the difference alone does not say where.
        intersection: A separate intersection, if it does not follow from the union.
        cut: Whether the union is cut by the box around both shapes.
    """

    union: Func[..., Any]
    mix: Func[..., Any]
    counted: bool = False
    local: bool = True
    steep: bool = False
    change: float = 1.0
    width: float | None = None
    intersection: Func[..., Any] | None = None
    cut: bool = False


BLENDS: Final[dict[str, Blend]] = {
    "quadratic": Blend(smooth.quadratic, smooth.quadratic_mix, width=4.0),
    "cubic": Blend(smooth.cubic, smooth.cubic_mix, width=6.0),
    "quartic": Blend(smooth.quartic, smooth.quartic_mix, width=16.0 / 3.0),
    "circular": Blend(smooth.circular, smooth.circular_mix, width=1.0 / smooth.CORNER),
    "circular_geometric": Blend(
        smooth.circular_geometric, smooth.circular_geometric_mix, steep=True, change=3.5
    ),
    "exponential": Blend(smooth.exponential, smooth.exponential_mix, local=False),
    "root": Blend(smooth.root, smooth.root_mix, local=False),
    "sigmoid": Blend(smooth.sigmoid, smooth.sigmoid_mix, local=False),
    "chamfer": Blend(edge_profiles.chamfer, edge_profiles.edge_mix, steep=True, cut=True),
    "round": Blend(smooth.round_corner, smooth.round_corner_mix, steep=True, cut=True),
    "columns": Blend(
        edge_profiles.columns,
        edge_profiles.counted_edge_mix,
        counted=True,
        steep=True,
        change=2.0,
        intersection=edge_profiles.columns_intersection,
    ),
    "stairs": Blend(edge_profiles.stairs, edge_profiles.counted_edge_mix, counted=True, width=1.0),
    "soft": Blend(edge_profiles.soft, edge_profiles.soft_mix, width=1.0),
}


# Slopes and boxes


@func
def crossed_slope(slope_a: float, slope_b: float) -> float:
    """Return sqrt(slope_a^2 + slope_b^2).

    It bounds the slope of a length in the plane of both distances, reached where their gradients
    are parallel.
    """
    return length(vec2(slope_a, slope_b))


@func
def cut_slope(slope_a: float, slope_b: float) -> float:
    """Return sqrt(slope_a^2 + slope_b^2), at least 1: that of a distance to a box."""
    return at_least_one(crossed_slope(slope_a, slope_b))


@func
def swollen_hull(bounds_a: Boxes, bounds_b: Boxes, smooth: float, side_growth: float) -> Boxes:
    """Return the box around both, enlarged by the most that a blend adds."""
    return moved_out(hull_of(bounds_a, bounds_b), smooth, side_growth)


@func
def pipe_box(
    bounds_a: Boxes, bounds_b: Boxes, radius: float, side_growth_a: float, side_growth_b: float
) -> Boxes:
    """Return the box of the region where both fields are at most ``radius``."""
    around_a = moved_out(bounds_a, radius, side_growth_a)
    return overlap(around_a, moved_out(bounds_b, radius, side_growth_b))


@func
def ridge_box(bounds_a: Boxes, bounds_b: Boxes, depth: float, side_growth_a: float) -> Boxes:
    """Return the first shape's box, enlarged by the ridge."""
    return moved_out(bounds_a, depth, side_growth_a)


@func
def power_growth(growth: float, exponent: float) -> float:
    """Return the growth of ``power_union``.

    Where both distances are equal, the value is less by a factor: 2 to the power 1 / exponent.
    """
    return min(growth * exp2(min(1.0 / exponent, MOST_DOUBLINGS)), UNBOUNDED)


# Unions that are cut by the box around both shapes


def _cut(name: str, union: Shared) -> Func[..., Any]:
    """Return the union without what it adds outside the box around both shapes."""

    def cut(
        a: float, b: float, p: vec3, smooth: float, bounds_a: Bounds, bounds_b: Bounds
    ) -> float:
        return max(union(a, b, smooth), box_distance(p, hull_of(bounds_a, bounds_b)))

    return named(f"union_{name}", cut)


def _cut_flat(name: str, union: Shared) -> Func[..., Any]:
    def cut(
        a: float, b: float, p: vec2, smooth: float, bounds_a: Bounds2, bounds_b: Bounds2
    ) -> float:
        return max(union(a, b, smooth), rectangle_distance(p, hull_of(bounds_a, bounds_b)))

    return named(f"flat_union_{name}", cut)


# Intersections, differences and exclusive ors, made from the union


def _turned(kind: str, name: str, of_first: Shared) -> Func[..., Any]:
    """Return a difference: the intersection with the complement of the second shape."""

    def turned(a: float, b: float, smooth: float) -> float:
        return of_first(a, -b, smooth)

    return named(f"{kind}_{name}", turned)


def _turned_counted(kind: str, name: str, of_first: Shared) -> Func[..., Any]:
    def turned(a: float, b: float, smooth: float, count: int) -> float:
        return of_first(a, -b, smooth, count)

    return named(f"{kind}_{name}", turned)


def _intersection(name: str, union: Shared) -> Func[..., Any]:
    """Return the complement of the union of the complements."""

    def inverted(a: float, b: float, smooth: float) -> float:
        return -union(-a, -b, smooth)

    return named(f"intersection_{name}", inverted)


def _intersection_counted(name: str, union: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, smooth: float, count: int) -> float:
        return -union(-a, -b, smooth, count)

    return named(f"intersection_{name}", inverted)


def _intersection_mix(name: str, share: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, smooth: float) -> float:
        return share(-a, -b, smooth)

    return named(f"intersection_{name}_mix", inverted)


def _intersection_mix_counted(name: str, share: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, smooth: float, count: int) -> float:
        return share(-a, -b, smooth, count)

    return named(f"intersection_{name}_mix", inverted)


def _xor(name: str, difference: Shared) -> Func[..., Any]:
    """Return what is in exactly one shape; the edges between the two parts are shaped."""

    def exclusive(a: float, b: float, smooth: float) -> float:
        return difference(min(a, b), max(a, b), smooth)

    return named(f"xor_{name}", exclusive)


def _xor_counted(name: str, difference: Shared) -> Func[..., Any]:
    def exclusive(a: float, b: float, smooth: float, count: int) -> float:
        return difference(min(a, b), max(a, b), smooth, count)

    return named(f"xor_{name}", exclusive)


def _count_requirement(count: int) -> str | None:
    return None if count >= 1 else "count must be 1 or more"


def _declare(name: str, blend: Blend) -> None:
    """Declare the four operators of a blend."""
    counted = blend.counted
    inverted = _intersection_counted if counted else _intersection
    shared = _intersection_mix_counted if counted else _intersection_mix
    turned = _turned_counted if counted else _turned
    intersection = blend.intersection or inverted(name, blend.union)
    intersection_mix = shared(name, blend.mix)
    difference = turned("difference", name, intersection)
    difference_mix = turned("difference_mix", name, intersection_mix)
    exclusive = (_xor_counted if counted else _xor)(name, difference)
    # A union is at most ``smooth`` below the smaller value, an intersection below the larger one.
    rows: dict[str, dict[str, Any]] = {
        "union": {
            "combine": blend.union,
            "mix": blend.mix,
            "bounds": swollen_hull,
            "growth": Growth.KEPT,
        },
        "intersection": {
            "combine": intersection,
            "mix": intersection_mix,
            "bounds": overlap,
            "growth": Growth.CORNERED,
        },
        "difference": {
            "combine": difference,
            "mix": difference_mix,
            "bounds": combine.first_box,
            "growth": Growth.FIRST,
            "cuts": True,
        },
        "xor": {"combine": exclusive, "growth": Growth.KEPT},
    }
    if blend.cut:
        # The value is at least the distance to the box around both.
        boxed = {"bounds": hull_of, "growth": Growth.HELD, "slope": cut_slope}
        rows["union"] |= boxed | {"combine": _cut(name, blend.union), "within": within_axes}
    for kind, row in rows.items():
        COMBINATIONS[kind, name] = operator(f"{kind} {name}", **_row(blend, row))
    if blend.cut:
        own = {"combine": _cut_flat(name, blend.union), "within": within_flat_axes}
        flat = Operator(f"union {name}", **_row(blend, rows["union"] | own))
        FLAT_UNIONS[COMBINATIONS["union", name]] = flat
        rule = COMBINATIONS["intersection", name]
        row = _row(blend, rows["intersection"] | {"slope": cut_slope})
        PRISMS[rule] = (_of_prisms(rule, row), _of_flat_prisms(rule, row))


def _row(blend: Blend, row: dict[str, Any]) -> dict[str, Any]:
    """Return the declaration of an operator; ``row`` is what differs between combinations."""
    usual = {
        "slope": crossed_slope if blend.steep else None,
        "limits": {"smooth": Limit.NOT_NEGATIVE},
        "requires": _count_requirement if blend.counted else None,
        "local": blend.local,
        "changes": {"smooth": blend.change},
    }
    return usual | row


def _of_prisms(rule: Operator, row: dict[str, Any]) -> Operator:
    """Return the intersection of two solids that are prisms along common axes, ``along``.

    It is not in the catalogue: authors write the intersection.
    """
    intersection: Shared = row["combine"]

    def cut(
        a: float, b: float, p: vec3, smooth: float, along: vec3, bounds_a: Bounds, bounds_b: Bounds
    ) -> float:
        return cut_at_ends(intersection(a, b, smooth), p, smooth, along, bounds_a, bounds_b)

    combined = named(f"{rule.name} of prisms".replace(" ", "_"), cut)
    own = {"combine": combined, "point": moved_inwards}
    return Operator(rule.name, **(row | own))


def _of_flat_prisms(rule: Operator, row: dict[str, Any]) -> Operator:
    intersection: Shared = row["combine"]

    def cut(
        a: float,
        b: float,
        p: vec2,
        smooth: float,
        along: vec2,
        bounds_a: Bounds2,
        bounds_b: Bounds2,
    ) -> float:
        return cut_at_ends_flat(intersection(a, b, smooth), p, smooth, along, bounds_a, bounds_b)

    combined = named(f"flat {rule.name} of prisms".replace(" ", "_"), cut)
    own = {"combine": combined, "point": moved_inwards_flat}
    return Operator(rule.name, **(row | own))


# The operators, by the name of the sharp operator and that of the blend.
COMBINATIONS: Final[dict[tuple[str, str], Operator]] = {}
# The operators of flat shapes in place of unions. They are not in the catalogue: authors write the
# union.
FLAT_UNIONS: Final[dict[Operator, Operator]] = {}
# The operators in place of intersections where both shapes are prisms along common axes: for solids
# and for flat shapes. Their number ``along`` is 1 for these axes and 0 for the others.
PRISMS: Final[dict[Operator, tuple[Operator, Operator]]] = {}
for _name, _blend in BLENDS.items():
    _declare(_name, _blend)
# The blends of the unions, flat ones too.
UNION_BLENDS: Final[dict[Operator, Blend]] = {
    COMBINATIONS["union", name]: blend for name, blend in BLENDS.items()
}
UNION_BLENDS.update({flat: UNION_BLENDS[solid] for solid, flat in FLAT_UNIONS.items()})

PIPE = operator(
    "pipe",
    combine=edge_profiles.pipe,
    mix=combine.first_shows,
    slope=crossed_slope,
    bounds=pipe_box,
    limits={"radius": Limit.POSITIVE},
    growth=Growth.CORNERED,
    width=pipe_width,
)
ENGRAVE = operator(
    "engrave",
    combine=edge_profiles.engrave,
    mix=combine.first_shows,
    slope=crossed_slope,
    bounds=combine.first_box,
    limits={"depth": Limit.NOT_NEGATIVE},
    growth=Growth.FIRST,
)
_SIZES = {"depth": Limit.NOT_NEGATIVE, "width": Limit.NOT_NEGATIVE}
GROOVE = operator(
    "groove",
    combine=edge_profiles.groove,
    mix=combine.first_shows,
    bounds=combine.first_box,
    limits=_SIZES,
    growth=Growth.FIRST,
    width=groove_width,
)
TONGUE = operator(
    "tongue",
    combine=edge_profiles.tongue,
    mix=combine.first_shows,
    bounds=ridge_box,
    limits=_SIZES,
    growth=Growth.FIRST,
    width=groove_width,
)
POWER = operator(
    "union power",
    combine=smooth.power_union,
    keeps=frozenset(),
    limits={"exponent": Limit.POSITIVE},
    growth=power_growth,
)
COMBINATIONS["union", "power"] = POWER
