"""Small files of every kind that others write, what reads them, and ways to damage them.

Input: a number. Output: bytes that are the same for the same number. ``tools/sweep_readers.py`` and
``test_damaged_files.py`` use it.
"""

from __future__ import annotations

import gzip
import io
import random
import re
import struct
import tempfile
import wave
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import Image

import distal
from distal.devices.resources import texels
from distal.diagnostics import CompileError, LoadError
from distal.editor.links import LinkError, link_of, shared_by
from distal.file_writer import SaveError
from distal.images import exr, jpeg, picture_files, png
from distal.images.metadata import ReadError
from distal.ir.types import TextureShape
from distal.lang import color, slider
from distal.lessons import reading as lessons
from distal.mesh.files.formats import write
from distal.polygons import volumes
from distal.polygons.points import read_points
from distal.polygons.reading import read_mesh
from distal.runtime.accumulation import Film
from distal.runtime.film_files import FilmFile
from distal.scene.objects.lettering import text_outline
from distal.scene.objects.outlines import svg_path
from distal.sounds.reading import read as read_sound
from distal.sweeps.inputs import inputs_of, read_inputs
from distal.sweeps.table import SweepTable
from distal.triangles import decode, encode
from distal.triangles.range_coder import CoderError
from distal.video.animation import _frame
from tests.mesh.sample_solids import Sample, sphere

# What a reader may raise: errors of one line.
REFUSALS: Final = (LoadError, CompileError, SaveError, ReadError, LinkError, CoderError)
EXTREMES: Final = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 2**31 - 1, 2**31, 2**32 - 1, 2**63)
FLOATS: Final = (float("inf"), float("nan"), 1e38, -1e38, 1e-45, 65504.0)
WORDS: Final = ("0", "-1", "1e308", "nan", "65536", "4294967295", "99999999999999999999", "1e-400")


_PARAMETERS: Final = (slider("Width", 0.5), color("Tint", "#fff"))
_LIST: Final = b"width,tint\n0.25,#ffffff\n" + 20 * b'1e-1,"0.1,0.2,1"\n'
_TABLE: Final = (
    b"number,input.width,input.tint.r,input.tint.g,input.tint.b,measured.volume,measured.remark\n"
    b'1,0.25,1.0,1.0,1.0,0.3333333333333333,\n2,0.25,0.0,0.0,0.0,,"nothing, of it"\n'
)


@dataclass(frozen=True)
class Subject:
    """A reader and a file that it reads.

    Attributes:
        kind: A key of ``foreign_files.KINDS``, or "link".
        name: The name of its file.
        made: Makes the file's bytes.
        read: Reads a file.
    """

    kind: str
    name: str
    made: Callable[[], bytes]
    read: Callable[[Path], object]


def _mesh(suffix: str) -> Callable[[], bytes]:
    def made() -> bytes:
        points, triangles = sphere(1)
        colors = np.clip(np.abs(points), 0.0, 1.0).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder) / f"a{suffix}", Sample(points, triangles, points, colors))
            return (Path(folder) / f"a{suffix}").read_bytes()

    return made


def _text_stl() -> bytes:
    points, triangles = sphere(0)
    rows = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*p) for p in corners)
        + "endloop\nendfacet\n"
        for corners in points[triangles].tolist()
    )
    return f"solid a\n{rows}endsolid a\n".encode()


def _text_ply() -> bytes:
    points, triangles = sphere(1)
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
        + "".join(f"property float {n}\n" for n in ("x", "y", "z", "nx", "ny", "nz"))
        + f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = [" ".join(f"{v:g}" for v in (*p, *p)) for p in points.tolist()]
    rows += ["3 " + " ".join(map(str, t)) for t in triangles.tolist()]
    return (head + "\n".join(rows) + "\n").encode()


