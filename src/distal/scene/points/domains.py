"""Domains in which points are scattered: boxes, the inside of solids, surfaces.

Input: a shape or a box, random numbers. Output: evenly distributed candidates. A domain can be made
wider by a margin: candidates in the margin keep others away from the border, where points would
otherwise be denser, and are left out in the end.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.scene.objects.field import BaseShape
from distal.scene.points.regions import (
    Box,
    Cells,
    Random,
    evaluated,
    gradients,
    moved_to_surface,
)

Floats: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Candidates:
    """Candidates for points.

    Attributes:
        points: The points.
        normals: The normals of the surface there; zeros in a volume.
        inside: Which points are in the domain itself; the others are in its margin.
    """

    points: Floats
    normals: Floats
    inside: Mask


class Domain(ABC):
    """Where points may be.

    Attributes:
        size: Length, area or volume of the region that points are drawn from.
        dimensions: 1, 2 or 3.
    """

    size: float
    dimensions: int

    @abstractmethod
    def drawn(self, random: Random, count: int) -> tuple[Candidates, int]:
        """Draw ``count`` points; return those in the domain, and how many of them counted.

        What counted, divided by ``count``, is the share of the domain in the region. A surface
        loses points that counted.
        """

    @abstractmethod
    def with_margin(self, margin: float) -> Self | None:
        """Return a domain that is wider by a margin; None if this one has no border."""

    @property
    def empty(self) -> bool:
        """Whether there is nothing to draw from."""
        return False


def _within(points: Floats, box: Box) -> Mask:
    low, high = box
    found: Mask = np.all((points >= low) & (points <= high), axis=1)
    return found


def _wider(box: Box, margin: float) -> Box:
    """Return a box with a margin on all sides; a flat one stays flat."""
    low, high = box
    wide = margin * (high > low)
    return low - wide, high + wide


class BoxDomain(Domain):
    """A box, a rectangle or a line."""

    def __init__(self, box: Box, margin: float = 0.0) -> None:
        self._box = box
        self._low, high = _wider(box, margin)
        self._sides = high - self._low
        wide = self._sides[self._sides > 0.0]
        self.size, self.dimensions = float(wide.prod()), len(wide)

    def drawn(self, random: Random, count: int) -> tuple[Candidates, int]:
        """Draw points; see ``Domain``."""
        points = self._low + random.fractions(count, 3) * self._sides
        return Candidates(points, np.zeros_like(points), _within(points, self._box)), count

    def with_margin(self, margin: float) -> BoxDomain:
        """Return a larger box."""
        return BoxDomain(self._box, margin)


class SolidDomain(Domain):
    """The inside of a solid, limited to a box."""

    def __init__(self, shape: BaseShape, box: Box, *, limited: bool, margin: float = 0.0) -> None:
        """Find the cells of the domain.

        Args:
            shape: The solid.
            box: The box.
            limited: Whether the box cuts the solid, so that points must be within it.
            margin: Width of the margin.
        """
        self._shape, self._box, self._limited, self._margin = shape, box, limited, margin
        self._cells = Cells(shape, _wider(box, margin), inside=True, margin=margin)
        self.size = self._cells.volume
        self.dimensions = int((box[0] < box[1]).sum())

    def drawn(self, random: Random, count: int) -> tuple[Candidates, int]:
        """Draw points; see ``Domain``."""
        points = self._cells.points(random, count)
        values = evaluated(self._shape, points)
        kept = values <= self._margin
        points, inside = points[kept], values[kept] <= 0.0
        if self._limited:
            inside &= _within(points, self._box)
        return Candidates(points, np.zeros_like(points), inside), len(points)

    def with_margin(self, margin: float) -> SolidDomain:
        """Return the domain with a layer of the outside."""
        return SolidDomain(self._shape, self._box, limited=self._limited, margin=margin)

    @property
    def empty(self) -> bool:
        """Whether no cell is left."""
        return self._cells.empty


class SurfaceDomain(Domain):
    """The surface of a solid, limited to a box."""

    dimensions = 2

    def __init__(self, shape: BaseShape, box: Box, *, limited: bool, margin: float = 0.0) -> None:
        """Find the cells of the domain.

        Args:
            shape: The solid.
            box: The box.
            limited: Whether the box cuts the surface, so that points must be within it.
            margin: Width of the margin.
        """
        self._shape, self._box, self._limited = shape, box, limited
        self._wide = _wider(box, margin)
        self._cells = Cells(shape, self._wide, inside=False)
        self._layer = self._cells.layer
        # Points are drawn from a layer around the surface, so its volume is divided by the
        # thickness. Its thickness in values is in proportion to the length of the gradient.
        self.size = self._cells.volume / (2.0 * self._layer)
        self._steepest = 2.0 * self._cells.rate
        self._extent = float((box[1] - box[0]).max())

    def drawn(self, random: Random, count: int) -> tuple[Candidates, int]:
        """Draw points; see ``Domain``."""
        points = self._cells.points(random, count)
        values = np.abs(evaluated(self._shape, points))
        near = values <= self._layer * self._steepest
        points, values = points[near], values[near]
        _, length = gradients(self._shape, points)
        points = points[values < self._layer * length]
        moved, normals, _ = moved_to_surface(self._shape, points, self._extent)
        inside = np.ones(len(moved), dtype=np.bool_)
        if self._limited:
            kept = _within(moved, self._wide)
            moved, normals = moved[kept], normals[kept]
            inside = _within(moved, self._box)
        return Candidates(moved, normals, inside), len(points)

    def with_margin(self, margin: float) -> SurfaceDomain | None:
        """Return the surface in a larger box; a whole surface has no border."""
        if not self._limited:
            return None
        return SurfaceDomain(self._shape, self._box, limited=True, margin=margin)

    @property
    def empty(self) -> bool:
        """Whether no cell is left."""
        return self._cells.empty
