"""A finished picture.

What flows in: pixels encoded for display, the light they show where it is known, and where they
came from. What flows out: an immutable
``Picture`` that saves itself and shows itself in a notebook. Knows nothing about how the pixels
were made.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.film.png import encode
from distal.film.replacement import SaveError, check_destination, replacement
from distal.version import __version__

SUFFIXES = (".png",)


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Where a picture came from: what is needed to render it again.

    Attributes:
        source: Name of the scene's file or function, as the author knows it; may be empty.
        source_hash: Hash of the source that was compiled; may be empty.
        parameters: The value of each parameter by name, as plain JSON values.
        time: Seconds.
    """

    source: str = ""
    source_hash: str = ""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    time: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """Pixels encoded for display, and where they came from.

    Attributes:
        array: float32, (height, width, 4), top row first: red, green, blue encoded for display
            and straight alpha. Read-only. Values outside 0 to 1, infinities and NaN stay as the
            scene made them; saving clamps them, and makes NaN 0.
        provenance: Where the picture came from; it travels in the file's metadata.
        stats: What rendering took: times in seconds and how the work was done.
        light: The same pixels before they were encoded, where the renderer has them.
    """

    array: NDArray[np.float32]
    provenance: Provenance = field(default_factory=Provenance)
    stats: Mapping[str, Any] = field(default_factory=dict)
    light: NDArray[np.float32] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "array", _checked(self.array))
        if self.light is not None:
            if self.light.shape != self.array.shape:
                raise ValueError(f"light of shape {self.light.shape} for {self.array.shape}")
            object.__setattr__(self, "light", _checked(self.light))
        object.__setattr__(self, "stats", MappingProxyType(dict(self.stats)))

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
        origin = self.provenance
        return {
            "Software": f"distal {__version__}",
            "distal:version": __version__,
            "distal:source": origin.source,
            "distal:source-hash": origin.source_hash,
            "distal:parameters": json.dumps(dict(origin.parameters), sort_keys=True),
            "distal:time": repr(float(origin.time)),
            "distal:size": f"{self.width}x{self.height}",
        }

    def save(self, path: str | PathLike[str]) -> None:
        """Write the picture; the suffix says how. The file appears whole or not at all.

        PNG: 8 bits with sRGB declared, nearest rounding, metadata as in ``metadata``.

        Raises:
            SaveError: The suffix is unknown, or the file cannot be written.
        """
        destination = Path(path)
        check_savable(destination)
        with replacement(destination) as file:
            file.write(self._repr_png_())

    def _repr_png_(self) -> bytes:
        """The bytes that a notebook shows."""
        return encode(self.array, self.metadata)

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
    """Light from values encoded in sRGB; the straight part goes on below 0."""
    color = array[..., :3]
    curved = ((np.maximum(color, 0.0) + np.float32(0.055)) / np.float32(1.055)) ** np.float32(2.4)
    linear = array.copy()
    linear[..., :3] = np.where(color > np.float32(0.04045), curved, color / np.float32(12.92))
    return linear


def check_savable(path: Path) -> None:
    """Refuse a path that ``Picture.save`` would refuse, before any work is spent on it.

    Raises:
        SaveError: The suffix is unknown, or no file can stand there.
    """
    if path.suffix.lower() not in SUFFIXES:
        named = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        raise SaveError(f"cannot write {path}: it has {named}, pictures end in {SUFFIXES[0]}")
    check_destination(path)
