"""Reads PLY: polygons and strips, as text and binary, little and big endian.

Properties of other programs are left out.

Input: bytes. Output: a mesh.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.foreign_files import check_time, need
from distal.polygons.filling import filled, strips
from distal.polygons.texts import line_of, numbers, text_of
from distal.polygons.triangles import SourceTriangles, checked, colored

_TYPES: Final = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_MOST_ROWS: Final = 100_000_000
_ORIENTED: Final = ("x", "y", "z", "nx", "ny", "nz")
_COLORS: Final = ("red", "green", "blue")
_LOOK: Final = 2**14  # rows between two looks at the budget
_LIST_BYTES: Final = 200  # of a list, without its numbers
_INDICES: Final = ("vertex_indices", "vertex_index")
_STRIPS: Final = "tristrips"
_KEPT: Final = {*_ORIENTED, *_COLORS}  # what is no list and is read of rows of different lengths
_END: Final = re.compile(rb"(?<=[\r\n])end_header[ \t]*(\r\n|\r|\n|$)")


@dataclass(slots=True)
class _Property:
    name: str
    type: str
    count: str = ""  # the type of a list's length; "" if it is no list


@dataclass(slots=True)
class _Element:
    name: str
    rows: int
    properties: list[_Property] = field(default_factory=list)


@dataclass(slots=True)
class _Rest:
    """The rest of the file after the header."""

    data: bytes
    order: str
    at: int = 0
    words: list[bytes] | None = None  # the numbers of a text file
    text: bytes = b""  # in which they are

    def line(self, number: int) -> int:
        """Return the line of one of the words."""
        word = next(islice(re.finditer(rb"\S+", self.text), number, None))
        return line_of(self.data, len(self.data) - len(self.text) + word.start())


def read_ply(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of a PLY file, with colors if they are wanted and there.

    Raises:
        LoadError: The file is no PLY, is truncated, or has no points or polygons.
    """
    elements, reader = _header(data)
    points: NDArray[np.float64] | None = None
    faces: tuple[NDArray[np.int64], NDArray[np.int64]] | None = None
    striped: NDArray[np.int64] | None = None
    shades: dict[str, NDArray[np.float32]] = {}
    for element in elements:
        columns = _columns(element, reader)
        shown = _colors(element, columns) if with_colors else None
        if shown is not None:
            shades[element.name] = shown
        if element.name == "vertex":
            missing = [axis for axis in "xyz" if not _is_plain(element, axis)]
            if missing:
                raise LoadError(f"its points have no {missing[0]}")
            points = np.stack([columns[axis] for axis in "xyz"], axis=1).astype(np.float64)
        elif element.name == "face":
            faces = _corners(element, columns)
        elif element.name == _STRIPS:
            striped = strips(*_corners(element, columns))
    if points is None:
        raise LoadError("it has no points")
    triangles = [] if faces is None else [filled(points, *faces)]
    triangles += [] if striped is None else [striped]
    if not sum(map(len, triangles)):
        raise LoadError("it has points only, no polygons")
    mesh = checked(points, np.concatenate(triangles))
    if faces is not None and "face" in shades:
        # Strips have no colors of their own.
        white = np.ones((len(mesh.triangles) - len(triangles[0]), 3), np.float32)
        rows = np.repeat(shades["face"], np.maximum(faces[0] - 2, 0), axis=0)
        return colored(mesh, np.concatenate([rows, white]), of="triangles")
    return colored(mesh, shades["vertex"]) if "vertex" in shades else mesh