def _strips_ply() -> bytes:
    head = (
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\n"
        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    )
    corners = struct.pack("<12f", *(0, 0, 0), *(1, 0, 0), *(0, 1, 0), *(0, 0, 1))
    strips = (0, 2, 1, -1, 0, 1, 3, -1, 0, 3, 2, 1, -1)
    return head.encode() + corners + struct.pack(f"<{1 + len(strips)}i", len(strips), *strips)


def _read_list(path: Path) -> object:
    try:
        return read_inputs(path, _PARAMETERS)
    except ValueError as error:  # what callers of a sweep get
        raise LoadError(str(error)) from None


def _read_table(path: Path) -> object:
    inputs = inputs_of({"width": [0.25, 0.5], "tint": "#fff;#000"}, _PARAMETERS)
    return SweepTable(path, inputs, (), (), files=False).earlier(fresh=False)


def _points() -> list[list[float]]:
    points, _ = sphere(1)
    return [[*p, *p] for p in points.tolist()]


def _xyz() -> bytes:
    return "\n".join(" ".join(f"{v:.4f}" for v in row) for row in _points()).encode()


def _obj_points() -> bytes:
    rows = _points()
    lines = ["v {:g} {:g} {:g}".format(*r[:3]) for r in rows]
    lines += ["vn {:g} {:g} {:g}".format(*r[3:]) for r in rows]
    return "\n".join(lines).encode()


def _samples() -> Any:
    z, y, x = np.ogrid[-1:1:6j, -1:1:7j, -1:1:8j]
    return (np.sqrt(x * x + y * y + z * z) - 0.7).astype(np.float32)


def _npy() -> bytes:
    file = io.BytesIO()
    np.save(file, _samples())
    return file.getvalue()


def _nrrd(encoding: str, beside: str = "") -> Callable[[], bytes]:
    def made() -> bytes:
        head = (
            "NRRD0004\ntype: float\ndimension: 3\nsizes: 8 7 6\nspacings: 1 1 2\n"
            f"space: LPS\nspace directions: (0,-1,0) (1,0,0) (0,0.1,2)\nspace origin: (9,8,7)\n"
            f"endian: little\nencoding: {encoding}\n"
        )
        if beside:
            return f"{head}data file: {beside}\n".encode()
        raw = _samples().tobytes()
        return f"{head}\n".encode() + (gzip.compress(raw, mtime=0) if encoding == "gzip" else raw)

    return made


def _volume_with_raw(path: Path) -> object:
    """Read a header whose samples are in a file beside it, which is not damaged."""
    path.with_name("a.raw").write_bytes(_samples().tobytes())
    return _volume(path)


def _radiance(packed: bool = True) -> bytes:
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 4 +X 12\n"
    line = b"\2\2\0\x0c" + b"\x8c\x40" * 2 + b"\x0c" + bytes(range(12)) + b"\x8c\x82"
    return head + (line * 4 if packed else b"\x40\x50\x60\x80\1\1\1\5" * 8)


_QFORM: Final = (0.1, 0.7, 0.1, -40.0, 30.0, 20.0)
_SFORM: Final = (0.9, 0.1, 0.0, -40.0, 0.0, 1.1, 0.2, 30.0, 0.1, 0.0, 2.0, 20.0)


def _nifti(codes: tuple[int, int] = (0, 0)) -> bytes:
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, 8, 7, 6, 1, 1, 1, 1)
    struct.pack_into("<h", head, 70, 16)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 2, 1, 1, 1, 1)
    struct.pack_into("<3f", head, 108, 352, 2.0, 0.1)
    struct.pack_into("<2h18f", head, 252, *codes, *_QFORM, *_SFORM)
    head[344:348] = b"n+1\0"
    return bytes(head) + _samples().tobytes()


