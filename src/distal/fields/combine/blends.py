"""Blends by name: each smooth minimum and shaped edge, for unions, intersections and differences.

Input: union forms from ``smooth`` and ``edge_profiles``. Output: ``BLENDS``, and an operator for
each way to combine with each of them (``COMBINATIONS``). The other ways follow from the union: an
intersection is the union of the outsides, a difference the intersection with an outside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from distal.fields.combine import edge_profiles, smooth
from distal.fields.combine import joins as combine
from distal.fields.extents import Boxes, hull_of, moved_out, overlap
from distal.fields.guarantees import UNBOUNDED, Growth, Limit, Operator, named, operator
from distal.lang import Func, exp2, func, length, max, min, vec2

# 2 to this power is beyond any size.
MOST_DOUBLINGS: Final = 60.0
# Scene code that takes two distances and the numbers of a blend.
Shared: TypeAlias = Callable[..., float]


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """One way to join surfaces.

    Attributes:
        union: ``(a, b, k[, count]) -> float``.
        mix: The share of b, 0 to 1, with the same parameters.
        counted: Whether it takes a ``count`` of parts.
        local: Whether it is the hard minimum where the two are far enough apart.
        steep: Whether its slope may be sqrt(slope_a^2 + slope_b^2) rather than the larger of both.
        intersection: Of its own, where it is not the union of the outsides turned inside out.
    """

    union: Func[..., Any]
    mix: Func[..., Any]
    counted: bool = False
    local: bool = True
    steep: bool = False
    intersection: Func[..., Any] | None = None


BLENDS: Final[dict[str, Blend]] = {
    "quadratic": Blend(smooth.quadratic, smooth.quadratic_mix),
    "cubic": Blend(smooth.cubic, smooth.cubic_mix),
    "quartic": Blend(smooth.quartic, smooth.quartic_mix),
    "circular": Blend(smooth.circular, smooth.circular_mix),
    "circular_geometric": Blend(
        smooth.circular_geometric, smooth.circular_geometric_mix, steep=True
    ),
    "exponential": Blend(smooth.exponential, smooth.exponential_mix, local=False),
    "root": Blend(smooth.root, smooth.root_mix, local=False),
    "sigmoid": Blend(smooth.sigmoid, smooth.sigmoid_mix, local=False),
    "chamfer": Blend(edge_profiles.chamfer, edge_profiles.edge_mix, steep=True),
    "round": Blend(smooth.round_corner, smooth.round_corner_mix, steep=True),
    "columns": Blend(
        edge_profiles.columns,
        edge_profiles.counted_edge_mix,
        counted=True,
        steep=True,
        intersection=edge_profiles.columns_intersection,
    ),
    "stairs": Blend(edge_profiles.stairs, edge_profiles.counted_edge_mix, counted=True),
    "soft": Blend(edge_profiles.soft, edge_profiles.soft_mix),
}


# Slopes and boxes


@func
def crossed_slope(slope_a: float, slope_b: float) -> float:
    """The slope of a length in the plane of both distances, where their gradients are parallel."""
    return length(vec2(slope_a, slope_b))


@func
def swollen_hull(bounds_a: Boxes, bounds_b: Boxes, k: float, side_growth: float) -> Boxes:
    """The box around both, moved out by what a blend adds at most."""
    return moved_out(hull_of(bounds_a, bounds_b), k, side_growth)


@func
def pipe_box(
    bounds_a: Boxes, bounds_b: Boxes, k: float, side_growth_a: float, side_growth_b: float
) -> Boxes:
    """Where neither field is above ``k``."""
    return overlap(moved_out(bounds_a, k, side_growth_a), moved_out(bounds_b, k, side_growth_b))


@func
def ridge_box(bounds_a: Boxes, bounds_b: Boxes, depth: float, side_growth_a: float) -> Boxes:
    """The first shape's box, moved out by the ridge."""
    return moved_out(bounds_a, depth, side_growth_a)


@func
def power_growth(growth: float, exponent: float) -> float:
    """Where both distances are equal the value is less by the exponent's root of 2."""
    return min(growth * exp2(min(1.0 / exponent, MOST_DOUBLINGS)), UNBOUNDED)


