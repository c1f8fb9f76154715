"""Frames along a curve that do not twist, as rotations of copies.

Input: points of a curve in order and the directions there. Output: unit quaternions (x, y, z, w)
that turn one axis of a shape into the direction of the curve, and the shape about it as little as
possible from place to place. Along a closed curve the last frame would not meet the first; the
remaining angle is distributed evenly.

Source: Wenping Wang, Bert Jüttler, Dayue Zheng and Yang Liu, "Computation of Rotation Minimizing
Frames", ACM Transactions on Graphics 27(1), 2008: two mirrors take each frame to the next.
"""

from __future__ import annotations

import math
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

# Steps that are shorter than this do not turn a frame.
_LEAST: Final = 1e-24
# If the part of ``up`` across the curve is shorter than this, it counts as parallel to it.
_PARALLEL: Final = 1e-4


def across(ahead: Floats, up: Floats) -> Floats:
    """Return the direction across ``ahead`` that is nearest to ``up``."""
    side = up - float(up @ ahead) * ahead
    if np.linalg.norm(side) < _PARALLEL * max(float(np.linalg.norm(up)), 1.0):
        other = np.eye(3)[int(np.argmin(np.abs(ahead)))]
        side = other - float(other @ ahead) * ahead
    made: Floats = side / np.linalg.norm(side)
    return made


def untwisted(points: Floats, aheads: Floats, up: Floats, *, closed: bool) -> Floats:
    """Return directions across the curve that turn about it as little as possible.

    Args:
        points: Points in order, (n, 3), close enough together that the curve bends little between.
        aheads: The directions of the curve there, of length 1.
        up: The first direction is as near to this one as possible.
        closed: Whether the curve goes on from the last point to the first.
    """
    sides = [across(aheads[0], up)]
    order = [*range(1, len(points)), *([0] if closed else [])]
    for last, this in zip([*range(len(points))], order, strict=False):
        sides.append(_mirrored(points[this] - points[last], aheads[last], aheads[this], sides[-1]))
    found = np.array(sides[: len(points)])
    if not closed:
        return found
    # The angle by which the frame has turned when it is back, taken back along the way.
    first, back = sides[0], sides[-1]
    turn = math.atan2(float(np.cross(first, back) @ aheads[0]), float(first @ back))
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    share = np.concatenate(([0.0], np.cumsum(steps)[:-1])) / steps.sum()
    return rolled(found, aheads, -turn * share)


def _mirrored(step: Floats, ahead: Floats, following: Floats, side: Floats) -> Floats:
    """Return a direction across the curve at the next point, by two mirrors."""
    square = float(step @ step)
    if square > _LEAST:
        side = side - (2.0 * float(step @ side) / square) * step
        ahead = ahead - (2.0 * float(step @ ahead) / square) * step
    change = following - ahead
    square = float(change @ change)
    if square > _LEAST:
        side = side - (2.0 * float(change @ side) / square) * change
    return across(following, side)


def rolled(sides: Floats, aheads: Floats, angles: Floats) -> Floats:
    """Return directions across the curve, turned about it, counterclockwise as it comes."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    made: Floats = c * sides + s * np.cross(aheads, sides)
    return made


def quaternions(aheads: Floats, sides: Floats, axis: Floats) -> Floats:
    """Return rotations that turn ``axis`` into ``aheads``, and one across it into ``sides``.

    For the axes y, z and x these are z, x and y.

    Args:
        aheads: Directions of length 1.
        sides: Directions across these.
        axis: The direction of the shape that is turned, of length 1.
    """
    cyclic = np.roll(axis, 1)
    own_side = across(axis, cyclic)
    own = np.stack([axis, own_side, np.cross(axis, own_side)], axis=1)
    thirds = np.cross(aheads, sides)
    matrices = np.stack([aheads, sides, thirds], axis=2) @ own.T
    return np.array([_quaternion(matrix) for matrix in matrices])


def _quaternion(m: Floats) -> tuple[float, float, float, float]:
    """Return the quaternion of a rotation, from its largest component, so that none is lost."""
    squares = (
        1.0 + m[0, 0] - m[1, 1] - m[2, 2],
        1.0 - m[0, 0] + m[1, 1] - m[2, 2],
        1.0 - m[0, 0] - m[1, 1] + m[2, 2],
        1.0 + m[0, 0] + m[1, 1] + m[2, 2],
    )
    i = int(np.argmax(squares))
    double = math.sqrt(float(squares[i]))
    sums = np.array(
        [
            [squares[0], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
            [m[1, 0] + m[0, 1], squares[1], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
            [m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], squares[2], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]],
        ]
    )
    x, y, z, w = (sums[i] * (0.5 / double)).tolist()
    size = math.sqrt(x * x + y * y + z * z + w * w)
    return x / size, y / size, z / size, w / size
