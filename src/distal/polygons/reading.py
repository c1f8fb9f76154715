"""The formats of meshes that are read, and the function that reads a file.

Input: a path. Output: points and triangles, or a ``LoadError`` that names the file and what is
wrong with it. A file is read once and never run; ``foreign_files`` bounds what it may take.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from distal.diagnostics import LoadError, printable
from distal.foreign_files import Memory, opened
from distal.polygons.glb import read_glb
from distal.polygons.obj import read_obj
from distal.polygons.ply import read_ply
from distal.polygons.stl import read_stl
from distal.polygons.three_mf import read_three_mf
from distal.polygons.triangles import SourceTriangles


@dataclass(frozen=True, slots=True)
class ReadFormat:
    """A format of meshes.

    Attributes:
        name: Its name, a key of ``foreign_files.KINDS``.
        z_up: Whether z is up in it; else y is.
        read: Reads the bytes of a file.
        colored: Reads them with colors, if they are there; None for a format without colors.
    """

    name: str
    z_up: bool
    read: Callable[[bytes], SourceTriangles]
    colored: Callable[[bytes], SourceTriangles] | None = None


READ_FORMATS: Final = {
    ".stl": ReadFormat("STL", True, read_stl),
    ".3mf": ReadFormat("3MF", True, read_three_mf, partial(read_three_mf, with_colors=True)),
    ".obj": ReadFormat("OBJ", False, read_obj, partial(read_obj, with_colors=True)),
    ".ply": ReadFormat("PLY", False, read_ply, partial(read_ply, with_colors=True)),
    ".glb": ReadFormat("GLB", False, read_glb, partial(read_glb, with_colors=True)),
}


def format_of(path: Path) -> ReadFormat:
    """Return the format that the suffix of a file names.

    Raises:
        LoadError: There is no such format.
    """
    chosen = READ_FORMATS.get(path.suffix.lower())
    if chosen is None:
        known = ", ".join(READ_FORMATS)
        raise LoadError(f"cannot read '{printable(path)}': a mesh's suffix is one of {known}")
    return chosen


def read_mesh(
    path: Path, *, with_colors: bool = False, max_memory: Memory | None = None
) -> SourceTriangles:
    """Return the triangles of a file, in its own unit and axes.

    Args:
        path: The file.
        with_colors: Whether to read its colors, if it has some.
        max_memory: The most bytes that it may become; None: by its size.

    Raises:
        LoadError: The file cannot be read, is not what its suffix says, or is too large.
    """
    chosen = format_of(path)
    read = chosen.colored if with_colors and chosen.colored is not None else chosen.read
    with opened(chosen.name, path, max_memory=max_memory, option=True) as data:
        return read(data)
