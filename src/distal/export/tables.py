"""Numbers as entries of a payload: base64, little-endian. Needs the standard library alone.

Input: numbers. Output: the JSON of a buffer, or of the texture that a host fills.
"""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping
from typing import Any

from distal.ir.types import INT, UINT, Buffer, Texture
from distal.lang.live_textures import LiveTexture
from distal.lang.values import VectorValue
from distal.render.live_film import FILM


def table(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Return the payload entry of a buffer for a table of the program."""
    values, kind = entry["values"], "int32" if entry["element"] == "int" else "float32"
    rows = values if values and isinstance(values[0], list | tuple) else [(v,) for v in values]
    flat = [number for row in rows for number in row]
    data = struct.pack(f"<{len(flat)}{kind[0]}", *flat)
    return {
        "type": "buffer",
        "size": [len(rows)],
        "components": len(rows[0]) if rows else 1,
        "format": kind,
        "data": base64.b64encode(data).decode("ascii"),
    }


def plain_resource(source: Any, type: Texture | Buffer) -> dict[str, Any] | None:
    """Return the payload entry of an author's list of numbers, or of a texture that a host fills.

    Args:
        source: The ``Buffer`` or texture.
        type: Its type.

    Returns:
        The entry; None for all that needs NumPy: files, arrays, pictures, numbers out of range.
    """
    if source is FILM or isinstance(source, LiveTexture):
        texel = base64.b64encode(bytes(4)).decode("ascii")
        entry = {"type": str(type), "size": [1, 1], "components": 4, "format": "rgba8"}
        return {**entry, "data": texel}
    data = source.data
    if isinstance(type, Texture) or not isinstance(data, list | tuple) or type.element == UINT:
        return None
    values = [tuple(v) if isinstance(v, list | tuple | VectorValue) else v for v in data]
    try:
        return table({"values": values, "element": "int" if type.element == INT else "float"})
    except (struct.error, OverflowError):
        return None
