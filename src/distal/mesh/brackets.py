"""Proved bounds of a solid's volume, mass, center of mass and box.

Input: a shape's kernels and its box. Output: a lower and an upper bound of each quantity. They
follow from boxes that are certainly inside and boxes that are certainly outside, by intervals; for
shapes that intervals cannot evaluate, by the slope that the shape states, which is then an
assumption (``certain_boxes``). What is between the bounds is due to the boxes that are left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from distal.lang.runtime_access import executor
from distal.mesh.certain_boxes import Divided, Effort, IntervalJudge, Judge, SlopeJudge, divided
from distal.mesh.extract import Extent
from distal.mesh.kernels import FieldKernels
from distal.mesh.requests import DISTANCE
from distal.mesh.solid import Floats
from distal.scene.lowering.derived import DistanceOf
from distal.tape.tape import TapeError

Bounds = tuple[tuple[float, ...], tuple[float, ...]]

# Of sums of numbers of 64 bits, as a share.
_ROUNDING: Final = 1e-12
# The box of a shape is computed in 32 bits; a face may be just beyond it.
_BOX_ROUNDING: Final = 1e-6
_MOST_STEPS: Final = 60


@dataclass(frozen=True, slots=True)
class Brackets:
    """Bounds that are certain within the shape's box, in scene units.

    Attributes:
        volume: The lower and the upper bound of the volume.
        mass: Those of the mass.
        center: The lower and the upper bounds of the center of mass, three numbers each.
        low: Bounds of the lowest coordinates: (lower, upper), three numbers each.
        high: Bounds of the highest coordinates.
        slope: None if intervals prove the bounds; else the slope that they assume: the shape states
            it, as a bound of |gradient|.
        reason: Why intervals cannot prove them; "" if they do.
        undecided: The share of the shape's box that is neither inside nor outside for certain.
        block: The largest side of the boxes that are left.
        boxes: How many boxes were looked at.
        reached: Whether the bounds of the volume are as close as was asked, if it was.
    """

    volume: tuple[float, float]
    mass: tuple[float, float]
    center: Bounds
    low: Bounds
    high: Bounds
    slope: float | None
    reason: str
    undecided: float
    block: float
    boxes: int
    reached: bool

    @property
    def width(self) -> float:
        """The distance between the bounds of the volume, as a share of their mean."""
        lower, upper = self.volume
        return (upper - lower) / (0.5 * (lower + upper)) if upper > 0.0 else 0.0

    def as_json(self) -> dict[str, Any]:
        """Return plain values."""
        pairs = {
            name: [list(corner) for corner in getattr(self, name)]
            for name in ("center", "low", "high")
        }
        plain = ("slope", "reason", "undecided", "width", "block", "boxes", "reached")
        return {
            "volume": list(self.volume),
            "mass": list(self.mass),
            **pairs,
            **{name: getattr(self, name) for name in plain},
        }


def brackets_of(
    kernels: FieldKernels,
    extent: Extent,
    watch: Callable[[float], None],
    effort: Effort | None = None,
    density: float = 1.0,
) -> Brackets:
    """Return the bounds.

    Args:
        kernels: The shape.
        extent: Its box, which the solid never leaves, and its slopes.
        watch: Called with the share of the work that is done.
        effort: How long to go on.
        density: The mass of a unit of volume.

    Raises:
        MeshProblem: A value is no number.
    """
    effort = effort or Effort()
    judge, slope, reason = _judge(kernels, extent)
    farthest = max(float(np.abs(extent.low).max()), float(np.abs(extent.high).max()), extent.size)
    margin = _BOX_ROUNDING * farthest
    found = divided(extent.low - margin, extent.high + margin, judge, effort, watch)
    least, most = (found.volume + float(ends.sum()) for ends in found.inside)
    volume = least * (1.0 - _ROUNDING), most * (1.0 + _ROUNDING)
    low, high = _box(found)
    return Brackets(
        volume=volume,
        mass=(volume[0] * density, volume[1] * density),
        center=_center(found, low[0], high[1]),
        low=(tuple(low[0].tolist()), tuple(low[1].tolist())),
        high=(tuple(high[0].tolist()), tuple(high[1].tolist())),
        slope=slope,
        reason=reason,
        undecided=found.undecided / found.whole,
        block=found.side,
        boxes=found.boxes,
        reached=not effort.width
        or volume[1] - volume[0] <= effort.width * 0.5 * (volume[0] + volume[1]),
    )


def _judge(kernels: FieldKernels, extent: Extent) -> tuple[Judge, float | None, str]:
    """Return a judge, and the slope that it assumes with the reason, if it assumes one."""
    try:
        distance = kernels.node.derived(DISTANCE, lambda: DistanceOf(kernels.node))
        tape = executor().box_tape(distance, kernels.params, kernels.time)
    except TapeError as error:
        slope = extent.slopes.slope
        return SlopeJudge(kernels, slope), slope, str(error)
    return IntervalJudge(tape), None, ""


def _box(found: Divided) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return bounds of the lowest and of the highest coordinates."""
    low, high = found.left
    outer_low = np.minimum(found.low, low.min(axis=0, initial=np.inf))
    outer_high = np.maximum(found.high, high.max(axis=0, initial=-np.inf))
    # Without a box that is inside, the lowest point may be anywhere.
    inner_low = np.where(np.isfinite(found.low), found.low, outer_high)
    inner_high = np.where(np.isfinite(found.high), found.high, outer_low)
    return (outer_low, inner_low), (inner_high, outer_high)


