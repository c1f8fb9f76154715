"""The part of a box on one side of a plane: its volume and its box.

Input: half sides of boxes around their middles, normals and distances of planes. Output: shares of
their volumes, and corners. The part is ``normal . u < -distance``, with u from the middle.

Source: R. Scardovelli, S. Zaleski, "Analytical Relations Connecting Linear Interfaces and Volume
Fractions in Rectangular Grids", Journal of Computational Physics 164 (2000).
"""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np

from distal.mesh.solid import Floats

# A plane closer to parallel to a side, as a share, is turned a little, and moved out of the way.
_LEAST: Final = 3e-4
# More than the rounding of the share for planes like these: a difference of cubes.
SHARE_ERROR: Final = 1e-6


def shares(half: Floats, normal: Floats, distance: Floats, side: int) -> Floats:
    """Return bounds of the shares of the boxes' volumes, (n,), from 0 to 1.

    Args:
        half: Half of the sides, (n, 3).
        normal: The normals, of any length, (n, 3).
        distance: How far the planes are from the middles, in lengths of the normals, (n,).
        side: -1 for lower bounds, 1 for upper bounds.
    """
    reach = np.abs(normal) * half
    turned = np.maximum(reach, _LEAST * reach.max(axis=1, keepdims=True))
    moved = (turned - reach).sum(axis=1)
    whole = turned.sum(axis=1)
    z = np.clip(-distance + side * moved, -whole, whole)
    found = np.zeros(len(z))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        a, b, c = (turned / whole[:, None]).T
        z = z / whole
        for signs in product((-1.0, 1.0), repeat=3):
            corner = z + signs[0] * a + signs[1] * b + signs[2] * c
            found += signs[0] * signs[1] * signs[2] * np.maximum(corner, 0.0) ** 3
        found = found / (48.0 * a * b * c) + side * SHARE_ERROR
    # A plane without a normal: all or nothing.
    flat = ~(whole > 0.0)
    found = np.where(flat, (distance < 0.0) | (side > 0) & (distance <= 0.0), found)
    share: Floats = np.clip(found, 0.0, 1.0)
    return share


def ends(half: Floats, normal: Floats, distance: Floats) -> tuple[Floats, Floats]:
    """Return the corners of boxes around the parts, from the middles, (n, 3) each.

    For a part that is empty they are anywhere in the box.

    Args:
        half: Half of the sides, (n, 3).
        normal: The normals, (n, 3).
        distance: How far the planes are from the middles, (n,).
    """
    reach = np.abs(normal) * half
    others = reach.sum(axis=1, keepdims=True) - reach
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        at = (distance[:, None] - others) / np.abs(normal)
    at = np.where(np.isfinite(at), np.clip(at, -half, half), -half)
    return np.where(normal < 0.0, at, -half), np.where(normal > 0.0, -at, half)
