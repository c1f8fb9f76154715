"""Variants of mesh files as programs write them, with what is right for each.

Output: ``VARIANTS``: bytes, and the triangles that they hold, or words of the reason for which they
are refused. ``test_mesh_variants`` gives them to distal's readers, ``tools/weigh_readers.py`` also to
those of libraries.
"""

# ruff: noqa: E501, UP031, RUF005 -- a table of texts, and sums of arrays

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Triangles = NDArray[np.float64]

# A box that differs along each axis, and is not about the origin.
POINTS = np.array([(x, y, z) for z in (0.25, 3.25) for y in (0, 2) for x in (0.5, 1.5)])
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
FACES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])
BOX: Triangles = POINTS[FACES]
TETRA_POINTS = np.array([(0.0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)])
TETRA_FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
TETRA: Triangles = TETRA_POINTS[np.array(TETRA_FACES)]


@dataclass(frozen=True)
class Variant:
    """A file.

    Attributes:
        name: What is special about it.
        suffix: That of its name.
        data: Its bytes.
        right: The triangles that it holds; None if it must be refused.
        reason: Words of the reason, if it may be refused.
    """

    name: str
    suffix: str
    data: bytes
    right: Triangles | None
    reason: str = ""


def moments(triangles: Triangles) -> NDArray[np.float64]:
    """Return integrals over a surface that do not depend on how its polygons are divided."""
    a, b, c = (triangles[:, i] for i in range(3))
    normals = np.cross(b - a, c - a) / 2
    areas = np.linalg.norm(normals, axis=1)
    first = areas[:, None] * (a + b + c) / 3
    middles = [(a + b) / 2, (b + c) / 2, (c + a) / 2]
    second = sum(areas[:, None] * m * np.roll(m, 1, axis=1) for m in middles) / 3
    squares = sum(areas[:, None] * m * m for m in middles) / 3
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    return np.concatenate(
        [[areas.sum(), volume], normals.sum(0), first.sum(0), second.sum(0), squares.sum(0)]
    )


def is_right(found: Triangles, right: Triangles) -> bool:
    """Whether two surfaces are the same to the accuracy of float32."""
    expected = moments(right)
    return bool(np.abs(moments(found) - expected).max() < 2e-5 * np.abs(expected).max())


VARIANTS: list[Variant] = []


def _add(
    suffix: str, name: str, data: bytes | str, right: Triangles | None = BOX, reason: str = ""
) -> None:
    content = data.encode() if isinstance(data, str) else data
    VARIANTS.append(Variant(name, suffix, content, right, reason))


# STL


def _facets(triangles: Triangles, number: str = "%g") -> str:
    corner = f"      vertex {number} {number} {number}\n"
    return "".join(
        "  facet normal 0 0 0\n    outer loop\n"
        + "".join(corner % tuple(p) for p in each)
        + "    endloop\n  endfacet\n"
        for each in triangles.tolist()
    )


