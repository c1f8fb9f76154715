"""Files of meshes: what independent readers and checks find in them."""

import json
import math
import os
import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from distal.file_writer import SaveError
from distal.lang.units import UNITS
from distal.mesh.files.formats import MESH_FORMATS, OUTLINE_FORMATS, write, write_outlines
from distal.mesh.files.parts import Finish
from tests.mesh.sample_solids import Sample, box, sphere, volume

WEB = Path(__file__).parents[2] / "web"
CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
MATERIAL = "{http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"
PRUSA = "{http://schemas.slic3r.org/3mf/2017/06}mmu_segmentation"
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
# A box with three different sides, so that no two axes can be confused.
POINTS, TRIANGLES = box((1.0, 2.0, 4.0))
TWO_COLORS = np.array([RED] * 4 + [BLUE] * 8)


def solid(**more) -> Sample:
    return Sample(POINTS + np.array((3.0, 0.0, 0.0)), TRIANGLES, **more)


def loaded(path):
    """The mesh that trimesh reads; trimesh shares no code with distal."""
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    found = trimesh.load(str(path), process=True, force="mesh")
    assert len(found.faces) > 0
    return found


def model_of(path):
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
        for name in archive.namelist():
            ElementTree.fromstring(archive.read(name))
        return ElementTree.fromstring(archive.read("3D/3dmodel.model"))


def parts_of(path):
    """Points, triangles and attributes of each object of a 3MF file, checked by its schema."""
    model = model_of(path)
    assert model.tag == f"{CORE}model" and model.get("unit") == "millimeter"
    resources, build = model.find(f"{CORE}resources"), model.find(f"{CORE}build")
    groups = {each.get("id"): len(each) for each in resources if each.tag != f"{CORE}object"}
    numbers = [each.get("id") for each in resources]
    assert len(set(numbers)) == len(numbers) and all(int(n) > 0 for n in numbers)
    objects = resources.findall(f"{CORE}object")
    assert [i.get("objectid") for i in build] == [o.get("id") for o in objects]
    found = []
    for each in objects:
        if each.get("pid") is not None:
            assert 0 <= int(each.get("pindex")) < groups[each.get("pid")]
            assert numbers.index(each.get("pid")) < numbers.index(each.get("id"))
        mesh = each.find(f"{CORE}mesh")
        vertices = [tuple(float(v.get(a)) for a in "xyz") for v in mesh[0]]
        rows = [dict(t.attrib) for t in mesh[1]]
        triangles = np.array([[int(t[v]) for v in ("v1", "v2", "v3")] for t in rows])
        assert triangles.max() < len(vertices)
        assert all(len(set(t)) == 3 for t in triangles.tolist())
        for row in rows:
            if "pid" in row:
                last = groups[row["pid"]]
                assert all(int(row[p]) < last for p in ("p1", "p2", "p3") if p in row)
        found.append((np.array(vertices), triangles, rows, each))
    return found


@pytest.mark.parametrize("suffix", [s for s in MESH_FORMATS if s != ".3mf"])
@pytest.mark.parametrize("bed", [False, True])
def test_another_reader_finds_the_box_in_its_place(tmp_path, suffix, bed):
    path = tmp_path / f"part{suffix}"
    write(path, solid(), unit="cm", bed=bed)
    mesh = loaded(path)
    scale = 0.01 if suffix == ".glb" else 10.0
    size = (1.0, 4.0, 2.0) if suffix == ".stl" else (1.0, 2.0, 4.0)
    middle = np.array((0.0, 0.0, 0.0) if bed else (3.0, 0.0, 0.0))
    if bed:
        middle[2 if suffix == ".stl" else 1] = 1.0
    expected = np.array([middle - np.array(size) / 2, middle + np.array(size) / 2]) * scale
    assert mesh.bounds == pytest.approx(expected, abs=1e-6 * scale)
    assert mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(8.0 * scale**3, rel=1e-5)


@pytest.mark.parametrize(("suffix", "index"), [(".stl", 2), (".ply", 1)])
def test_what_was_up_is_up(tmp_path, suffix, index):
    points = np.array([(0.0, 0, 0), (1, 0, 0), (0, 0, 1), (0.2, 5, 0.2)])
    triangles = np.array([(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)])
    assert volume(points, triangles) > 0.0
    write(tmp_path / f"a{suffix}", Sample(points, triangles))
    mesh = loaded(tmp_path / f"a{suffix}")
    assert mesh.volume == pytest.approx(5.0 / 6.0)
    assert mesh.vertices[:, index].max() == pytest.approx(5.0)


