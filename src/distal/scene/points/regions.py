"""Regions of space near a surface or in a volume, as equal cells, and random points in them.

Input: a shape and its bounds, a seed. Output: points as NumPy arrays, evenly distributed in a
volume, or in a thin layer around a surface. Values and gradients of the shape are computed by its
compiled functions, in double precision. Does not depend on what the points are for.
"""

from __future__ import annotations

import math
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import Span
from distal.ir.types import VEC3
from distal.scene.objects.field import BaseShape
from distal.scene.tree.conversion import Asked, number, shown
from distal.scene.tree.errors import refuse, refuse_kind

Floats: TypeAlias = NDArray[np.float64]
# The low and the high corner.
Box: TypeAlias = "tuple[Floats, Floats]"

# Cells along the longest side of the box: at first, and after they are divided.
COARSE: Final = 32
DIVIDED: Final = 4
# The most cells after the first division; a box full of surface is not divided.
MOST_CELLS: Final = 2_000_000
# Half of the layer's thickness, as a fraction of a cell.
LAYER: Final = 0.25
# Points that are tried at once, and at most in all.
BATCH: Final = 1 << 18
MOST_TRIED: Final = 1 << 26
# The largest value at a point on the surface, as a fraction of the box's size, and at most.
ON_SURFACE: Final = 1e-7
FARTHEST: Final = 1e-6
NEWTON_STEPS: Final = 24


