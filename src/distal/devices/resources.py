"""Load the data of textures and buffers into arrays for a device.

Input: a declared resource (a file's path, an array, nested lists) and its type. Output: texels as
(height, width, 4), depth or face first for volumes and cubes, in the order of their indices;
buffers as (n,) or (n, size). Values of pictures are scaled to 0 to 1 and otherwise unchanged.
Floats have 32 bits if these hold the source's numbers exactly (``float_type``). Does not depend on
devices.
"""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any, Final, assert_never

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import Memory, need_pixels, opened
from distal.ir.types import Buffer, Kind, Texture, TextureShape, component_count, kind_of
from distal.lang.resources import AXES

# Bytes that a pixel costs while its file is read: four floats, the decoder's pixel, and what
# progressive JPEG keeps.
_PIXEL_BYTES: Final = 24
_BAND: Final = 256  # rows that are converted at once
# Formats of pictures that Pillow decodes itself: its others start programs, or read more files.
PICTURE_FORMATS: Final = (
    "PNG",
    "JPEG",
    "WEBP",
    "GIF",
    "BMP",
    "TIFF",
    "TGA",
    "PPM",
    "AVIF",
    "JPEG2000",
    "DDS",
    "PCX",
    "PSD",
    "QOI",
    "SGI",
)

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
            found = _with_channels(_numbers(data), 3)
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
    if not isinstance(data, str | Path):
        return _with_channels(_numbers(data)[::step], 2)
    with (
        opened("texture", data, max_memory=max_memory, option=True) as content,
        _decoder(content, str(data)) as picture,
    ):
        width, height = picture.size
        need_pixels(width, height, _PIXEL_BYTES)
        picture.load()
        pixels = np.empty((height, width, 4), np.float32)
        for top in range(0, height, _BAND):
            band = picture.crop((0, top, width, min(top + _BAND, height)))
            pixels[::step][top : top + _BAND] = np.asarray(band.convert("RGBA"))
        pixels /= np.float32(255.0)
        return pixels


def _decoder(content: bytes, name: str) -> Any:
    """Return the picture of a file, of which only the header is read.

    ``Image.open`` refuses large pictures, whoever asked for them; the budget does that here.
    """
    from PIL import Image  # noqa: PLC0415 (only a file's data needs it)

    Image.init()
    for format in PICTURE_FORMATS:
        make, accept = Image.OPEN.get(format, (None, None))
        is_likely = accept is None or accept(content[:16])
        if make is None or isinstance(is_likely, str) or not is_likely:
            continue
        try:
            picture = make(io.BytesIO(content), name)
        except (SyntaxError, IndexError, TypeError, KeyError, EOFError, struct.error):
            continue  # as ``Image.open``: it is another format's
        if picture is not None:
            return picture
    raise LoadError("it is no picture of a format that is read")


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


def _with_channels(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Return RGBA from grey, RGB or RGBA; bytes are scaled to 0 to 1."""
    if array.ndim == axes:
        array = np.repeat(array[..., None], 3, axis=-1)
    if array.ndim != axes + 1 or array.shape[-1] not in (3, 4) or array.size == 0:
        names = ("height, width", "depth, height, width")[axes - 2]
        raise LoadError(f"a texture is ({names}), with 3 or 4 channels; not {array.shape}")
    values = array.astype(float_type(array), order="C")
    if array.dtype == np.uint8:
        values /= np.float32(255.0)
    if values.shape[-1] == 3:
        opaque = np.ones((*values.shape[:-1], 1), values.dtype)
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
    return np.ascontiguousarray(array, _COMPONENT.get(kind) or float_type(array))


def float_type(array: NDArray[Any]) -> np.dtype[Any]:
    """Return the type in which the floats of data are held: float32 if it holds them exactly.

    Where a kernel computes in 32 bits, its device rounds what has 64.
    """
    return np.dtype(np.float32 if np.can_cast(array.dtype, np.float32) else np.float64)
