"""Distances stored in bricks near the surface only: large meshes and volumes in little memory.

Input: a point, and one buffer of numbers: which brick is stored, values at the corners of all
bricks, the samples of those that are stored. Output: as ``volumes``, of which this is the sparse
form: where a brick is stored, the arithmetic and the samples are the same. A buffer has exact
numbers on every target, takes 4 bytes for each, and needs no filter of floats.
"""

from __future__ import annotations

from typing import Final

from distal.fields.guarantees import NOTHING, Limit, primitive
from distal.fields.solids.boxes import box_bounds
from distal.fields.solids.volumes import (
    BOX_SIZE,
    GRID_SLOPE,
    Eight,
    place_among,
    trilinear,
    within_box,
)
from distal.lang import Buffer, clamp, floor, func, ivec3, max, select, vec3, vec4

# A brick has 8 cells along each axis, and the samples at both of its ends.
CELLS: Final = 8
SIDE: Final = 9
SAMPLES: Final = 729
BRICK: Final = vec3(9.0)


@func
def eight_of(values: Buffer[float], first: int, row: int, layer: int) -> Eight:
    """Return the corners of a cell: the place of the lowest one, and the steps along y and z."""
    above = first + layer
    return Eight(
        vec4(values[first], values[first + 1], values[first + row], values[first + row + 1]),
        vec4(values[above], values[above + 1], values[above + row], values[above + row + 1]),
    )


@func
def stored(values: Buffer[float], place: vec3, samples: vec3, reach: float) -> float:
    """Return the value at a place, in samples from the first one."""
    count = ivec3(samples)
    bricks = max((count + (CELLS - 2)) // CELLS, ivec3(1))
    lower = clamp(ivec3(floor(place)), ivec3(0), max(count - 2, ivec3(0)))
    brick = lower // CELLS
    number = values[(brick.z * bricks.y + brick.y) * bricks.x + brick.x]
    row = bricks.x + 1
    layer = row * (bricks.y + 1)
    corners = bricks.x * bricks.y * bricks.z
    corner = corners + brick.z * layer + brick.y * row + brick.x
    atlas = corners + layer * (bricks.z + 1) + (int(number) - 1) * SAMPLES
    cell = lower - brick * CELLS
    sample = atlas + (cell.z * SIDE + cell.y) * SIDE + cell.x
    # One interpolation for both: lanes of a vector seldom agree on which it is.
    is_stored = number > 0.0
    found = trilinear(
        eight_of(
            values,
            select(is_stored, sample, corner),
            select(is_stored, SIDE, row),
            select(is_stored, SIDE * SIDE, layer),
        ),
        select(is_stored, place - vec3(lower), place / float(CELLS) - vec3(brick)),
    )
    away = max(found, reach)
    return select(is_stored, found, select(number < 0.0, -away, away))


@primitive(
    "BrickField",
    NOTHING,
    slope=GRID_SLOPE,
    bounds=box_bounds,
    tier=2,
    growth=1.0,
    limits={"samples": Limit.POSITIVE, "reach": Limit.NOT_NEGATIVE},
)
@func
def brick_field(
    p: vec3,
    values: Buffer[float],
    samples: vec3 = BRICK,
    size: vec3 = BOX_SIZE,
    reach: float = 0.0,
    value_scale: float = 1.0,
) -> float:
    """Shape from distance samples that are stored only near the surface.

    ``Shape.from_mesh`` and ``Shape.from_volume`` make the numbers; by hand, use ``VolumeField``.
    The grid is divided into bricks of 8 cells along each axis. Where a brick is stored, the value
    is that of ``VolumeField`` with the same samples. Elsewhere it is ``reach`` or more: at most the
    distance, interpolated between the corners of bricks.

    Args:
        p: Point.
        values: For each brick, x first: 1 and more for the stored ones in their order, 0 outside,
            -1 inside. Then a number for each corner of bricks. Then 9 * 9 * 9 samples for each
            stored brick, negative inside; those on a side without a stored neighbor are ``reach``.
        samples: The number of samples along x, y and z.
        size: Size of the box, which is centred at the origin; samples are at the centres of equal
            cells.
        reach: The least distance in bricks that are not stored.
        value_scale: Distance of a sample of value 1.

    Source: trilinear interpolation.

    Measured:
        brick_field((0, 0, 0), Buffer([0, 1, 2, 1, 2, 1, 2, 1, 2]), (9, 9, 9), (9, 9, 9)) = 1.5
        brick_field((0, 0, 0), Buffer([-1, 1, 1, 1, 1, 1, 1, 1, 1]), (9, 9, 9), (9, 9, 9), 3) = -3.0
        brick_field((0, 0, 8.5), Buffer([0, 1, 1, 1, 1, 1, 1, 1, 1]), (9, 9, 9), (9, 9, 9), 3) = 5.0
    """
    inside = stored(values, place_among(p, size, samples), samples, reach) * value_scale
    return within_box(p, size, inside)
