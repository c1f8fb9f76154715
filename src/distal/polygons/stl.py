"""Reads STL: binary and text.

Input: bytes. Output: a mesh whose equal corners are joined.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.diagnostics import LoadError, printable
from distal.polygons.texts import line_of, numbers, text_of
from distal.polygons.triangles import SourceTriangles, checked, welded

_HEADER: Final = 84
_RECORD: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
_LOOK: Final = 512  # bytes in which binary files have a zero
_BEGIN: Final = re.compile(rb"(?:^|[\r\n])[ \t]*(?:solid|facet)\b", re.I)
# The line that names a solid may contain any words, but a file may be one line, too.
_NAME: Final = re.compile(
    rb"(?:^|(?<=[\r\n]))[^\S\r\n]*(?:end[ \t]*)?solid\b[^\r\n]*?"
    rb"(?=facet\s+normal(?:\s+[-+.\dein]+){3}\s|[\r\n]|$)",
    re.I,
)
_END: Final = re.compile(rb"\bend[ \t]*solid\b", re.I)
_FACET: Final = re.compile(
    rb"\bloop" + 3 * rb"\s+vertex\s+(\S+)\s+(\S+)\s+(\S+)" + rb"\s+end[ \t]*loop\b", re.I
)
_LOOP: Final = re.compile(rb"\bouter\s+loop\b", re.I)
_LOOP_END: Final = re.compile(rb"\bend[ \t]*loop\b", re.I)
_VERTEX: Final = re.compile(rb"\bvertex\b", re.I)


def read_stl(data: bytes) -> SourceTriangles:
    """Return the triangles of an STL file.

    Raises:
        LoadError: The file is no STL, or is truncated.
    """
    count = int.from_bytes(data[80:84], "little") if len(data) >= _HEADER else 0
    size = _HEADER + count * _RECORD.itemsize
    # Some programs begin binary files with "solid" too, so the size decides first.
    if len(data) < _HEADER or len(data) != size:
        text = text_of(data)
        if b"\0" not in text[:_LOOK]:
            return _text(text)
    if len(data) < _HEADER:
        raise LoadError("it is neither binary STL, which has 84 bytes or more, nor text")
    there, rest = divmod(len(data) - _HEADER, _RECORD.itemsize)
    if there < count:
        raise LoadError(f"it announces {count} triangles and contains {there}: it is truncated")
    if there > count and rest == 0 and any(data[size:]):
        raise LoadError(
            f"it announces {count} triangles and contains {there}: its count is wrong, "
            "save it again"
        )
    if count == 0:
        raise LoadError("there is no triangle")
    return _mesh(np.frombuffer(data, _RECORD, count, _HEADER)["corners"])


def _text(data: bytes) -> SourceTriangles:
    if not _BEGIN.search(data, 0, 4096):
        begin = printable(data.strip()[:40].decode("utf-8", "replace"))
        raise LoadError(f"it is neither binary STL nor its text: it begins with '{begin}'")
    # As long as the file, so that places in it are those of the file.
    body = _NAME.sub(lambda name: b" " * len(name[0]), data)
    facets = _FACET.findall(body)
    if 3 * len(facets) != len(_VERTEX.findall(body)):
        raise LoadError(_wrong_facet(body))
    if not _END.search(data, body.lower().rfind(b"loop") + 1):
        corners = 3 * len(facets)
        raise LoadError(f"it has no 'endsolid' behind its {corners} corners: it is truncated")
    if not facets:
        raise LoadError("there is no triangle")
    try:
        values = numbers([word for facet in facets for word in facet])
    except LoadError:
        raise LoadError(_wrong_number(body)) from None
    with np.errstate(over="ignore"):  # ``checked`` finds what is not finite
        corners32 = np.array(values).astype(np.float32)
    return _mesh(corners32)


def _wrong_facet(body: bytes) -> str:
    """Return what is wrong with the first loop that is no triangle."""
    for loop in _LOOP.finditer(body):
        if _FACET.match(body, loop.end() - 4):
            continue
        end = _LOOP_END.search(body, loop.end())
        if end is None:
            break
        count = len(_VERTEX.findall(body, loop.end(), end.start()))
        line = line_of(body, loop.start())
        if count == 3:
            return f"line {line}: the corners of this loop are not three numbers each"
        return f"line {line}: this loop has {count} corners, and STL has triangles only"
    return f"it ends after {len(_VERTEX.findall(body))} corners: it is truncated"


def _wrong_number(body: bytes) -> str:
    """Return what is wrong with the first number that is none."""
    for facet in _FACET.finditer(body):
        for group in range(1, 10):
            try:
                numbers([facet[group]])
            except LoadError as error:
                return f"line {line_of(body, facet.start(group))}: {error.message}"
    raise AssertionError("all are numbers")


def _mesh(corners: NDArray[np.float32]) -> SourceTriangles:
    points, which = welded(corners.reshape(-1, 3))
    return checked(points, which.reshape(-1, 3))
