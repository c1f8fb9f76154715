"""Colors of meshes: read from each format, shown where the mesh has them, on every target."""

import json
import struct
import zipfile

import numpy as np
import pytest

from distal import Camera, OrthographicCamera, Scene, Shape, compile
from distal.diagnostics import LoadError
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.lang.srgb import decode_srgb, encode_srgb
from distal.mesh.files.formats import write
from distal.polygons import colors, importing
from distal.polygons.reading import READ_FORMATS, read_mesh
from distal.polygons.triangles import checked, colored
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from distal.scene.viewing.viewable import viewable
from tests.mesh.sample_solids import Sample, box, sphere, torus
from tests.parity.test_scenes import TARGETS, difference, drawn

POINTS, TRIANGLES = torus(48, 24)
# Linear light that changes along all axes.
LIGHT = np.stack([0.5 + 0.35 * POINTS[:, 0], 0.3 + POINTS[:, 1], 0.5 - 0.35 * POINTS[:, 2]], axis=1)
OF_TRIANGLES = np.linspace(0.0, 1.0, 3 * len(TRIANGLES)).reshape(-1, 3)


def shown(light):
    return np.asarray(encode_srgb(np.asarray(light, np.float32)))


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".glb", ".3mf"])
def test_colors_of_points_are_read(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    write(path, Sample(POINTS, TRIANGLES, colors=LIGHT), unit="mm")
    assert read_mesh(path).colors is None
    mesh = read_mesh(path, with_colors=True)
    found = mesh.colors if not mesh.is_light else shown(mesh.colors)
    # Points may be in another order and written once for each color.
    middles = mesh.points[mesh.triangles].mean(axis=1)
    assert len(mesh.triangles) == len(TRIANGLES) and mesh.colors.shape == mesh.points.shape
    ours = shown(LIGHT)[TRIANGLES].mean(axis=1)
    theirs = found[mesh.triangles].mean(axis=1)
    np.testing.assert_allclose(theirs, ours, atol=2.0 / 255.0)
    assert np.ptp(middles, axis=0).max() > 0.0


@pytest.mark.parametrize("suffix", [".ply", ".3mf", ".glb"])
def test_colors_of_triangles_are_read_sharp(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    write(path, Sample(POINTS, TRIANGLES, triangle_colors=OF_TRIANGLES))
    mesh = read_mesh(path, with_colors=True)
    found = mesh.colors if not mesh.is_light else shown(mesh.colors)
    for corner in range(3):
        each = found[mesh.triangles[:, corner]]
        np.testing.assert_allclose(each, shown(OF_TRIANGLES), atol=2.0 / 255.0)


def test_a_material_of_glb_colors_its_part(tmp_path):
    write(tmp_path / "a.glb", Sample(*box()))
    data = (tmp_path / "a.glb").read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    content = json.loads(data[20 : 20 + size])
    content["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 1.0]}}]
    content["meshes"][0]["primitives"][0]["material"] = 0
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    (tmp_path / "a.glb").write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + rest)
    mesh = read_mesh(tmp_path / "a.glb", with_colors=True)
    assert mesh.is_light
    np.testing.assert_allclose(mesh.colors, np.tile((0.2, 0.4, 0.6), (len(mesh.points), 1)))


def test_materials_of_3mf_color_objects_without_colors_of_their_own(tmp_path):
    model = (
        '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
        '><resources><basematerials id="7"><base name="a" displaycolor="#FF0000"/><base name="b" '
        'displaycolor="#0000FFFF"/></basematerials><object id="1" type="model" pid="7" pindex="1">'
        '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" '
        'z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="2" '
        'v3="1" pid="7" p1="0"/></triangles></mesh></object></resources><build><item objectid="1"/>'
        "</build></model>"
    )
    for text, expected in (
        (model, [(0, 0, 1)] * 3 + [(1, 0, 0)] * 3),
        (
            model.replace('p1="0"', 'p1="0" p2="1" p3="1"'),
            [(0, 0, 1)] * 3 + [(1, 0, 0)] + [(0, 0, 1)] * 2,
        ),
    ):
        with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
            archive.writestr("3D/3dmodel.model", text)
        assert np.array_equal(read_mesh(tmp_path / "a.3mf", with_colors=True).colors, expected)
    for text, message in (
        (model.replace("#FF0000", "red"), "the color 'red' is not as in #rrggbb"),
        (model.replace('p1="0"', 'p1="2"'), "a triangle names the color 2/2/2, of 2"),
    ):
        with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
            archive.writestr("3D/3dmodel.model", text)
        with pytest.raises(LoadError, match=message):
            read_mesh(tmp_path / "a.3mf", with_colors=True)
        assert len(read_mesh(tmp_path / "a.3mf").triangles) == 2  # without colors as before


def of_grid(grid, places):
    """The color of a grid at places, of its nearest node."""
    at = (places - np.array(grid.middle)) / np.array(grid.size) + 0.5
    x, y, z = (at * grid.values.shape[2::-1]).astype(int).T
    return grid.values[z, y, x]


def test_a_node_has_the_color_of_the_nearest_place():
    points, triangles = sphere(4)
    light = 0.5 + 0.45 * points  # linear along each axis
    grid = colors.color_grid(colored(checked(points, triangles), light, is_light=True), 0.1)
    nodes = np.stack(np.indices(grid.values.shape[:3])[::-1], axis=-1).reshape(-1, 3)
    places = np.array(grid.middle) + (nodes + 0.5 - 0.5 * np.array(grid.values.shape[2::-1])) * 0.1
    away = np.linalg.norm(places, axis=1)
    near = away > 0.5
    foot = places[near] / away[near, None]
    expected = 0.5 + 0.45 * foot
    found = np.asarray(decode_srgb((grid.values.reshape(-1, 3)[near] / 255.0).astype(np.float32)))
    # The triangles are flat: colors between their corners differ by half of their sag, .005, and
    # far away the nearest triangle is another one; one code of 255 is up to .008 of light.
    np.testing.assert_allclose(found, expected, atol=0.03)


def test_colors_between_triangles_are_sharp_up_to_the_spacing():
    points, triangles = box((2.0, 2.0, 2.0))
    mesh = checked(points, triangles)
    sides = np.abs(points[triangles].mean(axis=1)).argmax(axis=1)
    grid = colors.color_grid(colored(mesh, np.eye(3)[sides], of="triangles"), 0.1)
    places = np.random.default_rng(1).uniform(-0.85, 0.85, (500, 3))
    for axis in range(3):
        on = places.copy()
        on[:, axis] = 1.0
        assert (of_grid(grid, on) == 255 * np.eye(3)[axis]).all()


def test_a_fine_grid_has_coarser_colors():
    mesh = colored(checked(POINTS, TRIANGLES), LIGHT.clip(0.0, 1.0))
    grid = colors.color_grid(mesh, 0.005)
    count = np.prod(grid.values.shape[:3])
    assert 0.8 * colors.MOST_NODES < count <= colors.MOST_NODES


@pytest.fixture(scope="module")
def painted() -> Shape:
    return Shape.from_mesh(POINTS, TRIANGLES, spacing=0.05, colors=LIGHT)


def scene_of(shape: Shape) -> Scene:
    camera = Camera(position=(1.5, 1.8, 2.5), target=(0.0, 0.0, 0.0))
    return Scene(shape, camera=camera)


def material_seen_from_above(shape: Shape) -> np.ndarray:
    """The colors without light; 64 pixels are 4 units."""
    camera = OrthographicCamera(position=(0.0, 5.0, 0.0), up=(0.0, 0.0, -1.0), height=4.0)
    seen = Scene(shape, camera=camera)
    return np.asarray(seen.render(size=(64, 64), samples=1, view="material").array[..., :3])


def test_the_picture_shows_the_colors_where_the_mesh_has_them(painted):
    picture = material_seen_from_above(painted)
    y, x = np.mgrid[0:64, 0:64]
    place = np.stack([(x - 31.5) / 16.0, (y - 31.5) / 16.0], axis=-1)  # x, z
    out = np.hypot(place[..., 0], place[..., 1])
    on = np.abs(out - 1.0) < 0.15
    height = np.sqrt(0.25**2 - (out[on] - 1.0) ** 2)
    light = [0.5 + 0.35 * place[on][:, 0], 0.3 + height, 0.5 - 0.35 * place[on][:, 1]]
    expected = shown(np.stack(light, axis=1))
    np.testing.assert_allclose(picture[on], expected, atol=0.03)


def test_the_colors_move_with_bricks_and_operators(monkeypatch, painted):
    monkeypatch.setattr(importing, "_MOST_WHOLE", 1000)
    bricks = Shape.from_mesh(POINTS, TRIANGLES, spacing=0.05, colors=LIGHT)
    assert bricks.imported[0].bricks
    away = difference(material_seen_from_above(bricks), material_seen_from_above(painted))
    assert away.is_agreement, away
    turned = material_seen_from_above(painted.rotate(y=np.pi))
    np.testing.assert_allclose(
        turned[::-1, ::-1][28:36], material_seen_from_above(painted)[28:36], atol=0.02
    )


@pytest.mark.parametrize("target", TARGETS)
def test_drivers_draw_the_cpu_picture(painted, target):
    scene = scene_of(painted)
    cpu = scene.render(size=(96, 72), samples=1).array
    assert np.ptp(cpu[..., :3].mean(axis=(0, 1))) > 0.01
    found = difference(drawn(scene, target), cpu)
    assert found.is_agreement, found


def test_it_compiles_to_every_target_and_a_page_has_bytes(painted):
    scene = scene_of(painted)
    for target in ("glsl-es300", "wgsl", "llvm", "glsl-330"):
        assert len(compile(scene, target=target).text) > 200
    made = payload(viewable(scene), PageOptions(size=(96, 72), views=("color",)))
    formats = {r["format"] for r in made["resources"].values() if r["type"] == "Texture3D"}
    assert formats == {"float32", "rgba8"}


def test_a_file_with_colors_is_painted_and_moved_as_one(tmp_path):
    write(tmp_path / "a.ply", Sample(POINTS, TRIANGLES, colors=LIGHT))
    shape = Shape.from_mesh(tmp_path / "a.ply", spacing=0.1, colors=True)
    (child,) = shape.node.children
    assert child.material is not None
    (plain,) = Shape.from_mesh(tmp_path / "a.ply", spacing=0.1).node.children
    assert plain.material is None


def test_wrong_colors_are_refused(tmp_path):
    write(tmp_path / "a.stl", Sample(*box()))
    write(tmp_path / "a.obj", Sample(*box()))
    cases = [
        ((tmp_path / "a.stl",), True, "'a.stl' has no colors that are read: leave out colors=True"),
        ((tmp_path / "a.obj",), True, "'a.obj' has no colors that are read: leave out colors=True"),
        (box(), True, "'arrays' has no colors that are read"),
        (box(), np.ones((7, 3)), r"there are 8 points, and colors are \(7, 3\)"),
        (box(), np.full((8, 3), 2.0), "color 0 is no color: its numbers are from 0 to 1"),
        (box(), np.full((8, 3), np.nan), "color 0 is no color"),
        (box(), ["red"] * 8, "colors are numbers"),
    ]
    for arguments, given, message in cases:
        with pytest.raises(SceneValueError, match=message):
            Shape.from_mesh(*arguments, spacing=0.2, colors=given)
    with pytest.raises(SceneTypeError, match="a file has its own colors: colors=True shows them"):
        Shape.from_mesh(tmp_path / "a.obj", colors=np.ones((8, 3)))


def test_formats_with_colors_say_so():
    assert [suffix for suffix, f in READ_FORMATS.items() if f.colored is None] == [".stl"]
