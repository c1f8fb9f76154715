"""The grid of distances to the parts of a table, by which occlusion is computed.

Input: a table of parts that stand still, and how far occlusion reaches. Output: where the grid is,
and a buffer of levels as ``render.part_grid`` reads it. The distances are those of compiled scene
code. They are computed when a kernel or a page reads the buffer, once for each table: pictures that
do not use it do not compute it.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.at_once import cached_property
from distal.frontend import Assembly
from distal.ir.nodes import Param, Read, Return
from distal.ir.types import FLOAT, INT, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.resources import Buffer
from distal.lang.runtime_access import executor
from distal.packages import is_installed
from distal.render import part_tree
from distal.render.part_grid import HEAD
from distal.scene.lowering.parts.table import TableNode
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.tree.values import StatementList

# A search among fewer parts costs no more than a grid.
LEAST_PARTS: Final = 32
# The most points of a grid: 44 kB, which are 59 kB of a page.
MOST_POINTS: Final = 11_000
# The most cells along the longest side of the box around the parts.
MOST_CELLS: Final = 128
# The space around this box that a grid covers, in cells.
MARGIN: Final = 0.5
# The least reach of occlusion, in cells. Nearer to the parts a grid is too coarse: among boxes that
# are .6 cells apart, one pixel in a hundred is off by 13 of 255 levels with a reach of 8 cells, by
# 14 with 6, by 32 with 4.
LEAST_REACH: Final = 8.0
# The sizes of cells that are tried: each is so much larger than the one before.
GROWTH: Final = 1.01
MOST_SIZES: Final = 256
HIGHEST_LEVEL: Final = 255
# A point has the mean of the distances at these places around it, in cells. Panes as far apart as
# points would else make bands.
AROUND: Final = 0.25 * np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])


class DistanceGrid(Buffer):
    """The distances to the parts of a table around the points of a grid.

    Attributes:
        low: The low corner of the grid.
        cell: The side of a cell.
        points: How many points are along each axis.
    """

    element: Type = INT

    def __init__(self, node: TableNode) -> None:
        self._node: TableNode | None = node  # until its distances are known
        low, high = (np.array(corner) for corner in (node.table.low, node.table.high))
        sides = high - low
        sizes = sides.max() / MOST_CELLS * GROWTH ** np.arange(MOST_SIZES)
        counts = np.ceil(sides / sizes[:, None] + 2.0 * MARGIN).astype(int) + 1
        size = int(np.argmax(counts.prod(axis=1) <= MOST_POINTS))
        x, y, z = counts[size].tolist()
        self.points: tuple[int, int, int] = (x, y, z)
        self.cell = float(sizes[size])
        corner = 0.5 * (low + high - self.cell * (counts[size] - 1))
        self.low: tuple[float, ...] = tuple(corner.tolist())

    def __repr__(self) -> str:
        return f"<DistanceGrid of {math.prod(self.points)} distances>"

    @cached_property
    def data(self) -> NDArray[np.int32]:
        """The numbers of the grid.

        They are means, rounded up. For one convex part these are nowhere less than its distance, so
        that it does not darken itself.
        """
        farthest = math.hypot(*self.points)
        cells = np.nan_to_num(self._distances() / self.cell, nan=farthest)
        cells = np.clip(cells, -farthest, farthest)
        least = float(cells.min())
        per_cell = max(math.floor((HIGHEST_LEVEL - 1) / (float(cells.max()) - least + 1e-6)), 1)
        zero = math.ceil(-least * per_cell)
        levels = np.clip(np.ceil(per_cell * cells) + zero, 0, HIGHEST_LEVEL).astype(np.int64)
        padded = np.pad(levels, ((0, 0), (0, 1), (0, 1)), mode="edge")
        fours = padded[:, :-1, :-1] | padded[:, :-1, 1:] << 8
        fours |= padded[:, 1:, :-1] << 16 | padded[:, 1:, 1:] << 24
        data = np.empty(HEAD + levels.size, np.int32)
        data[:HEAD] = per_cell, zero
        data[HEAD:] = fours.reshape(-1).astype(np.uint32).view(np.int32)
        return data

    def _distances(self) -> NDArray[np.float32]:
        """Return the mean distances around all points, ``[z, y, x]``."""
        counts = self.points[::-1]
        index = np.indices(counts).reshape(3, -1)[::-1].T
        places = self.low + self.cell * (index[:, None] + AROUND)
        points = np.asarray(places.reshape(-1, 3), np.float32)
        assert self._node is not None
        found = executor().evaluate(PartDistance(self._node), [points], {}, 0.0)
        self._node = None  # devices hold buffers longer than a scene lives
        means: NDArray[np.float32] = np.asarray(found).reshape(*counts, len(AROUND)).mean(axis=-1)
        return means


def grid_for(node: TableNode, reach: Any) -> DistanceGrid | None:
    """Return the grid of a table by which occlusion is computed; None if the table is searched.

    Parts that move have none, and few parts; nobody has one where nothing compiles scene code.

    Args:
        node: The node with the table.
        reach: How far occlusion reaches; None if that may change.
    """
    table = node.table
    if reach is None or table.moves or table.count < LEAST_PARTS or not is_installed("llvmlite"):
        return None
    grid = node.derived("distances", lambda: DistanceGrid(node))
    return grid if reach >= LEAST_REACH * grid.cell else None


class PartDistance(Composed):
    """The distance of a point to the parts of a table; less than that where it is not known."""

    name = "distance to parts"
    signature = (("p", VEC3),)

    def __init__(self, node: TableNode) -> None:
        self._node = node
        self.result: Type = FLOAT

    def compose(self, assembly: Assembly) -> str:
        """Add the function to the program, and return its name."""
        composer = ShapeComposer(assembly, [self._node])
        body = StatementList(taken={"p"})
        given = {**composer.table(self._node).given, "p": Read("p", VEC3)}
        body.statements.append(Return(composer.call(part_tree.distance_to_all, given)))
        return assembly.define("distance_to_parts", [Param("p", VEC3)], FLOAT, body.statements)
