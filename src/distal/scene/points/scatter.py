"""Points scattered on a surface or in a volume: blue noise, the same for the same seed.

Input: a shape or a box, the number of points or their distance, a seed. Output: points (and
normals) as NumPy arrays, for ``Shape.array`` and ``copies``. Candidates are evenly distributed
random points (``regions``); some of them are kept (``poisson``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import Span
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.points import poisson, regions
from distal.scene.points.domains import (
    BoxDomain,
    Candidates,
    Domain,
    SolidDomain,
    SurfaceDomain,
)
from distal.scene.points.requests import MOST_POINTS, positive, whole_number
from distal.scene.tree.errors import refuse, refuse_kind

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Corners

Floats: TypeAlias = NDArray[np.float64]

# Candidates for each point that is kept. With 10, 44 % of an area is covered by disks of half the
# least distance; with 6, 40 % in half of the time; with all, 55 %.
PER_POINT: Final = 8
# The number of points from which the size of the domain is measured.
MEASURED: Final = 4096
# With a margin, a domain is at most so many times as large; thinner ones have none.
WIDEST: Final = 4.0
# After so many points without one in the domain, there is none.
FRUITLESS: Final = 1 << 22


def points_on(
    shape: BaseShape,
    count: int | None = None,
    *,
    spacing: float | None = None,
    seed: int = 0,
    within: Corners | None = None,
) -> tuple[Floats, Floats]:
    """Return points scattered on the surface of a solid, and the normals there.

    They are blue noise: random, with the same density everywhere, and none near another one. A seed
    gives the same points on every machine. Parameters have their defaults, time is 0.

    Args:
        shape: The solid.
        count: Number of points.
        spacing: Least distance between points, instead of ``count``.
        seed: Selects one of many sets of points.
        within: Corners (low, high) of a box to which points are limited; None for the box of the
            shape, which must be finite.

    Returns:
        Two (n, 3) arrays: the points, and the normals, of length 1.

    Raises:
        SceneTypeError: An argument has the wrong type.
        SceneValueError: The shape has no surface in the box, or not exactly one of count and
            spacing is given.
    """
    place, what = author_place(), "points_on"
    request = _Request(what, place, count, spacing, seed)
    _check_solid(shape, what, place)
    box = regions.box_of(shape, within, what, place)
    if not (box[0] < box[1]).all():
        refuse(f"{what} needs a box with three sides above 0", None, place)
    found = request.scattered(SurfaceDomain(shape, box, limited=within is not None))
    return found.points, found.normals


def points_in(
    region: BaseShape | Corners,
    count: int | None = None,
    *,
    spacing: float | None = None,
    seed: int = 0,
    within: Corners | None = None,
) -> Floats:
    """Return points scattered in a solid or in a box.

    They are blue noise, as those of ``points_on``. A box whose corners have the same height is a
    rectangle, and points in it lie in a plane.

    Args:
        region: The solid, or the corners (low, high) of a box.
        count: Number of points.
        spacing: Least distance between points, instead of ``count``.
        seed: Selects one of many sets of points.
        within: Corners of a box to which points in a solid are limited; None for the box of the
            solid, which must be finite.

    Returns:
        An (n, 3) array.

    Raises:
        SceneTypeError: An argument has the wrong type.
        SceneValueError: The solid has no inside in the box, or not exactly one of count and
            spacing is given.
    """
    place, what = author_place(), "points_in"
    request = _Request(what, place, count, spacing, seed)
    if not isinstance(region, BaseShape):
        return request.scattered(BoxDomain(regions.corners(region, what, place))).points
    _check_solid(region, what, place)
    if not region.node.signed:
        refuse(f"{what}: {region.name} has no inside", "points_on(shape, …)", place)
    box = regions.box_of(region, within, what, place)
    return request.scattered(SolidDomain(region, box, limited=within is not None)).points


def _check_solid(shape: Any, what: str, place: Span | None) -> None:
    if not isinstance(shape, BaseShape) or shape.flat:
        refuse_kind(f"{what} takes a solid shape, not {shape!r:.60}", None, place)


@dataclass(frozen=True, slots=True)
class _Request:
    """What the author requests: a count or a spacing, and the seed."""

    what: str
    place: Span | None
    count: int | None
    spacing: float | None
    seed: int

    def __post_init__(self) -> None:
        what, place = self.what, self.place
        if (self.count is None) == (self.spacing is None):
            refuse(f"{what} takes either count or spacing", f"{what}(region, 100)", place)
        if self.count is not None:
            whole_number(self.count, f"count of {what}", place)
        if self.spacing is not None:
            positive(self.spacing, f"spacing of {what}", place)
        whole_number(self.seed, f"seed of {what}", place, least=0, most=2**31 - 1)

    def scattered(self, domain: Domain) -> Candidates:
        """Return the points that are kept."""
        random = regions.Random(self.seed)
        drawn = self._draw(domain, random, MEASURED)
        size, dimensions = drawn.size_of(domain), domain.dimensions
        if self.count is not None:
            count = int(self.count)
            distance = poisson.distance_for(count, size, dimensions)
        else:
            assert self.spacing is not None
            distance = float(self.spacing)
            count = self._checked(round(poisson.count_for(distance, size, dimensions)))
        wide = domain.with_margin(distance)
        if wide is not None:
            wider = self._draw(wide, random, MEASURED)
            if wider.size_of(wide) <= WIDEST * size:
                domain, drawn = wide, wider
        wanted = PER_POINT * count
        self._draw(domain, random, max(wanted, MEASURED), drawn)
        candidates = drawn.first(wanted if self.count is not None else max(wanted, MEASURED))
        points, inside = candidates.points, candidates.inside
        if self.count is not None:
            kept = poisson.kept_of_count(points, inside, count, distance, dimensions)
        else:
            kept = poisson.kept_with_distance(points, distance)
            kept = kept[inside[kept]]
        return Candidates(points[kept], candidates.normals[kept], inside[kept])

    def _checked(self, count: int) -> int:
        """Return the number of points that a spacing gives."""
        if count > MOST_POINTS:
            refuse(
                f"a spacing of {self.spacing:g} gives about {count:,} points; "
                f"{MOST_POINTS:,} are the most",
                place=self.place,
            )
        return max(count, 1)

    def _draw(
        self, domain: Domain, random: regions.Random, wanted: int, drawn: _Drawn | None = None
    ) -> _Drawn:
        """Draw candidates until ``wanted`` are in the domain.

        Args:
            domain: The domain.
            random: The source of random numbers.
            wanted: The number of candidates.
            drawn: Candidates to add to; None for new ones.
        """
        drawn = drawn or _Drawn()
        while drawn.inside < wanted:
            share = (drawn.inside + 1.0) / (drawn.tried + 1.0) if drawn.tried else 0.25
            batch = min(max(int(1.1 * (wanted - drawn.inside) / share), 1024), regions.BATCH)
            nothing = drawn.tried > FRUITLESS and not drawn.inside
            if domain.empty or nothing or drawn.tried > regions.MOST_TRIED:
                where = "surface" if self.what == "points_on" else "inside"
                hint = "points are looked for in the shape's box, or in within=(low, high)"
                refuse(f"{self.what} found no {where} there", hint, self.place)
            drawn.add(*domain.drawn(random, batch), batch)
        return drawn


@dataclass(slots=True)
class _Drawn:
    """Candidates that are drawn until there are enough.

    Attributes:
        blocks: The candidates, in random order.
        tried: Number of points that were drawn.
        counted: Number of points that belong to the domain or its margin.
        inside: Number of candidates in the domain.
    """

    blocks: list[Candidates] = field(default_factory=list)
    tried: int = 0
    counted: int = 0
    inside: int = 0

    def add(self, block: Candidates, counted: int, tried: int) -> None:
        """Add a block of candidates.

        Args:
            block: The candidates.
            counted: How many points belong to the domain or its margin.
            tried: How many were drawn.
        """
        self.blocks.append(block)
        self.counted += counted
        self.tried += tried
        self.inside += int(block.inside.sum())

    def size_of(self, domain: Domain) -> float:
        """Return the size of the domain with its margin."""
        return domain.size * self.counted / self.tried

    def first(self, count: int) -> Candidates:
        """Return the first candidates, of which ``count`` are in the domain."""
        points, normals, inside = (
            np.concatenate([getattr(block, name) for block in self.blocks])
            for name in ("points", "normals", "inside")
        )
        end = int(np.searchsorted(np.cumsum(inside), count)) + 1
        return Candidates(points[:end], normals[:end], inside[:end])
