"""Load the data of textures and buffers into arrays for a device.

Input: a declared resource (a file's path, an array, nested lists) and its type. Output: texels as
(height, width, 4), depth or face first for volumes and cubes, in the order of their indices;
buffers as (n,) or (n, size). Pictures are those of ``distal.pixels``. Floats have 32 bits if these
hold the source's numbers exactly (``float_type``). Does not depend on
devices.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import Memory
from distal.ir.types import Buffer, Kind, Texture, TextureShape, component_count, kind_of
from distal.lang.resources import AXES
from distal.pixels.arrays import float_type, numbers_of, with_channels
from distal.pixels.reading import read_pixels

_COMPONENT: dict[Kind, Any] = {Kind.INT: np.int32, Kind.UINT: np.uint32}


class LoadedData:
    """The array of a resource that another process has loaded.

    Attributes:
        data: The array, as ``load`` returns it.
    """

    __slots__ = ("data",)

    def __init__(self, data: NDArray[Any]) -> None:
        self.data = data


def load(source: Any, type: Texture | Buffer) -> NDArray[Any]:
    """Return the array of a resource.

    Raises:
        LoadError: A file cannot be read, or the data does not have the shape of such a resource.
    """
    if isinstance(source, LoadedData):
        return source.data
    if isinstance(type, Buffer):
        return _buffer(source.data, type)
    return texels(
        source.data,
        type.shape,
        getattr(source, "axes", AXES),
        max_memory=getattr(source, "max_memory", None),
    )


def texels(
    data: Any, shape: TextureShape, axes: str = AXES, *, max_memory: Memory | None = None
) -> NDArray[np.float32]:
    """Return the texels of a texture; texel (0, 0) of a picture is at its lower left.

    Args:
        data: The path of a file, an array, or nested lists.
        shape: The kind of texture.
        axes: What the axes of a volume are, from the outermost to the innermost.
        max_memory: The most bytes that a file may become; None: by its size.

    Raises:
        LoadError: A file cannot be read or is too large, or the data does not have the shape of
            such a texture.
    """
    match shape:
        case TextureShape.FLAT:
            return _picture(data, max_memory, step=-1)
        case TextureShape.VOLUME:
            if isinstance(data, str | Path):
                raise LoadError(f"a Texture3D takes an array, not the file '{data}'")
            found = with_channels(numbers_of(data), 3)
            order = [axes.index(axis) for axis in AXES]
            return np.ascontiguousarray(found.transpose(*order, 3))
        case TextureShape.CUBE:
            # A cube's faces are seen from inside, top row first, as in OpenGL.
            faces = [_picture(face, max_memory) for face in _parts(data)]
            if {face.shape for face in faces} != {faces[0].shape} or len(faces) != 6:
                raise LoadError("a TextureCube takes six pictures of one size")
            if faces[0].shape[0] != faces[0].shape[1]:
                raise LoadError("the pictures of a TextureCube are square")
            return np.stack(faces)
        case _:
            assert_never(shape)


def _parts(data: Any) -> list[Any]:
    if isinstance(data, str | Path):
        raise LoadError("a TextureCube takes six pictures: +x, -x, +y, -y, +z, -z")
    parts = list(data)
    if not parts:
        raise LoadError("a TextureCube takes six pictures, not none")
    return parts


def _picture(data: Any, max_memory: Memory | None, step: int = 1) -> NDArray[Any]:
    """Return a picture: (height, width, 4), top row first; the last one with a step of -1."""
    return np.ascontiguousarray(read_pixels(data, max_memory).values[::step])


def _buffer(data: Any, type: Buffer) -> NDArray[Any]:
    kind = kind_of(type.element)
    assert kind is not None
    if not hasattr(data, "dtype"):
        data = [tuple(e) if component_count(type.element) > 1 else e for e in data]
    array = np.asarray(data)
    if kind in (Kind.INT, Kind.UINT):
        limits = np.iinfo(_COMPONENT[kind])
        if array.min() < limits.min or array.max() > limits.max:
            raise LoadError(f"a value of the buffer does not fit {kind.value}")
    return np.ascontiguousarray(array, _COMPONENT.get(kind) or float_type(array))
