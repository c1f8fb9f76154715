"""The formats of meshes that are read, and the function that reads a file.

Input: a path. Output: points and triangles, or a ``LoadError`` that names the file and what is
wrong with it. A file is read once and never run; nothing in it makes this module allocate more than
a small multiple of its size.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

from distal.diagnostics import LoadError, printable
from distal.polygons.glb import read_glb
from distal.polygons.obj import read_obj
from distal.polygons.ply import read_ply
from distal.polygons.stl import read_stl
from distal.polygons.three_mf import read_three_mf
from distal.polygons.triangles import SourceTriangles

LARGEST_FILE: Final = 2**30  # bytes


@dataclass(frozen=True, slots=True)
class ReadFormat:
    """A format of meshes.

    Attributes:
        name: Its name.
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


def read_mesh(path: Path, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a file, in its own unit and axes.

    Args:
        path: The file.
        with_colors: Whether to read its colors, if it has some.

    Raises:
        LoadError: The file cannot be read, or is not what its suffix says.
    """
    chosen = format_of(path)
    try:
        read = chosen.colored if with_colors and chosen.colored is not None else chosen.read
        return read(bytes_of(path, LARGEST_FILE))
    except LoadError as error:
        if error.message.startswith("cannot read"):
            raise
        reason = f"'{printable(path)}' is no {chosen.name} that can be read: {error.message}"
        raise LoadError(reason) from None


def bytes_of(path: Path, most: int) -> bytes:
    """Return the content of a file.

    Raises:
        LoadError: The file system reports an error, the file is empty, or it is too large.
    """
    try:
        if path.is_file() and path.stat().st_size > most:
            raise LoadError(f"cannot read '{printable(path)}': it is larger than {most >> 20} MiB")
        with path.open("rb") as file:
            data = file.read(most + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise LoadError(f"cannot read '{printable(path)}': {reason}") from None
    if not data:
        raise LoadError(f"cannot read '{printable(path)}': it is empty")
    return data