def _center(found: Divided, low: Floats, high: Floats) -> Bounds:
    """Return bounds of the center of mass.

    Args:
        found: What is certain.
        low: The lowest corner of what may be inside.
        high: Its highest corner.
    """
    if found.volume + float(found.inside[0].sum()) <= 0.0:
        return tuple(low.tolist()), tuple(high.tolist())
    first, last = (ends - found.origin for ends in found.left)
    sizes = last - first
    bounds: list[tuple[float, float]] = []
    for axis in range(3):
        areas = sizes[:, (axis + 1) % 3] * sizes[:, (axis + 2) % 3]
        a, b, moment = first[:, axis], last[:, axis], float(found.moment[axis])
        most = _farthest(found.volume, moment, (a, b), areas, found.inside)
        least = -_farthest(found.volume, -moment, (-b, -a), areas, found.inside)
        bounds.append((least + float(found.origin[axis]), most + float(found.origin[axis])))
    margin = _ROUNDING * (np.abs(found.origin) + (high - low))
    lower = np.maximum(np.array([end[0] for end in bounds]) - margin, low)
    upper = np.minimum(np.array([end[1] for end in bounds]) + margin, high)
    return tuple(lower.tolist()), tuple(upper.tolist())


def _farthest(
    volume: float,
    moment: float,
    ends: tuple[Floats, Floats],
    areas: Floats,
    inside: tuple[Floats, Floats],
) -> float:
    """Return the largest center of mass of a body and some of each of some boxes, along an axis.

    The least volume of a box counts as if it was at its far end, and what may be added to it before
    that. The center is at t or beyond for some parts if it is for those beyond t: if ``moment - t
    volume`` plus the integral of ``x - t`` over them is not negative. This function of t falls and
    is convex, so Newton's steps from a t that is too small never go too far; at least ``volume`` is
    its slope, which bounds the rest.

    Args:
        volume: The volume of the body.
        moment: The integral of its place.
        ends: Where the boxes begin and end along the axis.
        areas: The areas of their cross-sections.
        inside: Bounds of the volume of each box that counts.
    """
    first, last = ends
    with np.errstate(divide="ignore", invalid="ignore"):
        depths = [np.where(areas > 0.0, part / areas, last - first) for part in inside]
    least, most = (np.clip(last - depth, first, last) for depth in depths)
    volume += float(inside[0].sum())
    moment += float((inside[0] * (least + last) / 2.0).sum())
    t = moment / volume
    for _ in range(_MOST_STEPS):
        begin, end = np.maximum(most - t, 0.0), np.maximum(least - t, 0.0)
        beyond = moment - t * volume + 0.5 * float((areas * (end * end - begin * begin)).sum())
        step = beyond / (volume + float((areas * (end - begin)).sum()))
        if not step > 1e-15 * abs(t):
            break
        t += step
    return t + max(beyond, 0.0) / volume
