"""Reads OBJ: points, their colors, and polygons; materials and curves are left out.

Input: bytes. Output: a mesh.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.polygons.filling import filled
from distal.polygons.texts import numbers, text_of
from distal.polygons.triangles import SourceTriangles, checked, colored

_FACES: Final = (b"f", b"fo")  # the second one is that of the first versions


def read_obj(data: bytes, *, with_colors: bool = False) -> SourceTriangles:
    """Return the triangles of an OBJ file, with colors of points if they are wanted and there.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    points: list[list[float]] = []
    colors: list[list[float]] = []
    counts, lines, indices = array("q"), array("q"), array("q")
    for line, words in _lines(data):
        if words[0] == b"v":
            points.append(_numbers(words, line))
            if with_colors and len(words) == 7:  # with x, y, z: red, green, blue
                colors.append([_color(word, line) for word in words[4:7]])
        elif words[0] in _FACES:
            if len(words) < 4:
                raise LoadError(f"line {line}: a polygon needs three points")
            counts.append(len(words) - 1)
            lines.append(line)
            indices.extend([_index(word, len(points), line) for word in words[1:]])
    if not counts:
        raise LoadError("there is no polygon")
    corners, sizes = np.array(indices, np.int64), np.array(counts, np.int64)
    missing = np.flatnonzero(corners >= len(points))
    if len(missing):
        row = int(np.searchsorted(np.cumsum(sizes), missing[0], "right"))
        raise LoadError(
            f"line {lines[row]}: there is no point {corners[missing[0]] + 1}, "
            f"the file has {len(points)}"
        )
    places = np.array(points, np.float64).reshape(-1, 3)
    mesh = checked(places, filled(places, sizes, corners))
    if not colors or len(colors) != len(points):
        return mesh
    shown = np.array(colors, np.float32)
    return colored(mesh, np.clip(np.where(np.isfinite(shown), shown, 0.0), 0.0, 1.0))


def read_obj_points(data: bytes) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the points of an OBJ file and their normals: a vn for each v, in the same order.

    Raises:
        LoadError: A line is invalid; the message has its number.
    """
    rows: dict[bytes, list[list[float]]] = {b"v": [], b"vn": []}
    for line, words in _lines(data):
        if words[0] in rows:
            rows[words[0]].append(_numbers(words, line))
    points, normals = (np.array(rows[name], np.float64).reshape(-1, 3) for name in (b"v", b"vn"))
    return points, normals


def _lines(data: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Yield the number and the words of each line that has some, without comments.

    A backslash at the end continues a line, but not a comment: paths of Windows end in it, too.
    """
    begun: list[bytes] = []
    first = 0
    for number, line in enumerate(text_of(data).splitlines(), 1):
        text, mark, _ = line.partition(b"#")
        words = text.split()
        is_continued = not mark and bool(words) and words[-1].endswith(b"\\")
        if is_continued:
            words[-1] = words[-1][:-1]
        first = first if begun else number
        begun += filter(None, words)
        if not is_continued:
            if begun:
                yield first, begun
            begun = []
    if begun:
        yield first, begun


def _numbers(words: list[bytes], line: int) -> list[float]:
    """Return the three coordinates of a point or normal."""
    if len(words) < 4:
        what = "a point" if words[0] == b"v" else printable(words[0].decode("utf-8", "replace"))
        raise LoadError(f"line {line}: {what} needs three numbers")
    try:
        return numbers(words[1:4])
    except LoadError as error:
        raise LoadError(f"line {line}: {error.message}") from None


def _color(word: bytes, line: int) -> float:
    try:
        return float(word)
    except ValueError:
        shown = printable(word[:40].decode("utf-8", "replace"))
        raise LoadError(f"line {line}: '{shown}' is no number") from None


def _index(word: bytes, count: int, line: int) -> int:
    """Return the index of a corner: 1 is the first point, -1 the last one so far."""
    text = word.partition(b"/")[0]
    try:
        number = int(text)
    except ValueError:
        number = 0
    index = number - 1 if number > 0 else count + number
    if number == 0 or b"_" in text or not 0 <= index < 2**31:
        shown = printable(text[:20].decode("utf-8", "replace"))
        raise LoadError(f"line {line}: there is no point '{shown}'")
    return index
