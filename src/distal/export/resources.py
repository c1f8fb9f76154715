"""Convert the data of textures and buffers for a page.

Input: the data that the author declared. Output: JSON with the numbers in base64, in the smallest
format that shows the same picture. Does not depend on pages or programs.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.deflating import deflated_text
from distal.devices.resources import load
from distal.images.png import encode_levels
from distal.ir.types import Buffer, Texture, TextureShape
from distal.lang.live_textures import SoundFile
from distal.sounds.analysis import table_of

LEVELS: Final = 256


def resource(source: Any, type: Texture | Buffer) -> dict[str, Any]:
    """Return the payload entry of a texture or buffer.

    Raises:
        LoadError: A file cannot be read, or the data has the wrong shape for the resource.
    """
    data = load(source, type)
    if data.dtype == np.float64:
        with np.errstate(over="ignore"):  # what is too large becomes infinite, and is refused
            data = data.astype(np.float32)
    return _buffer(data) if isinstance(type, Buffer) else _texture(data, type)


def sound(name: str, source: SoundFile) -> dict[str, Any]:
    """Return the payload entry of a sound file: its texels at each time, and the file.

    Raises:
        LoadError: The file cannot be read.
    """
    return {
        "name": name,
        "loop": source.loop,
        "rows": deflated_text(table_of(source).tobytes()),
        "file": base64.b64encode(Path(source.path).read_bytes()).decode("ascii"),
    }


def png(entry: Mapping[str, Any]) -> bytes:
    """Return the PNG of a picture of bytes, as ``resource`` describes it.

    Args:
        entry: Its payload entry.
    """
    (width, height), components = entry["size"], entry["components"]
    levels = np.frombuffer(base64.b64decode(entry["data"]), np.uint8)
    levels = levels.reshape(height, width, components)[::-1]
    return encode_levels(np.repeat(levels, 3, axis=2) if components == 1 else levels, {})


def _buffer(data: NDArray[Any]) -> dict[str, Any]:
    kind = {"f": "float32", "i": "int32", "u": "uint32"}[data.dtype.kind]
    components = 1 if data.ndim == 1 else data.shape[1]
    return {
        "type": "buffer",
        "size": [len(data)],
        "components": components,
        "format": kind,
        "data": _base64(data.astype(f"<{kind[0]}4")),
    }


def _texture(texels: NDArray[np.float32], type: Texture) -> dict[str, Any]:
    if bool((texels[..., 3] == 1.0).all()):
        texels = texels[..., :3]  # without an alpha component, the texture's alpha reads as 1
    height, width, components = texels.shape[-3:]
    # Heights and distances are grey: one number stands for three equal components.
    grey = components == 3 and bool((texels[..., :1] == texels).all())
    name, stored = _narrowest(texels[..., :1] if grey else texels)
    deep = type.shape is TextureShape.VOLUME
    return {
        "type": str(type),
        "size": [width, height, texels.shape[0]] if deep else [width, height],
        "components": components,
        **({"grey": True} if grey else {}),
        "format": name,
        "data": _base64(stored),
    }


def _narrowest(texels: NDArray[np.float32]) -> tuple[str, NDArray[Any]]:
    """Return the smallest format without visible loss, and the data in it.

    Bytes if the values are bytes. Half floats (11 bits) if there are no more levels than a byte
    has, as in an 8-bit picture decoded to light. Otherwise single floats: heights and volumes are
    data, and normals computed from rounded ones show steps.
    """
    scaled = texels * np.float32(255.0)
    whole = np.rint(scaled)
    if texels.min() >= 0.0 and texels.max() <= 1.0 and float(np.abs(scaled - whole).max()) < 1e-3:
        return "rgba8", whole.astype(np.uint8)
    if float(np.abs(texels).max()) < 65504.0 and len(np.unique(texels)) <= LEVELS:
        return "float16", texels.astype("<f2")
    return "float32", texels.astype("<f4")


def _base64(data: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(data).tobytes()).decode("ascii")
