"""Measurements of a field at random points: its slope, and whether it stays within its box.

Input: a shape, its box, the region to measure where it has none, a seed. Output: figures. A
measurement finds mistakes but proves nothing: a steep place that is too small to be sampled is not
found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.lang.runtime_access import executor
from distal.scene.checks.bounds_report import NodeBounds
from distal.scene.lowering.derived import DistanceOf
from distal.scene.objects.field import BaseShape
from distal.scene.tree.node import Node

Points: TypeAlias = NDArray[np.float64]

POINTS: Final = 4096
# Number of points in the search around the steepest places; each round is closer to them.
SEARCHED: Final = 32
AROUND: Final = 24
ROUNDS: Final = 4
# How far outside its box a shape is measured, as a fraction of the box's size. In space only an
# eighth of the enlarged box is inside, so half of the points are drawn inside.
MARGIN: Final = 0.5
# An infinite shape in a tree without boxes is measured up to this distance from its finite side, or
# from the origin.
REACH: Final = 4.0

# A low and a high corner.
Region: TypeAlias = "tuple[tuple[float, ...], tuple[float, ...]]"
# Tolerance for a point on the surface, as a fraction of the box's size.
FOOT: Final = 2e-3


@dataclass(frozen=True, slots=True)
class Measured:
    """Measured figures of a field.

    Attributes:
        points: Number of evaluated points.
        median: The median of |gradient|.
        most_of_99: The 99th percentile of |gradient|.
        steepest: The largest |gradient|, within the box if there is one.
        steepest_at: The point of the largest |gradient|.
        steepest_around: The largest |gradient| outside the box.
        steepest_around_at: Its point, or None.
        largest_change: The largest |f(p) - f(q)| / |p - q|.
        change_between: The points p and q of the largest change.
        on_foot: Share of points p for which p - f * gradient lies on the surface: 1 if f is the
            true distance, except next to creases.
        outside_box: A point inside the shape and outside its box, or None.
        undefined_at: A point where the value or the gradient is NaN, or None.
    """

    points: int
    median: float
    most_of_99: float
    steepest: float
    steepest_at: tuple[float, ...]
    steepest_around: float
    steepest_around_at: tuple[float, ...] | None
    largest_change: float
    change_between: tuple[tuple[float, ...], tuple[float, ...]]
    on_foot: float
    outside_box: tuple[float, ...] | None
    undefined_at: tuple[float, ...] | None

    @property
    def slope(self) -> float:
        """The largest slope found by either method, within the box if there is one."""
        return max(self.steepest, self.largest_change)


def own_values(shape: BaseShape, params: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the parameters that a part of the whole has; others are refused."""
    names = {parameter.name for parameter in shape.parameters()}
    return {name: value for name, value in params.items() if name in names}


class InterpretedParts:
    """Parts of a whole at one time, evaluated at a few places without compiling anything.

    Each part is lowered once: at few places that takes longer than the evaluation.
    """

    def __init__(self, params: Mapping[str, Any], time: float) -> None:
        """Keep what all parts have in common.

        Args:
            params: Values of parameters by name, also of those that some parts have not.
            time: Time in seconds.
        """
        self._params, self._time = params, time
        # The functions keep their nodes: ids stay those of these.
        self._known: dict[tuple[int, Any], tuple[Any, dict[str, Any]]] = {}

    def values(self, node: Node, p: Points, what: Any = DistanceOf) -> Points:
        """Return values of a part.

        Args:
            node: The part.
            p: The places.
            what: What is evaluated, made of the node.
        """
        key = id(node), what
        if key not in self._known:
            self._known[key] = what(node), own_values(BaseShape._of(node), self._params)
        function, own = self._known[key]
        found = executor().call(function, (p,), {}, params=own, time=self._time, device="reference")
        return np.asarray(found, np.float64)


class _EvaluatedShape:
    """A shape at one time with one set of parameter values, evaluated in 64 bits."""

    def __init__(self, shape: BaseShape, params: Mapping[str, Any], time: float) -> None:
        self._shape, self._params, self._time = shape, own_values(shape, params), time
        self.dimensions = 2 if shape.flat else 3

    def value(self, p: Points) -> Points:
        return np.asarray(self._shape(p, params=self._params, time=self._time))

    def gradient(self, p: Points) -> Points:
        return np.asarray(self._shape.gradient(p, params=self._params, time=self._time))

    def steepness(self, p: Points) -> Points:
        return np.asarray(np.linalg.norm(self.gradient(p), axis=1))


