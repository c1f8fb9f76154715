"""Load the data of textures and buffers into arrays for a device.

Input: a declared resource (a file's path, an array, nested lists) and its type. Output: texels as
float32 (height, width, 4), depth or face first for volumes and cubes, in the order of their
indices; buffers as (n,) or (n, size). Values of pictures are scaled to 0 to 1 and otherwise
unchanged. Does not depend on devices.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.ir.types import Buffer, Kind, Texture, TextureShape, component_count, kind_of
from distal.lang.resources import AXES

_COMPONENT: dict[Kind, Any] = {Kind.FLOAT: np.float32, Kind.INT: np.int32, Kind.UINT: np.uint32}


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
    return texels(source.data, type.shape, getattr(source, "axes", AXES))


def texels(data: Any, shape: TextureShape, axes: str = AXES) -> NDArray[np.float32]:
    """Return the texels of a texture; texel (0, 0) of a picture is at its lower left.

    Args:
        data: The path of a file, an array, or nested lists.
        shape: The kind of texture.
        axes: What the axes of a volume are, from the outermost to the innermost.

    Raises:
        LoadError: A file cannot be read, or the data does not have the shape of such a texture.
    """
    match shape:
        case TextureShape.FLAT:
            return np.ascontiguousarray(_picture(data)[::-1])
        case TextureShape.VOLUME:
            found = _with_channels(_numbers(data), 3)
            order = [axes.index(axis) for axis in AXES]
            return np.ascontiguousarray(found.transpose(*order, 3))
        case TextureShape.CUBE:
            # A cube's faces are seen from inside, top row first, as in OpenGL.
            faces = [_picture(face) for face in _parts(data)]
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


def _picture(data: Any) -> NDArray[np.float32]:
    """Return a picture: (height, width, 4), top row first."""
    if not isinstance(data, str | Path):
        return _with_channels(_numbers(data), 2)
    from PIL import Image  # noqa: PLC0415 (only a file's data needs it)

    try:
        with Image.open(data) as picture:
            return _with_channels(np.asarray(picture.convert("RGBA")), 2)
    except Exception as error:  # Pillow raises many kinds of exceptions for broken files
        reason = getattr(error, "strerror", None) or error
        raise LoadError(f"the texture '{data}' cannot be read: {printable(reason)}") from error


def _numbers(data: Any) -> NDArray[Any]:
    if isinstance(data, str | Path):
        raise LoadError(f"a Texture3D takes an array, not the file '{data}'")
    try:
        array = np.asarray(data)
    except ValueError as error:
        raise LoadError("a texture's rows have one length") from error
    if array.dtype.kind not in "fiub":
        raise LoadError("a texture takes numbers")
    return array


def _with_channels(array: NDArray[Any], axes: int) -> NDArray[np.float32]:
    """Return RGBA from grey, RGB or RGBA; bytes are scaled to 0 to 1."""
    if array.ndim == axes:
        array = np.repeat(array[..., None], 3, axis=-1)
    if array.ndim != axes + 1 or array.shape[-1] not in (3, 4) or array.size == 0:
        names = ("height, width", "depth, height, width")[axes - 2]
        raise LoadError(f"a texture is ({names}), with 3 or 4 channels; not {array.shape}")
    scale = np.float32(255.0 if array.dtype == np.uint8 else 1.0)
    values = array.astype(np.float32) / scale
    if values.shape[-1] == 3:
        opaque = np.ones((*values.shape[:-1], 1), np.float32)
        values = np.concatenate([values, opaque], axis=-1)
    return np.ascontiguousarray(values)


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
    return np.ascontiguousarray(array, _COMPONENT[kind])
