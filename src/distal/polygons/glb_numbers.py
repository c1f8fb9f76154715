"""Numbers of a GLB file: checked entries of its JSON, and what its accessors hold.

Input: the two chunks of a file. Output: lists, whole numbers and arrays, or a ``LoadError``.

Source: glTF 2.0 Specification, Khronos; KHR_mesh_quantization.
"""

from __future__ import annotations

import base64
import binascii
import re
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError
from distal.foreign_files import need

COMPRESSED: Final = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
)
_COMPONENTS: Final = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS: Final = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# What a whole number that is normalized is divided by.
_LEVELS: Final = {5120: 127.0, 5121: 255.0, 5122: 32767.0, 5123: 65535.0}
_DATA: Final = re.compile(r"data:[^,]{0,200};base64,")


@dataclass(slots=True)
class GlbFile:
    """The two chunks of a file, and its other buffers by number."""

    content: dict[str, Any]
    data: bytes
    buffers: dict[int, bytes] = field(default_factory=dict)


def compressed(name: str) -> LoadError:
    """Return the error of a file that an extension compresses."""
    return LoadError(f"it is compressed by {name}: save it without compression")


def has_extension(item: dict[str, Any], name: str) -> bool:
    """Whether an item of the JSON uses an extension."""
    extensions = item.get("extensions", {})
    return isinstance(extensions, dict) and name in extensions


def scaled(file: GlbFile, number: Any, kind: str) -> NDArray[np.float64]:
    """Return the rows of an accessor as numbers: whole ones that are normalized from -1 to 1."""
    values = accessor(file, number, kind)
    need(values.size * 8, f"{len(values):,} rows of accessor {number}")
    rows = values.astype(np.float64)
    item = entry(file.content, "accessors", number)
    if item.get("normalized") is True and item["componentType"] in _LEVELS:
        return np.maximum(rows / _LEVELS[item["componentType"]], -1.0)
    return rows


def accessor(file: GlbFile, number: Any, kind: str) -> NDArray[Any]:
    """Return the rows of an accessor, (count, width)."""
    item = entry(file.content, "accessors", number)
    component = item.get("componentType")
    if item.get("type") != kind or component not in _COMPONENTS:
        raise LoadError(f"accessor {number} is no {kind} of numbers")
    if kind == "SCALAR" and np.dtype(_COMPONENTS[component]).kind != "u":
        raise LoadError(f"accessor {number} has indices that are no whole numbers from 0")
    dtype, width = np.dtype(_COMPONENTS[component]), _WIDTHS[kind]
    count = whole(item, "count", None)
    where = f"accessor {number}"
    if "bufferView" in item:
        rows = _rows(file, item, dtype, width, count, where)
    else:
        need(count * width * dtype.itemsize, f"{count:,} zeros of {where}")
        rows = np.zeros((count, width), dtype)
    if "sparse" not in item:
        return rows
    sparse = item["sparse"]
    parts = [sparse.get(key) if isinstance(sparse, dict) else None for key in ("indices", "values")]
    indices, values = parts
    if not isinstance(indices, dict) or not isinstance(values, dict):
        raise LoadError(f"{where} is sparse without indices or values")
    if indices.get("componentType") not in (5121, 5123, 5125):
        raise LoadError(f"{where} is sparse, and its indices are no whole numbers")
    changed = whole(sparse, "count", None)
    places = np.dtype(_COMPONENTS[indices["componentType"]])
    at = _rows(file, indices, places, 1, changed, where).reshape(-1)
    if len(at) and int(at.max()) >= count:
        raise LoadError(f"{where} changes its row {at.max()} of {count}")
    need(2 * rows.size * dtype.itemsize, f"{count:,} rows of {where}")
    rows = rows.copy()
    rows[at] = _rows(file, values, dtype, width, changed, where)
    return rows


def _rows(
    file: GlbFile, item: dict[str, Any], dtype: np.dtype[Any], width: int, count: int, where: str
) -> NDArray[Any]:
    """Return rows of numbers of a view, (count, width).

    Args:
        file: The file.
        item: What names the view, and where its rows begin in it.
        dtype: The type of its numbers.
        width: How many a row has.
        count: The number of rows.
        where: What they are, for messages.
    """
    view = entry(file.content, "bufferViews", item.get("bufferView"))
    for name in COMPRESSED:
        if has_extension(view, name):
            raise compressed(name)
    data = _buffer(file, view.get("buffer"))
    size = dtype.itemsize * width
    stride = whole(view, "byteStride", size)
    first = whole(view, "byteOffset", 0)
    begin = first + whole(item, "byteOffset", 0)
    end = min(len(data), first + whole(view, "byteLength", len(data)))
    last = begin + (count - 1) * stride + size if count else begin
    if stride < size or last > len(data):
        raise LoadError(f"it is truncated: {where} goes beyond the numbers")
    if last > end:
        raise LoadError(f"{where} goes beyond its part of the buffer")
    if count == 0:
        return np.zeros((0, width), dtype)
    return np.ndarray((count, width), dtype, data, begin, (stride, dtype.itemsize))


def _buffer(file: GlbFile, number: Any) -> bytes:
    """Return the bytes of a buffer: the second chunk, or what is in the JSON."""
    item = entry(file.content, "buffers", number)
    uri = item.get("uri")
    if uri is None:
        if number != 0:
            raise LoadError(f"its buffer {number} has no numbers")
        return file.data
    if number not in file.buffers:
        head = _DATA.match(uri) if isinstance(uri, str) else None
        if head is None:
            raise LoadError("its numbers are in another file: save it as one file")
        try:
            file.buffers[number] = base64.b64decode(uri[head.end() :], validate=True)
        except (binascii.Error, ValueError):
            raise LoadError(f"the text of its buffer {number} is damaged") from None
    return file.buffers[number]


# Checked entries of the JSON


def list_of(mapping: dict[str, Any], key: str) -> list[Any]:
    """Return a list of the JSON; an empty one if it is not there."""
    found = mapping.get(key, [])
    if not isinstance(found, list):
        raise LoadError(f"'{key}' in its JSON is no list")
    return found


def entry(content: dict[str, Any], key: str, number: Any) -> dict[str, Any]:
    """Return an object of a list of the JSON."""
    entries = list_of(content, key)
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(entries):
        raise LoadError(f"'{key}' in its JSON has no item {number!r:.20}")
    item = entries[number]
    if not isinstance(item, dict):
        raise LoadError(f"item {number} of '{key}' in its JSON is no object")
    return item


def whole(mapping: dict[str, Any], key: str, default: int | None) -> int:
    """Return a count or place of the JSON."""
    value = mapping.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**40:
        raise LoadError(f"'{key}' in its JSON is no count")
    return value


def numbers_of(
    mapping: dict[str, Any], key: str, count: int, default: tuple[float, ...]
) -> NDArray[np.float64]:
    """Return a list of so many numbers of the JSON."""
    values = mapping.get(key, default)
    known = isinstance(values, list | tuple) and len(values) == count
    if not known or not all(type(v) in (int, float) and abs(v) < 1e30 for v in values):
        raise LoadError(f"'{key}' in its JSON is not {count} numbers")
    return np.array(values, np.float64)
