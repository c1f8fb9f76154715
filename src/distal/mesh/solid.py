"""A mesh: triangles that enclose a solid, with normals, colors and a report on how it was made.

Input: arrays. Output: an immutable value. Does not depend on how the triangles were found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt

from distal.lang.runtime_access import mesh_cell
from distal.mesh.files import formats
from distal.mesh.files.parts import Finish, Finishes

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles that enclose a solid.

    Attributes:
        points: Of shape (n, 3), in scene units.
        triangles: Of shape (m, 3): indices of points, counter-clockwise seen from outside.
        normals: Of shape (n, 3), of length 1, pointing outwards; None if they are not known.
        colors: Of shape (n, 3): linear color of each point, 0 to 1; None for a mesh without colors.
        triangle_colors: Of shape (m, 3): linear color of each triangle; None without colors.
        report: What is known about the mesh: its spacing, counts, errors and warnings.
        name: The name of the shape.
        finish: How the mesh, or each triangle, reflects light in files with materials; None without
            materials.
    """

    points: Floats
    triangles: Integers
    normals: Floats | None = None
    colors: Floats | None = None
    triangle_colors: Floats | None = None
    report: Mapping[str, Any] = field(default_factory=dict)
    name: str = "shape"
    finish: Finish | Finishes | None = None

    def __post_init__(self) -> None:
        """Check the shapes of the arrays and make them read-only.

        Raises:
            ValueError: An array has another shape, or a triangle names a point that is not there.
        """
        set_array(self, "points", self.points, np.float64, None)
        set_array(self, "triangles", self.triangles, np.int64, None)
        set_array(self, "normals", self.normals, np.float64, len(self.points))
        set_array(self, "colors", self.colors, np.float64, len(self.points))
        set_array(self, "triangle_colors", self.triangle_colors, np.float64, len(self.triangles))
        if self.triangles.size and not (
            self.triangles.min() >= 0 and self.triangles.max() < len(self.points)
        ):
            raise ValueError(
                f"a triangle names a point outside 0 to {len(self.points) - 1}: points are counted "
                "from 0"
            )

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The smallest and the largest coordinates of the points.

        Raises:
            ValueError: The mesh has no points.
        """
        if not len(self.points):
            raise ValueError("an empty mesh has no bounds")
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        return (
            (float(low[0]), float(low[1]), float(low[2])),
            (float(high[0]), float(high[1]), float(high[2])),
        )

    def save(self, path: str | PathLike[str], *, unit: str = "mm", bed: bool = False) -> None:
        """Save the mesh in the format that the suffix names.

        Args:
            path: The file: ``.3mf``, ``.stl``, ``.glb``, ``.ply`` or ``.obj``.
            unit: The length of one scene unit: "um", "mm", "cm", "m", "inch" or "ft".
            bed: Move the part so that it stands on 0 and is centered there.

        Raises:
            SaveError: The suffix or the unit is unknown, or the file cannot be written.
        """
        formats.write(path, self, unit=unit, bed=bed, finishes=[self.finish])

    def _repr_html_(self) -> str | None:
        """Return the mesh as a notebook shows it: it turns; None without triangles."""
        return mesh_cell.html_of(self)

    def __repr__(self) -> str:
        return f"<Mesh '{self.name}': {len(self.points)} points, {len(self.triangles)} triangles>"


def set_array(mesh: Mesh, name: str, value: Any, dtype: type, count: int | None) -> None:
    """Store an array of the mesh, read-only and contiguous.

    Args:
        mesh: The mesh.
        name: The attribute.
        value: The array; None stays None.
        dtype: The type of its numbers.
        count: How many rows it must have; None for any number.

    Raises:
        ValueError: It has another shape.
    """
    if value is None:
        return
    array: npt.NDArray[Any] = np.ascontiguousarray(value, dtype)
    if array is value and array.flags.writeable:
        array = array.view()
    expected = "n" if count is None else str(count)
    if array.ndim != 2 or array.shape[1] != 3 or (count is not None and len(array) != count):
        raise ValueError(f"{name} of a mesh: an array ({expected}, 3), not {array.shape}")
    array.flags.writeable = False
    object.__setattr__(mesh, name, array)