def _binary(triangles: Triangles, head: bytes = b"made", count: int | None = None) -> bytes:
    rows = np.zeros(len(triangles), [("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    rows["c"] = triangles
    rows["a"] = 0x7FFF
    announced = len(rows) if count is None else count
    return head.ljust(80, b" ") + struct.pack("<I", announced) + rows.tobytes()


def _stl() -> None:
    body = _facets(BOX)
    plain = f"solid x\n{body}endsolid x\n"
    one_line = plain.replace("endsolid x\n", "endsolid").replace("\n", " ")

    def add(name: str, data: bytes | str, **more: Any) -> None:
        _add(".stl", name, data, **more)

    add("text", plain)
    add("text, end of lines CRLF", plain.replace("\n", "\r\n"))
    add("text, end of lines CR", plain.replace("\n", "\r"))
    add("text, tabs", plain.replace("  ", "\t"))
    add("text, blanks behind lines", plain.replace("\n", "  \n"))
    add("text, no indentation", plain.replace("  ", ""))
    add("text, empty lines", plain.replace("\n", "\n\n"))
    add("text, upper case", plain.upper())
    add("text, mixed case", plain.replace("facet", "Facet").replace("vertex", "Vertex"))
    add("text, exponents", f"solid\n{_facets(BOX, '%.7E')}endsolid\n")
    add(
        "text, exponents of three digits",
        f"solid\n{_facets(BOX, '%.7e')}endsolid\n".replace("e+00", "e+000"),
    )
    add("text, plus signs", f"solid\n{_facets(BOX, '%+f')}endsolid\n")
    add("text, end solid", plain.replace("endsolid", "end solid"))
    add(
        "text, end facet, end loop",
        plain.replace("endfacet", "end facet").replace("endloop", "end loop"),
    )
    add("text, blank line first", "\n" + plain)
    add("text, blanks first", "   " + plain)
    add("text, byte order mark", b"\xef\xbb\xbf" + plain.encode())
    add("text, UTF-16", plain.encode("utf-16"), right=None, reason="UTF-16")
    add("text, no name", plain.replace("solid x", "solid"))
    add("text, no name at the end", plain.replace("endsolid x\n", "endsolid"))
    add("text, name in Latin-1", plain.replace("solid x", "solid pi\xe8ce").encode("latin-1"))
    add(
        "text, name with words of the format",
        plain.replace("solid x", "solid vertex 1 2 3 facet endsolid"),
    )
    add("text, named 'facet normal'", plain.replace("solid x", "solid facet normal thing"))
    add("text, name of 2000 letters", plain.replace("solid x\n", "solid " + "n" * 2000 + "\n", 1))
    add(
        "text, two solids",
        f"solid a\n{_facets(BOX[:6])}endsolid a\nsolid b\n{_facets(BOX[6:])}endsolid b\n",
    )
    add("text, an empty solid and one", f"solid a\nendsolid a\nsolid b\n{body}endsolid b\n")
    add(
        "text, normals that are no numbers",
        plain.replace("normal 0 0 0", "normal nan -nan(ind) 1.#IND"),
    )
    add("text, no word normal", plain.replace(" normal 0 0 0", ""))
    add("text, one line", one_line)
    add(
        "text, a line for each facet",
        plain.replace("\n    ", " ").replace("\n  endf", " endf").replace("  vertex", "vertex"),
    )
    add("text, no endsolid", plain.replace("endsolid x\n", ""), right=None, reason="endsolid")
    add("text, ends in a facet", plain[: len(plain) // 2], right=None, reason="truncated")
    add(
        "text, loops of four corners",
        "solid\nfacet normal 0 0 1\nouter loop\n"
        + "".join("vertex %g %g %g\n" % tuple(POINTS[i]) for i in QUADS[1])
        + "endloop\nendfacet\nendsolid\n",
        right=POINTS[np.array([(4, 5, 7), (4, 7, 6)])],
        reason="line 3.*4 corners",
    )
    add(
        "text, loops of 2 and 4 corners",
        "solid\n"
        + "".join(
            "facet\nouter loop\n" + "vertex 0 0 1\n" * n + "endloop\nendfacet\n" for n in (2, 4)
        )
        + "endsolid\n",
        right=None,
        reason="line 3: ",
    )
    add("text, decimal commas", plain.replace("3.25", "3,25"), right=None, reason="line 18.*3,25")
    add(
        "text, a corner that is no number",
        plain.replace("3.25", "nan"),
        right=None,
        reason="line 18.*nan",
    )
    add("text, nothing in it", "solid Empty\nendsolid Empty", right=None, reason="no triangle")
    add(
        "a page of a site",
        "<!DOCTYPE html><html><body>" + "not here " * 20 + "</body></html>",
        right=None,
        reason="text",
    )
    add("binary", _binary(BOX))
    add("binary, header begins with solid", _binary(BOX, b"solid facet normal"))
    add("binary, header of zeros", _binary(BOX, bytes(80)))
    add("binary, header with a newline and solid", _binary(BOX, b"\nsolid x\nfacet"))
    add("binary, color in the header", _binary(BOX, b"COLOR=\xff\x00\x00\xff,MATERIAL="))
    add("binary, two bytes behind", _binary(BOX) + b"\r\n")
    add("binary, begins with solid, bytes behind", _binary(BOX, b"solid x") + b"\r\n")
    add("binary, 4096 zeros behind", _binary(BOX) + bytes(4100))
    add("binary, too large a count", _binary(BOX, count=13), right=None, reason="announces 13")
    add("binary, too small a count", _binary(BOX, count=6), right=None, reason="announces 6")
    add("binary, count of zero", _binary(BOX, count=0), right=None, reason="announces 0")
    add("binary, the largest count", _binary(BOX, count=2**32 - 1), right=None, reason="announces")
    add("binary, truncated", _binary(BOX)[:-30], right=None, reason="truncated")
    add(
        "binary, not a number",
        _binary(np.where(BOX == 3.25, np.nan, BOX)),
        right=None,
        reason="nan",
    )
    add("binary, infinite", _binary(np.where(BOX == 3.25, np.inf, BOX)), right=None, reason="inf")


# OBJ

V = "".join("v %g %g %g\n" % tuple(p) for p in POINTS)
F = "".join("f %d %d %d %d\n" % tuple(i + 1 for i in q) for q in QUADS)
VN = "vn 0 0 1\nvn 1 0 0\n"
VT = "vt 0 0\nvt 1 0\n"


def prism_of(
    outline: list[tuple[float, float]], pieces: list[tuple[int, ...]]
) -> tuple[str, Triangles]:
    """Return the OBJ of a prism with polygons as caps, and its triangles.

    Args:
        outline: The corners of its base, counterclockwise.
        pieces: Triangles that fill it.
    """
    n = len(outline)
    places = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in outline])
    rows = [(a, c, b) for a, b, c in pieces] + [(a + n, b + n, c + n) for a, b, c in pieces]
    text = "".join("v %.9g %.9g %.9g\n" % tuple(p) for p in places)
    text += "f " + " ".join(str(i + 1) for i in reversed(range(n))) + "\n"
    text += "f " + " ".join(str(i + 1 + n) for i in range(n)) + "\n"
    for i in range(n):
        j = (i + 1) % n
        rows += [(i, j, j + n), (i, j + n, i + n)]
        text += f"f {i + 1} {j + 1} {j + n + 1} {i + n + 1}\n"
    return text, places[np.array(rows)]


M_SHAPE = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5), (0.0, 2.0)]
M_PIECES = [(0, 1, 3), (1, 2, 3), (0, 3, 4)]
# A square with a square hole, whose outline goes in and out over one edge.
RING = [(0.0, 0.0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
RING_PIECES = [
    (0, 1, 8),
    (0, 8, 9),
    (1, 2, 8),
    (8, 2, 7),
    (2, 3, 7),
    (7, 3, 6),
    (3, 4, 6),
    (6, 4, 5),
]
# A comb with points along its straight edges.
COMB = [(0.0, 0.0), (1, 0), (2, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)]
COMB_PIECES = [
    (0, 1, 7),
    (0, 7, 10),
    (10, 7, 8),
    (10, 8, 9),
    (1, 2, 6),
    (1, 6, 7),
    (2, 3, 4),
    (2, 4, 6),
    (6, 4, 5),
]


def _obj() -> None:
    def add(name: str, data: bytes | str, **more: Any) -> None:
        _add(".obj", name, data, **more)

    plain = V + F

    def faces(write: Any) -> str:
        return "".join("f " + " ".join(write(i) for i in q) + "\n" for q in QUADS)

    add("quads", plain)
    add("end of lines CRLF", plain.replace("\n", "\r\n"))
    add("end of lines CR", plain.replace("\n", "\r"))
    add("byte order mark", b"\xef\xbb\xbf" + plain.encode())
    add("UTF-16", plain.encode("utf-16"), right=None, reason="UTF-16")
    add("indentation", plain.replace("v ", "  v ").replace("f ", "\tf "))
    add("tabs", plain.replace(" ", "\t"))
    add("blanks behind lines", plain.replace("\n", " \t\n"))
    add("comment behind faces", V + F.replace("\n", " # here\n") + "# end")
    add("comment behind points", plain.replace("\nv", " # here 1 2\nv"))
    add("comment without a blank", V + F.replace("\n", "#1\n"))
    add("comment that ends in a backslash", "# C:\\models\\\n" + plain)
    add("comment in Latin-1", "# pi\xe8ce\n".encode("latin-1") + plain.encode())
    add("empty lines", "\n\n" + plain.replace("\n", "\n\n"))
    add("no newline at the end", plain.rstrip())
    add("triangles", V + "".join("f %d %d %d\n" % tuple(f + 1) for f in FACES))
    add("v/t", V + VT + faces(lambda i: f"{i + 1}/1"))
    add("v/t/n", V + VT + VN + faces(lambda i: f"{i + 1}/2/1"))
    add("v//n", V + VN + faces(lambda i: f"{i + 1}//2"))
    add("v/ and v//", V + faces(lambda i: f"{i + 1}/").replace("/ ", "// "))
    add("negative indices", V + faces(lambda i: f"{i - 8}"))
    add("negative indices v//n", V + VN + faces(lambda i: f"{i - 8}//-1"))
    pairs = "".join(
        "".join("v %g %g %g\n" % tuple(POINTS[i]) for i in q) + "f -4 -3 -2 -1\n" for q in QUADS
    )
    add("negative indices between points", pairs)
    add("faces before points", F + V)
    add("continued lines", plain.replace("f ", "f \\\n"))
    add("continued lines CRLF", plain.replace("f ", "f \\\n").replace("\n", "\r\n"))
    add("a continued line in a number of words", V + F.replace(" 4 2\n", " \\\n  4 \\\n 2\n"))
    add(
        "objects and groups",
        "mtllib a.mtl\no one\n"
        + V
        + "g top side\ns off\nusemtl red\n"
        + F[:20]
        + "o two\ng\ns 1\n"
        + F[20:],
    )
    add(
        "points of two objects",
        "o a\n"
        + V
        + F
        + "o b\n"
        + "".join("v %g %g %g\n" % tuple(p + 5) for p in POINTS)
        + faces(lambda i: f"{i + 9}"),
        right=np.concatenate([BOX, BOX + 5]),
    )
    add("colors of points", V.replace("\n", " 1 0 .5\n") + F)
    add("weights of points", V.replace("\n", " 1.0\n") + F)
    add("exponents", "".join("v %.8E %+.8e %.3f\n" % tuple(p) for p in POINTS) + F)
    add("lines and points beside", plain + "p 1\nl 1 2 3\nl 1/1 2/1\n")
    add(
        "parameters, curves",
        "vp 0 0\n" + plain + "cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nparm u 0 1\nend\n",
    )
    add("faces by fo", plain.replace("f ", "fo "))
    add("a face with a corner twice", V + F.replace("f 1 3 4 2", "f 1 1 3 4 2 2"))
    for name, outline, pieces in (
        ("M", M_SHAPE, M_PIECES),
        ("ring with a bridge", RING, RING_PIECES),
        ("comb", COMB, COMB_PIECES),
    ):
        text, right = prism_of(outline, pieces)
        add(f"concave caps: {name}", text, right=right)
    text, right = prism_of(
        [(y, -x) for x, y in M_SHAPE[1:] + M_SHAPE[:1]],
        [tuple((i - 1) % 5 for i in p) for p in M_PIECES],
    )
    add("concave caps: M turned", text, right=right)
    add("a point that is no number", plain.replace("3.25", "nan", 1), right=None, reason="line 5")
    add("a point that is infinite", plain.replace("3.25", "1e999", 1), right=None, reason="line 5")
    add("decimal commas", plain.replace("3.25", "3,25"), right=None, reason="line 5")
    add("underscores in numbers", plain.replace("3.25", "3_2"), right=None, reason="line 5")
    add(
        "a face that names a missing point",
        V + F.replace("8", "9"),
        right=None,
        reason="line 10.*9",
    )
    add("a face that names point 0", V + F.replace("8", "0"), right=None, reason="line 10")
    add("a face that is no numbers", V + F.replace("8", "x"), right=None, reason="line 10")
    add("a face of two points", V + F + "f 1 2\n", right=None, reason="line 15")
    add(
        "an index that is far too large",
        V + F.replace("8", "99999999999999999999"),
        right=None,
        reason="line 10",
    )
    add("a point of two numbers", "v 1 2\n" + plain, right=None, reason="line 1")
    add("no face", V, right=None, reason="no polygon")


# PLY


def _ply_file(
    order: str = "ascii",
    *,
    point: tuple[str, ...] = ("float x", "float y", "float z"),
    face: tuple[str, ...] = ("list uchar int vertex_indices",),
    extra: str = "",
    faces: list[tuple[int, ...]] | None = None,
    name: str = "face",
    before: tuple[str, bytes | str] = ("", ""),
    tail: str = "",
    points: NDArray[np.float64] = POINTS,
    value: Any = 7,
) -> bytes:
    """Return a PLY file; properties other than x, y, z and the list have one value."""
    polygons = [tuple(q) for q in QUADS] if faces is None else faces
    head = f"ply\nformat {order} 1.0\n{extra}{before[0]}element vertex {len(points)}\n"
    head += "".join(f"property {each}\n" for each in point)
    head += f"element {name} {len(polygons)}\n" + "".join(f"property {each}\n" for each in face)
    head += f"{tail}end_header\n"
    codes = {
        "char": "b",
        "uchar": "B",
        "short": "h",
        "ushort": "H",
        "int": "i",
        "uint": "I",
        "float": "f",
        "double": "d",
        "int8": "b",
        "uint8": "B",
        "int16": "h",
        "uint16": "H",
        "int32": "i",
        "uint32": "I",
        "float32": "f",
        "float64": "d",
    }
    mark = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(order, "")
    out = head.encode()
    rest = before[1]
    out += rest.encode() if isinstance(rest, str) else rest

    def row(properties: tuple[str, ...], values: dict[str, Any]) -> bytes:
        words: list[str] = []
        data = b""
        for each in properties:
            *types, key = each.split()
            found = values.get(key, value)
            if types[0] == "list":
                found = found if isinstance(found, tuple) else (found,) * 3
                words += [str(len(found)), *map(str, found)]
                data += struct.pack(mark + codes[types[1]], len(found)) if mark else b""
                data += struct.pack(f"{mark}{len(found)}{codes[types[2]]}", *found) if mark else b""
            else:
                words.append(f"{found:g}")
                code = codes[types[0]]
                packed = found if code in "fd" else int(found)
                data += struct.pack(mark + code, packed) if mark else b""
        return data if mark else (" ".join(words) + "\n").encode()

    for place in points.tolist():
        out += row(point, dict(zip("xyz", place, strict=True)))
    for each in polygons:
        out += row(face, {key: each for key in ("vertex_indices", "vertex_index", "vertices")})
    return out


def _ply() -> None:
    def add(name: str, data: bytes | str, **more: Any) -> None:
        _add(".ply", name, data, **more)

    triangles = [tuple(f) for f in FACES.tolist()]
    mixed = [*[tuple(q) for q in QUADS[:3]], *triangles[6:]]
    orders = ("ascii", "binary_little_endian", "binary_big_endian")
    for order in orders:
        add(f"{order}: quads", _ply_file(order))
        add(f"{order}: triangles", _ply_file(order, faces=triangles))
        add(f"{order}: triangles and quads", _ply_file(order, faces=mixed))
        add(f"{order}: vertex_index", _ply_file(order, face=("list uint8 uint32 vertex_index",)))
        add(f"{order}: short indices", _ply_file(order, face=("list int16 uint16 vertex_indices",)))
        add(f"{order}: char indices", _ply_file(order, face=("list int char vertex_indices",)))
        add(f"{order}: int lengths", _ply_file(order, face=("list uint int vertex_indices",)))
        add(f"{order}: doubles", _ply_file(order, point=("double x", "float64 y", "double z")))
        add(
            f"{order}: integer points",
            _ply_file(order, point=("short x", "int y", "uchar z"), points=POINTS * 4 // 1),
            right=(POINTS * 4)[FACES],
        )
        add(
            f"{order}: z, y, x and others between",
            _ply_file(
                order,
                point=("uchar red", "float z", "double quality", "float y", "short s", "float x"),
            ),
        )
        add(
            f"{order}: other properties of faces",
            _ply_file(
                order,
                face=("uchar red", "list uchar int vertex_indices", "float quality"),
                faces=mixed,
            ),
        )
        add(
            f"{order}: a list before the indices",
            _ply_file(
                order,
                face=("list uchar float texcoord", "list uchar int vertex_indices"),
                faces=mixed,
            ),
        )
        add(
            f"{order}: a list behind the indices",
            _ply_file(
                order,
                face=(
                    "list uchar int vertex_indices",
                    "list uchar float texcoord",
                    "int texnumber",
                ),
            ),
        )
        add(
            f"{order}: a list in points",
            _ply_file(order, point=("float x", "list uchar int near", "float y", "float z")),
        )
        add(
            f"{order}: comments",
            _ply_file(
                order, extra="comment made by hand element vertex 3\nobj_info num_cols 5\ncomment\n"
            ),
        )
        add(f"{order}: a comment without ASCII", _ply_file(order, extra="comment pièce\n"))
        add(
            f"{order}: element behind",
            _ply_file(order, tail="element edge 0\nproperty int vertex1\nproperty int vertex2\n"),
        )
        add(
            f"{order}: strips",
            _ply_file(
                order,
                face=("list int int vertex_indices",),
                faces=[(0, 2, 1, 3, 0, 2)],
                name="tristrips",
                points=TETRA_POINTS,
            ),
            right=TETRA,
            reason="strip",
        )
        add(
            f"{order}: strips with ends",
            _ply_file(
                order,
                face=("list int int vertex_indices",),
                faces=[(0, 2, 1, -1, 0, 1, 3, -1, 0, 3, 2, 1, -1)],
                name="tristrips",
                points=TETRA_POINTS,
            ),
            right=TETRA,
            reason="strip",
        )
        add(
            f"{order}: strips in two rows",
            _ply_file(
                order,
                face=("list int int vertex_indices",),
                faces=[(0, 2, 1, 3), (2, 0, 3, 1)],
                name="tristrips",
                points=TETRA_POINTS,
            ),
            right=TETRA,
            reason="strip",
        )
        text, right = prism_of(M_SHAPE, M_PIECES)
        rows = [line.split() for line in text.splitlines()]
        places = np.array([[float(w) for w in r[1:]] for r in rows if r[0] == "v"])
        polygons = [tuple(int(w) - 1 for w in r[1:]) for r in rows if r[0] == "f"]
        add(f"{order}: concave caps", _ply_file(order, points=places, faces=polygons), right=right)
        add(
            f"{order}: not a number",
            _ply_file(order, points=np.where(POINTS == 3.25, np.nan, POINTS)),
            right=None,
            reason="nan",
        )
        add(
            f"{order}: a missing point",
            _ply_file(order, faces=[*triangles, (0, 1, 8)]),
            right=None,
            reason="point 8",
        )
        add(
            f"{order}: a negative index",
            _ply_file(order, faces=[*triangles, (0, 1, -1)]),
            right=None,
            reason="point -1",
        )
        add(f"{order}: truncated", _ply_file(order)[:-4], right=None, reason="truncated")
        add(
            f"{order}: points only",
            _ply_file(order, faces=[]).replace(
                b"element face 0\nproperty list uchar int vertex_indices\n", b""
            ),
            right=None,
            reason="points only",
        )
        add(
            f"{order}: no z",
            _ply_file(order, point=("float x", "float y", "float w")),
            right=None,
            reason="no z",
        )
    little = "binary_little_endian"
    camera = (
        "element camera 1\nproperty float view_px\nproperty float view_py\n",
        struct.pack("<2f", 1, 2),
    )
    add("element before points, binary", _ply_file(little, before=camera))
    add(
        "element before points, text",
        _ply_file(
            before=(
                "element camera 2\nproperty float a\nproperty list uchar int b\n",
                "1 2 5 6\n2 0\n",
            )
        ),
    )
    add("element without properties", _ply_file(extra="element nothing 0\n"))
    add("end of lines CRLF, text", _ply_file().replace(b"\n", b"\r\n"))
    add("end of lines CR, text", _ply_file().replace(b"\n", b"\r"))
    head, _, rest = _ply_file(little).partition(b"end_header\n")
    add(
        "end of lines CRLF, header of binary",
        head.replace(b"\n", b"\r\n") + b"end_header\r\n" + rest,
    )
    add("end of lines CR, header of binary", head.replace(b"\n", b"\r") + b"end_header\r" + rest)
    ten = POINTS.copy()
    ten[0, 0] = struct.unpack("<f", b"\x0a\x00\x00\x3f")[0]
    h2, _, r2 = _ply_file(little, points=ten).partition(b"end_header\n")
    add(
        "CR header, binary begins with a newline's byte",
        h2.replace(b"\n", b"\r") + b"end_header\r" + r2,
    )
    add("byte order mark", b"\xef\xbb\xbf" + _ply_file())
    add(
        "tabs and blanks in the header",
        _ply_file().replace(b"property float x", b"property  float\tx  "),
    )
    add("a comment that says end_header", _ply_file(extra="comment before end_header\n"))
    add("exponents", _ply_file().replace(b"3.25", b"3.25E+0"))
    add(
        "all on one line",
        head[:0]
        + _ply_file().partition(b"end_header\n")[0]
        + b"end_header\n"
        + b" ".join(_ply_file().partition(b"end_header\n")[2].split()),
    )
    add("indices as floats", _ply_file(face=("list uchar float vertex_indices",)))
    add(
        "indices with a fraction",
        _ply_file(face=("list uchar float vertex_indices",)).replace(b"4 0 2 3 1", b"4 0.5 2 3 1"),
        right=None,
        reason="whole",
    )
    add(
        "text with a wrong number",
        _ply_file().replace(b"3.25", b"3,25"),
        right=None,
        reason="line 14.*3,25",
    )
    add(
        "text with an underscore",
        _ply_file().replace(b"3.25", b"3_2"),
        right=None,
        reason="line 14.*3_2",
    )
    add(
        "a huge count",
        _ply_file(little).replace(b"vertex 8", b"vertex 99999999"),
        right=None,
        reason="truncated",
    )
    add(
        "a huge list",
        _ply_file(little, face=("list uint int vertex_indices",))[:-20] + b"\xff" * 20,
        right=None,
        reason="truncated|point",
    )
    add("an unknown type", _ply_file().replace(b"float z", b"quad z"), right=None, reason="quad z")
    add(
        "an unknown format",
        _ply_file().replace(b"ascii", b"binary_middle_endian"),
        right=None,
        reason="format",
    )
    add(
        "faces and strips",
        _ply_file(
            little,
            faces=[(0, 2, 1), (0, 1, 3)],
            points=TETRA_POINTS,
            tail="element tristrips 1\nproperty list int int vertex_indices\n",
        )
        + struct.pack("<5i", 4, 0, 3, 2, 1),
        right=TETRA,
        reason="strip",
    )


# GLB


class _Parts:
    """Numbers of a GLB file, each in a view of its own."""

    def __init__(self) -> None:
        self.data = b""
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, data: bytes, **more: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        )
        self.data += data
        return len(self.views) - 1

    def accessor(self, values: Any, dtype: str, kind: str = "VEC3", **more: Any) -> int:
        array = np.asarray(values).astype(dtype)
        code = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}[dtype[-2:]]
        entry = {
            "bufferView": self.view(array.tobytes()),
            "componentType": code,
            "count": len(array),
            "type": kind,
        }
        self.accessors.append({**entry, **more})
        return len(self.accessors) - 1


def _glb_file(parts: _Parts, primitives: Any, nodes: Any = None, **more: Any) -> bytes:
    content = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes or [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "accessors": parts.accessors,
        "bufferViews": parts.views,
        "buffers": [{"byteLength": len(parts.data)}],
        **more,
    }
    content = {key: value for key, value in content.items() if value is not None}
    return glb_bytes(content, parts.data)


def glb_bytes(content: dict[str, Any], data: bytes) -> bytes:
    """Return a GLB file of two chunks."""
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    if data:
        body += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def _box_parts(indices: str = "<u2") -> tuple[_Parts, list[dict[str, Any]]]:
    parts = _Parts()
    points = parts.accessor(POINTS, "<f4", min=POINTS.min(0).tolist(), max=POINTS.max(0).tolist())
    numbers = parts.accessor(FACES.reshape(-1), indices, "SCALAR")
    return parts, [{"attributes": {"POSITION": points}, "indices": numbers}]


def _glb() -> None:
    def add(name: str, data: bytes, **more: Any) -> None:
        _add(".glb", name, data, **more)

    for kind in ("u1", "u2", "u4"):
        add(f"indices {kind}", _glb_file(*_box_parts(f"<{kind}")))
    parts = _Parts()
    parts.accessor(BOX.reshape(-1, 3), "<f4")
    add("no indices", _glb_file(parts, [{"attributes": {"POSITION": 0}}]))
    parts = _Parts()
    rows = np.zeros((8, 6), "<f4")
    rows[:, 1:4] = POINTS
    parts.views.append({"buffer": 0, "byteOffset": 0, "byteLength": 192, "byteStride": 24})
    parts.data = rows.tobytes()
    parts.accessors.append(
        {"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 8, "type": "VEC3"}
    )
    parts.accessor(FACES.reshape(-1), "<u4", "SCALAR")
    add("points with a stride", _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": 1}]))
    # A strip and a fan.
    for mode, order, right in ((5, (0, 2, 1, 3, 0, 2), TETRA), (6, (0, 2, 1, 3, 2), TETRA[:3])):
        parts = _Parts()
        parts.accessor(TETRA_POINTS, "<f4")
        parts.accessor(order, "<u2", "SCALAR")
        if mode == 6:
            right = TETRA_POINTS[np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2)])]
        add(
            f"mode {mode}",
            _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]),
            right=right,
        )
    parts, primitives = _box_parts()
    both = [
        primitives[0],
        {**primitives[0], "mode": 1},
        {"attributes": primitives[0]["attributes"], "mode": 0},
    ]
    add("lines and points beside", _glb_file(parts, both))
    parts = _Parts()
    parts.accessor(POINTS, "<f4")
    halves = [parts.accessor(FACES[i : i + 6].reshape(-1), "<u2", "SCALAR") for i in (0, 6)]
    add(
        "two primitives",
        _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": i} for i in halves]),
    )

    # Quantized.
    low, size = POINTS.min(0), np.ptp(POINTS, axis=0)
    for dtype, top in (("u1", 255), ("u2", 65535), ("i1", 127), ("i2", 32767)):
        unit = (POINTS - low) / size
        if dtype[0] == "i":
            unit = unit * 2 - 1
        parts = _Parts()
        wide = np.zeros((8, 4))
        wide[:, :3] = np.rint(unit * top)
        parts.views.append(
            {
                "buffer": 0,
                "byteOffset": 0,
                "byteLength": 8 * 4 * int(dtype[1]),
                "byteStride": 4 * int(dtype[1]),
            }
        )
        parts.data = wide.astype("<" + dtype).tobytes()
        parts.accessors.append(
            {
                "bufferView": 0,
                "componentType": {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123}[dtype],
                "count": 8,
                "type": "VEC3",
                "normalized": True,
            }
        )
        parts.accessor(FACES.reshape(-1), "<u2", "SCALAR")
        scale, move = (size, low) if dtype[0] == "u" else (size / 2, low + size / 2)
        node = [{"mesh": 0, "scale": scale.tolist(), "translation": move.tolist()}]
        needs = {
            "extensionsUsed": ["KHR_mesh_quantization"],
            "extensionsRequired": ["KHR_mesh_quantization"],
        }
        add(
            f"normalized {dtype}",
            _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": 1}], node, **needs),
        )
        parts.accessors[0] = {**parts.accessors[0], "normalized": False}
        node = [{"mesh": 0, "scale": (scale / top).tolist(), "translation": move.tolist()}]
        add(
            f"whole numbers {dtype}",
            _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": 1}], node, **needs),
        )

    # Sparse.
    sparse_rows = (3, 7)
    for base in (True, False):
        parts = _Parts()
        shifted = POINTS.copy()
        shifted[list(sparse_rows)] = 9.0
        parts.accessor(shifted if base else POINTS, "<f4")
        changed = list(sparse_rows) if base else list(range(8))
        entry = parts.accessors[0]
        if not base:
            del entry["bufferView"]
        at = parts.view(np.array(changed, "<u2").tobytes())
        values = parts.view(POINTS[changed].astype("<f4").tobytes())
        entry["sparse"] = {
            "count": len(changed),
            "indices": {"bufferView": at, "componentType": 5123},
            "values": {"bufferView": values},
        }
        parts.accessor(FACES.reshape(-1), "<u2", "SCALAR")
        add(
            f"sparse points {'over others' if base else 'over zeros'}",
            _glb_file(parts, [{"attributes": {"POSITION": 0}, "indices": 1}]),
        )

    # Nodes.
    parts, primitives = _box_parts()
    turn = [0.0, 0.0, 0.5**0.5, 0.5**0.5]
    turned = np.stack([-BOX[..., 1], BOX[..., 0], BOX[..., 2]], axis=-1)
    add(
        "translation, rotation, scale",
        _glb_file(
            parts,
            primitives,
            [{"mesh": 0, "translation": [1, 2, 3], "rotation": turn, "scale": [1, 2, 3]}],
        ),
        right=np.stack([-2 * BOX[..., 1] + 1, BOX[..., 0] + 2, 3 * BOX[..., 2] + 3], axis=-1),
    )
    add(
        "matrix",
        _glb_file(
            parts,
            primitives,
            [{"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}],
        ),
        right=turned + (5, 6, 7),
    )
    add(
        "nested nodes",
        _glb_file(
            parts,
            primitives,
            [
                {"children": [1], "rotation": turn},
                {"children": [2], "translation": [1, 0, 0]},
                {"mesh": 0, "scale": [2, 2, 2]},
            ],
        ),
        right=np.stack([-2 * BOX[..., 1], 2 * BOX[..., 0] + 1, 2 * BOX[..., 2]], axis=-1),
    )
    add(
        "a mesh in two nodes",
        _glb_file(
            parts,
            primitives,
            [{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}],
        ),
        right=np.concatenate([BOX, BOX + (9, 0, 0)]),
    )
    mirrored = (BOX * (-1, 1, 1))[:, ::-1]
    add(
        "negative scale",
        _glb_file(parts, primitives, [{"mesh": 0, "scale": [-1, 1, 1]}]),
        right=mirrored,
    )
    add(
        "two negative scales",
        _glb_file(parts, primitives, [{"mesh": 0, "scale": [-1, -1, 1]}]),
        right=BOX * (-1, -1, 1),
    )
    add(
        "no scene",
        _glb_file(
            parts,
            primitives,
            [{"children": [1], "translation": [1, 0, 0]}, {"mesh": 0}],
            scene=None,
            scenes=None,
        ),
        right=BOX + (1, 0, 0),
    )
    add("no default scene", _glb_file(parts, primitives, scene=None))
    add(
        "the second scene",
        _glb_file(
            parts,
            primitives,
            [{"mesh": 0, "translation": [1, 0, 0]}, {"mesh": 0}],
            scene=1,
            scenes=[{"nodes": [0]}, {"nodes": [1]}],
        ),
    )
    add(
        "a node outside of the scene",
        _glb_file(parts, primitives, [{"mesh": 0}, {"mesh": 0, "translation": [9, 0, 0]}]),
    )
    add(
        "camera and light in nodes",
        _glb_file(
            parts,
            primitives,
            [
                {"mesh": 0, "children": [1]},
                {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
            ],
            cameras=[{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
            extensions={"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
            extensionsUsed=["KHR_lights_punctual"],
            extensionsRequired=["KHR_lights_punctual"],
        ),
    )
    add(
        "required extension of materials",
        _glb_file(
            parts,
            primitives,
            extensionsUsed=["KHR_materials_unlit", "KHR_texture_transform"],
            extensionsRequired=["KHR_materials_unlit", "KHR_texture_transform"],
        ),
    )
    add(
        "optional extension that nobody has",
        _glb_file(parts, primitives, extensionsUsed=["ACME_thing"]),
    )
    for name in (
        "ACME_thing",
        "EXT_mesh_gpu_instancing",
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
    ):
        add(
            f"required {name}",
            _glb_file(parts, primitives, extensionsUsed=[name], extensionsRequired=[name]),
            right=None,
            reason=name,
        )
    for name in ("EXT_lights_image_based", "EXT_mesh_features", "KHR_animation_pointer"):
        add(f"required {name}", _glb_file(parts, primitives, extensionsRequired=[name]))
    for least, right in (("2.0", BOX), ("2.1", None)):
        asset = {"version": "2.1", "minVersion": least}
        file = _glb_file(parts, primitives, asset=asset)
        add(f"minVersion {least}", file, right=right, reason="version 2.1 of glTF")
    for length in (1.0, 1.01, 2.0):
        turn = [0.0, 0.0, length * 0.6, length * 0.8]
        matrix = np.array([(0.28, -0.96, 0), (0.96, 0.28, 0), (0, 0, 1)])
        file = _glb_file(parts, primitives, [{"mesh": 0, "rotation": turn}])
        add(f"quaternion of length {length}", file, right=BOX @ matrix.T)
    file = _glb_file(parts, primitives, [{"mesh": 0, "rotation": [0, 0, 0, 0]}])
    add("quaternion of zeros", file, right=None, reason="four zeros")
    beyond, p3 = _box_parts()
    beyond.accessors[0]["count"] = 9
    add("points beyond their view", _glb_file(beyond, p3), right=None, reason="its part")
    instanced, p2 = _box_parts()
    moves = instanced.accessor([(0, 0, 0), (9, 0, 0)], "<f4")
    add(
        "optional instances",
        _glb_file(
            instanced,
            p2,
            [
                {
                    "mesh": 0,
                    "extensions": {
                        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}
                    },
                }
            ],
            extensionsUsed=["EXT_mesh_gpu_instancing"],
        ),
        right=np.concatenate([BOX, BOX + (9, 0, 0)]),
        reason="EXT_mesh_gpu_instancing",
    )
    draco, p3 = _box_parts()
    for each in draco.accessors:
        del each["bufferView"]
    p3[0]["extensions"] = {
        "KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}
    }
    add(
        "Draco that is not required",
        _glb_file(draco, p3, extensionsUsed=["KHR_draco_mesh_compression"]),
        right=None,
        reason="KHR_draco_mesh_compression",
    )
    meshopt, p4 = _box_parts()
    meshopt.views = [
        {
            **v,
            "buffer": 1,
            "extensions": {
                "EXT_meshopt_compression": {
                    "buffer": 0,
                    "byteLength": 9,
                    "byteStride": 12,
                    "count": 8,
                    "mode": "ATTRIBUTES",
                }
            },
        }
        for v in meshopt.views
    ]
    add(
        "meshopt with an empty fallback",
        _glb_file(
            meshopt,
            p4,
            buffers=[
                {"byteLength": 8},
                {"byteLength": 168, "extensions": {"EXT_meshopt_compression": {"fallback": True}}},
            ],
            extensionsUsed=["EXT_meshopt_compression"],
        ),
        right=None,
        reason="EXT_meshopt_compression",
    )

    # Buffers.
    data = base64.b64encode(parts.data).decode()
    content = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": primitives}],
        "accessors": parts.accessors,
        "bufferViews": parts.views,
    }
    add(
        "numbers in a data URI",
        glb_bytes(
            {
                **content,
                "buffers": [
                    {
                        "byteLength": len(parts.data),
                        "uri": f"data:application/octet-stream;base64,{data}",
                    }
                ],
            },
            b"",
        ),
    )
    add(
        "numbers in another file",
        glb_bytes({**content, "buffers": [{"byteLength": len(parts.data), "uri": "a.bin"}]}, b""),
        right=None,
        reason="another file",
    )
    second = [{**v, "buffer": 1} for v in parts.views]
    add(
        "a second buffer as data URI",
        glb_bytes(
            {
                **content,
                "bufferViews": second,
                "buffers": [
                    {"byteLength": 8},
                    {"byteLength": len(parts.data), "uri": f"data:;base64,{data}"},
                ],
            },
            bytes(8),
        ),
    )
    add("truncated", _glb_file(parts, primitives)[:-40], right=None, reason="truncated")
    add(
        "version 1",
        b"glTF" + struct.pack("<I", 1) + _glb_file(parts, primitives)[8:],
        right=None,
        reason="version 2",
    )
    add(
        "an index beyond the points",
        _glb_file(
            *(
                lambda p: (
                    p[0],
                    [{"attributes": {"POSITION": p[0].accessor(POINTS[:4], "<f4")}, "indices": 1}],
                )
            )(_box_parts())
        ),
        right=None,
        reason="point 7 of 4",
    )
    add(
        "a huge accessor",
        glb_bytes(
            {
                **content,
                "accessors": [{**parts.accessors[0], "count": 2**31}, parts.accessors[1]],
                "buffers": [{"byteLength": len(parts.data)}],
            },
            parts.data,
        ),
        right=None,
        reason="truncated|become",
    )
    nothing = [
        {k: v for k, v in parts.accessors[0].items() if k != "bufferView"}
        | {
            "count": 2**36,
            "sparse": {
                "count": 1,
                "indices": {"bufferView": 1, "componentType": 5123},
                "values": {"bufferView": 0},
            },
        },
        parts.accessors[1],
    ]
    add(
        "a huge sparse accessor",
        glb_bytes(
            {**content, "accessors": nothing, "buffers": [{"byteLength": len(parts.data)}]},
            parts.data,
        ),
        right=None,
        reason="become|most",
    )
    add(
        "not a number",
        _glb_file(
            *(
                lambda p: (
                    p,
                    [
                        {
                            "attributes": {
                                "POSITION": p.accessor(
                                    np.where(BOX == 3.25, np.nan, BOX).reshape(-1, 3), "<f4"
                                )
                            }
                        }
                    ],
                )
            )(_Parts())
        ),
        right=None,
        reason="nan",
    )

    # Morphs and skins.
    for weights in ("mesh", "node"):
        parts, primitives = _box_parts()
        primitives[0]["targets"] = [
            {"POSITION": parts.accessor(POINTS * 0 + (2, 0, 0), "<f4")},
            {"POSITION": parts.accessor(POINTS * 0 + (0, 8, 0), "<f4")},
        ]
        nodes = [{"mesh": 0, **({"weights": [0.5, 0.25]} if weights == "node" else {})}]
        mesh = {"primitives": primitives, "weights": [0.5, 0.25] if weights == "mesh" else [1, 1]}
        add(
            f"morphs by weights of the {weights}",
            _glb_file(parts, None, nodes, meshes=[mesh]),
            right=BOX + (1, 2, 0),
            reason="morph",
        )
    parts, primitives = _box_parts()
    primitives[0]["targets"] = [{"POSITION": parts.accessor(POINTS * 0 + 2, "<f4")}]
    add("morphs without weights", _glb_file(parts, primitives))
    parts, primitives = _box_parts()
    joints = parts.accessor([(0, 1, 0, 0)] * 8, "u1", "VEC4")
    weights_ = parts.accessor([(0.5, 0.5, 0, 0)] * 8, "<f4", "VEC4")
    primitives[0]["attributes"] |= {"JOINTS_0": joints, "WEIGHTS_0": weights_}
    inverse = parts.accessor(np.stack([np.eye(4)] * 2).reshape(2, 16), "<f4", "MAT4")
    nodes = [
        {"children": [1, 2]},
        {"mesh": 0, "skin": 0, "translation": [50, 0, 0]},
        {"translation": [2, 0, 0], "children": [3]},
        {"translation": [0, 4, 0]},
    ]
    add(
        "a skin in a pose",
        _glb_file(
            parts, primitives, nodes, skins=[{"joints": [2, 3], "inverseBindMatrices": inverse}]
        ),
        right=BOX + (2, 2, 0),
        reason="skin",
    )


# 3MF

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_KNOWN = {
    "p": "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "m": "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "b": "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02",
    "s": "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07",
    "v": "http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01",
    "bo": "http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07",
    "t": "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
}
_RELS = (
    '<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/'
    'package/2006/relationships"><Relationship Target="%s" Id="r0" Type="http://schemas.microsoft.com'
    '/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/'
    '2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package'
    '.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.'
    '3dmanufacturing-3dmodel+xml"/></Types>'
)


def _mesh(extra: str = "", points: Any = POINTS, faces: Any = FACES) -> str:
    places = "".join('<vertex x="%g" y="%g" z="%g"/>' % tuple(p) for p in points)
    rows = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % tuple(f) for f in faces)
    return f"<mesh><vertices>{places}</vertices><triangles>{rows}</triangles>{extra}</mesh>"


def _model(
    objects: str, items: str = '<item objectid="1"/>', attributes: str = 'unit="millimeter"'
) -> str:
    spaces = " ".join(f'xmlns:{key}="{value}"' for key, value in _KNOWN.items())
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<model {attributes} xml:lang="en-US" xmlns="{_CORE}" {spaces}><resources>{objects}</resources><build>{items}</build></model>'


def _package(
    model: str | bytes,
    more: dict[str, str] | None = None,
    path: str = "3D/3dmodel.model",
    *,
    target: str | None = None,
    rels: bool = True,
    method: int = zipfile.ZIP_DEFLATED,
) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", method) as archive:
        archive.writestr("[Content_Types].xml", _TYPES)
        if rels:
            archive.writestr("_rels/.rels", _RELS % ("/" + path if target is None else target))
        archive.writestr(path, model)
        for name, text in (more or {}).items():
            archive.writestr(name, text)
    return file.getvalue()


def _three_mf() -> None:
    def add(name: str, data: bytes, **more: Any) -> None:
        _add(".3mf", name, data, **more)

    one = f'<object id="1">{_mesh()}</object>'
    two = f'<object id="2">{_mesh(points=TETRA_POINTS, faces=TETRA_FACES)}</object>'
    plain = _model(one)
    add("one object", _package(plain))
    add("type model", _package(_model(one.replace('id="1"', 'id="1" type="model"'))))
    add("not packed", _package(plain, method=zipfile.ZIP_STORED))
    add("relative target", _package(plain, target="3D/3dmodel.model"))
    add("no relations", _package(plain, rels=False))
    add("another name of the model", _package(plain, path="3D/thing.model"))
    add("capital letters in the target", _package(plain, target="/3d/3DModel.model"))
    add("blank in the name", _package(plain, path="3D/my part.model", target="/3D/my%20part.model"))
    add("byte order mark", _package(b"\xef\xbb\xbf" + plain.encode()))
    add("UTF-16", _package(plain.replace("UTF-8", "UTF-16").encode("utf-16")))
    add(
        "prefix for the core",
        _package(
            plain.replace("<", "<c:")
            .replace("<c:/", "</c:")
            .replace("<c:?", "<?")
            .replace("xmlns=", "xmlns:c=")
        ),
    )
    add("unit inch", _package(_model(one, attributes='unit="inch"')))
    add("no unit", _package(_model(one, attributes="")))
    add(
        "unknown unit",
        _package(_model(one, attributes='unit="parsec"')),
        right=None,
        reason="parsec",
    )
    add(
        "two items",
        _package(_model(one + two, '<item objectid="1"/><item objectid="2"/>')),
        right=np.concatenate([BOX, TETRA]),
    )
    add("an object that is not in the build", _package(_model(one + two)))
    add(
        "item with a transform",
        _package(_model(one, '<item objectid="1" transform="0 1 0 -1 0 0 0 0 1 5 6 7"/>')),
        right=np.stack([-BOX[..., 1] + 5, BOX[..., 0] + 6, BOX[..., 2] + 7], axis=-1),
    )
    add(
        "item that mirrors",
        _package(_model(one, '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>')),
        right=(BOX * (-1, 1, 1))[:, ::-1],
    )
    add(
        "an item twice",
        _package(
            _model(
                one, '<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>'
            )
        ),
        right=np.concatenate([BOX, BOX + (9, 0, 0)]),
    )
    parts = '<object id="3"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 9 0 0"/><component objectid="2"/></components></object>'
    add(
        "components",
        _package(
            _model(one + two + parts, '<item objectid="3" transform="2 0 0 0 2 0 0 0 2 0 0 1"/>')
        ),
        right=np.concatenate([BOX + (9, 0, 0), TETRA]) * 2 + (0, 0, 1),
    )
    nested = (
        parts
        + '<object id="4"><components><component objectid="3" transform="0 1 0 -1 0 0 0 0 1 0 0 0"/></components></object>'
    )
    inner = np.concatenate([BOX + (9, 0, 0), TETRA])
    add(
        "nested components",
        _package(_model(one + two + nested, '<item objectid="4"/>')),
        right=np.stack([-inner[..., 1], inner[..., 0], inner[..., 2]], axis=-1),
    )
    ring = '<object id="1"><components><component objectid="1"/></components></object>'
    add("components in a ring", _package(_model(ring)), right=None, reason="contain each other")
    add("a missing object", _package(_model(one, '<item objectid="7"/>')), right=None, reason="7")
    other = '<object id="1" p:UUID="00000000-0000-0000-0000-00000000000a"><components><component objectid="5" p:path="/3D/part.model" p:UUID="00000000-0000-0000-0000-00000000000b"/></components></object>'
    part = _model(f'<object id="5">{_mesh()}</object>', "")
    more = {"3D/part.model": part, "3D/_rels/3dmodel.model.rels": _RELS % "/3D/part.model"}
    add(
        "production: component in another model",
        _package(_model(other, attributes='unit="millimeter" requiredextensions="p"'), more),
    )
    add(
        "production: item in another model",
        _package(
            _model(
                "",
                '<item objectid="5" p:path="/3D/part.model" p:UUID="00000000-0000-0000-0000-00000000000c"/>',
                'unit="millimeter" requiredextensions="p"',
            ),
            more,
        ),
    )
    add("production: a missing model", _package(_model(other)), right=None, reason="3D/part.model")
    colors = '<m:colorgroup id="9"><m:color color="#FF0000FF"/></m:colorgroup><basematerials id="8"><base name="a" displaycolor="#00FF00"/></basematerials>'
    add(
        "colors and materials",
        _package(
            _model(
                colors
                + one.replace('id="1"', 'id="1" pid="9" pindex="0"').replace(
                    'v3="3"/', 'v3="3" pid="8" p1="0"/', 1
                ),
                attributes='unit="millimeter" requiredextensions="m"',
            )
        ),
    )
    add(
        "triangle sets",
        _package(
            _model(
                f'<object id="1">{_mesh("<t:trianglesets><t:triangleset name=%s identifier=%s><t:ref index=%s/></t:triangleset></t:trianglesets>" % (chr(34) + "a" + chr(34), chr(34) + "b" + chr(34), chr(34) + "0" + chr(34)))}</object>'
            )
        ),
    )
    beams = '<b:beamlattice minlength="0.1" radius="0.1"><b:beams><b:beam v1="0" v2="1"/></b:beams></b:beamlattice>'
    add(
        "required beam lattice",
        _package(
            _model(
                f'<object id="1">{_mesh(beams)}</object>',
                attributes='unit="millimeter" requiredextensions="b"',
            )
        ),
        right=None,
        reason="beamlattice",
    )
    add(
        "beams only",
        _package(_model(f'<object id="1">{_mesh(beams, faces=[])}</object>')),
        right=None,
        reason="beam",
    )
    add(
        "required booleans",
        _package(_model(one, attributes='requiredextensions="bo"')),
        right=None,
        reason="booleanoperations",
    )
    add(
        "required volumes and production",
        _package(_model(one, attributes='requiredextensions="p v"')),
        right=None,
        reason="volumetric",
    )
    add(
        "required prefix without a name",
        _package(_model(one, attributes='requiredextensions="zz"')),
        right=None,
        reason="zz",
    )
    for kind in ("surface", "support", "other"):
        add(
            f"type {kind} only",
            _package(_model(one.replace('id="1"', f'id="1" type="{kind}"'))),
            right=None,
            reason=f"type '{kind}'",
        )
    add("type solidsupport", _package(_model(one.replace('id="1"', 'id="1" type="solidsupport"'))))
    add(
        "model and support",
        _package(
            _model(
                one + two.replace('id="2"', 'id="2" type="support"'),
                '<item objectid="1"/><item objectid="2"/>',
            )
        ),
    )
    add(
        "model and surface",
        _package(
            _model(
                one + two.replace('id="2"', 'id="2" type="surface"'),
                '<item objectid="1"/><item objectid="2"/>',
            )
        ),
        right=None,
        reason="type 'surface'",
    )
    add(
        "item that is not printable",
        _package(_model(one + two, '<item objectid="1"/><item objectid="2" printable="0"/>')),
        right=np.concatenate([BOX, TETRA]),
    )
    add("exponents and signs", _package(plain.replace('z="3.25"', 'z="+3.25E+00"')))
    add(
        "single quotes, blanks, comments",
        _package(
            plain.replace('"', "'")
            .replace("<vertex ", "<!-- v -->\n <vertex  ")
            .replace("/>", " />")
        ),
    )
    add(
        "vertex without z",
        _package(plain.replace(' z="3.25"', "", 1)),
        right=None,
        reason="line 2.*vertex",
    )
    add(
        "a decimal comma",
        _package(plain.replace('z="3.25"', 'z="3,25"', 1)),
        right=None,
        reason="line 2.*vertex",
    )
    add(
        "an underscore",
        _package(plain.replace('z="3.25"', 'z="3_2"', 1)),
        right=None,
        reason="line 2.*vertex",
    )
    add("not a number", _package(plain.replace('z="3.25"', 'z="nan"', 1)), right=None, reason="nan")
    add(
        "a triangle of a missing point",
        _package(plain.replace('v1="7"', 'v1="70"').replace('v2="7"', 'v2="70"')),
        right=None,
        reason="missing point",
    )
    add(
        "a document type",
        _package(plain.replace("<model", '<!DOCTYPE a [<!ENTITY b "c">]><model', 1)),
        right=None,
        reason="document type",
    )
    add(
        "no item in the build",
        _package(_model(one, "")),
        right=None,
        reason="build is empty|no item",
    )
    add("no archive", b"PK\3\4 nothing", right=None, reason="zip")
    add("truncated", _package(plain)[:-200], right=None, reason="zip")
    add("truncated XML", _package(plain[:900]), right=None, reason="XML")


_stl()
_obj()
_ply()
_glb()
_three_mf()
