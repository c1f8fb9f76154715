"""Environment maps as lights for paths: directions by the brightness of the picture.

Input: the table of a picture (``brightness``), random numbers. Output: a direction and its density.
Cells have equal steps of longitude and latitude; inside of a cell directions are uniform by solid
angle.
"""

from __future__ import annotations

from distal.lang import (
    Buffer,
    clamp,
    cos,
    floor,
    func,
    max,
    min,
    select,
    sin,
    sqrt,
    struct,
    vec3,
)
from distal.render.camera import equirectangular
from distal.render.environment import turned_by

PI = 3.14159265358979
FULL_TURN = 6.28318530717959


@struct
class DirectionSample:
    """A random direction to the surroundings.

    Attributes:
        direction: Unit direction.
        density: Its density by solid angle.
    """

    direction: vec3
    density: float


@func
def no_direction() -> DirectionSample:
    """Return a direction of ambient light that is not sampled."""
    return DirectionSample(vec3(0.0, 1.0, 0.0), 0.0)


@func
def sample_surroundings(
    table: Buffer[vec3], rows: int, columns: int, turn: float, u: vec3
) -> DirectionSample:
    """Return a random direction, denser where the picture is brighter.

    Args:
        table: Cells, made by ``brightness.brightness_table``; the bottom row first.
        rows: Rows of the table.
        columns: Columns of the table.
        turn: Turns the surroundings to the left about the upright axis, in radians.
        u: Three random numbers; the first chooses the cell.
    """
    place = u.x * float(rows * columns)
    number = min(int(place), rows * columns - 1)
    first = table[number]
    chosen = select(place - floor(place) < first.x, number, int(first.y))
    row = chosen // columns
    low = -cos(PI * float(row) / float(rows))
    high = -cos(PI * float(row + 1) / float(rows))
    y = low + (high - low) * u.z
    across = (float(chosen - row * columns) + u.y) / float(columns)
    angle = FULL_TURN * (across - 0.5)
    level = sqrt(max(1.0 - y * y, 0.0))
    direction = vec3(level * sin(angle), y, -level * cos(angle))
    return DirectionSample(turned_by(direction, -turn), table[chosen].z)


@func
def surroundings_density(
    table: Buffer[vec3], rows: int, columns: int, turn: float, direction: vec3
) -> float:
    """Return the density by solid angle with which ``sample_surroundings`` chooses a direction.

    Args:
        table: Cells, made by ``brightness.brightness_table``.
        rows: Rows of the table.
        columns: Columns of the table.
        turn: As for ``sample_surroundings``.
        direction: Unit direction.
    """
    place = equirectangular(turned_by(direction, turn))
    row = int(clamp(place.y * float(rows), 0.0, float(rows - 1)))
    column = int(clamp(place.x * float(columns), 0.0, float(columns - 1)))
    return table[row * columns + column].z
