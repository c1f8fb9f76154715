"""Find the triangles or lines near places.

Input: corners of triangles in space, or of lines in the plane; places with normals. Output: for
each place the distance to the nearest element that faces the same way. Does not depend on a shape.
"""

from __future__ import annotations

from functools import reduce
from itertools import product
from typing import Final, NamedTuple

import numpy as np

from distal.mesh.accuracy import runs
from distal.mesh.kernels import rows_of
from distal.mesh.lattice import keys_of, position
from distal.mesh.outlines.arithmetic import distance_if_alike as distance_to_line
from distal.mesh.parallel import parallel_map, slices_of
from distal.mesh.solid import Bools, Floats, Integers
from distal.mesh.triangle_arithmetic import distance_if_alike as distance_to_triangle
from distal.polygons.whole_numbers import numbers_in, sorted_keys

# The least cosine between the normal at a place and that of an element that shows it.
_ALIKE: Final = 1e-3
_ANY: Final = -2.0
_MOST_LEVELS: Final = 18  # keys have 21 bits for each coordinate
_PLACES_AT_ONCE: Final = 1 << 13
_PAIRS_AT_ONCE: Final = 1 << 20
# Elements are looked for within these shares of the reach, one after the other.
_SHARES: Final = (1.0 / 32.0, 0.25, 1.0)


class BoxedElements(NamedTuple):
    """Triangles or lines with their boxes.

    Attributes:
        corners: Of shape (n, 3, 3) for triangles, (n, 2, 2) for lines.
        low: The lowest corners of their boxes.
        high: The highest ones.
    """

    corners: Floats
    low: Floats
    high: Floats

    @staticmethod
    def of(corners: Floats) -> BoxedElements:
        """Return elements; their corners are as above."""
        columns = [corners[:, i] for i in range(corners.shape[1])]
        return BoxedElements(corners, reduce(np.minimum, columns), reduce(np.maximum, columns))


class ElementGrid:
    """Triangles or lines near places, in cells that are as long as they are.

    Elements of one length, up to a factor of two, share a grid: each is in the cells that it comes
    closer to than the reach. Those in whose cells there are no places are left out.
    """

    def __init__(self, elements: BoxedElements, places: Floats, reach: float) -> None:
        """Sort elements into cells.

        Args:
            elements: The elements.
            places: Where they are looked for; at least one.
            reach: How far from a place elements are found.
        """
        self._corners, self._places, self._levels = elements.corners, places, []
        low, high = elements.low - reach, elements.high + reach
        origin = low.min(axis=0)
        lengths = (high - low).max(axis=1)
        base = max(float(lengths.min()), float(lengths.max()) * 2.0**-_MOST_LEVELS)
        level = np.ceil(np.log2(np.maximum(lengths / base, 1.0))).astype(np.int64)
        for number in numbers_in(level):
            side = base * 2.0 ** int(number)
            own = np.flatnonzero(level == number)
            at, first = _cells(places, origin, side), _cells(low[own], origin, side)
            close = _are_close(first, at)
            last = _cells(high[own[close]], origin, side)
            self._levels.append((_keys(at), *_sorted(own[close], first[close], last)))

    def distances(self, normals: Floats | None = None) -> Floats:
        """Return the distance of each place to the nearest element that faces as it does.

        It is infinite where none is within reach; elements that are farther may count.

        Args:
            normals: The normal at each place, of length 1; None if elements may face anywhere.
        """
        least = _ALIKE if normals is not None else _ANY
        facing = np.zeros_like(self._places) if normals is None else normals

        def of_some(rows: slice) -> Floats:
            return self._distances(rows, facing[rows], least)

        found = parallel_map(of_some, slices_of(len(self._places), _PLACES_AT_ONCE))
        return np.concatenate([np.empty(0), *found])

    def _distances(self, rows: slice, normals: Floats, cosine: float) -> Floats:
        places = self._places[rows]
        nearest = np.full(len(places), np.inf)
        for at, keys, elements in self._levels:
            first = np.searchsorted(keys, at[rows])
            count = np.searchsorted(keys, at[rows], side="right") - first
            for some in _parts(count, _PAIRS_AT_ONCE):
                place, row = runs(some, first[some], count[some])
                corners = self._corners[elements[row]]
                ends = [corners[:, i] for i in range(corners.shape[1])]
                function = distance_to_line if len(ends) == 2 else distance_to_triangle
                least = np.full(len(place), cosine)
                away = rows_of(function, places[place], normals[place], *ends, least)
                np.minimum.at(nearest, place, np.where(away < 1e29, away, np.inf))
        return nearest