def _nifti_2() -> bytes:
    head = bytearray(544)
    struct.pack_into("<i8sh", head, 0, 540, b"n+2\0\r\n\x1a\n", 16)
    struct.pack_into("<8q", head, 16, 3, 8, 7, 6, 1, 1, 1, 1)
    struct.pack_into("<8d", head, 104, 1, 1, 1, 2, 1, 1, 1, 1)
    struct.pack_into("<q2d", head, 168, 544, 2.0, 0.1)
    struct.pack_into("<2i18d", head, 344, 0, 1, *_QFORM, *_SFORM)
    struct.pack_into("<i", head, 500, 2)
    return bytes(head) + _samples().tobytes()


def _picture(format: str, mode: str = "RGB") -> Callable[[], bytes]:
    def made() -> bytes:
        levels = np.arange(24 * 18 * 4, dtype=np.uint8).reshape(18, 24, 4)
        picture = Image.fromarray(levels).convert("L" if mode == "I;16" else mode)
        if mode == "I;16":
            picture = Image.fromarray(np.asarray(picture).astype(np.uint16) * 200)
        file = io.BytesIO()
        picture.save(file, format)
        return file.getvalue()

    return made


def _wave(width: int) -> Callable[[], bytes]:
    def made() -> bytes:
        file = io.BytesIO()
        with wave.open(file, "wb") as out:
            out.setnchannels(2)
            out.setsampwidth(width)
            out.setframerate(8000)
            out.writeframes(bytes(range(256)) * 2 * width)
        return file.getvalue()

    return made


def _float_wave() -> bytes:
    data = np.sin(np.arange(800, dtype=np.float32)).tobytes()
    head = struct.pack("<HHIIHH", 3, 1, 8000, 32000, 4, 32)
    body = b"WAVEfmt " + struct.pack("<I", 16) + head + b"data" + struct.pack("<I", len(data))
    return b"RIFF" + struct.pack("<I", len(body) + len(data)) + body + data


def _sound(format: str, codec: str, layout: str = "s16") -> Callable[[], bytes]:
    def made() -> bytes:
        import av  # noqa: PLC0415

        file = io.BytesIO()
        with av.open(file, "w", format=format, options={"fflags": "+bitexact"}) as out:
            stream = out.add_stream(codec, rate=16000)
            stream.layout = "mono"
            planar = layout.endswith("p")
            values = (np.sin(np.arange(4096) / 9.0) * (1.0 if planar else 9000)).astype(
                np.float32 if planar else np.int16
            )
            for start in range(0, 4096, 1024):
                frame = av.AudioFrame.from_ndarray(
                    values[None, start : start + 1024], layout, "mono"
                )
                frame.sample_rate, frame.pts = 16000, start
                out.mux(stream.encode(frame))
            out.mux(stream.encode(None))
        return file.getvalue()

    return made


