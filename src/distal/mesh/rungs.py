"""Meshes of ever finer cells, and what they say together of a solid's integrals.

Input: a shape's kernels and box, and how exact the volume must be. Output: integrals with errors,
and the finest mesh. The spacings are always the same, whatever is asked, and the result is the one
of the smallest error: to ask for more never makes an error larger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Final

import numpy as np

from distal.mesh.extract import Extent, Extracted, Nothing, extracted
from distal.mesh.integrals import Integrals, integrals_of
from distal.mesh.kernels import FieldKernels
from distal.mesh.lattice import DIGIT
from distal.mesh.problems import MeshProblem
from distal.mesh.solid import Floats
from distal.mesh.spacing import MOST_BRICKS

_FINER: Final = 1.6
# Without a tolerance the cells become finer until there are so many along the largest side, and so
# many triangles: small parts in a wide box have few of them.
_CELLS: Final = 128.0
_FIRST: Final = _CELLS / _FINER**3  # of the first mesh
_TRIANGLES: Final = 40_000
_USUAL: Final = 1e-3  # and the error of the volume is this share,
_EXACT: Final = 1e-7  # or until it is this one
# No mesh has more bricks than these: without a tolerance, and with one of the volume.
_BRICKS: Final = 12_000
_BRICKS_OF_TOLERANCE: Final = 40_000
# At 128 cells along a side, lines may be this far from the surface, as a share of that side.
_LINES: Final = 2e-3
_MOST_CELLS: Final = 1 << 20  # along a side: a key has 21 bits
_SHOWN: Final = 3  # meshes that show an order, and one before them that confirms it
# How errors follow from differences and from the volume between mesh and surface; measured on
# random solids with closed volumes (tests/mesh/closed_volumes.py).
_LAST: Final = 3.0
_BEFORE: Final = 1.0
_ROUGH: Final = 12.0
_COLUMNS: Final = 2e-4
_THICK: Final = 0.02
# Of an area: its error is of the second order on smooth faces.
_ORDER: Final = _FINER**2
_LAST_AREA: Final = 5.0
_SMOOTH: Final = 1e-3
_MOST_DEVIATION: Final = 0.3  # of an order, as a share
_SAME: Final = 1.0 + 1e-9  # of powers of the ratio
_ROUNDING: Final = 1e-12


@dataclass(frozen=True, slots=True)
class Estimate:
    """The integrals that three or four meshes give.

    Attributes:
        integrals: Those of the finest; its area is extrapolated if they show its order twice.
        volume: The error of the volume.
        area: That of the area.
        center: That of the center of mass.
        inertia: That of the inertia.
    """

    integrals: Integrals
    area_value: float
    volume: float
    area: float
    center: float
    inertia: float


@dataclass(slots=True)
class Climbed:
    """What meshes of ever finer cells give.

    Attributes:
        finest: The finest mesh.
        estimate: The estimate of the smallest error; None if no three meshes have all parts.
        last: The integrals of the finest mesh.
        lost: Places of parts that the finest mesh misses.
        reached: Whether the error of the volume is as small as was asked.
        nothing: The finest spacing at which there was no mesh, if there was no mesh at all.
    """

    finest: Extracted | None = None
    estimate: Estimate | None = None
    last: Integrals | None = None
    lost: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    reached: bool = True
    nothing: Nothing | None = None


def climbed(
    kernels: FieldKernels,
    extent: Extent,
    watch: Callable[[float], None],
    volume_tolerance: float | None = None,
    step: float | None = None,
) -> Climbed:
    """Return what meshes of ever finer cells give.

    Args:
        kernels: The shape.
        extent: Its box.
        watch: Called with the share of the work that is done.
        volume_tolerance: How large the error of the volume may be; None for the usual work.
        step: The length of a cell that must be reached; None for the usual one.

    Raises:
        MeshProblem: The shape has no mesh.
    """
    found = Climbed()
    rungs: list[Integrals] = []
    cells, sampled, done = _FIRST, 0, 0.0
    most = _BRICKS if volume_tolerance is None else _BRICKS_OF_TOLERANCE
    smallest = extent.size / _CELLS if step is None else min(step, extent.size / _CELLS)
    while cells < _MOST_CELLS:
        spacing = extent.size / cells
        must = spacing * _FINER > smallest * _SAME
        if sampled * _ORDER > (MOST_BRICKS if must else most) and found.last is not None:
            break
        lines = _LINES * extent.size * (_CELLS / cells) ** 2

        def inner(share: float, base: float = done) -> None:
            watch(base + 0.5 * share * (1.0 - base))

        try:
            made = extracted(kernels, extent, spacing, lines, MOST_BRICKS, inner, digit=DIGIT)
        except MeshProblem as problem:
            if problem.kind == "too many" and (found.last or found.nothing) is not None:
                break
            raise
        done += 0.5 * (1.0 - done)
        sampled = made.sampled
        found.lost = made.lost
        if isinstance(made, Nothing):
            found.nothing = made
        else:
            found.finest = made
            found.last = integrals_of(kernels, made, extent)
            rungs = [] if len(found.lost) else [*rungs, found.last]
            if len(found.lost):
                # Coarser meshes did not show them either.
                found.estimate = None
            _take(found, rungs, extent)
        if spacing <= smallest * _SAME and _enough(found, volume_tolerance):
            break
        # Parts whose cells are too coarse to say how thick they are are looked at again.
        if isinstance(made, Nothing) and not len(made.lost) and spacing <= smallest * _SAME:
            break
        cells *= _FINER
    error = None if found.estimate is None else found.estimate.volume
    found.reached = volume_tolerance is None or (error is not None and error <= volume_tolerance)
    return found


def _take(found: Climbed, rungs: Sequence[Integrals], extent: Extent) -> None:
    """Take what the last three meshes say of the volume, and of the area, if it is more exact."""
    if len(rungs) < _SHOWN:
        return
    estimate = estimated(rungs[-_SHOWN - 1 :], extent)
    best = found.estimate
    if best is not None:
        volumes = best.integrals.volume, estimate.integrals.volume
        areas = best.area_value, estimate.area_value
        area = best if _stays(*areas, best.area, estimate.area) else estimate
        whole = best if _stays(*volumes, best.volume, estimate.volume) else estimate
        estimate = replace(whole, area_value=area.area_value, area=area.area)
    found.estimate = estimate


def _stays(value: float, finer: float, error: float, finer_error: float) -> bool:
    """Return whether a value stays: it has the smaller error, and a finer one is well within it.

    Differences that are small by chance make small errors, which finer meshes do not confirm.
    """
    return error < finer_error and 2.0 * abs(value - finer) <= error


def _enough(found: Climbed, volume_tolerance: float | None) -> bool:
    """Return whether no finer mesh is needed."""
    if found.estimate is None or found.last is None or len(found.lost):
        return False
    if volume_tolerance is not None and found.estimate.volume > volume_tolerance:
        return False
    share = found.estimate.volume / max(abs(found.estimate.integrals.volume), 1e-300)
    return share <= _EXACT or (share <= _USUAL and found.last.triangles >= _TRIANGLES)


def estimated(rungs: Sequence[Integrals], extent: Extent) -> Estimate:
    """Return the integrals of the last of three or four meshes, coarse to fine, with errors."""
    coarse, middle, fine = rungs[-_SHOWN:]
    far = max(float(np.abs(extent.low).max()), float(np.abs(extent.high).max()))
    size = abs(fine.volume)
    # Thick columns say that the mesh does not see the shape.
    thick = min(1.0, fine.columns / (_THICK * size)) if size else 1.0
    volume = max(
        _spread(coarse.volume, middle.volume, fine.volume),
        _ROUGH * fine.rough,
        _COLUMNS * fine.columns,
        2.0 * fine.columns * thick**2,
        _ROUNDING * size,
        DIGIT * far * fine.area,
    )
    area, area_error = _area(rungs)
    half = 0.5 * extent.size
    share = volume / size if size else 1.0
    return Estimate(
        integrals=fine,
        area_value=area,
        volume=volume,
        area=max(area_error, share * area),
        center=max(
            _spread(coarse.center, middle.center, fine.center), half * share, DIGIT * 8.0 * far
        ),
        inertia=max(_spread(coarse.inertia, middle.inertia, fine.inertia), half**2 * volume),
    )


def unconfirmed(integrals: Integrals, extent: Extent) -> Estimate:
    """Return the estimate of a mesh that may miss parts: its errors are as large as its values."""
    reach = float(np.linalg.norm(extent.high - extent.low))
    volume = abs(integrals.volume) + integrals.columns
    return Estimate(
        integrals=integrals,
        area_value=integrals.area,
        volume=volume,
        area=integrals.area,
        center=reach,
        inertia=max(float(np.abs(integrals.inertia).max()), volume * reach**2),
    )


def _spread(coarse: float | Floats, middle: float | Floats, fine: float | Floats) -> float:
    """Return the error of the finest of three values, from their differences."""
    last = _LAST * np.abs(np.subtract(fine, middle)).max()
    return float(max(last, _BEFORE * np.abs(np.subtract(middle, coarse)).max()))


def _area(rungs: Sequence[Integrals]) -> tuple[float, float]:
    """Return an area and its error: extrapolated where four meshes show the second order twice."""
    fine = rungs[-1].area
    steps = [finer.area - rung.area for rung, finer in pairwise(rungs)]
    *_, before, last = steps
    least = _ROUNDING * abs(fine)
    orders = [step / finer if finer else 0.0 for step, finer in pairwise(steps)]
    # At creases, areas can show an order by chance.
    smooth = rungs[-1].rough <= _SMOOTH * rungs[-1].columns and len(orders) > 1
    deviation = max(abs(order / _ORDER - 1.0) for order in orders)
    if not smooth or deviation > _MOST_DEVIATION:
        spread = max(abs(last) * _LAST_AREA, 2.0 * abs(before), 2.0 * abs(last + before))
        return fine, max(spread, least)
    rest = last / (_ORDER - 1.0)
    # The more the orders differ from the second, the less the rest is trusted.
    share = min(1.0, 0.05 + 6.0 * deviation)
    return fine + rest, max(share * abs(rest), least)