def to_nearest(
    corners: Floats, places: Floats, reach: float, normals: Floats | None = None
) -> Floats:
    """Return the distance of each place to the nearest element, as ``ElementGrid.distances``.

    Most places are close to one: all are compared with what is close first, the rest with more.

    Args:
        corners: Of shape (n, 3, 3) for triangles, (n, 2, 2) for lines.
        places: The places.
        reach: How far from a place elements are found.
        normals: The normal at each, of length 1; None if elements may face anywhere.
    """
    found = np.full(len(places), np.inf)
    rows = np.arange(len(places))
    if not len(places) or not len(corners):
        return found
    elements = BoxedElements.of(corners)
    for share in _SHARES:
        near = share * reach
        facing = None if normals is None else normals[rows]
        found[rows] = ElementGrid(elements, places[rows], near).distances(facing)
        rows = rows[found[rows] > near]
        if not len(rows):
            break
    return found


def to_triangles(corners: Floats, places: Floats, least: Floats, enough: float) -> Floats:
    """Return the distances of places to triangles, where those so far are too large.

    Args:
        corners: Of shape (n, 3, 3).
        places: Of shape (m, 3).
        least: The least distance of each place so far; infinite ones stay.
        enough: Smaller ones stay, too.
    """
    rows = np.flatnonzero((least > enough) & np.isfinite(least))
    if not len(rows) or not len(corners):
        return least
    found = least.copy()
    nearest = to_nearest(corners, places[rows], float(least[rows].max()))
    found[rows] = np.minimum(least[rows], nearest)
    return found


def _parts(count: Integers, most: int) -> list[Integers]:
    """Return the rows whose counts are not 0, in parts with about so many together."""
    rows = np.flatnonzero(count)
    ends = np.flatnonzero(np.diff(np.cumsum(count[rows]) // most)) + 1
    return [part for part in np.split(rows, ends) if len(part)]


def _cells(places: Floats, origin: Floats, side: float) -> Integers:
    """Return the cells that places are in; those outside of the grid are in some beside it."""
    found: Integers = np.clip(np.floor((places - origin) / side), -1.0, 2.0**20).astype(np.int64)
    return found


def _keys(cells: Integers) -> Integers:
    """Return keys of cells of space or of the plane."""
    missing = 3 - cells.shape[1]
    if missing:
        cells = np.concatenate([cells, np.zeros((len(cells), missing), np.int64)], axis=1)
    return keys_of(cells)


def _are_close(first: Integers, at: Integers) -> Bools:
    """Return which boxes of two cells along each axis have others in them.

    Args:
        first: The lowest cell of each box.
        at: The other cells.
    """
    ways = product((0, 1), repeat=at.shape[1])
    keys = sorted_keys(np.concatenate([_keys(at - np.array(bits)) for bits in ways]))
    found: Bools = position(_keys(first), keys) >= 0
    return found


def _sorted(own: Integers, low: Integers, high: Integers) -> tuple[Integers, Integers]:
    """Return the keys of the cells of elements, sorted, and the elements.

    Args:
        own: The elements.
        low: The lowest cell of each.
        high: The highest, at most one farther along each axis.
    """
    keys, elements = [], []
    for bits in product((0, 1), repeat=low.shape[1]):
        cells = low + np.array(bits)
        there = np.flatnonzero((cells <= high).all(axis=1))
        keys.append(_keys(cells[there]))
        elements.append(own[there])
    key, element = np.concatenate(keys), np.concatenate(elements)
    order = np.argsort(key, kind="stable")
    return key[order], element[order]
