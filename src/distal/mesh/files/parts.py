"""What a file of a mesh contains: parts with points, triangles, colors and a finish.

Input: meshes in scene units, y up. Output: checked parts in the unit and the axes of a format.
Does not depend on formats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from distal.file_writer import SaveError
from distal.lang.runtime_access import executor
from distal.lang.srgb import encode_srgb

_LARGEST: Final = 1e30  # single floats of a file hold it, squared lengths in double ones too


class Solid(Protocol):
    """A mesh, as the writers read it; ``distal.mesh.solid.Mesh`` is one.

    Attributes:
        points: (n, 3), scene units, y up.
        triangles: (m, 3), indices of points, counterclockwise seen from outside.
        normals: (n, 3) or None.
        colors: Linear light of each point, (n, 3), or None.
        triangle_colors: Linear light of each triangle, (m, 3), or None; used before ``colors``,
            because it is sharp where colors change.
        name: The name of the part.
    """

    @property
    def points(self) -> NDArray[Any]:
        """The corners."""

    @property
    def triangles(self) -> NDArray[Any]:
        """Three indices of corners each."""

    @property
    def normals(self) -> NDArray[Any] | None:
        """A direction for each corner."""

    @property
    def colors(self) -> NDArray[Any] | None:
        """A color for each corner."""

    @property
    def triangle_colors(self) -> NDArray[Any] | None:
        """A color for each triangle."""

    @property
    def name(self) -> str:
        """The name of the part."""


@dataclass(frozen=True, slots=True)
class Finish:
    """How a whole part reflects light, in the terms of glTF.

    Attributes:
        color: Linear light; multiplied by the colors of points and triangles.
        metallic: 0 for dielectrics to 1 for metals.
        roughness: 0 (a mirror) to 1.
        opacity: 0 to 1.
        emission: Linear light that the part emits.
        transmission: The share of light that passes through, 0 to 1.
        ior: The index of refraction.
    """

    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    metallic: float = 0.0
    roughness: float = 0.5
    opacity: float = 1.0
    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)
    transmission: float = 0.0
    ior: float = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Finishes:
    """How the triangles of a part reflect light, if they differ.

    Attributes:
        kinds: The finishes.
        of_triangles: For each triangle the index of its finish.
    """

    kinds: tuple[Finish, ...]
    of_triangles: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class FilePart:
    """A checked part of a file.

    Attributes:
        name: Its name.
        points: (n, 3) float64, in the unit and the axes of the format.
        triangles: (m, 3) int64.
        normals: (n, 3) float64, or None.
        colors: Linear light of each point, or None.
        triangle_colors: Linear light of each triangle, or None.
        finish: How the part reflects light: as a whole or each triangle; or None.
    """

    name: str
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: NDArray[np.float64] | None = None
    colors: NDArray[np.float64] | None = None
    triangle_colors: NDArray[np.float64] | None = None
    finish: Finish | Finishes | None = None

    @property
    def whole_finish(self) -> Finish | None:
        """How the whole part reflects light, or None."""
        return self.finish if isinstance(self.finish, Finish) else None

    def pieces(self) -> list[FilePart]:
        """Return the triangles of each finish as a part of its own."""
        if not isinstance(self.finish, Finishes):
            return [self]
        of = self.finish.of_triangles
        rows = [(kind, np.flatnonzero(of == i)) for i, kind in enumerate(self.finish.kinds)]
        return [self._piece(kind, each) for kind, each in rows if len(each)]

    def _piece(self, kind: Finish, rows: NDArray[np.intp]) -> FilePart:
        used, corners = np.unique(self.triangles[rows], return_inverse=True)
        shades = self.triangle_colors
        return replace(
            self,
            points=self.points[used],
            triangles=corners.reshape(-1, 3),
            normals=None if self.normals is None else self.normals[used],
            colors=None if self.colors is None else self.colors[used],
            triangle_colors=None if shades is None else shades[rows],
            finish=kind,
        )


def part_of(solid: Solid, finish: Finish | Finishes | None = None) -> FilePart:
    """Check a mesh.

    Args:
        solid: The mesh.
        finish: How it reflects light, or None.

    Raises:
        SaveError: It has no triangle, a number that is not finite, or arrays that do not match.
    """
    points = _table(solid.points, "points", None)
    triangles = np.asarray(solid.triangles)
    if triangles.ndim != 2 or triangles.shape[1:] != (3,) or triangles.dtype.kind not in "iu":
        raise SaveError(f"a mesh's triangles are integers (m, 3), not {_described(triangles)}")
    if not len(triangles):
        raise SaveError("the mesh has no triangle, so there is nothing to save")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise SaveError(f"a triangle names a point that is not among the {len(points)}")
    return FilePart(
        name=str(solid.name),
        points=points,
        triangles=triangles.astype(np.int64),
        normals=_optional(solid.normals, "normals", len(points)),
        colors=_optional(solid.colors, "colors", len(points)),
        triangle_colors=_optional(solid.triangle_colors, "triangle_colors", len(triangles)),
        finish=finish,
    )


def placed(parts: Sequence[FilePart], scale: float, *, z_up: bool, bed: bool) -> list[FilePart]:
    """Return the parts in the unit and the axes of a format.

    Args:
        parts: The parts, y up.
        scale: Units of the format in one scene unit.
        z_up: Whether the format's third axis is up: (x, y, z) becomes (x, -z, y), a turn about x.
        bed: Move all parts together, so that they stand on 0 and their box is centered there.
    """
    turned = [_turned(part, scale) if z_up else _scaled(part, scale) for part in parts]
    if not bed:
        return turned
    up = 2 if z_up else 1
    low = np.min([part.points.min(axis=0) for part in turned], axis=0)
    high = np.max([part.points.max(axis=0) for part in turned], axis=0)
    origin = 0.5 * (low + high)
    origin[up] = low[up]
    return [replace(part, points=part.points - origin) for part in turned]


def display_values(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the sRGB values, 0 to 1, of linear light."""
    encoded = executor().call(encode_srgb, (np.clip(light, 0.0, 1.0),), {})
    return np.clip(np.asarray(encoded, np.float64), 0.0, 1.0)


