"""A finished picture.

Input: pixels encoded for display, the light they show where it is known, and where they
came from. Output: an immutable
``Picture`` that saves itself and shows itself in a notebook. Knows nothing about how the pixels
were made.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.images import metadata, png
from distal.images.atomic_files import SaveError, check_destination, replacement
from distal.images.metadata import Provenance
from distal.lang.lazy_module import LazyModule
from distal.lang.runtime_access import executor
from distal.lang.srgb import decode_srgb
from distal.packages import PackageError, imported

if TYPE_CHECKING:
    from distal.images import exr
else:
    exr = LazyModule("distal.images.exr")  # OpenEXR is an extra, and heavy

# Suffix -> the bits of a channel that its files may have; the first are its usual ones.
FORMATS: Final = {".png": (8, 16), ".exr": (16, 32)}

__all__ = ["FORMATS", "Picture", "Provenance", "check_savable"]


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """Pixels encoded for display, and where they came from.

    Attributes:
        array: float32, (height, width, 4), top row first: red, green, blue encoded for display
            and straight alpha. Read-only. Values outside 0 to 1, infinities and NaN stay as the
            scene made them; saving clamps them, and makes NaN 0.
        provenance: Where the picture came from; it travels in the file's metadata.
        stats: What rendering took: times in seconds and how it was done.
        light: The same pixels before they were encoded, where the renderer has them.
        layers: What else is known of each pixel's middle, by name: "depth" (float32, scene units
            along the ray, infinite where nothing is met), "normal" (float32, (height, width, 3),
            world space, toward the eye; 0), "albedo" (float32, (height, width, 3), linear; 0),
            "material" (uint32, from 1 in the order of the author's tree; 0).
    """

    array: NDArray[np.float32]
    provenance: Provenance = field(default_factory=Provenance)
    stats: Mapping[str, Any] = field(default_factory=dict)
    light: NDArray[np.float32] | None = field(default=None, repr=False)
    layers: Mapping[str, NDArray[Any]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "array", _checked(self.array))
        if self.light is not None:
            if self.light.shape != self.array.shape:
                raise ValueError(f"light of shape {self.light.shape} for {self.array.shape}")
            object.__setattr__(self, "light", _checked(self.light))
        object.__setattr__(self, "stats", MappingProxyType(dict(self.stats)))
        layers = {name: _layer(name, values, self.array) for name, values in self.layers.items()}
        object.__setattr__(self, "layers", MappingProxyType(layers))

    @property
    def linear(self) -> NDArray[np.float32]:
        """Linear light: float32 (height, width, 4), straight alpha, top row first. Read-only.

        What the scene's renderer computed, before exposure and tone mapping; of an ``@image``,
        whose values are encoded already, these decoded (IEC 61966-2-1).
        """
        if self.light is None:
            object.__setattr__(self, "light", _checked(_decoded(self.array)))
        assert self.light is not None
        return self.light

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """``array``, for NumPy and for what shows arrays."""
        made: NDArray[Any] = np.array(self.array, dtype) if copy else np.asarray(self.array, dtype)
        return made

    @property
    def width(self) -> int:
        """Pixels from left to right."""
        return int(self.array.shape[1])

    @property
    def height(self) -> int:
        """Pixels from top to bottom."""
        return int(self.array.shape[0])

    @property
    def metadata(self) -> dict[str, str]:
        """The texts that a saved file carries."""
        return metadata.texts(self.provenance, (self.width, self.height))

    def with_provenance(self, **changes: Any) -> Picture:
        """The same picture with these fields of its ``Provenance`` changed."""
        return replace(self, provenance=replace(self.provenance, **changes))

    def with_layers(self, layers: Mapping[str, NDArray[Any]]) -> Picture:
        """The same picture with layers."""
        return replace(self, layers=layers)

    def save(self, path: str | PathLike[str], bits: int | None = None) -> None:
        """Write the picture; the suffix says how. The file appears whole or not at all.

        PNG: display values with sRGB declared, nearest rounding, straight alpha. EXR: linear
        light, before exposure and tone mapping, premultiplied, and the layers. Both carry
        ``metadata``.

        Args:
            path: A file that ends in .png or .exr.
            bits: Of each channel: 8 (the usual) or 16 of a PNG, 16 (half floats, the usual) or 32
                of an EXR.

        Raises:
            SaveError: The suffix is unknown, it has no such bits, or the file cannot be written.
        """
        destination = Path(path)
        suffix, bits = check_savable(destination, bits)
        if suffix == ".exr":
            data = exr.encode(self.linear, self.layers, self.metadata, bits)
        else:
            data = png.encode(self.array, self.metadata, bits)
        with replacement(destination) as file:
            file.write(data)

    def _repr_png_(self) -> bytes:
        """The bytes that a notebook shows."""
        return png.encode(self.array, self.metadata)

    def __repr__(self) -> str:
        name = self.provenance.source
        return f"<Picture {self.width}x{self.height}{f' of {name}' if name else ''}>"


def _checked(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """The pixels, not to be written to."""
    shape = pixels.shape
    if len(shape) != 3 or shape[2] != 4 or 0 in shape:
        raise ValueError(f"a picture's array has the shape (height, width, 4), not {shape}")
    if pixels.dtype != np.float32:
        raise ValueError(f"a picture's array is of float32, not {pixels.dtype}")
    view = pixels.view()
    view.setflags(write=False)
    return view


def _decoded(array: NDArray[np.float32]) -> NDArray[np.float32]:
    """Light from values encoded in sRGB."""
    linear = array.copy()
    color = array[..., :3]
    # The reference device: machine code would take longer for a single call.
    light = executor().call(decode_srgb, (color.reshape(-1, 3),), {}, device="reference")
    linear[..., :3] = light.reshape(color.shape)
    return linear


def check_savable(path: Path, bits: int | None = None) -> tuple[str, int]:
    """Refuse what ``Picture.save`` would refuse, before any work is spent on it.

    Returns:
        The suffix, and the bits of a channel.

    Raises:
        SaveError: The suffix is unknown, it has no such bits, its package is missing or broken, or
            no file can be written there.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        named = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        raise SaveError(f"cannot write {path}: it has {named}, pictures end in .png or .exr")
    usual = FORMATS[suffix]
    if bits is not None and bits not in usual:
        raise SaveError(f"cannot write {path}: a channel has {usual[0]} or {usual[1]} bits")
    if suffix == ".exr":
        try:
            imported("OpenEXR")
        except PackageError as error:
            raise SaveError(f"cannot write {path}: {error}") from None
    check_destination(path)
    return suffix, bits or usual[0]


def _layer(name: str, values: NDArray[Any], array: NDArray[np.float32]) -> NDArray[Any]:
    """A layer, not to be written to."""
    if values.shape[:2] != array.shape[:2]:
        raise ValueError(f"layer {name} of shape {values.shape} for {array.shape}")
    view = values.view()
    view.setflags(write=False)
    return view
