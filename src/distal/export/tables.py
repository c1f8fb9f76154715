"""Numbers as entries of a payload: base64, little-endian. Needs the standard library alone.

Input: numbers. Output: the JSON of a buffer.
"""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping
from typing import Any


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
