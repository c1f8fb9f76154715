"""An outline: closed polylines around the inside of a flat shape, and how exact they are.

Input: arrays. Output: an immutable value. Does not depend on how the polylines were found.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt

from distal.mesh.files import formats


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Closed polylines around the inside of a flat shape.

    Attributes:
        loops: An array (n, 2) for each polyline, in scene units; the last point is joined to the
            first. The inside is at the left: outer ones are counter-clockwise, holes clockwise.
        area: The area inside.
        length: The length of all polylines.
        report: What is known about the outline: its spacing, counts, errors and warnings.
        name: The name of the shape.
    """

    loops: Sequence[npt.NDArray[np.float64]]
    area: float = 0.0
    length: float = 0.0
    report: Mapping[str, Any] = field(default_factory=dict)
    name: str = "shape"

    def __post_init__(self) -> None:
        """Make the arrays read-only.

        Raises:
            ValueError: An array has another shape.
        """
        loops = []
        for loop in self.loops:
            array = np.array(loop, np.float64)
            if array.ndim != 2 or array.shape[1] != 2 or len(array) < 3:
                raise ValueError(
                    f"a loop is an array (n, 2) of 3 points or more, not {array.shape}"
                )
            array.flags.writeable = False
            loops.append(array)
        object.__setattr__(self, "loops", tuple(loops))

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The smallest and the largest coordinates of the points.

        Raises:
            ValueError: The outline has no points.
        """
        if not self.loops:
            raise ValueError("an empty outline has no bounds")
        points = np.concatenate(self.loops)
        low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return (low[0], low[1]), (high[0], high[1])

    def save(self, path: str | PathLike[str], *, unit: str = "mm") -> None:
        """Save the outline in the format that the suffix names, in millimeters.

        Args:
            path: The file: ``.svg`` or ``.dxf``.
            unit: The length of one scene unit: "um", "mm", "cm", "m", "inch" or "ft".

        Raises:
            SaveError: The suffix or the unit is unknown, or the file cannot be written.
        """
        formats.write_outlines(path, self.loops, unit=unit)

    def _repr_svg_(self) -> str:
        """Return the outline as SVG, for notebooks."""
        file = io.BytesIO()
        formats.OUTLINE_FORMATS[".svg"].write(file, self.loops, None)
        return file.getvalue().decode()

    def __repr__(self) -> str:
        points = sum(len(loop) for loop in self.loops)
        return f"<Outline '{self.name}': {len(self.loops)} loops, {points} points>"