def test_3mf_is_in_millimeters_with_z_up(tmp_path):
    write(tmp_path / "a.3mf", solid(name='lid "1" & <2>'), unit="inch", bed=True)
    ((points, triangles, _, element),) = parts_of(tmp_path / "a.3mf")
    assert element.get("name") == 'lid "1" & <2>'
    expected = [(-12.7, -50.8, 0.0), (12.7, 50.8, 50.8)]
    assert np.array([points.min(axis=0), points.max(axis=0)]) == pytest.approx(np.array(expected))
    assert volume(points, triangles) == pytest.approx(8.0 * 25.4**3)
    assert element.get("pid") is None


def test_3mf_has_the_colors_of_triangles_for_each_slicer(tmp_path):
    write(tmp_path / "a.3mf", solid(triangle_colors=TWO_COLORS))
    model = model_of(tmp_path / "a.3mf")
    colors = [c.get("color") for c in model.iter(f"{MATERIAL}color")]
    assert sorted(colors) == ["#0000FFFF", "#FF0000FF"]
    ((_, _, rows, element),) = parts_of(tmp_path / "a.3mf")
    shown = [colors[int(row["p1"])] for row in rows]
    assert shown == ["#FF0000FF"] * 4 + ["#0000FFFF"] * 8
    assert colors[int(element.get("pindex"))] == "#0000FFFF"  # the color of most triangles
    # Filament 1 is written "4", filament 2 "8"; the first is the most frequent color.
    assert [row[PRUSA] for row in rows] == ["8"] * 4 + ["4"] * 8


def test_3mf_numbers_sixteen_filaments_and_leaves_out_more(tmp_path):
    points, triangles = sphere(1)
    many = np.zeros((32, 3))
    many[:, 0] = (np.arange(32) % 16) / 15.0
    write(tmp_path / "a.3mf", Sample(points, triangles, triangle_colors=many))
    ((_, _, rows, _),) = parts_of(tmp_path / "a.3mf")
    assert len({row[PRUSA] for row in rows}) == 16
    assert {"4", "8", "0C", "1C", "DC"} <= {row[PRUSA] for row in rows}
    many[:, 1] = (np.arange(32) == 7) * 0.5
    write(tmp_path / "a.3mf", Sample(points, triangles, triangle_colors=many))
    ((_, _, rows, _),) = parts_of(tmp_path / "a.3mf")
    assert not any(PRUSA in row for row in rows)


def test_3mf_has_one_color_of_a_whole_part(tmp_path):
    red = np.tile(RED, (12, 1))
    parts = [solid(triangle_colors=red), solid(colors=np.tile(BLUE, (8, 1))), solid()]
    write(tmp_path / "a.3mf", parts, finishes=[None, None, Finish(color=(0.0, 1.0, 0.0))])
    model = model_of(tmp_path / "a.3mf")
    assert [c.get("color") for c in model.iter(f"{MATERIAL}color")] == ["#FF0000FF", "#0000FFFF"]
    assert [c.get("displaycolor") for c in model.iter(f"{CORE}base")] == ["#00FF00"]
    for _, _, rows, element in parts_of(tmp_path / "a.3mf"):
        assert element.get("pindex") == "0"
        assert not any("p1" in row for row in rows)


def test_3mf_has_colors_of_corners(tmp_path):
    colors = np.zeros((8, 3))
    colors[:4, 0] = 1.0
    write(tmp_path / "a.3mf", solid(colors=colors))
    ((_, triangles, rows, _),) = parts_of(tmp_path / "a.3mf")
    shades = [c.get("color") for c in model_of(tmp_path / "a.3mf").iter(f"{MATERIAL}color")]
    for corners, row in zip(triangles.tolist(), rows, strict=True):
        expected = ["#FF0000FF" if at < 4 else "#000000FF" for at in corners]
        found = [shades[int(row.get(p, row["p1"]))] for p in ("p1", "p2", "p3")]
        assert found == expected