def _font() -> bytes:
    from fontTools.fontBuilder import FontBuilder  # noqa: PLC0415
    from fontTools.pens.ttGlyphPen import TTGlyphPen  # noqa: PLC0415

    builder = FontBuilder(1000, isTTF=True)
    names = [".notdef", "A", "V", "acute", "pair"]
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({65: "A", 86: "V", 66: "pair", 0x301: "acute"})
    glyphs = {}
    for name in names[:4]:
        pen = TTGlyphPen(None)
        pen.moveTo((0, 0))
        pen.qCurveTo((250, 700), (500, 0))
        pen.closePath()
        glyphs[name] = pen.glyph()
    pen = TTGlyphPen(dict.fromkeys(names))
    for x in (0, 500):
        pen.addComponent("A", (1, 0, 0, 1, x, 0))
    glyphs["pair"] = pen.glyph()
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics(dict.fromkeys(names, (520, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": "A", "styleName": "Regular"})
    builder.setupOS2(sCapHeight=700)
    builder.setupPost()
    builder.addOpenTypeFeatures("feature kern { pos A V -80; } kern;")
    file = io.BytesIO()
    builder.save(file)
    return file.getvalue()


def _film() -> bytes:
    film = Film.empty(4, 3)
    arrays = {n: getattr(film, n) for n in ("sums", "spread", "samples", "passes", "steps")}
    file = io.BytesIO()
    np.savez(file, key="key", **arrays)
    return file.getvalue()


_TEXTS: Final = {"distal:source-hash": "1" * 64, "distal:size": "8x6", "distal:version": "1"}


def _pixels() -> Any:
    return np.linspace(0.0, 1.0, 6 * 8 * 4, dtype=np.float32).reshape(6, 8, 4)


def _opaque() -> Any:
    pixels = _pixels()
    pixels[..., 3] = 1.0
    return pixels


_LESSON: Final = b"""+++
number = 1
title = "A ball"
summary = "A ball."
scene = "ball.py"
+++

# One
Text with `code`.

:::layers coordinate="coordinate" signal="signal"
coordinate | The place in space that each ray hit.
signal | The distances along the way.
:::
"""
_VM: Final = (
    b"_0 var-x\n_1 var-y\n_2 square _0\n_3 square _1\n_4 add _2 _3\n_5 const 1\n_6 sub _4 _5\n"
)
_PATH: Final = b"M 0 0 L 10 0 Q 12 5 10 10 C 7 12 3 12 0 10 A 5 5 30 0 1 0 0 Z m 2 2 h 3 v 3 H 2 z"


def _head_and_pixels(kind: Any) -> Callable[[Path], object]:
    def read(path: Path) -> object:
        picture_files.read(path)
        return kind.decode(path.read_bytes())

    return read


def _volume(path: Path) -> object:
    found = volumes.read_volume(path)
    return volumes.field_of(found.values, "zyx", found.spacing or (1.0, 1.0, 1.0), None)


def _read_film(path: Path) -> object:
    try:
        return FilmFile(path, "key").load(4, 3)
    except ValueError as error:
        if type(error) is ValueError and str(error).startswith(str(path)):
            raise LoadError(str(error)) from None
        raise


SUBJECTS: Final = (
    *(
        Subject(kind, f"a{suffix}", _mesh(suffix), lambda path: read_mesh(path, with_colors=True))
        for kind, suffix in (("STL", ".stl"), ("OBJ", ".obj"), ("PLY", ".ply"), ("GLB", ".glb"))
    ),
    Subject("3MF", "a.3mf", _mesh(".3mf"), lambda path: read_mesh(path, with_colors=True)),
    Subject("STL", "text.stl", _text_stl, read_mesh),
    Subject(
        "STL", "import.stl", _mesh(".stl"), lambda path: distal.Shape.from_mesh(path, spacing=0.2)
    ),
    Subject("PLY", "text.ply", _text_ply, read_mesh),
    Subject("PLY", "strips.ply", _strips_ply, read_mesh),
    Subject("points", "text.ply", _text_ply, read_points),
    Subject("points", "a.xyz", _xyz, read_points),
    Subject("points", "b.obj", _obj_points, read_points),
    Subject("volume", "a.npy", _npy, _volume),
    Subject("volume", "a.nrrd", _nrrd("raw"), _volume),
    Subject("volume", "gzip.nrrd", _nrrd("gzip"), _volume),
    Subject("volume", "a.nhdr", _nrrd("raw", beside="a.raw"), _volume_with_raw),
    Subject("volume", "a.nii", _nifti, _volume),
    Subject("volume", "qform.nii", lambda: _nifti((1, 0)), _volume),
    Subject("volume", "sform.nii", lambda: _nifti((1, 1)), _volume),
    Subject("volume", "b.nii", _nifti_2, _volume),
    Subject("volume", "a.nii.gz", lambda: gzip.compress(_nifti(), mtime=0), _volume),
    *(
        Subject(
            "texture", name, _picture(format, mode), lambda path: texels(path, TextureShape.FLAT)
        )
        for name, format, mode in (
            ("a.png", "PNG", "RGBA"),
            ("deep.png", "PNG", "I;16"),
            ("palette.png", "PNG", "P"),
            ("a.jpg", "JPEG", "RGB"),
            ("a.webp", "WEBP", "RGBA"),
            ("a.gif", "GIF", "P"),
            ("a.bmp", "BMP", "RGB"),
            ("a.tif", "TIFF", "RGB"),
            ("a.tga", "TGA", "RGB"),
        )
    ),
    Subject("texture", "a.hdr", lambda: _radiance(), lambda p: texels(p, TextureShape.FLAT)),
    Subject(
        "texture", "b.hdr", lambda: _radiance(packed=False), lambda p: texels(p, TextureShape.FLAT)
    ),
    Subject(
        "texture",
        "a.exr",
        lambda: exr.encode(_pixels(), {}, _TEXTS, 16),
        lambda path: texels(path, TextureShape.FLAT),
    ),
    Subject("sound", "a.wav", _wave(2), read_sound),
    Subject("sound", "deep.wav", _wave(3), read_sound),
    Subject("sound", "float.wav", _float_wave, read_sound),
    Subject("sound", "a.flac", _sound("flac", "flac"), read_sound),
    Subject("sound", "a.m4a", _sound("mp4", "aac", "fltp"), read_sound),
    Subject("sound", "a.mka", _sound("matroska", "pcm_s16le"), read_sound),
    Subject("font", "a.ttf", _font, lambda path: text_outline("AVB", font=path)),
    # An accent above: the line is shaped.
    Subject("font", "shaped.ttf", _font, lambda path: text_outline("AV\u0301B", font=path)),
    Subject(
        "drawing",
        "a.txt",
        lambda: _PATH,
        lambda path: svg_path(path.read_bytes().decode("latin-1"), size=1.0),
    ),
    Subject(".vm", "a.vm", lambda: _VM, lambda path: distal.Shape2D.from_vm(path)),
    Subject("film", "a.film", _film, _read_film),
    Subject(
        "frame", "frame.png", lambda: png.encode(_pixels(), _TEXTS), lambda path: _frame(path, 0)
    ),
    Subject("PNG", "b.png", lambda: png.encode(_pixels(), _TEXTS), _head_and_pixels(png)),
    Subject("PNG", "b16.png", lambda: png.encode(_pixels(), _TEXTS, 16), _head_and_pixels(png)),
    Subject("JPEG", "b.jpg", lambda: jpeg.encode(_opaque(), _TEXTS), _head_and_pixels(jpeg)),
    Subject("EXR", "b.exr", lambda: exr.encode(_pixels(), {}, _TEXTS, 16), _head_and_pixels(exr)),
    Subject(
        "triangles",
        "a.dtr",
        lambda: encode(np.asarray(Image.open(io.BytesIO(_picture("PNG")())))),
        lambda path: decode(path.read_bytes()),
    ),
    Subject("lesson", "a.md", lambda: _LESSON, lessons.read),
    Subject("list", "a.csv", lambda: _LIST, _read_list),
    Subject("table", "a.csv", lambda: _TABLE, _read_table),
    Subject(
        "link",
        "link.txt",
        lambda: link_of({"files": {"a.py": "x = 1\n" * 20}, "main": "a.py"}).encode(),
        lambda path: shared_by(path.read_bytes().decode("latin-1")),
    ),
)


def damaged(data: bytes, number: int) -> bytes:
    """Return a file that is damaged in one of several ways."""
    rng = random.Random(number)
    ways = [_flipped, _cut, _spliced, _extreme, _extreme, _reworded]
    if data[:2] == b"PK":
        ways += [_member] * 6
    if data[:2] == b"\x1f\x8b":
        ways += [_unpacked] * 6
    if data[:4] == b"\x89PNG":
        ways += [_chunk] * 6
    found = rng.choice(ways)(data, rng)
    return found if rng.random() < 0.8 else rng.choice(ways[:6])(found, rng)


def _flipped(data: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8))):
        if changed:
            changed[_place(len(changed), rng)] ^= 1 << rng.randrange(8)
    return bytes(changed)


def _place(length: int, rng: random.Random) -> int:
    """Return a place, half of the time in the first part, where headers are."""
    return rng.randrange(min(length, 256) if rng.random() < 0.5 else length)


def _cut(data: bytes, rng: random.Random) -> bytes:
    return data[: rng.randrange(len(data) + 1)]


def _spliced(data: bytes, rng: random.Random) -> bytes:
    a, b = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    return rng.choice(
        (data[:a] + data[b:], data[:b] + data[a:], data[a:], data[:a] + bytes(b - a) + data[b:])
    )


def _extreme(data: bytes, rng: random.Random) -> bytes:
    """Put an extreme number at the place of a field."""
    order = rng.choice("<>")
    if rng.random() < 0.25:
        number = struct.pack(f"{order}f", rng.choice(FLOATS))
    else:
        size = rng.choice((1, 2, 4, 4, 8))
        number = (rng.choice(EXTREMES) % 256**size).to_bytes(
            size, "little" if order == "<" else "big"
        )
    at = _place(max(len(data), 1), rng)
    at -= at % rng.choice((1, len(number)))
    return data[:at] + number + data[at + len(number) :]


def _reworded(data: bytes, rng: random.Random) -> bytes:
    """Replace a number that is written as text."""
    numbers = list(re.finditer(rb"[0-9.]+", data))
    if not numbers:
        return _flipped(data, rng)
    match = rng.choice(numbers)
    return data[: match.start()] + rng.choice(WORDS).encode() + data[match.end() :]


def _member(data: bytes, rng: random.Random) -> bytes:
    """Change a member of a zip archive, and pack it again."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
    except Exception:  # it was damaged before
        return _flipped(data, rng)
    name = rng.choice(list(members))
    way = rng.choice(
        (_flipped, _cut, _spliced, _extreme, _reworded, _reworded, _encoded, _repeated)
    )
    members[name] = way(members[name], rng)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", rng.choice((0, 8, 8, 14))) as archive:
        for each, content in members.items():
            archive.writestr(each, content)
    return file.getvalue()


def _encoded(data: bytes, rng: random.Random) -> bytes:
    text = data.decode("utf-8", "replace")
    text = re.sub(r"^<\?xml.*?\?>", "", text)
    return text.encode(
        rng.choice(("utf-16", "utf-16-le", "utf-16-be", "utf-32", "latin-1")), "replace"
    )


def _repeated(data: bytes, rng: random.Random) -> bytes:
    """Repeat a line or an element many times."""
    parts = re.findall(rb"<[^<>]*/>|[^\n]+\n", data)
    if not parts:
        return data
    part = rng.choice(parts)
    return data.replace(part, part * rng.choice((2, 100, 20_000)), 1)


def _unpacked(data: bytes, rng: random.Random) -> bytes:
    """Damage what is packed, and pack it again."""
    try:
        raw = gzip.decompress(data)
    except Exception:  # it was damaged before
        return _flipped(data, rng)
    return gzip.compress(rng.choice((_flipped, _cut, _spliced, _extreme))(raw, rng), mtime=0)


def _chunk(data: bytes, rng: random.Random) -> bytes:
    """Change a chunk of a PNG, with its right checksum."""
    parts, at = [], 8
    while at + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        parts.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += length + 12
    if not parts:
        return data
    number = rng.choice((0, 0, rng.randrange(len(parts))))
    name, content = parts[number]
    if name == b"IHDR" and len(content) >= 8 and rng.random() < 0.6:
        sizes = [rng.choice((0, 1, 5000, 16384, 65535, 2**31 - 1)) for _ in range(2)]
        content = struct.pack(">II", *sizes) + content[8:]
    else:
        content = rng.choice((_flipped, _cut, _extreme))(content or b"\0", rng)
    parts[number] = name, content
    return data[:8] + b"".join(
        struct.pack(">I", len(c)) + n + c + struct.pack(">I", zlib.crc32(n + c)) for n, c in parts
    )
