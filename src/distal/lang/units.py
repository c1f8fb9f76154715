"""Units: ``45 * deg`` in radians; ``8 * inch`` in a scene whose unit is 1 mm; those of files.

Input: nothing. Output: numbers. Angles are radians everywhere. A scene has no unit of its own;
parts for printing use millimeters, as the sizes of ``Bolt``, ``Nut`` and ``MetricThread`` do.
"""

from __future__ import annotations

import math
from typing import Final

# Meters in one unit, by the names that commands, files and methods know.
UNITS: Final = {
    "um": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
    "inch": 0.0254,
    "ft": 0.3048,
}
MILLIMETER: Final = UNITS["mm"]

mm: Final = UNITS["mm"] / MILLIMETER
cm: Final = UNITS["cm"] / MILLIMETER
meter: Final = UNITS["m"] / MILLIMETER
inch: Final = UNITS["inch"] / MILLIMETER
foot: Final = UNITS["ft"] / MILLIMETER

# Radians in one degree.
deg: Final = math.pi / 180.0


def meters_of(unit: str, error: type[Exception] = ValueError) -> float:
    """Return the length of a unit in meters.

    Args:
        unit: Its name, a key of ``UNITS``.
        error: The class of the exception for an unknown unit.

    Raises:
        Exception: There is no such unit; of the class ``error``.
    """
    if unit not in UNITS:
        raise error(f"a unit is one of {', '.join(UNITS)}, not {unit!r:.40}")
    return UNITS[unit]
