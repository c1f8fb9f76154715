"""Divide a box into boxes of which it is certain how much of them is inside a solid.

Input: a box, and a judge: what is certain of some boxes. Output: what the boxes inside add up to,
and the boxes that are left, with bounds of the volume in them. Those with the most uncertain volume
are halved, until all of it is little enough or the work is done.

There are two judges. One evaluates the field and its gradient over a box by intervals that are
rounded outwards; it assumes nothing. Where the gradient varies little, the surface is between two
planes that are close together. The other compares the value in the middle with half of the diagonal
times the slope that the shape states, which may be wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from distal.ir.types import VEC3
from distal.mesh.arithmetic import distance_value
from distal.mesh.bricks import check_numbers
from distal.mesh.half_boxes import ends, shares
from distal.mesh.kernels import FieldKernels
from distal.mesh.solid import Floats, Integers
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.tape.box_tape import BoxTape

MOST_BOXES: Final = 1_000_000
MOST_WORK: Final = 1_000_000_000
# So many boxes fit into a processor's cache with their values; fewer for a gradient of many steps.
_CHUNK: Final = 4096
_MOST_STEPS: Final = 1_000_000
# Gradients of longer fields take too long; they become shorter in smaller boxes.
_LONGEST: Final = 2000
_FEW: Final = 1024
# Boxes are halved whose uncertain volume is at least this share of the mean.
_SHARE: Final = 0.5
_ENOUGH: Final = 1e-9  # a width that nobody needs to be less
_SMALLEST: Final = 2.0**-45  # side, of the largest coordinate; a number of 64 bits has 52
_ROUNDING: Final = 1e-9
_OUTWARDS: Final = 1e-12
_COLUMNS: Final = ("low", "high", "volumes", "outer", "axis")  # of ``_OpenBoxes``


@dataclass(frozen=True, slots=True)
class Effort:
    """How long boxes are divided: until the width or the work is reached.

    Attributes:
        width: The distance between the bounds of the volume, as a share of the volume.
        work: About how many boxes are looked at, at most.

    Raises:
        SceneValueError: A number is out of range.
    """

    width: Any = 0.0
    work: Any = MOST_BOXES

    def __post_init__(self) -> None:
        width, work = self.width, self.work
        if isinstance(width, bool) or not isinstance(width, int | float) or not 0.0 <= width < 2.0:
            words = f"the width of proved bounds is a share from 0 to 2, not {width!r:.40}"
            refuse(words, "width=0.01")
        if isinstance(work, bool) or not isinstance(work, int) or not 1 <= work <= MOST_WORK:
            words = f"the work for proved bounds is 1 to {MOST_WORK:,} boxes, not {work!r:.40}"
            refuse(words, f"work={MOST_BOXES}")


@dataclass(frozen=True, slots=True)
class Judged:
    """What is certain of some boxes.

    Attributes:
        least: The share of each box that is inside at least, (n,).
        most: The share that is inside at most.
        outer: Corners of boxes that hold all that may be inside, two of (n, 3).
        inner: Corners that are reached by what is inside for certain: the highest that the low
            corner may be, and the lowest that the high corner may be. NaN where nothing is.
        axis: Along which axis a box is halved best, (n,).
        judge: A judge of parts of the boxes.
    """

    least: Floats
    most: Floats
    outer: tuple[Floats, Floats]
    inner: tuple[Floats, Floats]
    axis: Integers
    judge: Judge


class Judge(Protocol):
    """Says what is certain of boxes."""

    def judged(self, low: Floats, high: Floats) -> Judged:
        """Return what is certain of boxes."""


def _plain(low: Floats, high: Floats, inside: Any, outside: Any, judge: Judge) -> Judged:
    """Return what is certain of boxes that are inside, outside or neither.

    Args:
        low: The lower corners.
        high: The upper corners.
        inside: Which boxes are inside.
        outside: Which are outside.
        judge: A judge of their parts.
    """
    inner = np.where(inside[:, None], low, np.nan), np.where(inside[:, None], high, np.nan)
    axis = (high - low).argmax(axis=1)
    least, most = inside.astype(np.float64), 1.0 - outside.astype(np.float64)
    return Judged(least, most, (low.copy(), high.copy()), inner, axis, judge)


@dataclass(frozen=True, slots=True)
class IntervalJudge:
    """Evaluates the field over boxes.

    Attributes:
        tape: The field.
    """

    tape: BoxTape

    def judged(self, low: Floats, high: Floats) -> Judged:
        """Return what is certain of boxes."""
        bottom, top, shorter = self.tape.values(low, high)
        # What is not known is NaN, and not certain.
        found = _plain(low, high, top < 0.0, bottom >= 0.0, IntervalJudge(shorter))
        if len(shorter) > _LONGEST:
            return found
        open_ = np.flatnonzero((found.least < found.most) & np.isfinite(bottom) & np.isfinite(top))
        chunk = max(_MOST_STEPS // len(shorter), 64)
        for begin in range(0, len(open_), chunk):
            rows = open_[begin : begin + chunk]
            self._cut(found, rows, low[rows], high[rows], shorter)
        return found

    def _cut(self, found: Judged, rows: Integers, low: Floats, high: Floats, tape: BoxTape) -> None:
        """Bound the surface by two planes in each of some boxes.

        Args:
            found: What is certain; its rows are changed.
            rows: The rows of the boxes.
            low: The lower corners.
            high: The upper corners.
            tape: The field.
        """
        falling, rising = tape.gradients(low, high)
        known = np.isfinite(falling).all(axis=1) & np.isfinite(rising).all(axis=1)
        if not known.any():
            return
        rows, low, high = rows[known], low[known], high[known]
        falling, rising = falling[known], rising[known]
        middle = low + (high - low) / 2.0
        bottom, top, _ = tape.values(middle, middle)
        half = np.maximum(high - middle, middle - low) * (1.0 + _OUTWARDS)
        normal = (falling + rising) / 2.0
        spread = np.maximum(rising - normal, normal - falling)
        bend = (spread * half).sum(axis=1)
        rounding = _OUTWARDS * (np.abs(normal) * half).sum(axis=1)
        near, far = top + bend + rounding, bottom - bend - rounding
        # The middle and half of the sides are rounded; the box is a little smaller than them.
        off = 4e-16 * (np.abs(middle) / half).max(axis=1)
        least = np.maximum(shares(half, normal, near, -1) - off, 0.0)
        most = np.minimum(shares(half, normal, far, 1) + off, 1.0)
        # Planes that pass beside the box say that all of it is inside, or outside.
        reach = (np.abs(normal) * half).sum(axis=1)
        found.least[rows] = np.where(near < -reach, 1.0, least)
        found.most[rows] = np.where(far > reach, 0.0, np.maximum(most, found.least[rows]))
        margin = _OUTWARDS * (np.abs(middle) + half)
        for target, distance, outwards in ((found.outer, far, 1.0), (found.inner, near, -1.0)):
            first, last = ends(half, normal, distance)
            target[0][rows] = np.clip(middle + first - outwards * margin, low, high)
            target[1][rows] = np.clip(middle + last + outwards * margin, low, high)
        empty = found.least[rows] <= 0.0
        found.inner[0][rows[empty]] = np.nan
        found.inner[1][rows[empty]] = np.nan
        found.axis[rows] = ((spread + 1e-3 * np.abs(normal)) * half).argmax(axis=1)


@dataclass(frozen=True, slots=True)
class SlopeJudge:
    """Evaluates the field in the middle of boxes.

    Attributes:
        kernels: The shape.
        slope: A bound on its gradient, as the shape states it.
    """

    kernels: FieldKernels
    slope: float

    def judged(self, low: Floats, high: Floats) -> Judged:
        """Return what is certain of boxes.

        Raises:
            MeshProblem: A value is no number.
        """
        middles = (low + high) / 2.0
        value = self.kernels.call(distance_value, middles, types=[("p", VEC3)])
        check_numbers(value, middles)
        reach = np.sqrt(((high - low) ** 2).sum(axis=1)) / 2.0 * self.slope * (1.0 + _ROUNDING)
        return _plain(low, high, value < -reach, value > reach, self)


@dataclass(slots=True)
class Divided:
    """What is known of a box.

    Attributes:
        whole: The volume of the box.
        origin: The middle of the box.
        volume: The volume of the boxes inside.
        moment: The integral of the place over them, from ``origin``.
        low: The highest that the lowest corner of the solid may be; infinite if not known.
        high: The lowest that its highest corner may be.
        left: The lower and the upper corners of the boxes that are neither inside nor outside, as
            far as they may be inside.
        inside: Bounds of the volume inside in each of these: two of (n,).
        side: The largest side of these boxes.
        boxes: How many boxes were looked at.
    """

    origin: Floats
    whole: float
    volume: float = 0.0
    moment: Floats = field(default_factory=lambda: np.zeros(3))
    low: Floats = field(default_factory=lambda: np.full(3, np.inf))
    high: Floats = field(default_factory=lambda: np.full(3, -np.inf))
    left: tuple[Floats, Floats] = field(default_factory=lambda: (np.zeros((0, 3)),) * 2)
    inside: tuple[Floats, Floats] = field(default_factory=lambda: (np.zeros(0),) * 2)
    side: float = 0.0
    boxes: int = 0

    @property
    def undecided(self) -> float:
        """The volume that is neither inside nor outside for certain."""
        return float((self.inside[1] - self.inside[0]).sum())

    def add(self, low: Floats, high: Floats, judged: Judged) -> None:
        """Add what is certain of boxes that are looked at."""
        inside = judged.least >= 1.0
        if inside.any():
            first, last = low[inside], high[inside]
            volumes = (last - first).prod(axis=1)
            self.volume += float(volumes.sum())
            self.moment = self.moment + volumes @ ((first + last) / 2.0 - self.origin)
        self.low = np.fmin(self.low, np.fmin.reduce(judged.inner[0]))
        self.high = np.fmax(self.high, np.fmax.reduce(judged.inner[1]))


@dataclass(frozen=True, slots=True)
class _OpenBoxes:
    """Boxes that are not certain, and who judges their parts.

    Attributes:
        low: Their lower corners.
        high: Their upper corners.
        volumes: Bounds of the volume inside each, (n, 2).
        outer: Corners of what may be inside, (n, 6).
        axis: Along which axis each is halved.
        judge: Who judges their parts.
    """

    low: Floats
    high: Floats
    volumes: Floats
    outer: Floats
    axis: Integers
    judge: Judge

    @classmethod
    def of(cls, low: Floats, high: Floats, judged: Judged) -> _OpenBoxes:
        """Return the boxes that are not certain."""
        rows = np.flatnonzero((judged.least < 1.0) & (judged.most > 0.0))
        low, high = low[rows], high[rows]
        each = (high - low).prod(axis=1)
        volumes = np.stack([judged.least[rows] * each, judged.most[rows] * each], axis=1)
        outer = np.concatenate([corner[rows] for corner in judged.outer], axis=1)
        return cls(low, high, volumes, outer, judged.axis[rows], judged.judge)

    @property
    def gaps(self) -> Floats:
        """The volumes that are not certain."""
        found: Floats = self.volumes[:, 1] - self.volumes[:, 0]
        return found

    @property
    def sides(self) -> Floats:
        """The sides that are halved."""
        found: Floats = (self.high - self.low)[np.arange(len(self.axis)), self.axis]
        return found

    def chosen(self, rows: Any) -> _OpenBoxes:
        """Return some of the boxes."""
        return replace(self, **{name: getattr(self, name)[rows] for name in _COLUMNS})

    def joined(self, others: _OpenBoxes) -> _OpenBoxes:
        """Return these boxes and others, for the judge of these."""
        columns: dict[str, Any] = {
            name: np.concatenate([getattr(self, name), getattr(others, name)]) for name in _COLUMNS
        }
        return replace(self, **columns)

    def halves(self) -> tuple[Floats, Floats]:
        """Return the corners of the halves of the boxes; their common corners are equal."""
        rows = np.arange(len(self.low))
        low, high = np.repeat(self.low, 2, axis=0), np.repeat(self.high, 2, axis=0)
        first, last = self.low[rows, self.axis], self.high[rows, self.axis]
        middle = first + (last - first) / 2.0
        high[2 * rows, self.axis], low[2 * rows + 1, self.axis] = middle, middle
        return low, high


def divided(
    low: Floats, high: Floats, judge: Judge, effort: Effort, watch: Callable[[float], None]
) -> Divided:
    """Return what is known of a box.

    Args:
        low: Its lower corner.
        high: Its upper corner.
        judge: Says what is certain.
        effort: How long it is divided.
        watch: Called with the share of the work that is done.
    """
    found = Divided((low + high) / 2.0, float((high - low).prod()), boxes=1)
    judged = judge.judged(low[None], high[None])
    found.add(low[None], high[None], judged)
    chunks = [some for some in (_OpenBoxes.of(low[None], high[None], judged),) if len(some.low)]
    smallest = _SMALLEST * max(float(np.abs(low).max()), float(np.abs(high).max()))
    while chunks:
        gaps = np.concatenate([some.gaps for some in chunks])
        least = found.volume + sum(float(some.volumes[:, 0].sum()) for some in chunks)
        gap = float(gaps.sum())
        if gap <= max(effort.width, _ENOUGH) * (least + gap / 2.0):
            break
        limit = _limit(gaps, (effort.work - found.boxes) // 2)
        next_chunks: list[_OpenBoxes] = []
        halved = False
        for some in chunks:
            split = (some.gaps >= limit) & (some.gaps > 0.0) & (some.sides > smallest)
            halved |= bool(split.any())
            next_chunks += _halved(found, some, split)
            watch(min(1.0, found.boxes / effort.work))
        chunks = next_chunks
        if not halved:
            break
    _finish(found, chunks)
    return found


def _limit(gaps: Floats, most: int) -> float:
    """Return from which uncertain volume on boxes are halved: at most so many of them."""
    limit = _SHARE * float(gaps.mean())
    if int((gaps >= limit).sum()) <= most:
        return limit
    # The largest of them; equal ones are left out together.
    return float(np.nextafter(np.partition(gaps, len(gaps) - most - 1)[-most - 1], np.inf))


def _halved(found: Divided, some: _OpenBoxes, split: Any) -> list[_OpenBoxes]:
    """Return the boxes after some of them are halved.

    Args:
        found: What is known, to add to.
        some: The boxes.
        split: Which are halved.
    """
    if not split.any():
        return [some]
    kept = some.chosen(~split)
    low, high = some.chosen(split).halves()
    found.boxes += len(low)
    made: list[_OpenBoxes] = []
    for begin in range(0, len(low), _CHUNK):
        first, last = low[begin : begin + _CHUNK], high[begin : begin + _CHUNK]
        judged = some.judge.judged(first, last)
        found.add(first, last, judged)
        made.append(_OpenBoxes.of(first, last, judged))
    if len(kept.low) and len(made) == 1 and len(made[0].low) < _FEW:
        return [kept.joined(made[0])]
    return [some for some in (kept, *made) if len(some.low)]


def _finish(found: Divided, chunks: Sequence[_OpenBoxes]) -> None:
    """Record the boxes that are left."""
    if not chunks:
        return
    outer, volumes = (
        np.concatenate([getattr(some, name) for some in chunks]) for name in ("outer", "volumes")
    )
    found.left = outer[:, :3], outer[:, 3:]
    found.inside = volumes[:, 0], volumes[:, 1]
    found.side = max(float((some.high - some.low).max()) for some in chunks)
