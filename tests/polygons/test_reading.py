"""Files of meshes: what is read from them, and that damaged files are refused in words."""

import io
import json
import re
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from distal.diagnostics import LoadError
from distal.foreign_files import reading
from distal.mesh.files.formats import MESH_FORMATS, write
from distal.polygons.reading import READ_FORMATS, read_mesh
from distal.polygons.triangles import checked, welded
from tests.mesh.sample_solids import Sample, box, torus, volume

POINTS, TRIANGLES = box((1.0, 2.0, 4.0))
CUBE_STL = b"solid cube\n" + b"".join(
    b"facet normal 0 0 0\nouter loop\n"
    + b"".join(b"vertex %f %f %f\n" % tuple(p) for p in corners)
    + b"endloop\nendfacet\n"
    for corners in POINTS[TRIANGLES].tolist()
)
ASCII_PLY = """ply
format ascii 1.0
comment made by hand
element vertex 5
property float x
property float y
property double z
property uchar red
element face 3
property list uchar int vertex_indices
property float quality
end_header
0 0 0 255
1 0 0 255
1 1 0 255
0 1 0 255
0.5 0.5 2 255
4 3 2 1 0 0.5
3 0 1 4 0.5
5 1 2 4 3 4 0.5
"""
SQUARE_OBJ = """# a square with a roof
v 0 0 0 1 0 0
v 1 0 0 1.0
v 1 0 1
v 0 0 1
vt 0 0
f 1/1 2/1 3/1 4/1
v .5 1 .5
f -5//1 \\
  -4//1 -1//1
"""


def read(tmp_path: Path, name: str, data: bytes | str):
    path = tmp_path / name
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read_mesh(path)


def refused(tmp_path: Path, name: str, data: bytes | str) -> str:
    with pytest.raises(LoadError) as caught:
        read(tmp_path, name, data)
    return caught.value.message.replace(str(tmp_path) + "/", "")


def test_every_written_format_is_read():
    assert set(READ_FORMATS) == set(MESH_FORMATS)
    assert all(READ_FORMATS[s].z_up == MESH_FORMATS[s].z_up for s in READ_FORMATS)


@pytest.mark.parametrize("suffix", READ_FORMATS)
def test_what_was_written_is_read(tmp_path, suffix):
    ring, faces = torus(12, 6)
    parts = [Sample(ring, faces), Sample(POINTS + 5.0, TRIANGLES)]
    write(tmp_path / f"a{suffix}", parts, unit="inch")
    mesh = read_mesh(tmp_path / f"a{suffix}")
    scale = 0.0254 if suffix == ".glb" else 25.4
    assert (len(mesh.points), len(mesh.triangles)) == (80, 156)
    assert mesh.meters == {".glb": 1.0, ".3mf": 0.001}.get(suffix)
    expected = (volume(ring, faces) + 8.0) * scale**3
    assert volume(mesh.points, mesh.triangles) == pytest.approx(expected, rel=1e-5)
    up = 2 if READ_FORMATS[suffix].z_up else 1
    assert mesh.points[:, up].max() == pytest.approx(6.0 * scale)


def test_stl_as_text(tmp_path):
    mesh = read(tmp_path, "a.stl", CUBE_STL + b"endsolid cube\n")
    assert len(mesh.points) == 8
    assert volume(mesh.points, mesh.triangles) == pytest.approx(8.0)


def test_a_binary_stl_that_begins_with_solid(tmp_path):
    write(tmp_path / "a.stl", Sample(POINTS, TRIANGLES))
    data = b"solid facet" + (tmp_path / "a.stl").read_bytes()[11:]
    assert len(read(tmp_path, "a.stl", data).triangles) == 12


def test_ply_as_text_with_polygons(tmp_path):
    mesh = read(tmp_path, "a.ply", ASCII_PLY)
    assert mesh.triangles[:3].tolist() == [[3, 2, 1], [3, 1, 0], [0, 1, 4]]
    # The last polygon has a corner twice.
    assert len(mesh.triangles) == 6
    assert set(mesh.triangles[3:].reshape(-1).tolist()) == {1, 2, 3, 4}
    assert mesh.points[4].tolist() == [0.5, 0.5, 2.0]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("mixed", [False, True])
