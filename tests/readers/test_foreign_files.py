"""Files of strangers: refused with their sizes before they take memory, in one line."""

from __future__ import annotations

import ast
import io
import itertools
import json
import os
import re
import struct
import time
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

import distal
from distal import foreign_files
from distal.devices.resources import texels
from distal.diagnostics import LoadError
from distal.foreign_files import KINDS, memory_of, need, opened, reading, shown, watched
from distal.ir.types import TextureShape
from distal.pixels import exr_header
from distal.polygons.reading import read_mesh
from distal.polygons.volumes import read_volume
from distal.scene.objects.lettering import text_outline
from distal.scene.tree.errors import SceneValueError
from tests.readers.damage import SUBJECTS

SOURCE = Path(distal.__file__).parent
SMALL = "files of this size get 805 MB"


def refusal(read, *args, **options) -> str:
    with pytest.raises((LoadError, SceneValueError)) as caught:
        read(*args, **options)
    text = caught.value.diagnostics[0].message
    return re.sub(r"'/[^']*/([^'/]*)'", r"'\1'", text)


# Files that would become many times their size


def glb(copies: int, triangles: int, *, primitives: int = 1) -> bytes:
    """A GLB of a fan whose mesh is in many nodes."""
    points = np.zeros((triangles + 2, 3), "<f4")
    points[1:, 0] = np.cos(np.arange(triangles + 1))
    points[1:, 1] = np.sin(np.arange(triangles + 1))
    part = {"attributes": {"POSITION": 0}, "mode": 6}
    data = points.tobytes()
    content = json.dumps(
        {
            "buffers": [{"byteLength": len(data)}],
            "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"}
            ],
            "meshes": [{"primitives": [part] * primitives}],
            "nodes": [{"mesh": 0}] * copies,
        }
    ).encode()
    content += b" " * (-len(content) % 4)
    chunks = struct.pack("<I4s", len(content), b"JSON") + content
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def test_copies_of_a_mesh_are_counted_before_they_are_made(tmp_path):
    path = tmp_path / "x.glb"
    path.write_bytes(glb(20_000, 1600))
    assert refusal(read_mesh, path) == (
        "'x.glb' is no GLB that can be read: it has 20,000 copies of 1,600 triangles, and a mesh "
        "has at most 10,000,000 triangles: leave some out"
    )
    path.write_bytes(glb(4000, 1600))
    size = shown(len(path.read_bytes()))
    assert refusal(read_mesh, path) == (
        f"'x.glb' of {size} would become 3.9 GB: 4,000 copies of 1,600 "
        'triangles; files of this size get 810 MB; max_memory="5 GB" or DISTAL_MAX_MEMORY=5GB '
        "reads it anyway"
    )
    path.write_bytes(glb(2, 10, primitives=50_000))  # that share their numbers
    assert "in 50,000 parts" not in refusal(read_mesh, path)  # parsed only as far as they fit
    path.write_bytes(glb(20, 10))
    assert len(read_mesh(path).triangles) == 200


CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def three_mf(path: Path, model: str | bytes, method: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr("3D/3dmodel.model", model)
    return path


def model_of(resources: str, item: str = "1") -> str:
    return (
        f'<?xml version="1.0"?><model xmlns="{CORE}"><resources>{resources}</resources>'
        f'<build><item objectid="{item}"/></build></model>'
    )


MESH = (
    '<object id="{}"><mesh><vertices>'
    + '<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>{}'
    + '</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>'
)


def test_components_within_components_are_counted_before_they_are_made(tmp_path):
    """Each object has ten of the one before it, and points that no triangle has."""
    levels = [MESH.format(1, '<vertex x="0" y="0" z="0"/>' * 1000)]
    for level in range(2, 12):
        parts = f'<component objectid="{level - 1}"/>' * 10
        levels.append(f'<object id="{level}"><components>{parts}</components></object>')
    path = three_mf(tmp_path / "x.3mf", model_of("".join(levels), "11"))
    message = refusal(read_mesh, path)
    assert re.fullmatch(
        r"'x\.3mf' of \d+ B would become 805 MB: [0-9,]+ triangles and [0-9,]+ points in "
        rf'[0-9,]+ parts; {SMALL}; max_memory="1 GB" or DISTAL_MAX_MEMORY=1GB reads it anyway',
        message,
    )


def test_points_of_a_model_are_counted_while_it_is_unpacked(tmp_path):
    path = three_mf(
        tmp_path / "x.3mf", model_of(MESH.format(1, '<vertex x="0" y="0" z="0"/>' * 50_000))
    )
    small = path.stat().st_size
    assert small < 6000
    with pytest.raises(LoadError, match=r"would become 8\.\d MB: 1 triangles and 50,003 points"):
        read_mesh(path, max_memory="8 MB")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_document_type_is_refused_in_every_encoding(tmp_path, encoding):
    text = model_of(MESH.format(1, "")).replace(
        "<model", '<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]><model', 1
    )
    path = three_mf(tmp_path / "x.3mf", text.encode(encoding))
    assert refusal(read_mesh, path) == (
        "'x.3mf' is no 3MF that can be read: its part '3D/3dmodel.model' declares a document type, "
        "which 3MF forbids"
    )
    plain = model_of(MESH.format(1, "")).encode(encoding)
    assert len(read_mesh(three_mf(tmp_path / "y.3mf", plain)).triangles) == 1


def test_a_model_in_an_encoding_that_the_parser_lacks_is_refused(tmp_path):
    for encoding in ("utf-32", "utf-32-le", "utf-7"):
        path = three_mf(tmp_path / "x.3mf", model_of(MESH.format(1, "")).encode(encoding))
        if encoding != "utf-7":
            assert "is no XML" in refusal(read_mesh, path)


def test_a_tag_without_an_end_and_a_strange_packing_are_refused(tmp_path):
    path = three_mf(tmp_path / "x.3mf", f'<model xmlns="{CORE}" a="{"x" * 3_000_000}"/>')
    assert "a tag" in refusal(read_mesh, path) or "longer than 1 MiB" in refusal(read_mesh, path)
    path = three_mf(tmp_path / "x.3mf", model_of(MESH.format(1, "")), zipfile.ZIP_LZMA)
    assert "is packed in a way that 3MF does not have" in refusal(read_mesh, path)


def png(width: int, height: int, bits: int = 8) -> bytes:
    """A black picture of grey levels."""
    row = bytes(1 + (width * bits + 7) // 8)
    pack = zlib.compressobj(9)
    data = b"".join([pack.compress(row * 64) for _ in range(height // 64)]) + pack.flush()

    def chunk(name: bytes, content: bytes) -> bytes:
        check = zlib.crc32(name + content)
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", check)

    head = struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def test_pixels_are_counted_before_they_are_decoded(tmp_path):
    path = tmp_path / "x.png"
    path.write_bytes(png(16384, 16384, bits=1))
    expected = (
        "'x.png' of 33 kB would become 6.4 GB: 16,384 x 16,384 pixels; files of this size get 807 "
        'MB; max_memory="7 GB" or DISTAL_MAX_MEMORY=7GB reads it anyway'
    )
    assert refusal(texels, str(path), TextureShape.FLAT) == expected
    assert refusal(distal.Shape2D.from_image, path) == f"from_image: {expected}"


def test_a_small_file_of_a_large_flat_picture_is_read(tmp_path):
    path = tmp_path / "x.png"
    path.write_bytes(png(4096, 4096))
    assert path.stat().st_size < 20_000
    found = texels(str(path), TextureShape.FLAT)
    assert found.shape == (4096, 4096, 4)
    assert found[::500, ::500].tolist() == [[[0.0, 0.0, 0.0, 1.0]] * 9] * 9


def test_more_memory_is_given_by_the_loader_or_the_variable(tmp_path, monkeypatch):
    path = tmp_path / "x.png"
    path.write_bytes(png(640, 640))
    for limit in (9_000_000, "9 MB"):
        assert "it may take 9.0 MB; max_memory=" in refusal(
            texels, str(path), TextureShape.FLAT, max_memory=limit
        )
    assert texels(str(path), TextureShape.FLAT, max_memory="10 MB").shape == (640, 640, 4)
    monkeypatch.setenv("DISTAL_MAX_MEMORY", "5MB")
    assert "would become 9.8 MB" in refusal(texels, str(path), TextureShape.FLAT)
    assert texels(str(path), TextureShape.FLAT, max_memory="10 MB").shape == (640, 640, 4)
    monkeypatch.setenv("DISTAL_MAX_MEMORY", "much")
    assert refusal(texels, str(path), TextureShape.FLAT) == (
        "DISTAL_MAX_MEMORY is an amount of memory as \"4 GB\", not 'much'"
    )
    texture = distal.lang.Texture2D(str(path), max_memory="9 MB")
    assert "would become 9.8 MB" in refusal(distal.Shape2D.from_image, texture)


def test_amounts_of_memory():
    assert memory_of(None) is None
    assert [memory_of(a) for a in ("2 GB", "1.5MB", "7 kB", "7 KB", 12)] == [
        2 * 10**9, 1_500_000, 7000, 7000, 12
    ]  # fmt: skip
    for wrong in ("", "4", "GB", "-1 GB", "1e9 GB", True, 1.5, 0, -3, "0 GB"):
        with pytest.raises(ValueError, match="max_memory is"):
            memory_of(wrong)
    assert [shown(n) for n in (7, 999, 1000, 57_400, 1_100_000, 6_442_450_944)] == [
        "7 B", "999 B", "1.0 kB", "57 kB", "1.1 MB", "6.4 GB"
    ]  # fmt: skip


def ball_stl(far: float) -> bytes:
    """A tetrahedron with one corner far away."""
    points = np.array([(far, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], "<f4")
    rows = np.zeros(4, np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("e", "<u2")]))
    rows["p"] = points[[(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]]
    return bytes(80) + struct.pack("<I", 4) + rows.tobytes()


def test_a_point_far_away_is_refused_with_the_number_of_samples(tmp_path):
    path = tmp_path / "x.stl"
    path.write_bytes(ball_stl(400.0))
    assert re.fullmatch(
        r"'x\.stl' of 284 B would become [0-9.]+ GB: a spacing of 0\.02 needs [0-9,]+ numbers near "
        rf"the surface; {SMALL}; max_memory=\"\d GB\" or DISTAL_MAX_MEMORY=\dGB reads it anyway",
        refusal(distal.Shape.from_mesh, path, spacing=0.02),
    )


def test_long_triangles_are_counted_before_they_are_cut(tmp_path):
    path = tmp_path / "x.stl"
    rows = np.frombuffer(ball_stl(1.0)[84:], "u1")
    path.write_bytes(bytes(80) + struct.pack("<I", 40_000) + np.tile(rows, 10_000).tobytes())
    message = refusal(distal.Shape.from_mesh, path, max_memory="300 MB")
    assert "its 40,000 triangles meet" in message
    assert "cells of the grid and more; a wider spacing= has fewer; it may take 300 MB" in message


def test_headers_of_volumes_are_not_believed(tmp_path):
    path = tmp_path / "x.npy"
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        file, {"descr": "<f8", "fortran_order": False, "shape": (400, 400, 400)}
    )
    path.write_bytes(file.getvalue())
    assert refusal(read_volume, path) == (
        "'x.npy' of 128 B would become 1.5 GB: 400 x 400 x 400 samples; files of this size get 805 "
        'MB; max_memory="2 GB" or DISTAL_MAX_MEMORY=2GB reads it anyway'
    )
    assert "announces 64,000,000 samples and contains 0" in refusal(
        read_volume, path, max_memory="2 GB"
    )


# Time


def font_of_copies(depth: int) -> bytes:
    """A font whose glyph A is two of another one, which is two of another one, and so on."""
    from fontTools.fontBuilder import FontBuilder  # noqa: PLC0415
    from fontTools.pens.ttGlyphPen import TTGlyphPen  # noqa: PLC0415

    names = [".notdef", *(f"g{i}" for i in range(depth))]
    builder = FontBuilder(1000, isTTF=True)
    builder.setupGlyphOrder(names)
    builder.setupCharacterMap({65: names[-1]})
    glyphs = {name: TTGlyphPen(None).glyph() for name in names[:2]}
    for inner, name in itertools.pairwise(names[1:]):
        pen = TTGlyphPen(dict.fromkeys(names))
        pen.addComponent(inner, (1, 0, 0, 1, 0, 0))
        pen.addComponent(inner, (1, 0, 0, 1, 1, 0))
        glyphs[name] = pen.glyph()
    builder.setupGlyf(glyphs, calcGlyphBounds=False)
    for glyph in glyphs.values():
        glyph.xMin = glyph.yMin = glyph.xMax = glyph.yMax = 0
    builder.setupHorizontalMetrics(dict.fromkeys(names, (500, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupOS2()
    builder.setupPost()
    builder.font.recalcBBoxes = False
    builder.font["maxp"].recalc = lambda _: None
    file = io.BytesIO()
    builder.save(file)
    return file.getvalue()


def test_a_glyph_that_never_ends_is_ended(tmp_path, monkeypatch):
    """It draws nothing 2^40 times: no edge is counted, and fontTools asks nobody."""
    path = tmp_path / "x.ttf"
    path.write_bytes(font_of_copies(40))
    monkeypatch.setattr(foreign_files, "BASE_SECONDS", 0.3)
    monkeypatch.setattr(foreign_files, "SECONDS_A_MEGABYTE", 0.0)
    message = refusal(text_outline, "A", font=path)
    assert message.startswith("'x.ttf' of ")
    assert message.endswith(
        "is not read after 0 s, which files of this size get; DISTAL_MAX_MEMORY=2GB reads it anyway"
    )


def test_a_package_that_fills_the_memory_is_ended(monkeypatch):
    """As fontTools does with 60,000 ranges of all glyphs, which are a font of 620 kB."""
    monkeypatch.setattr(foreign_files, "BASE_BYTES", 2**26)
    kept = []

    def fill():
        for _ in range(1000):
            kept.append(b"x" * 2**20)
            time.sleep(0.001)

    def read():
        with reading("font", "x.ttf", 1):
            watched(fill)

    assert refusal(read) == (
        "'x.ttf' of 1 B takes more than 67 MB, which files of this size get; "
        "DISTAL_MAX_MEMORY=1GB reads it anyway"
    )
    assert len(kept) < 1000


def test_what_fails_after_its_time_is_an_error_too(monkeypatch):
    """While zlib unpacks, the thread's exception waits; then zlib's own comes first."""
    monkeypatch.setattr(foreign_files, "BASE_SECONDS", 0.0)
    packed = zlib.compress(bytes(10**8), 1)[:-1]

    def read():
        with reading("font", "x.ttf", 1):
            watched(lambda: [zlib.decompress(packed) for _ in range(3)])

    assert refusal(read).startswith("'x.ttf' of 1 B is not read after 0 s")


@pytest.mark.parametrize("mark", [b"wOFF", b"wOF2"])
def test_a_packed_font_is_refused(tmp_path, mark):
    """A table of 1 MB would unpack to 1 GB in one call."""
    path = tmp_path / "x.ttf"
    path.write_bytes(mark + bytes(100))
    assert refusal(text_outline, "A", font=path) == (
        "the font 'x.ttf' cannot be read: it is a packed font of web pages (WOFF): convert it to "
        ".ttf or .otf"
    )


def test_channels_of_an_exr_are_not_copied_for_each_of_them():
    copied = 0

    class CountedBytes(bytes):
        def __getitem__(self, place):
            nonlocal copied
            part = super().__getitem__(place)
            copied += len(part) if isinstance(part, bytes) else 1
            return CountedBytes(part) if isinstance(part, bytes) else part

    one = struct.pack("<iIii", 1, 0, 1, 1)
    data = CountedBytes(b"".join(b"%d\0%b" % (i, one) for i in range(1000)) + b"\0")
    assert len(exr_header._channels({"channels": ("chlist", data)})) == 1000
    assert copied < len(data)


def test_lists_of_different_lengths_are_counted(tmp_path, monkeypatch):
    """A list of no numbers is one byte of the file, and an array here."""
    monkeypatch.setattr(foreign_files, "BASE_BYTES", 0)
    path = tmp_path / "a.ply"
    head = "element face 60000\nproperty list uchar uchar vertex_indices"
    ply = f"ply\nformat binary_little_endian 1.0\n{head}\nend_header\n".encode()
    path.write_bytes(ply + b"\1\0" + bytes(59_999))
    assert "32,768 rows of lists of different lengths" in refusal(read_mesh, path)


@pytest.mark.parametrize(
    ("vertex", "face", "reason"),
    [
        ("float x", "int vertex_indices", "its polygons have no lists vertex_indices"),
        ("list int float x", "list int int vertex_indices", "its points have no x"),
    ],
)
def test_properties_of_a_ply_that_are_no_lists_or_are(tmp_path, vertex, face, reason):
    path = tmp_path / "a.ply"
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex 1\nproperty {vertex}\nproperty float y\n"
        f"property float z\nelement face 1\nproperty {face}\nend_header\n1 0 0 0\n3 0 0 0\n"
    )
    assert refusal(read_mesh, path) == f"'a.ply' is no PLY that can be read: {reason}"


def test_empty_lines_of_an_stl_are_read_once(tmp_path):
    """One line of it after the other was once tried with all that follow: hours for this file."""
    path = tmp_path / "x.stl"
    path.write_bytes(b"solid a\nfacet\n" + b"\n" * 3_000_000 + b"endsolid\n")
    assert refusal(read_mesh, path) == "'x.stl' is no STL that can be read: there is no triangle"


# Errors


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (struct.error("unpack requires 4 bytes"), "it ends early: unpack requires 4 bytes"),
        (EOFError(), "it ends early"),
        (zlib.error("Error -3"), "its packed part is damaged: Error -3"),
        (zipfile.BadZipFile("no"), "its packed part is damaged: no"),
        (RecursionError("maximum"), "its parts are nested too deeply"),
        (MemoryError(), "it needs more memory than there is"),
        (OverflowError("int too large"), "a number in it is too large"),
        (KeyError("glyf"), "it is damaged: a part of it is missing ('glyf')"),
        (UnicodeDecodeError("utf-8", b"\xff", 0, 1, "no"), "it is no text in UTF-8"),
        (AttributeError(), "it is damaged (AttributeError)"),
        (RuntimeError("two\nlines"), "two\\nlines"),
        (LoadError("it is truncated"), "it is truncated"),
    ],
)
def test_every_exception_of_a_reader_is_one_line(error, reason):
    with pytest.raises(LoadError) as caught, reading("volume", "a.nii", 1):
        raise error
    assert caught.value.message == f"'a.nii' is no volume that can be read: {reason}"


def test_what_an_author_interrupts_is_no_damage():
    with pytest.raises(KeyboardInterrupt), reading("volume", "a.nii", 1):
        raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.npy", "cannot read 'none.npy': No such file or directory"),
        (".", "cannot read '.': Is a directory"),
        ("empty.npy", "cannot read 'empty.npy': it is empty"),
        ("a\0b.npy", "cannot read 'a\\x00b.npy': embedded null byte"),
    ],
)
def test_what_is_no_file(tmp_path, monkeypatch, name, message):
    monkeypatch.chdir(tmp_path)
    Path("empty.npy").touch()
    with pytest.raises(LoadError) as caught, opened("volume", name):
        pass
    assert caught.value.message == message


def test_a_pipe_is_not_waited_for(tmp_path):
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no named pipes")
    os.mkfifo(tmp_path / "x.stl")
    assert refusal(read_mesh, tmp_path / "x.stl") == "cannot read 'x.stl': it is no ordinary file"


def test_arrays_of_the_author_have_no_budget():
    need(10**15, "numbers")


# No kind is forgotten

READING = {
    "open",
    "fdopen",
    "read_bytes",
    "read_text",
    "ZipFile",
    "TTFont",
    "loads",
    "fromstring",
    "frombuffer",
    "fromfile",
    "genfromtxt",
    "loadtxt",
    "memmap",
    "DictReader",
    "parse_path",
    "PngImageFile",
    "JpegImageFile",
    "File",
    "ParserCreate",
    "decompress",
    "decompressobj",
    "np.load",
    "numpy.load",
    "json.load",
    "pickle.load",
    "tomllib.load",
    "csv.reader",
}
# What reads files that distal, its author or the system wrote.
OWN = {
    "cli/doctor.py": "/proc/cpuinfo",
    "cli/messages.py": "/dev/null",
    "cli/progress_lines.py": "descriptors of the terminal",
    "cli/running.py": "descriptors of the terminal",
    "cluster/connecting.py": "the file of a scheduler that the author started",
    "cluster/local.py": "messages of its own workers",
    "compiler/kept_texts.py": "the cache",
    "devices/": "the cache, buffers of devices, the system",
    "editor/answers.py": "writes",
    "editor/links.py": "share links: a million characters at most, each error is LinkError",
    "editor/local/": "the files that the author edits, and what the app sends",
    "editor/messages/": "messages of the app",
    "editor/worker.py": "/dev/null",
    "export/": "what distal wrote, and files that were read before",
    "file_writer/": "writes, and compares what it replaces",
    "images/picture_files.py": "eight bytes; the readers of the formats do the rest",
    "images/metadata.py": "texts of pictures, within the readers of the formats",
    "ir/encoding.py": "programs from distal's own cluster",
    "lessons/page.py": "distal's own style sheet",
    "lessons/scenes.py": "the scene of a lesson, which was run",
    "library_stamp.py": "distal's own source",
    "loading.py": "the author's scene",
    "mesh/": "writes",
    "notebook/widget.py": "distal's own script",
    "pixels/": "within the readers of pictures, from bytes",
    "polygons/": "within read_mesh, read_points and read_volume",
    "read_watch.py": "/proc",
    "runtime/fingerprints.py": "files that were read before",
    "scene/rerender.py": "passes bytes to the readers of pictures",
    "sounds/reading.py": "within read",
    "sweeps/": "the table that distal wrote",
    "video/": "segments that distal encoded",
    "window/log.py": "writes",
}


def calls_that_read(tree: ast.Module) -> set[str]:
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            function = node.func
            name = getattr(function, "attr", getattr(function, "id", ""))
            module = getattr(getattr(function, "value", None), "id", "")
            found |= {name, f"{module}.{name}"} & READING
    return found


def test_whatever_reads_a_file_goes_through_the_wrapper():
    """A new module that reads files fails here until it uses ``foreign_files``, or says whose."""
    unused = set(OWN)
    for path in sorted(SOURCE.rglob("*.py")):
        name = path.relative_to(SOURCE).as_posix()
        text = path.read_text(encoding="utf-8")
        if name == "foreign_files.py" or not calls_that_read(ast.parse(text)):
            continue
        reasons = {
            own for own in OWN if name == own or (own.endswith("/") and name.startswith(own))
        }
        unused -= reasons
        wraps = re.search(r"\b(opened|reading)\(\n?\s*(\"|chosen)", text)
        assert wraps or reasons, f"{name} reads {calls_that_read(ast.parse(text))}"
    assert not unused


def test_each_kind_is_read_somewhere_and_damaged_by_the_sweep():
    source = "".join(p.read_text(encoding="utf-8") for p in sorted(SOURCE.rglob("*.py")))
    used = set(re.findall(r"\b(?:opened|reading|bounded)\(\s*\"([^\"]+)\"", source))
    meshes = {"STL", "OBJ", "PLY", "GLB", "3MF"}  # by ``READ_FORMATS``
    assert used | meshes == set(KINDS)
    assert {subject.kind for subject in SUBJECTS} - {"link"} == set(KINDS)
