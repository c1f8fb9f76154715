"""Choose the length of a cell so that the mesh is as exact as its tolerance.

Input: a shape's kernels and extent, a tolerance and a feature size. Output: a mesh. A coarse mesh
comes first; its measured errors give the next spacing, until few cells are too large. These are
divided one by one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from distal.mesh.dividing import bad_share, divided, typical_error
from distal.mesh.extract import Extent, Extracted, Nothing, extracted
from distal.mesh.kernels import FieldKernels
from distal.mesh.leaf_spacing import LEAST_WALL, LeafSpacing

# The first mesh has this many cells along the largest side of the box.
FIRST_CELLS: Final = 24
# A ball wider than this many cells has a lattice point inside.
BALL_CELLS: Final = math.sqrt(3.0)
# The most bricks that are sampled; 100,000 have about 8 million cells and 17 million triangles.
MOST_BRICKS: Final = 100_000
# Lost parts make the spacing finer without a feature size, up to this many bricks.
_BRICKS_FOR_LOST: Final = 6_000
_MOST_ROUNDS: Final = 12
# Below this share of triangles that are too far from the surface, single cells are divided.
_FEW: Final = 0.1
DIVIDE: Final = 0.0  # instead of a spacing
# A next round is this much finer than a quadratic error needs, since it is not quite quadratic.
_AIM: Final = 0.87
_COARSEST_STEP: Final = 0.9
_FINEST_STEP: Final = 0.2


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is wanted of a mesh.

    Attributes:
        tolerance: How far it may be from the surface, in scene units.
        feature: The smallest diameter of parts and gaps that must be found; None if not given.
        angle: How much the surface may turn within a triangle, in radians; infinite for any angle.
    """

    tolerance: float
    feature: float | None
    angle: float = math.inf


@dataclass(frozen=True, slots=True)
class TooFine:
    """The spacing that is wanted has too many cells.

    Attributes:
        step: The spacing that is possible.
        tolerance: The tolerance that this spacing gives, about; None if it is not known.
        triangles: About how many triangles the mesh would have.
        by_feature: Whether the feature size makes it so fine.
    """

    step: float
    tolerance: float | None
    triangles: float
    by_feature: bool


def meshed(
    kernels: FieldKernels, extent: Extent, wanted: Wanted, watch: Callable[[float], None]
) -> Extracted | Nothing | TooFine:
    """Return a mesh within the tolerance, or what prevents it.

    Args:
        kernels: The shape.
        extent: Its box and its slope.
        wanted: The tolerance and the feature size.
        watch: Called with the share of the work that is done.

    Raises:
        MeshProblem: The shape cannot be meshed.
    """
    finest = math.inf if wanted.feature is None else wanted.feature / BALL_CELLS
    # Finer first where the tolerance is: a cell is rarely more than 50 times as long.
    step = min(extent.size / FIRST_CELLS, 50.0 * wanted.tolerance)
    step = max(step, extent.size / 64.0)
    least = min(wanted.feature or math.inf, LEAST_WALL * wanted.tolerance) / BALL_CELLS
    leaves = LeafSpacing(kernels, extent.slopes, extent.low, extent.high, least)
    step = leaves.aligned(step)
    done = 0.0
    for number in range(_MOST_ROUNDS):
        share = (0.1 if number == 0 else 0.85) * (1.0 - done)

        def inner(part: float, base: float = done, share: float = share) -> None:
            watch(base + share * part)

        tolerance, angle = wanted.tolerance, wanted.angle
        found = extracted(
            kernels,
            extent,
            step,
            tolerance,
            MOST_BRICKS,
            inner,
            tolerance,
            leaves=leaves,
            angle=angle,
        )
        if isinstance(found, Extracted) and _joined_too_large(found, tolerance, finest):
            found = divided(kernels, extent, found, tolerance, inner, angle, joined_only=True)
        done += share
        following = _next_step(found, wanted, finest)
        if following is None:
            if isinstance(found, Extracted) and found.tree and found.excess(tolerance) > tolerance:
                found = divided(kernels, extent, found, tolerance, inner, angle, joined_only=True)
            return found
        if isinstance(found, Extracted) and following == DIVIDE:

            def last(part: float, base: float = done) -> None:
                watch(base + (1.0 - base) * part)

            return divided(kernels, extent, found, tolerance, last, angle)
        bricks = max(found.sampled, 1) * (found.step / following) ** 2
        if bricks > MOST_BRICKS:
            return _too_fine(found, wanted, following, bricks, by_feature=following == finest)
        step = following
    return found


def _joined_too_large(found: Extracted, tolerance: float, finest: float) -> bool:
    """Return whether joined cells must be divided before anything can be said about the others."""
    if (
        found.tree is None
        or found.step > finest
        or len(found.lost)
        or found.excess(tolerance) <= tolerance
    ):
        return False
    shares = (bad_share(found, tolerance, "good"), bad_share(found, tolerance, "replaced"))
    return shares[0] < _FEW <= shares[1]


def _next_step(found: Extracted | Nothing, wanted: Wanted, finest: float) -> float | None:
    """Return the next spacing; None if this mesh is as wanted, 0 to divide some of its cells.

    Args:
        found: The mesh.
        wanted: The tolerance and the feature size.
        finest: The spacing that the feature size needs.
    """
    if found.step > finest:
        return finest
    fewer = found.sampled * 4 <= _BRICKS_FOR_LOST
    if isinstance(found, Nothing):
        searched = wanted.feature is None and (len(found.lost) > 0 or found.sampled > 0)
        return found.step / 2.0 if searched and fewer else None
    if len(found.lost):
        # What is thinner than a cell is missed by far: the spacing says nothing of the tolerance.
        return found.step / 2.0 if wanted.feature is None and fewer else None
    divisible = found.divisible
    corner = found.corner.distance if divisible else 0.0
    if max(found.excess(wanted.tolerance), corner) <= wanted.tolerance:
        return None
    if divisible and bad_share(found, wanted.tolerance, "good") < _FEW:
        return DIVIDE
    error = typical_error(found, wanted.tolerance) if divisible else found.excess(wanted.tolerance)
    factor = _AIM * math.sqrt(wanted.tolerance / error)
    return found.step * min(max(factor, _FINEST_STEP), _COARSEST_STEP)


def _too_fine(
    found: Extracted | Nothing,
    wanted: Wanted,
    step: float,
    bricks: float,
    *,
    by_feature: bool,
) -> TooFine:
    """Return what is possible instead.

    Args:
        found: The last mesh.
        wanted: The tolerance and the feature size.
        step: The spacing that is wanted.
        bricks: About how many bricks it has.
        by_feature: Whether the feature size makes it so fine.
    """
    possible = found.step * math.sqrt(max(found.sampled, 1) / MOST_BRICKS) / _COARSEST_STEP
    if isinstance(found, Nothing):
        return TooFine(possible, None, 160.0 * bricks, by_feature)
    error = max(found.accuracy.largest, found.accuracy.from_surface)
    finer = (found.step / step) ** 2 if by_feature else error / wanted.tolerance
    triangles = len(found.made.triangles) * finer
    # Coarse bricks say little of how many finer ones there are: twice the tolerance always fits.
    tolerance = 2.0 * error * (possible / (_AIM * found.step)) ** 2
    return TooFine(possible, tolerance, triangles, by_feature)