def test_binary_ply(tmp_path, order, mixed):
    word = {"<": "little", ">": "big"}[order]
    faces = [(0, 1, 2, 3), (0, 1, 4)] if mixed else [(0, 1, 2), (0, 1, 4)]
    body = b"".join(struct.pack(f"{order}hf2d", 7, i, 2.5, -i) for i in range(5))
    for each in faces:
        body += struct.pack(f"{order}B{len(each)}Hf", len(each), *each, 0.5)
    header = (
        f"ply\nformat binary_{word}_endian 1.0\nelement vertex 5\nproperty short s\n"
        "property float x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar ushort vertex_index\n"
        "property float quality\nend_header\n"
    )
    mesh = read(tmp_path, "a.ply", header.encode() + body)
    expected = [[0, 1, 2], [0, 2, 3], [0, 1, 4]] if mixed else [[0, 1, 2], [0, 1, 4]]
    assert mesh.triangles.tolist() == expected
    assert mesh.points[3].tolist() == [3.0, 2.5, -3.0]


def test_obj_with_polygons_and_indices_from_the_end(tmp_path):
    mesh = read(tmp_path, "a.obj", SQUARE_OBJ)
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4]]
    assert mesh.points[4].tolist() == [0.5, 1.0, 0.5]


def glb(content: dict, data: bytes) -> bytes:
    text = json.dumps(content).encode()
    chunks = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0")
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks) + len(data)) + chunks + data


TRIANGLE_GLB = {
    "nodes": [
        {"children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, 0.5**0.5, 0.5**0.5]},
        {"mesh": 0, "scale": [2, 3, 4]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
    ],
    "scenes": [{"nodes": [0]}],
    "meshes": [
        {
            "primitives": [
                {"attributes": {"POSITION": 0}, "mode": 5},
                {"attributes": {"POSITION": 0}, "mode": 1},
            ]
        }
    ],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 64, "byteStride": 16}],
    "buffers": [{"byteLength": 64}],
}
STRIP = np.zeros((4, 4), "<f4")
STRIP[:, :3] = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]


def test_glb_places_the_meshes_of_nodes(tmp_path):
    mesh = read(tmp_path, "a.glb", glb(TRIANGLE_GLB, STRIP.tobytes()))
    # A quarter turn about z takes (x, y) to (-y, x).
    first, second = mesh.points[:4], mesh.points[4:]
    assert first == pytest.approx(np.array([(10, 0, 0), (10, 2, 0), (7, 0, 0), (7, 2, 0)]))
    assert second == pytest.approx(np.array([(10, 0, 5), (10, -1, 5), (9, 0, 5), (9, -1, 5)]))
    # The second triangle of a strip and those of a mirrored node are turned around.
    edges = mesh.points[mesh.triangles]
    normals = np.cross(edges[:, 1] - edges[:, 0], edges[:, 2] - edges[:, 0])
    assert (normals[:, 2] > 0.0).all() and len(normals) == 4


def three_mf(model: str, names: dict[str, str] | None = None) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
        for name, text in (names or {}).items():
            archive.writestr(name, text)
    return file.getvalue()


CORE = 'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
PRODUCTION = 'xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"'
TETRAHEDRON = """<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>
<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
<triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>"""
MODEL = f"""<model unit="inch" {CORE} {PRODUCTION}><resources>
<object id="2"><components>
<component objectid="1" p:path="/3D/Objects/part.model" transform="2 0 0 0 2 0 0 0 2 5 0 0"/>
<component objectid="1" p:path="/3D/Objects/part.model" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>
</components></object></resources>
<build><item objectid="2" transform="0 1 0 -1 0 0 0 0 1 0 0 7"/></build></model>"""
PART = f'<model {CORE}><resources><object id="1">{TETRAHEDRON}</object></resources></model>'


def test_3mf_places_the_components_of_other_models(tmp_path):
    mesh = read(tmp_path, "a.3mf", three_mf(MODEL, {"3D/Objects/part.model": PART}))
    assert mesh.meters == 0.0254
    assert volume(mesh.points, mesh.triangles) == pytest.approx((8.0 + 1.0) / 6.0)
    # The first component's second point: (7, 0, 0), turned to (0, 7, 0), moved up by 7.
    assert mesh.points[1].tolist() == [0.0, 7.0, 7.0]