def test_ply_has_display_codes(tmp_path):
    write(tmp_path / "a.ply", solid(triangle_colors=TWO_COLORS * 0.5))
    codes = np.asarray(loaded(tmp_path / "a.ply").visual.face_colors)[:, :3]
    assert codes.tolist() == [[188, 0, 0]] * 4 + [[0, 0, 188]] * 8


def test_obj_has_a_material_for_each_color(tmp_path):
    write(tmp_path / "two parts.obj", solid(triangle_colors=TWO_COLORS, name="é 1"))
    text = (tmp_path / "two parts.obj").read_text()
    assert "mtllib two parts.mtl\no __1\n" in text
    found = re.findall(r"usemtl (\w+)\n((?:f .*\n)+)", text)
    assert [(name, block.count("\n")) for name, block in found] == [
        ("color_0000ff", 8),
        ("color_ff0000", 4),
    ]
    assert "newmtl color_ff0000\nKd 1 0 0\n" in (tmp_path / "two parts.mtl").read_text()
    assert sorted(os.listdir(tmp_path)) == ["two parts.mtl", "two parts.obj"]


def glb_of(path):
    data = path.read_bytes()
    assert data[:4] == b"glTF" and int.from_bytes(data[8:12], "little") == len(data)
    size = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def test_glb_has_parts_with_materials_and_linear_colors(tmp_path):
    blue = Finish((0.25, 0.5, 1.0), metallic=1.0, roughness=0.2)
    glass = Finish(opacity=0.5, emission=(0.0, 0.1, 0.0))
    colors = np.full((8, 3), 0.5)
    write(
        tmp_path / "a.glb",
        [solid(name="lid", triangle_colors=TWO_COLORS), solid(colors=colors, name="")],
        finishes=[blue, glass],
    )
    content, data = glb_of(tmp_path / "a.glb")
    assert [node["name"] for node in content["nodes"]] == ["lid", "part 2"]
    first, second = content["materials"]
    assert first["pbrMetallicRoughness"] == {
        "baseColorFactor": [0.25, 0.5, 1.0, 1.0],
        "metallicFactor": 1.0,
        "roughnessFactor": 0.2,
    }
    assert second["alphaMode"] == "BLEND" and second["emissiveFactor"] == [0.0, 0.1, 0.0]
    at = content["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"]
    accessor = content["accessors"][at]
    view = content["bufferViews"][accessor["bufferView"]]
    row = np.frombuffer(data, "<u2", 4, view["byteOffset"])
    assert accessor["normalized"] and row.tolist() == [32768, 32768, 32768, 65535]
    # The 4 red triangles and the 8 blue ones share no point: 8 red and 8 blue ones.
    places = content["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    assert content["accessors"][places]["count"] == 16


def test_glb_passes_the_validator(tmp_path):
    if shutil.which("node") is None or not (WEB / "node_modules/gltf-validator").is_dir():
        pytest.skip("gltf-validator is not installed: cd web && npm ci")
    normals = POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True)
    normals[0] = 0.0
    every = [
        solid(),
        solid(normals=normals, colors=np.abs(normals)),
        solid(normals=normals, triangle_colors=TWO_COLORS),
    ]
    write(tmp_path / "a.glb", every, finishes=[Finish(opacity=0.3), None, Finish(transmission=0.9)])
    script = (
        "const v = require('gltf-validator'), fs = require('fs');"
        "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))"
        ".then(r => console.log(JSON.stringify(r)))"
    )
    command = ["node", "-e", script, str(tmp_path / "a.glb")]
    done = subprocess.run(command, cwd=WEB, capture_output=True, text=True, check=True)
    report = json.loads(done.stdout)
    assert report["issues"]["messages"] == []
    assert report["info"]["totalTriangleCount"] == 36


@pytest.mark.parametrize("suffix", MESH_FORMATS)
def test_the_bytes_are_always_the_same(tmp_path, suffix):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write(tmp_path / name / f"part{suffix}", solid(triangle_colors=TWO_COLORS))
    first, second = ((tmp_path / n / f"part{suffix}").read_bytes() for n in ("a", "b"))
    assert first == second


def test_units_are_meters():
    assert pytest.approx(12 * UNITS["inch"]) == UNITS["ft"]
    assert [UNITS[u] for u in ("um", "mm", "cm", "m")] == [1e-6, 1e-3, 1e-2, 1.0]


def edited(**changes):
    return Sample(**{"points": POINTS, "triangles": TRIANGLES, **changes})


