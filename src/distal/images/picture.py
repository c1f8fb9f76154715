"""``Picture``: a finished picture.

Input: pixels encoded for display, the linear light before encoding if available, and how they were
rendered. Output: an immutable ``Picture`` with methods to save it and to show it in a notebook.
Does not depend on how the pixels were computed.
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

from distal.file_writer import SaveError, check_destination, replacement
from distal.images import jpeg, metadata, png
from distal.images.metadata import Provenance
from distal.lang.lazy_module import LazyModule
from distal.lang.runtime_access import executor
from distal.lang.srgb import decode_srgb
from distal.packages import PackageError, imported

if TYPE_CHECKING:
    from distal.images import exr
else:
    exr = LazyModule("distal.images.exr")  # OpenEXR is optional, and slow to import

# The possible bits of a channel by suffix; the first is the default.
FORMATS: Final[Mapping[str, tuple[int, ...]]] = {
    ".png": png.BITS,
    ".jpg": jpeg.BITS,
    ".exr": (16, 32),
}
_OTHER_SUFFIXES: Final = {".jpeg": ".jpg"}
# The optional packages that write them.
PACKAGES: Final = {".exr": "OpenEXR"}

__all__ = ["FORMATS", "Picture", "Provenance", "check_savable"]


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """Pixels encoded for display, with their provenance.

    Attributes:
        array: float32, (height, width, 4), top row first: red, green, blue encoded for display
            and straight alpha. Read-only. Values outside 0 to 1, infinities and NaN are kept as the
            scene computed them; saving clamps them and replaces NaN by 0.
        provenance: How the picture was rendered; saved in the metadata of the file.
        stats: Statistics of the rendering: times in seconds, the device and others.
        light: The same pixels before they were encoded, if the renderer has them.
        layers: Other values at the middle of each pixel, by name: "depth" (float32, scene units
            along the ray, infinite if nothing is hit), "normal" (float32, (height, width, 3),
            world space, toward the eye; else 0), "albedo" (float32, (height, width, 3), linear;
            else 0), "material" (uint32, from 1 in the order of the author's tree; else 0), "height"
            (of a ``HeightMap``: float32, scene units; NaN if there is nothing). In mode "path"
            "normal" and "albedo" are means over samples, of what is seen in mirrors and through
            clear glass, and there are "samples" (uint32, the number of each pixel) and "variance"
            (float32, of the pixel's luma: its squared standard error; infinite if unknown).
        rounded: uint8, of the shape of ``array``: its levels, if it was made from them.
    """

    array: NDArray[np.float32]
    provenance: Provenance = field(default_factory=Provenance)
    stats: Mapping[str, Any] = field(default_factory=dict)
    light: NDArray[np.float32] | None = field(default=None, repr=False)
    layers: Mapping[str, NDArray[Any]] = field(default_factory=dict, repr=False)
    rounded: NDArray[np.uint8] | None = field(default=None, init=False, repr=False)

    @classmethod
    def of_levels(
        cls, levels: NDArray[np.uint8], provenance: Provenance, stats: Mapping[str, Any]
    ) -> Picture:
        """Return a picture of 8-bit levels, which ``levels`` returns again.

        Args:
            levels: uint8, (height, width, 4), straight alpha, top row first.
            provenance: How it was made.
            stats: What was measured while it was made.
        """
        array = np.divide(levels, np.float32(255.0), dtype=np.float32)
        made = cls(array, provenance, stats)
        object.__setattr__(made, "rounded", levels)
        return made

    def __post_init__(self) -> None:
        object.__setattr__(self, "array", _checked(self.array))
        if self.light is not None:
            if self.light.shape != self.array.shape:
                raise ValueError(f"light of shape {self.light.shape} for {self.array.shape}")
            object.__setattr__(self, "light", _checked(self.light))
        object.__setattr__(self, "stats", MappingProxyType(dict(self.stats)))
        layers = {name: _layer(name, values, self.array) for name, values in self.layers.items()}
        object.__setattr__(self, "layers", MappingProxyType(layers))

    def __reduce__(self) -> Any:
        given = (self.array, self.provenance, dict(self.stats), self.light, dict(self.layers))
        return _picture_of, (given, self.rounded)

    def __eq__(self, other: object) -> bool:
        """Return whether pixels and layers are the same to the bit; how they came does not count.

        NaN is equal to itself.
        """
        if not isinstance(other, Picture):
            return NotImplemented
        return self is other or self._contents() == other._contents()

    def __hash__(self) -> int:
        return hash(self.array.tobytes())

    def _contents(self) -> list[tuple[str, tuple[int, ...], bytes]]:
        arrays = {"": self.array, **self.layers}
        return [(name, arrays[name].shape, arrays[name].tobytes()) for name in sorted(arrays)]

    @property
    def levels(self) -> NDArray[np.uint8]:
        """``array`` rounded to 256 levels, as saving does: uint8, (height, width, 4)."""
        return png.quantise(self.array) if self.rounded is None else self.rounded

    @property
    def linear(self) -> NDArray[np.float32]:
        """Linear light: float32 (height, width, 4), straight alpha, top row first. Read-only.

        For a scene: the light before exposure and tone mapping. For an ``@image``, whose values
        are already encoded: these values decoded (IEC 61966-2-1).
        """
        if self.light is None:
            object.__setattr__(self, "light", _checked(_decoded(self.array)))
        assert self.light is not None
        return self.light

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return ``array``, for NumPy and for libraries that display arrays."""
        made: NDArray[Any] = np.array(self.array, dtype) if copy else np.asarray(self.array, dtype)
        return made

    @property
    def width(self) -> int:
        """Width in pixels."""
        return int(self.array.shape[1])

    @property
    def height(self) -> int:
        """Height in pixels."""
        return int(self.array.shape[0])

    @property
    def metadata(self) -> dict[str, str]:
        """The metadata of a saved file."""
        return metadata.texts(self.provenance, (self.width, self.height))

    def with_provenance(self, **changes: Any) -> Picture:
        """Return the same picture with some fields of its ``Provenance`` changed."""
        return self._with(provenance=replace(self.provenance, **changes))

    def with_layers(self, layers: Mapping[str, NDArray[Any]]) -> Picture:
        """Return the same picture with these layers."""
        return self._with(layers=layers)

    def _with(self, **changes: Any) -> Picture:
        """Return a picture of the same pixels."""
        made = replace(self, **changes)
        object.__setattr__(made, "rounded", self.rounded)
        return made

    def save(self, path: str | PathLike[str], bits: int | None = None) -> None:
        """Write the picture in the format of the suffix. The file is complete or not written.

        PNG: display values with sRGB declared, rounded to nearest, straight alpha. JPEG: the same
        at quality 95, opaque. EXR: linear light before exposure and tone mapping, premultiplied,
        and the layers. All contain ``metadata``.

        Args:
            path: A file that ends in .png, .jpg or .exr.
            bits: Bits of a channel: 8 (default) or 16 for a PNG, 16 (default, half floats) or 32
                for an EXR.

        Raises:
            SaveError: The suffix or number of bits is not supported, the picture of a JPEG is
                transparent, or the file cannot be written.
        """
        destination = Path(path)
        suffix, bits = check_savable(destination, bits)
        if suffix == ".exr":
            data = exr.encode(self.linear, self.layers, self.metadata, bits)
        elif suffix == ".png":
            data = png.encode(self.array, self.metadata, bits)
        else:
            data = jpeg.encode(self.array, self.metadata)
        with replacement(destination) as file:
            file.write(data)

    def _repr_png_(self) -> bytes:
        """Return the PNG file that a notebook shows."""
        return png.encode(self.array, self.metadata)

    def __repr__(self) -> str:
        name = self.provenance.source
        return f"<Picture {self.width}x{self.height}{f' of {name}' if name else ''}>"


def _checked(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the pixels as a read-only view, after checking their shape and type."""
    shape = pixels.shape
    if len(shape) != 3 or shape[2] != 4 or 0 in shape:
        raise ValueError(f"a picture's array has the shape (height, width, 4), not {shape}")
    if pixels.dtype != np.float32:
        raise ValueError(f"a picture's array is of float32, not {pixels.dtype}")
    view = pixels.view()
    view.setflags(write=False)
    return view


def _decoded(array: NDArray[np.float32]) -> NDArray[np.float32]:
    """Decode sRGB values to linear light."""
    linear = array.copy()
    color = array[..., :3]
    # On the reference device, because compiling for a single call would take longer.
    light = executor().call(decode_srgb, (color.reshape(-1, 3),), {}, device="reference")
    linear[..., :3] = light.reshape(color.shape)
    return linear


def check_savable(path: Path, bits: int | None = None) -> tuple[str, int]:
    """Check that ``Picture.save`` would work, before time is spent on rendering.

    Args:
        path: A file that ends in .png or .exr.
        bits: Bits of a channel; None for the default.

    Returns:
        The suffix, and the bits of a channel.

    Raises:
        SaveError: The suffix or number of bits is not supported, the package is missing or broken,
            or no file can be written there.
    """
    suffix = path.suffix.lower()
    suffix = _OTHER_SUFFIXES.get(suffix, suffix)
    if suffix not in FORMATS:
        named = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        raise SaveError(f"cannot write {path}: it has {named}, pictures end in .png, .jpg or .exr")
    usual = FORMATS[suffix]
    if bits is not None and bits not in usual:
        possible = " or ".join(map(str, usual))
        raise SaveError(f"cannot write {path}: a channel has {possible} bits")
    if suffix in PACKAGES:
        try:
            imported(PACKAGES[suffix])
        except PackageError as error:
            raise SaveError(f"cannot write {path}: {error}") from None
    check_destination(path)
    return suffix, bits or usual[0]


def _layer(name: str, values: NDArray[Any], array: NDArray[np.float32]) -> NDArray[Any]:
    """Return a layer as a read-only view, after checking its shape."""
    if values.shape[:2] != array.shape[:2]:
        raise ValueError(f"layer {name} of shape {values.shape} for {array.shape}")
    view = values.view()
    view.setflags(write=False)
    return view


def _picture_of(given: tuple[Any, ...], rounded: NDArray[np.uint8] | None) -> Picture:
    """Return a picture from a pickle."""
    made = Picture(*given)
    object.__setattr__(made, "rounded", rounded)
    return made