class Random:
    """Random numbers that depend on the seed alone.

    The bits of NumPy's PCG64 never change from version to version; its distributions may.
    """

    def __init__(self, seed: int) -> None:
        self._bits = np.random.PCG64(seed)

    def fractions(self, rows: int, columns: int) -> Floats:
        """Return numbers of at least 0 and below 1."""
        bits = self._bits.random_raw(rows * columns)
        made: Floats = (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53
        return made.reshape(rows, columns)


def corners(given: Any, what: str, place: Span | None) -> Box:
    """Return the corners of a box that the author gives.

    Args:
        given: (low, high).
        what: The name of the function in messages.
        place: The author's line.

    Raises:
        SceneTypeError: It is not two points.
        SceneValueError: The low corner is above the high one.
    """
    try:
        low, high = given
    except (TypeError, ValueError):
        hint = "((-1, 0, -1), (1, 2, 1))"
        refuse_kind(f"{what} takes a box as two corners, not {given!r:.60}", hint, place)
    ends = []
    for name, corner in (("low corner", low), ("high corner", high)):
        found = number(corner, Asked(name, what, VEC3, place=place)).plain
        if found is None:
            refuse_kind(f"the corners of {what} are plain numbers", place=place)
        ends.append(np.array(found, dtype=np.float64))
    if not (ends[0] <= ends[1]).all() or (ends[0] == ends[1]).all():
        pair = f"{shown(tuple(ends[0]))} and {shown(tuple(ends[1]))}"
        refuse(f"{what}: nothing lies between {pair}: the low corner comes first", place=place)
    return ends[0], ends[1]


def box_of(shape: BaseShape, given: Any, what: str, place: Span | None) -> Box:
    """Return the box in which points of a shape are looked for.

    Args:
        shape: The shape.
        given: The author's box, or None for that of the shape.
        what: The name of the function in messages.
        place: The author's line.

    Raises:
        SceneValueError: The shape has no box, and none is given.
    """
    if given is not None:
        return corners(given, what, place)
    low, high = (np.array(corner, dtype=np.float64) for corner in shape.bounds())
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        hint = f"{what}(shape, …, within=((-5, -1, -5), (5, 1, 5)))"
        refuse(f"{what}: the box of {shape.name} has no end", hint, place)
    # A flat part may touch its box, which is computed in 32 bits.
    margin = 1e-4 * float((high - low).max()) + 1e-6
    return low - margin, high + margin


class Cells:
    """Equal cells that together contain all points of a box where a field is near a range.

    Attributes:
        size: Size of a cell.
        volume: Volume of all cells.
        rate: How much larger the value may be than the distance from the surface.
    """

    def __init__(self, shape: BaseShape, box: Box, *, inside: bool, margin: float = 0.0) -> None:
        """Divide the box twice, and keep the cells that may contain points.

        Args:
            shape: The shape.
            box: The box.
            inside: Whether the inside counts, besides the surface.
            margin: Up to which value the outside counts too.
        """
        low, high = box
        self._shape, self._inside, self._margin = shape, inside, margin
        self._low, self._high = low, high
        longest = float((high - low).max())
        counts = np.maximum(np.ceil((high - low) / longest * COARSE - 1e-9), 1.0)
        self.size = (high - low) / counts
        self.rate = self._rate()
        grid = np.meshgrid(*(np.arange(n) for n in counts), indexing="ij")
        self._starts = low + np.stack([g.ravel() for g in grid], axis=1) * self.size
        self._starts = self._near(self._starts)
        if len(self._starts) * DIVIDED**3 <= MOST_CELLS:
            fine = self.size / DIVIDED
            steps = np.stack(np.meshgrid(*[np.arange(DIVIDED)] * 3, indexing="ij"), axis=-1)
            offsets = steps.reshape(-1, 3) * fine
            self.size = fine
            self._starts = self._near((self._starts[:, None] + offsets).reshape(-1, 3))
        self.volume = float(len(self._starts) * self.size[self.size > 0.0].prod())

    def _rate(self) -> float:
        slope = self._shape.slope
        return slope if math.isfinite(slope) and slope < 1e6 else self._shape.divisor

    @property
    def layer(self) -> float:
        """Half of the thickness of the layer around the surface."""
        return LAYER * float(self.size.max())

    def _near(self, starts: Floats) -> Floats:
        """Return the cells that may contain points."""
        reach = 0.5 * float(np.linalg.norm(self.size)) + self.layer
        values = evaluated(self._shape, starts + 0.5 * self.size) / self.rate
        near = values <= reach + self._margin
        if not self._inside:
            near &= values >= -reach
        return starts[near]

    def points(self, random: Random, count: int) -> Floats:
        """Return random points, evenly distributed in the cells."""
        drawn = random.fractions(count, 4)
        chosen = (drawn[:, 3] * len(self._starts)).astype(np.int64)
        made: Floats = self._starts[chosen] + drawn[:, :3] * self.size
        return made

    @property
    def empty(self) -> bool:
        """Whether there are no cells."""
        return not len(self._starts)


def evaluated(shape: BaseShape, points: Floats) -> Floats:
    """Return the field's values; what is not a number counts as far outside."""
    found = np.asarray(shape(points), dtype=np.float64)
    return np.where(np.isnan(found), np.inf, found)


def gradients(shape: BaseShape, points: Floats) -> tuple[Floats, Floats]:
    """Return the field's gradients, and their lengths; where there is none, both are 0."""
    found = np.nan_to_num(np.asarray(shape.gradient(points), dtype=np.float64))
    return found, np.linalg.norm(found, axis=1)


def moved_to_surface(
    shape: BaseShape, points: Floats, size: float
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return points moved to the surface along the gradient, by Newton's method.

    Args:
        shape: The shape.
        points: Points near the surface.
        size: The size of the shape's box.

    Returns:
        The points, their normals, and which of the given points reached the surface: the others
        are left out.
    """
    tolerance = min(ON_SURFACE * size, FARTHEST)
    moved = points.copy()
    normals = np.zeros_like(points)
    arrived = np.zeros(len(points), dtype=np.bool_)
    left = np.arange(len(points))
    for _ in range(NEWTON_STEPS):
        values = evaluated(shape, moved[left])
        gradient, length = gradients(shape, moved[left])
        steep = length > 0.0
        there = steep & (np.abs(values) <= tolerance)
        normals[left[there]] = gradient[there] / length[there, None]
        arrived[left[there]] = True
        on = steep & ~there & np.isfinite(values)
        left = left[on]
        if not len(left):
            break
        moved[left] -= gradient[on] * (values[on] / length[on] ** 2)[:, None]
    return moved[arrived], normals[arrived], arrived
