"""Units of length that files of meshes name, and that authors choose."""

from __future__ import annotations

from typing import Final

# Meters in one unit.
UNITS: Final = {
    "um": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
    "inch": 0.0254,
    "ft": 0.3048,
}
MILLIMETER: Final = 1e-3
