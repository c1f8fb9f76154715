"""Signed distances to the edge of what a picture shows.

Input: how much of each pixel is inside, from 0 to 1. Output: the distance of each pixel's middle to
the edge, negative inside, in pixels. The edge is the line at a level of the bilinear grid between
the middles of pixels (marching squares), so soft edges of a picture place it more exactly than its
pixels are wide. The distances to its pieces are exact. Does not read files.

Source: marching squares: the two-dimensional case of Lorensen and Cline, "Marching cubes" (1987).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Pixels of a tile's side: the pieces that may be nearest to its pixels are found together.
TILE: Final = 16
# The sides of a cell that the edge joins, by which of its corners are inside: bits 1, 2, 4 and 8
# for the corners in the order around the cell. A side is numbered by the corner where it begins.
_JOINED: Final[dict[int, tuple[tuple[int, int], ...]]] = {
    1: ((3, 0),),
    2: ((0, 1),),
    3: ((3, 1),),
    4: ((1, 2),),
    6: ((0, 2),),
    7: ((3, 2),),
    8: ((2, 3),),
    9: ((2, 0),),
    11: ((2, 1),),
    12: ((1, 3),),
    13: ((1, 0),),
    14: ((0, 3),),
}
# Two opposite corners inside: joined by what is between them, or apart.
_SADDLES: Final = {
    5: (((3, 2), (1, 0)), ((3, 0), (1, 2))),
    10: (((0, 3), (2, 1)), ((0, 1), (2, 3))),
}
_CORNERS: Final = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])


def signed_distances(shares: Floats, level: float = 0.5) -> Floats:
    """Return the distances of pixels' middles to the edge, in pixels, negative inside.

    Args:
        shares: How much of each pixel is inside, (rows, columns). Its border must be outside.
        level: The share at the edge.

    Raises:
        ValueError: Nothing is inside.
    """
    values = np.asarray(shares, np.float64) - level
    pieces = edge_of(values)
    if not len(pieces):
        raise ValueError("nothing is inside")
    found = np.empty(values.shape)
    for top in range(0, values.shape[0], TILE):
        for left in range(0, values.shape[1], TILE):
            tile = found[top : top + TILE, left : left + TILE]
            rows, columns = np.indices(tile.shape, np.float64)
            places = np.stack([rows + top, columns + left], axis=-1)
            tile[...] = _nearest(places, pieces)
    return np.where(values > 0.0, -found, found)


def edge_of(values: Floats) -> Floats:
    """Return the pieces of the line at 0, (n, 2, 2): row and column of both ends.

    Args:
        values: Values at the grid's points, above 0 inside.
    """
    rows, columns = (n - 1 for n in values.shape)
    corners = np.stack([values[r : r + rows, c : c + columns] for r, c in _CORNERS], axis=-1)
    kinds = ((corners > 0.0) << np.arange(4)).sum(axis=-1)
    cells = np.argwhere((kinds > 0) & (kinds < 15))
    corners, kinds = corners[tuple(cells.T)], kinds[tuple(cells.T)]
    after = np.roll(corners, -1, axis=1)
    share = np.divide(corners, corners - after, out=np.zeros_like(corners), where=corners != after)
    begin = cells[:, None].astype(np.float64) + _CORNERS
    crossings = begin + share[..., None] * (np.roll(_CORNERS, -1, axis=0) - _CORNERS)
    found = [
        crossings[kinds == kind][:, list(sides)] for kind, all in _JOINED.items() for sides in all
    ]
    is_joined = corners.mean(axis=1) > 0.0
    for kind, ways in _SADDLES.items():
        for joined, all in zip((True, False), ways, strict=True):
            chosen = crossings[(kinds == kind) & (is_joined == joined)]
            found += [chosen[:, list(sides)] for sides in all]
    return np.concatenate(found)


def _nearest(places: Floats, pieces: Floats) -> Floats:
    """Return the distances of the places of a tile to the nearest piece.

    A piece that is nearest to some place is at most the tile's diameter farther from the tile's
    middle than the nearest one is.
    """
    flat = places.reshape(-1, 2)
    middle = 0.5 * (flat[0] + flat[-1])
    radius = float(np.linalg.norm(flat[-1] - middle))
    from_middle = _distances(middle[None], pieces)[0]
    near = pieces[from_middle <= from_middle.min() + 2.0 * radius + 1e-9]
    found: Floats = _distances(flat, near).min(axis=1).reshape(places.shape[:-1])
    return found


def _distances(places: Floats, pieces: Floats) -> Floats:
    """Return the distances of places to pieces, (places, pieces)."""
    begin, along = pieces[:, 0], pieces[:, 1] - pieces[:, 0]
    length = (along * along).sum(axis=1)
    away = places[:, None] - begin
    share = np.clip((away * along).sum(axis=2) / np.maximum(length, 1e-300), 0.0, 1.0)
    rest = away - share[..., None] * along
    found: Floats = np.sqrt((rest * rest).sum(axis=2))
    return found


def reduced(shares: Floats, most: int) -> tuple[Floats, int]:
    """Return means of square blocks of pixels, and the side of a block in pixels.

    Args:
        shares: How much of each pixel is inside; what is missing of a block is outside.
        most: The most blocks along the longest side.
    """
    side = -(-max(shares.shape) // most)
    if side == 1:
        return shares, 1
    missing = [(-n) % side for n in shares.shape]
    padded = np.pad(shares, [(n // 2, n - n // 2) for n in missing]) if any(missing) else shares
    rows, columns = (n // side for n in padded.shape)
    return padded.reshape(rows, side, columns, side).mean(axis=(1, 3)), side