def measure(
    shape: BaseShape,
    declared: NodeBounds,
    params: Mapping[str, Any],
    time: float,
    seed: int = 0,
    region: Region | None = None,
) -> Measured:
    """Measure a shape in its box, and around it.

    Args:
        shape: The shape.
        declared: The bounds that the shape declares.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.
        seed: Seed of the random points.
        region: Where to measure along axes without an end; None for ``REACH``.
    """
    asked = _EvaluatedShape(shape, params, time)
    n = asked.dimensions
    random = np.random.default_rng(seed)
    low, high = _looked_at(declared, n, region)
    size = float(np.max(high - low))
    grown = MARGIN * np.maximum(high - low, 0.1 * size)
    within = random.uniform(low, high, (POINTS // 2, n))
    around = random.uniform(low - grown, high + grown, (POINTS // 2, n))
    p = np.concatenate([within, around])
    values, slopes = asked.value(p), asked.gradient(p)
    fine = np.isfinite(values) & np.isfinite(slopes).all(axis=1)
    undefined = None if fine.all() else _point(p[~fine][0])
    p, values, slopes = p[fine], values[fine], slopes[fine]
    if not len(p):
        nowhere = (0.0,) * n
        pair = (nowhere, nowhere)
        return Measured(0, 0.0, 0.0, 0.0, nowhere, 0.0, None, 0.0, pair, 0.0, None, undefined)
    # Half of the points are moved to the surface, where marchers evaluate most.
    steep = np.linalg.norm(slopes, axis=1)
    foot = p - values[:, None] * slopes / np.maximum(steep**2, 1e-12)[:, None]
    near = foot[::2] + random.normal(0.0, 0.01 * size, foot[::2].shape)
    near = near[(np.abs(near) < 10.0 * REACH + 10.0 * np.abs(high).max() + size).all(axis=1)]
    asked_at = np.concatenate([p, near])
    steepness = np.concatenate([steep, _finite(asked.steepness(near))])
    box = (low, high) if declared.finite else (low - np.inf, high + np.inf)
    inside = _is_in(asked_at, box)
    at, steepest = _steepest(asked, asked_at[inside], steepness[inside], size, random, box)
    steepest_around, around_at = 0.0, None
    if not inside.all():
        place = int(np.argmax(np.where(inside, 0.0, steepness)))
        steepest_around, around_at = float(steepness[place]), _point(asked_at[place])
    held = np.concatenate([asked_at[inside], at[None]])
    pair, change = _largest_change(asked, held, size, random, box)
    beyond = ((asked_at < low - 1e-3 * size) | (asked_at > high + 1e-3 * size)).any(axis=1)
    outside = beyond & (np.concatenate([values, asked.value(near)]) < 0.0)
    return Measured(
        len(asked_at),
        float(np.median(steepness)),
        float(np.quantile(steepness, 0.99)),
        steepest,
        _point(at),
        steepest_around,
        around_at,
        change,
        pair,
        _on_foot(asked, p, values, slopes, size),
        _point(asked_at[outside][0]) if declared.finite and outside.any() else None,
        undefined,
    )


def _looked_at(declared: NodeBounds, n: int, region: Region | None) -> tuple[Points, Points]:
    low, high = np.array(declared.low[:n]), np.array(declared.high[:n])
    if region is not None:
        # Where the region lies beyond a finite side, this side decides.
        least, most = np.array(region[0][:n]), np.array(region[1][:n])
        low = np.where(np.isfinite(low), low, np.where(least < high, least, low))
        high = np.where(np.isfinite(high), high, np.where(most > low, most, high))
    ends_below, ends_above = np.isfinite(low), np.isfinite(high)
    cut = np.where(ends_below, low, np.minimum(np.where(ends_above, high, 0.0), 0.0) - REACH)
    top = np.where(ends_above, high, np.maximum(np.where(ends_below, low, 0.0), 0.0) + REACH)
    return cut, np.maximum(top, cut + 1e-6)


def _is_in(p: Points, box: tuple[Points, Points]) -> NDArray[np.bool_]:
    return np.asarray(((p >= box[0]) & (p <= box[1])).all(axis=-1))


def _steepest(
    asked: _EvaluatedShape,
    p: Points,
    steepness: Points,
    size: float,
    random: np.random.Generator,
    box: tuple[Points, Points],
) -> tuple[Points, float]:
    """Return the steepest place near the steepest points found, by a search in shrinking steps."""
    for round in range(ROUNDS):
        best = p[np.argsort(steepness)[-SEARCHED:]]
        reach = 0.1 * size * 0.2**round
        around = random.normal(0.0, reach, (len(best), AROUND, p.shape[1]))
        more = (best[:, None] + around).reshape(-1, p.shape[1])
        p = np.clip(np.concatenate([best, more]), *box)
        steepness = _finite(asked.steepness(p))
    at = int(np.argmax(steepness))
    return p[at], float(steepness[at])


def _largest_change(
    asked: _EvaluatedShape,
    p: Points,
    size: float,
    random: np.random.Generator,
    box: tuple[Points, Points],
) -> tuple[tuple[tuple[float, ...], tuple[float, ...]], float]:
    """Return the points with the largest change of value per distance, and this change.

    Half of the pairs lie along the gradient, where the value changes fastest.
    """
    away = random.normal(0.0, 1.0, p.shape)
    along = _finite(asked.gradient(p))
    away[::2] = np.where(np.linalg.norm(along[::2], axis=1)[:, None] > 0, along[::2], away[::2])
    away /= np.maximum(np.linalg.norm(away, axis=1), 1e-12)[:, None]
    # From a ten-thousandth of the box, where 64 bits still resolve differences, to a tenth.
    reach = size * 10.0 ** random.uniform(-4.0, -1.0, (len(p), 1))
    q = np.clip(p + reach * away, *box)
    apart = np.maximum(np.linalg.norm(q - p, axis=1), 1e-5 * size)
    change = _finite(np.abs(asked.value(q) - asked.value(p)) / apart)
    at = int(np.argmax(change))
    return (_point(p[at]), _point(q[at])), float(change[at])


def _on_foot(
    asked: _EvaluatedShape, p: Points, values: Points, slopes: Points, size: float
) -> float:
    foot = p - values[:, None] * slopes
    off = np.abs(asked.value(foot))
    return float(np.mean(off <= FOOT * size))


def _finite(values: Points) -> Points:
    return np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)


def _point(p: Points) -> tuple[float, ...]:
    return tuple(float(c) for c in p)
