"""Signed distances to a surface that points with normals lie on, at the nodes of a grid.

Input: points, the spacing of the nodes, the radius within which points count. Output: distances,
and what is known of the points. Near the points the distance is that of a surface through them, by
moving least squares; elsewhere it is that to small triangles, one for each point, which also say by
their winding number what is inside where points are missing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need
from distal.polygons import point_arithmetic
from distal.polygons.bricks import MOST_DENSE
from distal.polygons.distances import CELLS_ALONG, MARGIN, nearest_triangles, widened
from distal.polygons.inside import (
    closed_between,
    filled,
    is_contradictory,
    shorten,
    winding_numbers,
)
from distal.polygons.kernels import run
from distal.polygons.points import SourcePoints
from distal.polygons.topology import Joined
from distal.polygons.tree import tree_buffers

# Points within the radius at which areas are measured: enough for a mean, few enough to be local.
_COUNTED: Final = (8, 24)
# The radius within which points count, in distances of points and of nodes.
_IN_POINTS: Final = 3.0
_IN_NODES: Final = 2.5
# The surface is that of the points up to this height, in nodes; and where the weight of points is
# at least this part of its mean on the surface: beyond, there are no points, or only at one side.
_HIGHEST: Final = 1.5
_LEAST_WEIGHT: Final = 0.02
# A normal disagrees if it is more than 90 degrees away from those about it. More than this share
# of them is no cloud of oriented points.
_MOST_WRONG: Final = 0.25
_MOST_OPEN: Final = 0.8
_NODE_BYTES: Final = 200  # that a node costs at the peak


@dataclass(frozen=True, slots=True, eq=False)
class CloudDistances:
    """Signed distances to points at the nodes of a grid.

    Attributes:
        values: float32, (nodes along z, y, x), in the unit of the points.
        low: The first node.
        spacing: The distance of two nodes along an axis.
        apart: The distance of points, about: the root of the area of one.
        radius: Within which points count.
        turned: Whether the normals pointed inwards, and were turned.
        wrong: The number of points that were left out, because their normals disagree with those
            about them.
        is_closed: Whether the points surround the inside; else holes were closed.
    """

    values: NDArray[np.float32]
    low: NDArray[np.float64]
    spacing: float
    apart: float
    radius: float
    turned: bool
    wrong: int
    is_closed: bool


def cloud_distances(
    cloud: SourcePoints, spacing: float | None = None, radius: float | None = None
) -> CloudDistances:
    """Return the signed distances to a surface through points.

    Args:
        cloud: The points.
        spacing: The distance of two nodes; None: a 64th of the longest side of the points' box, or
            the distance of points if that is more.
        radius: Within which points count; None: three times their distance, or 2.5 nodes if that
            is more.

    Raises:
        LoadError: The points are in one place, do not enclose anything, have normals that
            contradict each other, or need too large a grid.
    """
    low, high = cloud.points.min(axis=0), cloud.points.max(axis=0)
    longest = float((high - low).max())
    if not longest > 0.0:
        raise LoadError("all points are in one place: there is no surface")
    apart, areas = _areas(cloud, longest)
    kept = _agreeing(cloud, _IN_POINTS * apart)
    wrong = int(np.count_nonzero(~kept))
    points, normals, areas = cloud.points[kept], cloud.normals[kept], areas[kept]
    volume = float((areas * ((points - low) * normals).sum(axis=1)).sum()) / 3.0
    turned = volume < 0.0
    if turned:
        normals = -normals
    step = spacing or max(longest / CELLS_ALONG, apart)
    if step >= longest:
        message = f"the spacing {step:g} is not smaller than the cloud, {longest:g}"
        raise LoadError(f"{message}: leave it out, or give {longest / CELLS_ALONG:.3g}")
    within = radius or max(_IN_POINTS * apart, _IN_NODES * step)
    margin = MARGIN + math.ceil(math.sqrt(float(areas.max())) / step)
    counts = [math.ceil(s / step - 1e-9) + 1 + 2 * margin for s in (high - low).tolist()]
    if math.prod(counts) > MOST_DENSE:
        enough = 1.05 * step * (math.prod(counts) / MOST_DENSE) ** (1.0 / 3.0)
        message = f"a spacing of {step:g} needs {math.prod(counts):,} samples, more than "
        raise LoadError(f"{message}{MOST_DENSE:,}: a spacing of {enough:.3g} is enough")
    count = math.prod(counts)
    need(count * _NODE_BYTES, f"a spacing of {step:g} needs {count:,} samples")
    origin = 0.5 * (low + high) - 0.5 * step * (np.array(counts) - 1)
    grid = _Grid((points - origin) / step, normals, areas / step**2, counts, within / step)
    values, is_closed = grid.distances(apart / step)
    # The sum of the normals of a closed surface is 0, that of half a sphere half of its area.
    openness = float(np.linalg.norm((areas[:, None] * normals).sum(axis=0)) / areas.sum())
    if not (values < 0.0).any() or (openness > _MOST_OPEN and not is_closed):
        raise LoadError("the points enclose nothing: are there points on all sides of the solid?")
    return CloudDistances(
        values * np.float32(step), origin, step, apart, within, turned, wrong, is_closed
    )


class _Sites:
    """Points sorted into cells as wide as a radius, for ``point_arithmetic``.

    Attributes:
        buffers: Its buffers.
        order: The points in the order of the buffers.
    """

    def __init__(
        self, points: NDArray[np.float64], normals: NDArray[np.float64], radius: float
    ) -> None:
        self._low = points.min(axis=0) - 2.0 * radius
        self._radius = radius
        places = (points - self._low) / radius
        cells = places.astype(np.int64)
        self._shape = np.maximum(cells.max(axis=0) + 3, 3)  # x, y, z
        if math.prod(self._shape.tolist()) > MOST_DENSE:
            raise LoadError(
                "the points are too near to each other for the size of all: is one of them far "
                "away from the others?"
            )
        x, y, z = cells.T
        keys = (z * self._shape[1] + y) * self._shape[0] + x
        self.order = np.argsort(keys, kind="stable")
        counted = np.bincount(keys, minlength=math.prod(self._shape.tolist()))
        steps = [self._shape[0], self._shape[0] * self._shape[1]]
        self.buffers: dict[str, NDArray[Any]] = {
            "SITES": places[self.order].astype(np.float32),
            "DIRECTIONS": normals[self.order].astype(np.float32),
            "SITE_STARTS": np.concatenate([[0], np.cumsum(counted)]).astype(np.int32),
            "SITE_STEPS": np.array(steps, np.int32),
        }
        self.is_met = (counted > 0).reshape(self._shape[::-1])

    def places(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points in units of the cells."""
        found: NDArray[np.float64] = (points - self._low) / self._radius
        return found

    def are_near(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which places have a point in the 27 cells about them."""
        near = widened(self.is_met)
        cells = np.floor(places).astype(np.int64)
        # A place in a cell of the border has no 27 cells, and no point is near it.
        inside = ((cells >= 1) & (cells < self._shape - 1)).all(axis=1)
        x, y, z = np.where(inside[:, None], cells, 0).T
        found: NDArray[np.bool_] = inside & near[z, y, x]
        return found


def _areas(cloud: SourcePoints, longest: float) -> tuple[float, NDArray[np.float64]]:
    """Return the distance of points, and the area of each: that of a disc, by the points in it."""
    # A closed surface has about three times the area of a square as long.
    radius = 2.0 * longest * math.sqrt(3.0 / len(cloud.points))
    least, most = _COUNTED
    for _ in range(8):
        sites = _Sites(cloud.points, cloud.normals, radius)
        places = sites.places(cloud.points)
        counts = np.asarray(run(point_arithmetic.points_within, places, None, sites.buffers))
        middle = float(np.median(counts))
        if least <= middle <= most or middle == len(cloud.points):
            break
        radius *= math.sqrt(0.5 * (least + most) / middle)
    areas = math.pi * radius * radius / counts
    return math.sqrt(float(np.median(areas))), areas


def _agreeing(cloud: SourcePoints, radius: float) -> NDArray[np.bool_]:
    """Return which points have normals that agree with those about them.

    Raises:
        LoadError: Many do not.
    """
    sites = _Sites(cloud.points, cloud.normals, radius)
    places = sites.places(cloud.points[sites.order])
    rows = np.arange(len(places), dtype=np.int32)
    agrees = np.asarray(run(point_arithmetic.agreement, places, rows, sites.buffers)) >= 0.0
    kept = np.empty(len(agrees), bool)
    kept[sites.order] = agrees
    share = 1.0 - float(kept.mean())
    if share > _MOST_WRONG:
        raise LoadError(
            f"{share:.0%} of the normals point away from those about them: orient them alike, "
            "outward, in the program that made them"
        )
    return kept


class _Grid:
    """The nodes of a grid about points; lengths are in units of the nodes."""

    def __init__(
        self,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        areas: NDArray[np.float64],
        counts: list[int],
        radius: float,
    ) -> None:
        self._points, self._areas = points, areas
        self._nodes = (counts[0], counts[1], counts[2])
        self._radius = radius
        self._sites = _Sites(points, normals, radius)

    def distances(self, apart: float) -> tuple[NDArray[np.float32], bool]:
        """Return the signed distances of the nodes, (z, y, x), and whether there were no holes.

        Args:
            apart: The distance of points.
        """
        height = self._heights(apart)
        surfels = self._surfels()
        _, away = nearest_triangles(surfels, self._nodes)
        is_known = np.isfinite(height)
        near = np.where(is_known, np.abs(height), away)
        signs = np.zeros(near.shape, np.int8)
        signs[is_known] = np.where(height[is_known] < 0.0, -1, 1)
        inside = filled(signs) < 0
        # Negative inside, and 0.5 at the surface, as winding numbers are.
        level = np.where(is_known, np.float32(0.5) - height, np.where(inside, 1.5, -0.5))
        is_closed = not is_contradictory(inside, np.where(is_known, 0.0, away))
        if not is_closed:
            z, y, x = np.indices(near.shape).reshape(3, -1)
            tree = tree_buffers(surfels.corners)
            winding = winding_numbers(tree, np.stack([x, y, z], axis=1)).reshape(near.shape)
            level = np.where(is_known, level, winding)
        closed_between(near, level)
        shorten(near)
        return np.where(level > 0.5, -near, near).astype(np.float32), is_closed

    def _heights(self, apart: float) -> NDArray[np.float32]:
        """Return the heights of nodes above the surface of the points; infinite if it is far."""
        shape = self._nodes[::-1]
        z, y, x = np.indices(shape).reshape(3, -1)
        places = self._sites.places(np.stack([x, y, z], axis=1).astype(np.float64))
        rows = np.flatnonzero(self._sites.are_near(places))
        height, weight, _ = run(
            point_arithmetic.surroundings, places[rows], None, self._sites.buffers
        )
        # The mean of the weight over a disc of the radius is 1 / 5.
        usual = math.pi / 5.0 * (self._radius / apart) ** 2
        kept = (np.asarray(weight) > _LEAST_WEIGHT * usual) & (
            np.abs(height) * self._radius <= _HIGHEST
        )
        found = np.full(z.size, np.inf, np.float32)
        found[rows[kept]] = np.asarray(height)[kept] * np.float32(self._radius)
        return found.reshape(shape)

    def _surfels(self) -> Joined:
        """Return a triangle for each point."""
        order = self._sites.order
        buffers = {**self._sites.buffers, "SITE_AREAS": self._areas[order].astype(np.float32)}
        rows = np.arange(len(order), dtype=np.int32)
        a, b, c = run(point_arithmetic.surfel, self._points[order], rows, buffers)
        corners = tuple(np.ascontiguousarray(corner, np.float32) for corner in (a, b, c))
        triangles = np.arange(3 * len(order), dtype=np.int64).reshape(3, -1).T
        first, second, third = corners
        return Joined(np.concatenate(corners), triangles, (first, second, third), 0)
