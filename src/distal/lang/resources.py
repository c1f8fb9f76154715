"""Textures and buffers: read-only data for scene code.

They are declared in the author's module and used by name in scene code. This module checks only the
shape of the data; files are loaded and their contents checked when the program runs.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, ClassVar

from distal.example_files import data_file
from distal.ir.types import (
    FLOAT,
    INT,
    TEXTURE_2D,
    TEXTURE_3D,
    TEXTURE_CUBE,
    UINT,
    Kind,
    Type,
    vector_of,
)
from distal.lang.source import folder_of
from distal.lang.values import VectorValue, uint

WRAPS = ("repeat", "clamp")
# What the axes of a volume's array are, from the outermost to the innermost: array[z, y, x].
AXES = "zyx"


def checked_axes(axes: object) -> str:
    """Return an order of the three axes.

    Raises:
        ValueError: It is none.
    """
    if not isinstance(axes, str) or sorted(axes) != ["x", "y", "z"]:
        raise ValueError(f"axes are 'zyx' or another order of the three, not {axes!r:.40}")
    return axes


def beside(file: str, data: Any) -> Any:
    """Return file names as paths in the folder of ``file``, or else in the working folder.

    Names of files that do not exist stay as they are. "example:FILE" is a file of the examples.
    """
    if isinstance(data, list | tuple) and len(data) == 6:  # the faces of a cube map
        return [beside(file, part) if isinstance(part, str | PathLike) else part for part in data]
    if not isinstance(data, str | PathLike):
        return data
    if (example := data_file(os.fspath(data))) is not None:
        return str(example)
    name = os.fspath(data)
    candidate = os.path.join(os.path.abspath(folder_of(file)), name)
    if os.path.exists(candidate):
        return candidate
    return os.path.abspath(name) if os.path.exists(name) else data


def _shown(data: Any) -> str:
    """Return what texels come from: the name of a file, an array's shape, or their count."""
    if isinstance(data, str | PathLike):
        return f"'{os.path.basename(os.fspath(data))}'"
    shape = getattr(data, "shape", None)
    if shape is not None:
        return f"an array {tuple(shape)}"
    return f"{len(data)} rows" if isinstance(data, Sequence) else "texels"


class TextureValue:
    """Base class of the three kinds of texture.

    Attributes:
        data: The name or path of a file, an array, or nested lists of numbers. A relative name is
            looked up in the folder of the file that declares the texture, then in the working
            folder.
        wrap: How to sample outside of the texture: "repeat", or "clamp" to repeat the edge texels.
        max_memory: The most memory that a file may become, as "4 GB" or in bytes; None: by its
            size.
    """

    __distal_type__: ClassVar[Type]

    def __init__(
        self, data: Any, wrap: str = "repeat", *, max_memory: int | str | None = None
    ) -> None:
        if wrap not in WRAPS:
            raise ValueError(f"wrap is 'repeat' or 'clamp', not {wrap!r}")
        declared_in = sys._getframe(1).f_globals.get("__file__")
        self.data = beside(declared_in, data) if isinstance(declared_in, str) else data
        self.wrap = wrap
        self.max_memory = max_memory

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {_shown(self.data)}, wrap='{self.wrap}'>"


class Texture2D(TextureValue):
    """A picture, sampled by a vec2: (0, 0) is the lower left corner, (1, 1) the upper right.

    Args:
        data: A file, an array, or nested lists of numbers.
        wrap: How to sample outside: "repeat", or "clamp" to repeat the edge texels.
        max_memory: The most memory that a file may become, as "4 GB" or in bytes; None: by its
            size.
    """

    __distal_type__ = TEXTURE_2D


class TextureCube(TextureValue):
    """Six square pictures, sampled by a direction.

    Args:
        data: Six files or arrays: +x, -x, +y, -y, +z, -z.
        wrap: How to sample outside: "repeat", or "clamp" to repeat the edge texels.
        max_memory: The most memory that a file may become, as "4 GB" or in bytes; None: by its
            size.
    """

    __distal_type__ = TEXTURE_CUBE


class Texture3D(TextureValue):
    """A volume, sampled by a vec3 from (0, 0, 0) to (1, 1, 1).

    Args:
        data: An array, or nested lists of numbers.
        wrap: "repeat", or "clamp" to repeat the edge texels.
        axes: What the axes of ``data`` are, from the outermost to the innermost. "zyx": a value is
            ``data[z, y, x]``, as a stack of pictures is stored; "xyz": ``data[x, y, z]``, as
            ``numpy.meshgrid(..., indexing="ij")`` makes it. Channels, if any, are the fourth axis.
    """

    __distal_type__ = TEXTURE_3D

    def __init__(self, data: Any, wrap: str = "repeat", *, axes: str = AXES) -> None:
        super().__init__(data, wrap)
        self.axes = checked_axes(axes)


@dataclass(frozen=True, slots=True)
class BufferAnnotation:
    """``Buffer[element]`` as the author wrote it, not checked."""

    element: Any


class Buffer:
    """A sequence of numbers or vectors, read by index.

    Attributes:
        data: Floats, ints, vectors or tuples of 2 to 4 floats; or an array (n,) or (n, 2 to 4).
        element: The type of one element.
    """

    def __init__(self, data: Any) -> None:
        self.data = data
        self.element = _element(data)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self.data)} {self.element}>"

    def __class_getitem__(cls, item: Any) -> BufferAnnotation:
        """Return the annotation for a buffer parameter."""
        return BufferAnnotation(item)


class MovingBuffer(Buffer):
    """A buffer whose numbers a host may compute for each picture.

    Its own ``data`` are right for all pictures, so a host that computes nothing reads them.
    """

    def at(self, params: Mapping[str, Any], time: float) -> Any:
        """Return the numbers of one picture, an array like ``data``.

        Args:
            params: Values of parameters by name; the others have their defaults.
            time: Seconds.
        """
        raise NotImplementedError


def _element(data: Any) -> Type:
    dtype = getattr(data, "dtype", None)
    if dtype is not None:
        return _array_element(data.shape, dtype.kind)
    if isinstance(data, str | bytes) or not isinstance(data, Sequence):
        raise TypeError("a Buffer takes a list of numbers or vectors, or an array")
    if len(data) == 0:
        raise ValueError("a Buffer needs at least one element")
    sizes = {len(e) if isinstance(e, tuple | list | VectorValue) else 1 for e in data}
    if len(sizes) > 1 or not sizes <= {1, 2, 3, 4}:
        raise ValueError("all elements of a Buffer have one size, a number or 2 to 4 of them")
    (size,) = sizes
    if size > 1:
        return vector_of(Kind.FLOAT, size)
    if any(isinstance(e, bool) or not isinstance(e, int | float) for e in data):
        raise TypeError("a Buffer takes numbers or vectors")
    if all(isinstance(e, uint) for e in data):
        return UINT
    return INT if all(isinstance(e, int) for e in data) else FLOAT


def _array_element(shape: tuple[int, ...], kind: str) -> Type:
    if len(shape) == 2 and 2 <= shape[1] <= 4 and shape[0] > 0:
        return vector_of(Kind.FLOAT, shape[1])
    if len(shape) != 1 or shape[0] == 0:
        raise ValueError(f"a Buffer takes an array (n,) or (n, 2 to 4), not {shape}")
    scalars = {"f": FLOAT, "i": INT, "u": UINT}
    if kind not in scalars:
        raise TypeError("a Buffer's array holds floats or integers")
    return scalars[kind]