def display_codes(light: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return the sRGB codes, 0 to 255, of linear light."""
    return np.asarray(np.rint(255.0 * display_values(light)), np.uint8)


def corner_codes(part: FilePart) -> NDArray[np.uint8] | None:
    """Return the sRGB codes of each corner of each triangle, (m, 3, 3); None without colors."""
    if part.triangle_colors is not None:
        return np.repeat(display_codes(part.triangle_colors)[:, None], 3, axis=1)
    if part.colors is not None:
        return display_codes(part.colors)[part.triangles]
    return None


def _scaled(part: FilePart, scale: float) -> FilePart:
    return replace(part, points=part.points * scale)


def _turned(part: FilePart, scale: float) -> FilePart:
    normals = None if part.normals is None else _z_up(part.normals)
    return replace(part, points=_z_up(part.points) * scale, normals=normals)


def _z_up(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    # 0 - z, because a negated zero would be written as "-0".
    return np.stack([vectors[:, 0], 0.0 - vectors[:, 2], vectors[:, 1]], axis=1)


def _optional(array: Any, name: str, rows: int) -> NDArray[np.float64] | None:
    return None if array is None else _table(array, name, rows)


def _table(array: Any, name: str, rows: int | None) -> NDArray[np.float64]:
    table = np.asarray(array)
    if table.ndim != 2 or table.shape[1:] != (3,) or table.dtype.kind not in "fiu":
        raise SaveError(f"a mesh's {name} are numbers (n, 3), not {_described(table)}")
    if rows is not None and len(table) != rows:
        raise SaveError(f"the mesh has {len(table)} {name}, but needs {rows}")
    table = table.astype(np.float64)
    wrong = np.flatnonzero(~(np.abs(table) <= _LARGEST).all(axis=1))
    if len(wrong):
        values = ", ".join(f"{value:g}" for value in table[wrong[0]])
        raise SaveError(
            f"row {wrong[0]} of the mesh's {name} is ({values}): it has no finite place"
        )
    return table


def _described(array: NDArray[Any]) -> str:
    return f"{array.dtype} {array.shape}"