def _corners(
    element: _Element, columns: dict[str, Any]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the lengths and the numbers of an element's lists of points."""
    name = next((name for name in _INDICES if name in columns), None)
    if name is None or _is_plain(element, name):
        what = "strips" if element.name == _STRIPS else "polygons"
        raise LoadError(f"its {what} have no lists vertex_indices")
    lengths, values = columns[name]
    if values.dtype.kind == "f" and not (values == np.rint(values)).all():
        raise LoadError("an index of a point is no whole number")
    if not (np.abs(values.astype(np.float64)) < 2.0**31).all():
        raise LoadError("an index of a point is no 32-bit number")
    return lengths, values.astype(np.int64)


def _is_plain(element: _Element, name: str) -> bool:
    """Whether an element has a property of this name that is no list."""
    return [each.count for each in element.properties if each.name == name] == [""]


def _colors(element: _Element, columns: dict[str, Any]) -> NDArray[np.float32] | None:
    """Return the colors of an element's rows, display values from 0 to 1; None without them."""
    if not all(_is_plain(element, name) for name in _COLORS):
        return None
    found = np.stack([columns[name] for name in _COLORS], axis=1).astype(np.float32)
    types = {each.type for each in element.properties if each.name in _COLORS}
    most = {"u1": 255.0, "u2": 65535.0}.get(min(types), 1.0)
    shown: NDArray[np.float32] = np.clip(np.nan_to_num(found / np.float32(most)), 0.0, 1.0)
    return shown


def read_ply_points(data: bytes) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the points of a PLY file and their normals.

    Raises:
        LoadError: The file is no PLY, is truncated, or has no points with normals.
    """
    elements, reader = _header(data)
    for element in elements:
        columns = _columns(element, reader)
        if element.name == "vertex":
            missing = [name for name in _ORIENTED if not _is_plain(element, name)]
            if missing:
                raise LoadError(f"its points have no {missing[0]}")
            found = np.stack([columns[name] for name in _ORIENTED], axis=1).astype(np.float64)
            return found[:, :3], found[:, 3:]
    raise LoadError("it has no points")


def _header(data: bytes) -> tuple[list[_Element], _Rest]:
    data = text_of(data)
    end = _END.search(data, 0, 65536)
    if not data.startswith(b"ply") or end is None:
        raise LoadError("it does not begin with the header of PLY")
    begin = end.end()
    # Where lines end in CR alone, a LF is the first byte of the numbers.
    if end[1] == b"\r\n" and data[3:5] != b"\r\n" and data[3:4] == b"\r":
        begin -= 1
    order: str | None = None
    elements: list[_Element] = []
    for line in data[: end.start()].decode("ascii", "replace").splitlines()[1:]:
        match line.split():
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, rows] if rows.isdecimal() and int(rows) <= _MOST_ROWS:
                elements.append(_Element(name, int(rows)))
            case ["property", "list", count, type, name] if (
                elements and type in _TYPES and _TYPES.get(count, "f")[0] != "f"
            ):
                elements[-1].properties.append(_Property(name, _TYPES[type], _TYPES[count]))
            case ["property", type, name] if elements and type in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[type]))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise LoadError(f"its header has the invalid line '{line:.60}'")
    if order is None:
        raise LoadError("its header names no format")
    reader = _Rest(data, order, begin)
    if not order:
        reader.text = data[begin:]
        reader.words, reader.at = reader.text.split(), 0
    return elements, reader


def _columns(element: _Element, reader: _Rest) -> dict[str, Any]:
    """Return an array for each property; a list is (lengths, values)."""
    if not element.properties and element.rows == 0:
        return {}
    if not element.properties:
        raise LoadError(f"'{element.name:.20}' has no properties")
    if reader.words is not None:
        return _text_columns(element, reader, reader.words)
    if not any(each.count for each in element.properties):
        rows = _take(reader, element, np.dtype(_fields(element, reader.order, {})), element.rows)
        return {each.name: rows[each.name] for each in element.properties}
    lengths = _first_lengths(element, reader)
    if lengths is not None:
        dtype = np.dtype(_fields(element, reader.order, lengths))
        there = (len(reader.data) - reader.at) // dtype.itemsize
        if there >= element.rows:
            rows = np.frombuffer(reader.data, dtype, element.rows, reader.at)
            if all((rows[f"{n} count"] == length).all() for n, length in lengths.items()):
                reader.at += rows.nbytes
                return {p.name: _uniform(rows, p, lengths) for p in element.properties}
    return _row_by_row(element, reader)


def _fields(element: _Element, order: str, lengths: dict[str, int]) -> list[Any]:
    fields: list[Any] = []
    for each in element.properties:
        if each.count:
            fields.append((f"{each.name} count", order + each.count))
            fields.append((each.name, order + each.type, (lengths[each.name],)))
        else:
            fields.append((each.name, order + each.type))
    names = [entry[0] for entry in fields]
    if len(set(names)) != len(names) or not names:
        raise LoadError(f"the properties of '{element.name:.20}' have no names of their own")
    return fields


def _uniform(rows: NDArray[Any], each: _Property, lengths: dict[str, int]) -> Any:
    if not each.count:
        return rows[each.name]
    counts = np.full(len(rows), lengths[each.name], np.int64)
    return counts, rows[each.name].reshape(-1)


def _first_lengths(element: _Element, reader: _Rest) -> dict[str, int] | None:
    """Return the lengths of the lists of the first row; None without rows."""
    if element.rows == 0:
        return None
    at, lengths = reader.at, {}
    for each in element.properties:
        if each.count:
            length = int(_number(reader, at, each.count))
            if not 0 <= length < 1024:
                return None
            lengths[each.name] = length
            at += np.dtype(each.count).itemsize + length * np.dtype(each.type).itemsize
        else:
            at += np.dtype(each.type).itemsize
    return lengths


def _row_by_row(element: _Element, reader: _Rest) -> dict[str, Any]:
    """Read rows whose lists differ in length; of what is no list, that of ``_KEPT``."""
    lengths: dict[str, list[int]] = {each.name: [] for each in element.properties if each.count}
    values: dict[str, list[NDArray[Any]]] = {name: [] for name in lengths}
    plain: dict[str, list[float]] = {
        each.name: [] for each in element.properties if not each.count and each.name in _KEPT
    }
    for row in range(element.rows):
        if row % _LOOK == 0:
            check_time()
            count = len(lengths) + len(plain)
            need(row * count * _LIST_BYTES, f"{row:,} rows of lists of different lengths")
        for each in element.properties:
            if not each.count:
                if each.name in plain:
                    plain[each.name].append(_number(reader, reader.at, each.type))
                reader.at += np.dtype(each.type).itemsize
                continue
            length = int(_number(reader, reader.at, each.count))
            reader.at += np.dtype(each.count).itemsize
            if length < 0:
                raise LoadError(f"a list of '{element.name:.20}' has a negative length")
            lengths[each.name].append(length)
            dtype = np.dtype(reader.order + each.type)
            values[each.name].append(_take(reader, element, dtype, length))
    lists = {
        name: (
            np.array(lengths[name], np.int64),
            np.concatenate([np.zeros(0, "i1"), *values[name]]),
        )
        for name in lengths
    }
    return {**lists, **{name: np.array(rows, np.float64) for name, rows in plain.items()}}


def _number(reader: _Rest, at: int, type: str) -> Any:
    dtype = np.dtype(reader.order + type)
    if at + dtype.itemsize > len(reader.data):
        raise LoadError("it is truncated")
    return np.frombuffer(reader.data, dtype, 1, at)[0]


def _take(reader: _Rest, element: _Element, dtype: np.dtype[Any], count: int) -> NDArray[Any]:
    if reader.at + count * dtype.itemsize > len(reader.data):
        raise LoadError(f"it is truncated: '{element.name:.20}' has {element.rows} rows")
    rows = np.frombuffer(reader.data, dtype, count, reader.at)
    reader.at += rows.nbytes
    return rows


def _text_columns(element: _Element, reader: _Rest, words: list[bytes]) -> dict[str, Any]:
    columns: dict[str, list[float]] = {each.name: [] for each in element.properties}
    lengths: dict[str, list[int]] = {e.name: [] for e in element.properties if e.count}
    at = reader.at
    try:
        for _ in range(element.rows):
            for each in element.properties:
                length = 1
                if each.count:
                    length = int(words[at])
                    lengths[each.name].append(length)
                    at += 1
                if length < 0 or at + length > len(words):
                    raise IndexError
                columns[each.name] += map(float, words[at : at + length])
                at += length
    except IndexError:
        message = f"it is truncated: '{element.name:.20}' has {element.rows} rows"
        raise LoadError(message) from None
    except ValueError:
        raise _wrong_word(words, reader, at) from None
    if b"_" in b"".join(words[reader.at : at]):  # Python reads these in numbers
        raise _wrong_word(words, reader, reader.at)
    reader.at = at
    return {
        name: (np.array(lengths[name], np.int64), values) if name in lengths else values
        for name, values in ((n, np.array(v, np.float64)) for n, v in columns.items())
    }


def _wrong_word(words: list[bytes], reader: _Rest, begin: int) -> LoadError:
    """Return the error of the first word that is no number."""
    for at in range(begin, len(words)):
        try:
            float(words[at])
        except ValueError:
            break
        if b"_" in words[at]:
            break
    else:
        at = begin  # the length of a list
    try:
        numbers([words[at]])
    except LoadError as error:
        return LoadError(f"line {reader.line(at)}: {error.message}")
    shown = printable(words[at][:20].decode("ascii", "replace"))
    return LoadError(f"line {reader.line(at)}: '{shown}' is no length of a list")