BAD = [
    (edited(triangles=TRIANGLES[:0]), "the mesh has no triangle, so there is nothing to save"),
    (edited(triangles=TRIANGLES + 1), "a triangle names a point that is not among the 8"),
    (
        edited(triangles=TRIANGLES * 1.0),
        "a mesh's triangles are integers (m, 3), not float64 (12, 3)",
    ),
    (
        edited(points=np.where(POINTS > 0.4, np.nan, POINTS)),
        "row 1 of the mesh's points is (nan, -1, -2): it has no finite place",
    ),
    (edited(colors=TWO_COLORS), "the mesh has 12 colors, but needs 8"),
    (edited(points=POINTS[:, :2]), "a mesh's points are numbers (n, 3), not float64 (8, 2)"),
]


@pytest.mark.parametrize(("mesh", "message"), BAD)
def test_an_invalid_mesh_is_refused_and_leaves_no_file(tmp_path, mesh, message):
    with pytest.raises(SaveError) as caught:
        write(tmp_path / "a.stl", mesh)
    assert str(caught.value) == message
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "unit", "message"),
    [
        ("a.step", "mm", "a mesh is not saved as '.step': use one of .3mf, .stl, .glb, .ply, .obj"),
        (
            "part",
            "mm",
            "a mesh is not saved as the name 'part' without a suffix: use one of "
            ".3mf, .stl, .glb, .ply, .obj",
        ),
        ("a.stl", "yard", "a unit is one of um, mm, cm, m, inch, ft, not 'yard'"),
    ],
)
def test_unknown_words_are_refused(tmp_path, name, unit, message):
    with pytest.raises(SaveError) as caught:
        write(tmp_path / name, solid(), unit=unit)
    assert str(caught.value) == message


def test_too_many_materials_are_refused(tmp_path):
    points, triangles = sphere(4)
    shades = np.random.default_rng(1).random((len(triangles), 3))
    with pytest.raises(SaveError, match=r"save fewer colors, or as \.ply or \.glb"):
        write(tmp_path / "a.obj", Sample(points, triangles, triangle_colors=shades))
    assert os.listdir(tmp_path) == []


SQUARE = np.array([(1.0, 1.0), (4.0, 1.0), (4.0, 3.0), (1.0, 3.0)])
HOLE = np.array([(2.0, 1.5), (2.0, 2.5), (3.0, 2.0)])


def test_svg_is_in_real_size_with_y_down(tmp_path):
    write_outlines(tmp_path / "a.svg", [SQUARE, HOLE], unit="cm")
    svg = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert (svg.get("width"), svg.get("height"), svg.get("viewBox")) == (
        "30mm",
        "20mm",
        "0 0 30 20",
    )
    (path,) = svg
    assert path.get("fill-rule") == "evenodd"
    assert path.get("d") == "M0 20L30 20L30 0L0 0Z M10 15L10 5L20 10Z"


def test_dxf_has_closed_polylines(tmp_path):
    write_outlines(tmp_path / "a.dxf", [SQUARE, HOLE])
    lines = (tmp_path / "a.dxf").read_text().splitlines()
    pairs = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    assert pairs[-1] == (0, "EOF") and (1, "AC1009") in pairs
    rings, inside = [], False
    for code, value in pairs:
        if code == 0:
            inside = value == "VERTEX"
            if value == "POLYLINE":
                rings.append([])
        elif code == 70 and rings and not rings[-1]:
            assert value == "1"  # closed
        elif inside and code in (10, 20):
            rings[-1].append(float(value))
    assert [np.reshape(ring, (-1, 2)).tolist() for ring in rings] == [
        SQUARE.tolist(),
        HOLE.tolist(),
    ]


@pytest.mark.parametrize("suffix", OUTLINE_FORMATS)
@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([], "there is no outline to save: the shape has no edge here"),
        ([SQUARE[:2]], "outline 0 has 2 points, but needs 3"),
        ([SQUARE, HOLE * math.inf], "outline 1 has a point without a finite place"),
        ([POINTS], "outline 0 is an array (n, 2), not float64 (8, 3)"),
    ],
)
def test_invalid_outlines_are_refused(tmp_path, suffix, lines, message):
    with pytest.raises(SaveError) as caught:
        write_outlines(tmp_path / f"a{suffix}", lines)
    assert str(caught.value) == message
    assert os.listdir(tmp_path) == []
