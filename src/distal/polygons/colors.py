"""The colors of a mesh on a grid: at each node that of the nearest place of the mesh.

Input: a mesh with colors. Output: a grid of colors as they are displayed. Near the surface they are
those of the mesh; between nodes they are interpolated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.srgb import encode_srgb
from distal.polygons import arithmetic
from distal.polygons.distances import (
    box_and_spacing,
    first_node,
    joined_on_grid,
    nearest_triangles,
    nodes_along,
)
from distal.polygons.kernels import run
from distal.polygons.triangles import SourceTriangles

# The most nodes of the grid; a finer grid of distances gets coarser colors.
MOST_NODES: Final = 2**21


@dataclass(frozen=True, slots=True, eq=False)
class ColorGrid:
    """Colors at the nodes of a grid.

    Attributes:
        values: Codes of sRGB, (nodes along z, y, x, 3) uint8.
        middle: The middle of the grid.
        size: The size of the grid's cells together.
        spacing: The distance of two nodes.
    """

    values: NDArray[np.uint8]
    middle: tuple[float, float, float]
    size: tuple[float, float, float]
    spacing: float


def color_grid(mesh: SourceTriangles, spacing: float) -> ColorGrid:
    """Return the colors of a mesh that has some.

    Args:
        mesh: The mesh.
        spacing: The distance of two nodes, or less than it.
    """
    low, high, step = box_and_spacing(mesh, spacing)
    while math.prod(nodes_along(high - low, step)) > MOST_NODES:
        step *= 1.02
    x, y, z = nodes_along(high - low, step)
    origin = first_node(low, high, step)
    found = joined_on_grid(mesh, origin, step)
    nearest, _ = nearest_triangles(found, (x, y, z))
    assert mesh.colors is not None
    corners = mesh.triangles if found.rows is None else mesh.triangles[found.rows]
    colors = mesh.colors
    if mesh.is_light:
        colors = np.asarray(run(encode_srgb, colors, None, {}), np.float32)
    names = ("FIRST_COLOR", "SECOND_COLOR", "THIRD_COLOR")
    shades = {name: colors[corners[:, i]] for i, name in enumerate(names)}
    places = np.indices(nearest.shape)[::-1].reshape(3, -1).T
    which = nearest.reshape(-1) - 1
    shown = run(arithmetic.color_of_triangle, places, which, {**found.buffers, **shades})
    codes = np.rint(np.clip(np.asarray(shown), 0.0, 1.0) * 255.0).astype(np.uint8)
    counts = np.array((x, y, z))
    a, b, c = (origin + 0.5 * (counts - 1) * step).tolist()
    width, height, depth = (counts * step).tolist()
    values = codes.reshape(z, y, x, 3)
    return ColorGrid(values, (a, b, c), (width, height, depth), step)
