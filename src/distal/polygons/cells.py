"""Sorts triangles into the cells of a grid.

Input: corners in units of the grid. Output: which triangles meet each cell, at least. Does not
compute distances.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.foreign_files import need
from distal.polygons.whole_numbers import sorted_keys

# A triangle larger than this, in cells, is halved first: the box of a large slanted triangle
# contains many cells that it does not meet.
_LARGEST_PIECE: Final = 2.0
# Bytes that a piece costs at the peak, with the pairs of it and the cells of its box.
_PIECE_BYTES: Final = 240


@dataclass(frozen=True, slots=True, eq=False)
class CellMembers:
    """The triangles of each cell.

    Attributes:
        members: Numbers of triangles, cell by cell, int32.
        starts: The first member of each cell, and the number of all; int32.
        shape: The number of cells along z, y and x.
    """

    members: NDArray[np.int32]
    starts: NDArray[np.int32]
    shape: tuple[int, int, int]

    @property
    def is_met(self) -> NDArray[np.bool_]:
        """Whether a cell has triangles, by its place."""
        return (np.diff(self.starts) > 0).reshape(self.shape)


@dataclass(frozen=True, slots=True, eq=False)
class MetCells:
    """The triangles of the cells that have some, for grids most of whose cells have none.

    Attributes:
        members: Numbers of triangles, cell by cell, int32.
        starts: The first member of each cell, the number of all, and that again: the last cell has
            no triangle. int32.
        cells: The numbers of the cells, ascending: (z, y, x) in ``shape``.
        shape: The number of cells along z, y and x.
    """

    members: NDArray[np.int32]
    starts: NDArray[np.int32]
    cells: NDArray[np.int64]
    shape: tuple[int, int, int]

    def near_nodes(self) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """Return the nodes with a triangle in the eight cells about them, and those cells.

        The nodes are (n, 3) along z, y and x; the cells are places in ``cells``, (n, 8), or the
        number of cells where one has no triangle.
        """
        _, height, width = self.shape
        # The numbers of the eight cells about a node, from the lowest one.
        steps = np.array(
            [(z * height + y) * width + x for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        )
        lowest = sorted_keys((self.cells[:, None] - steps).reshape(-1))
        asked = lowest[:, None] + steps
        found = np.searchsorted(self.cells, asked)
        is_met = np.append(self.cells, -1)[found] == asked
        nodes = np.stack(np.unravel_index(lowest, self.shape), axis=1)
        return nodes, np.where(is_met, found, len(self.cells)).astype(np.int32)


Corners = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]
# The lowest and the highest cell of small pieces of triangles, and whose they are.
Boxes = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]


def sorted_into_cells(corners: Corners, nodes: tuple[int, int, int]) -> CellMembers:
    """Return the triangles in the cells between the nodes of a grid.

    Cell (i, j, k) lies between the nodes i - 1 and i, and so on: there is one more along each axis.

    Args:
        corners: The first, second and third corner of each triangle, with the first node at 0; all
            lie between nodes.
        nodes: The number of nodes along x, y and z.
    """
    shape = (nodes[2] + 1, nodes[1] + 1, nodes[0] + 1)
    cell, members = _pairs(corners, shape, boxes_of_pieces(corners))
    counted = np.bincount(cell, minlength=shape[0] * shape[1] * shape[2])
    starts = np.concatenate([[0], np.cumsum(counted)]).astype(np.int32)
    return CellMembers(members.astype(np.int32), starts, shape)


def sorted_into_met_cells(corners: Corners, nodes: tuple[int, int, int], boxes: Boxes) -> MetCells:
    """Return the triangles in the cells that have some.

    Args:
        corners: As for ``sorted_into_cells``.
        nodes: The number of nodes along x, y and z.
        boxes: What ``boxes_of_pieces`` returns for the corners.
    """
    shape = (nodes[2] + 1, nodes[1] + 1, nodes[0] + 1)
    cell, members = _pairs(corners, shape, boxes)
    first = np.flatnonzero(np.concatenate([[True], cell[1:] != cell[:-1]]))
    starts = np.concatenate([first, [len(cell)] * 2]).astype(np.int32)
    return MetCells(members.astype(np.int32), starts, cell[first], shape)


def _pairs(
    corners: Corners, shape: tuple[int, int, int], boxes: Boxes
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the number of a cell and one of its triangles, for all of them, sorted."""
    low, high, owners = boxes
    sizes = high - low + 1
    first = (low[:, 2].astype(np.int64) * shape[1] + low[:, 1]) * shape[2] + low[:, 0]
    parts = []
    # Boxes of one size have the same steps from their first cell.
    codes = (sizes[:, 2] * 8 + sizes[:, 1]) * 8 + sizes[:, 0]
    for code in np.flatnonzero(np.bincount(codes)).tolist():
        rows = np.flatnonzero(codes == code)
        z, y, x = (np.arange(code >> bits & 7) for bits in (6, 3, 0))
        steps = ((z[:, None, None] * shape[1] + y[:, None]) * shape[2] + x).reshape(-1)
        keys = (first[rows] * len(corners[0]) + owners[rows])[:, None]
        parts.append((keys + steps * len(corners[0])).reshape(-1))
    keys = np.sort(np.concatenate(parts))
    if len(owners) > len(corners[0]):  # pieces of one triangle may share a cell
        keys = keys[np.concatenate([[True], keys[1:] != keys[:-1]])]
    cell, members = np.divmod(keys, len(corners[0]))
    return cell, members


def boxes_of_pieces(corners: Corners) -> Boxes:
    """Return the lowest and the highest cell of small pieces of triangles, and whose they are."""
    found: list[tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64]]] = []
    left, owner = corners, np.arange(len(corners[0]))
    while len(owner):
        low = np.minimum(np.minimum(*left[:2]), left[2])
        high = np.maximum(np.maximum(*left[:2]), left[2])
        x, y, z = (high - low).T
        is_large = np.maximum(np.maximum(x, y), z) > _LARGEST_PIECE
        if not is_large.any():
            found.append((low, high, owner))
            break
        pieces = sum(len(rows) for _, _, rows in found) + len(owner) + int(is_large.sum())
        need(
            pieces * _PIECE_BYTES,
            f"its {len(corners[0]):,} triangles meet {pieces:,} cells of the grid and more; a "
            "wider spacing= has fewer",
        )
        found.append((low[~is_large], high[~is_large], owner[~is_large]))
        left = _halved(tuple(corner[is_large] for corner in left))
        owner = np.tile(owner[is_large], 2)
    low, high, owner = (np.concatenate(parts) for parts in zip(*found, strict=True))
    # A number on the border of two cells may be rounded into either one; no harm is done, because
    # the triangle touches both.
    return np.floor(low).astype(np.int32) + 1, np.floor(high).astype(np.int32) + 1, owner


def _halved(corners: tuple[NDArray[np.float32], ...]) -> Corners:
    """Return the two halves of each triangle, cut in the middle of its longest edge."""
    whole = np.stack(corners, axis=1)
    along = np.roll(whole, -1, axis=1) - whole
    longest = (along * along).sum(axis=2).argmax(axis=1)
    rows = np.arange(len(whole))
    a, b, c = (whole[rows, (longest + i) % 3] for i in range(3))
    middle = 0.5 * (a + b)
    return np.concatenate([a, middle]), np.concatenate([middle, b]), np.concatenate([c, c])