def test_equal_corners_are_joined_with_one_zero():
    corners = np.array([[(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(-0.0, 0, 0), (0, 1, 0), (0, 0, 1)]])
    points, which = welded(corners.reshape(-1, 3).astype(np.float32))
    assert len(points) == 4
    assert points[which] == pytest.approx(corners.reshape(-1, 3))


BINARY = struct.pack("<80sI", b"", 3) + bytes(60)
ENDLESS = MODEL.replace("/3D/Objects/part.model", "/3D/3dmodel.model").replace(
    '<component objectid="1"', '<component objectid="2"'
)
WRONG = [
    ("a.stl", b"", "cannot read 'a.stl': it is empty"),
    (
        "a.stl",
        BINARY,
        "'a.stl' is no STL that can be read: it announces 3 triangles and contains 1: "
        "it is truncated",
    ),
    (
        "a.stl",
        CUBE_STL[:600],
        "'a.stl' is no STL that can be read: it ends after 12 corners: it is truncated",
    ),
    (
        "a.stl",
        b"hello",
        "'a.stl' is no STL that can be read: it is neither binary STL nor its text: it begins with "
        "'hello'",
    ),
    ("a.stl", bytes(84), "'a.stl' is no STL that can be read: there is no triangle"),
    (
        "a.stl",
        struct.pack("<80sI12f", b"", 1, *[0] * 3, *[float("nan")] * 9) + bytes(2),
        "'a.stl' is no STL that can be read: point 0 is (nan, nan, nan), which is no place",
    ),
    (
        "a.obj",
        "v 0 0 0\nf 1 2 3\n",
        "'a.obj' is no OBJ that can be read: line 2: there is no point 2, the file has 1",
    ),
    (
        "a.obj",
        "v 0 0 0\nf 1 x 3\n",
        "'a.obj' is no OBJ that can be read: line 2: there is no point 'x'",
    ),
    ("a.obj", "f -1 -2 -3", "'a.obj' is no OBJ that can be read: line 1: there is no point '-1'"),
    ("a.obj", "v 0 0", "'a.obj' is no OBJ that can be read: line 1: a point needs three numbers"),
    ("a.obj", "v 0 0 0", "'a.obj' is no OBJ that can be read: there is no polygon"),
    (
        "a.ply",
        ASCII_PLY[:-8],
        "'a.ply' is no PLY that can be read: it is truncated: 'face' has 3 rows",
    ),
    (
        "a.ply",
        ASCII_PLY.replace("0.5 0.5 2", "0.5 half 2"),
        "'a.ply' is no PLY that can be read: line 17: 'half' is no number",
    ),
    (
        "a.ply",
        ASCII_PLY.replace("double z", "double w"),
        "'a.ply' is no PLY that can be read: its points have no z",
    ),
    (
        "a.ply",
        ASCII_PLY.replace("double z", "quad z"),
        "'a.ply' is no PLY that can be read: its header has the invalid line 'property quad z'",
    ),
    (
        "a.ply",
        ASCII_PLY.split("element face")[0] + "end_header\n" + "0 0 0 1\n" * 5,
        "'a.ply' is no PLY that can be read: it has points only, no polygons",
    ),
    (
        "a.ply",
        "ply\nformat ascii 1.0\nelement nothing 100000000\nend_header\n",
        "'a.ply' is no PLY that can be read: 'nothing' has no properties",
    ),
    (
        "a.glb",
        glb(TRIANGLE_GLB, STRIP.tobytes()[:-8]),
        "'a.glb' is no GLB that can be read: it is truncated: accessor 0 goes beyond the numbers",
    ),
    (
        "a.glb",
        glb({**TRIANGLE_GLB, "extensionsRequired": ["KHR_draco_mesh_compression"]}, b""),
        "'a.glb' is no GLB that can be read: it is compressed by KHR_draco_mesh_compression: "
        "save it without compression",
    ),
    (
        "a.glb",
        glb({**TRIANGLE_GLB, "nodes": [{"mesh": 0, "children": [0]}]}, STRIP.tobytes()),
        "'a.glb' is no GLB that can be read: node 0 is in the scene twice",
    ),
    (
        "a.glb",
        glb({**TRIANGLE_GLB, "meshes": 3}, STRIP.tobytes()),
        "'a.glb' is no GLB that can be read: 'meshes' in its JSON is no list",
    ),
    (
        "a.3mf",
        b"PK nothing",
        "'a.3mf' is no 3MF that can be read: it is no whole zip archive, as 3MF is: "
        "File is not a zip file",
    ),
    (
        "a.3mf",
        three_mf(MODEL),
        "'a.3mf' is no 3MF that can be read: it lacks the part '3D/Objects/part.model'",
    ),
    (
        "a.3mf",
        three_mf(ENDLESS),
        "'a.3mf' is no 3MF that can be read: its objects contain each other too often",
    ),
    (
        "a.3mf",
        three_mf('<!DOCTYPE a [<!ENTITY b "c">]>' + MODEL),
        "'a.3mf' is no 3MF that can be read: its part '3D/3dmodel.model' declares a document "
        "type, which 3MF forbids",
    ),
    (
        "a.step",
        b"ISO-10303-21;",
        "cannot read 'a.step': a mesh's suffix is one of .stl, .3mf, .obj, .ply, .glb",
    ),
]


@pytest.mark.parametrize(("name", "data", "message"), WRONG)
def test_a_wrong_file_is_refused_with_its_reason(tmp_path, name, data, message):
    assert refused(tmp_path, name, data) == message


def test_a_missing_file_and_a_folder_are_refused(tmp_path):
    with pytest.raises(LoadError, match=r"cannot read '.*none.stl': No such file or directory"):
        read_mesh(tmp_path / "none.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(LoadError, match=r"cannot read '.*folder.stl': Is a directory"):
        read_mesh(tmp_path / "folder.stl")


@pytest.mark.parametrize(
    ("points", "triangles", "message"),
    [
        ([(0, 0)], [(0, 0, 0)], r"points are numbers \(n, 3\), not int64 \(1, 2\)"),
        ([(0, 0, 0), (1,)], [(0, 0, 0)], "points are an array .* different lengths"),
        ([(0, 0, 0)], [(0, 0, -1)], "a triangle names point -1, and there are 1 points"),
        ([(0, 0, 0)], np.zeros((0, 3), int), "there is no triangle"),
    ],
)
def test_wrong_arrays_are_refused(points, triangles, message):
    with pytest.raises(LoadError, match=message):
        checked(points, triangles)


def _whole_files(folder: Path) -> list[tuple[str, bytes]]:
    for suffix in (".stl", ".ply", ".glb", ".3mf"):
        write(folder / f"a{suffix}", Sample(POINTS, TRIANGLES))
    written = [(s, (folder / f"a{s}").read_bytes()) for s in (".stl", ".ply", ".glb", ".3mf")]
    texts = [(".stl", CUBE_STL + b"endsolid"), (".ply", ASCII_PLY.encode())]
    return [
        *written,
        *texts,
        (".obj", SQUARE_OBJ.encode()),
        (".glb", glb(TRIANGLE_GLB, STRIP.tobytes())),
    ]


class _Files(list):
    def __repr__(self):
        return "files"


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> list[tuple[str, bytes]]:
    return _Files(_whole_files(tmp_path_factory.mktemp("whole")))


def survives(suffix: str, data: bytes) -> None:
    """Read damaged bytes: a mesh or a LoadError, and nothing else."""
    try:
        with reading(READ_FORMATS[suffix].name, "a", len(data)):
            mesh = READ_FORMATS[suffix].read(data)
    except LoadError as error:
        assert error.message and "\n" not in error.message
    else:
        assert np.isfinite(mesh.points).all()
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.points)


@settings(max_examples=300, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_bytes_never_end_in_another_exception(whole, data):
    suffix, content = whole[data.draw(st.integers(0, len(whole) - 1))]
    damaged = bytearray(content)
    for _ in range(data.draw(st.integers(0, 3))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        damaged = damaged[: data.draw(st.integers(0, len(damaged)))]
    survives(suffix, bytes(damaged))


VALUES = st.sampled_from(
    [None, True, -1, 0, 1, 2, 7, 2**40, 1e308, -0.5, "a", "VEC3", [], [0], [1e300] * 3, {}, [{}]]
)


@settings(max_examples=200, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_json_never_ends_in_another_exception(data):
    content = json.loads(json.dumps(TRIANGLE_GLB))
    for _ in range(data.draw(st.integers(1, 2))):
        at = content
        while True:
            keys = sorted(at) if isinstance(at, dict) else range(len(at))
            if not keys:
                break
            key = data.draw(st.sampled_from(keys))
            if isinstance(at[key], dict | list) and data.draw(st.booleans()):
                at = at[key]
                continue
            at[key] = data.draw(VALUES)
            break
    survives(".glb", glb(content, STRIP.tobytes()))


WORDS = st.sampled_from(["", "1e999", "nan", "-1", "99999999999999999999", "x", "0 1", "2", "é"])


@settings(max_examples=200, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_damaged_xml_never_ends_in_another_exception(data):
    model = MODEL.replace("</resources>", f'<object id="1">{TETRAHEDRON}</object></resources>')
    model = model.replace(' p:path="/3D/Objects/part.model"', "")
    values = [each.span(1) for each in re.finditer(r'"([^"]*)"', model)]
    low, high = data.draw(st.sampled_from(values))
    survives(".3mf", three_mf(model[:low] + data.draw(WORDS) + model[high:]))