# The other ways to combine, made of the union


def _turned(kind: str, name: str, of_first: Shared) -> Func[..., Any]:
    """A difference: the intersection with everything but the second."""

    def turned(a: float, b: float, k: float) -> float:
        return of_first(a, -b, k)

    return named(f"{kind}_{name}", turned)


def _turned_counted(kind: str, name: str, of_first: Shared) -> Func[..., Any]:
    def turned(a: float, b: float, k: float, count: int) -> float:
        return of_first(a, -b, k, count)

    return named(f"{kind}_{name}", turned)


def _intersection(name: str, union: Shared) -> Func[..., Any]:
    """The union of the outsides, seen from inside."""

    def inverted(a: float, b: float, k: float) -> float:
        return -union(-a, -b, k)

    return named(f"intersection_{name}", inverted)


def _intersection_counted(name: str, union: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, k: float, count: int) -> float:
        return -union(-a, -b, k, count)

    return named(f"intersection_{name}", inverted)


def _intersection_mix(name: str, share: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, k: float) -> float:
        return share(-a, -b, k)

    return named(f"intersection_{name}_mix", inverted)


def _intersection_mix_counted(name: str, share: Shared) -> Func[..., Any]:
    def inverted(a: float, b: float, k: float, count: int) -> float:
        return share(-a, -b, k, count)

    return named(f"intersection_{name}_mix", inverted)


def _xor(name: str, difference: Shared) -> Func[..., Any]:
    """What is in either without what is in both; the edges between the two are shaped."""

    def exclusive(a: float, b: float, k: float) -> float:
        return difference(min(a, b), max(a, b), k)

    return named(f"xor_{name}", exclusive)


def _xor_counted(name: str, difference: Shared) -> Func[..., Any]:
    def exclusive(a: float, b: float, k: float, count: int) -> float:
        return difference(min(a, b), max(a, b), k, count)

    return named(f"xor_{name}", exclusive)


def _count_requirement(count: int) -> str | None:
    return None if count >= 1 else "count must be 1 or more"


def _declare(name: str, blend: Blend) -> None:
    """The four operators of a blend."""
    counted = blend.counted
    inverted = _intersection_counted if counted else _intersection
    shared = _intersection_mix_counted if counted else _intersection_mix
    turned = _turned_counted if counted else _turned
    intersection = blend.intersection or inverted(name, blend.union)
    intersection_mix = shared(name, blend.mix)
    difference = turned("difference", name, intersection)
    difference_mix = turned("difference_mix", name, intersection_mix)
    exclusive = (_xor_counted if counted else _xor)(name, difference)
    # A union is nowhere below the nearer shape's value by more than k, nor an intersection below
    # the farther one's.
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
    for kind, row in rows.items():
        COMBINATIONS[kind, name] = operator(
            f"{kind} {name}",
            slope=crossed_slope if blend.steep else None,
            limits={"k": Limit.NOT_NEGATIVE},
            requires=_count_requirement if counted else None,
            local=blend.local,
            **row,
        )


# By the sharp operator's name and the blend's.
COMBINATIONS: Final[dict[tuple[str, str], Operator]] = {}
for _name, _blend in BLENDS.items():
    _declare(_name, _blend)

PIPE = operator(
    "pipe",
    combine=edge_profiles.pipe,
    mix=combine.first_shows,
    slope=crossed_slope,
    bounds=pipe_box,
    limits={"k": Limit.POSITIVE},
    growth=Growth.CORNERED,
)
ENGRAVE = operator(
    "engrave",
    combine=edge_profiles.engrave,
    mix=combine.first_shows,
    slope=crossed_slope,
    bounds=combine.first_box,
    limits={"k": Limit.NOT_NEGATIVE},
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
)
TONGUE = operator(
    "tongue",
    combine=edge_profiles.tongue,
    mix=combine.first_shows,
    bounds=ridge_box,
    limits=_SIZES,
    growth=Growth.FIRST,
)
POWER = operator(
    "union power",
    combine=smooth.power_union,
    keeps=frozenset(),
    limits={"exponent": Limit.POSITIVE},
    growth=power_growth,
)
COMBINATIONS["union", "power"] = POWER
