"""Shapes from meshes: an ordinary shape everywhere, and what an author is told."""

import re
import subprocess
import sys
import warnings

import numpy as np
import pytest

from distal import Camera, Scene, Shape, Sphere, compile, matte
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.mesh.files.formats import write
from distal.polygons.distances import SIGNS
from distal.scene.objects import mesh_shapes
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from distal.scene.viewing.viewable import viewable
from tests.mesh.sample_solids import Sample, box, sphere, torus
from tests.parity.test_scenes import TARGETS, difference, drawn

SIZE = (96, 72)


@pytest.fixture(scope="module")
def ring() -> Shape:
    return Shape.from_mesh(*torus(48, 24), spacing=0.1)


def of_torus(p):
    return np.hypot(np.hypot(p[..., 0], p[..., 2]) - 1.0, p[..., 1]) - 0.25


def test_values_and_normals_are_those_of_the_solid(ring):
    u, v = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, (2, 2000))
    normal = np.stack([np.cos(v) * np.cos(u), np.sin(v), np.cos(v) * np.sin(u)], axis=1)
    middle = np.stack([np.cos(u), 0.0 * u, np.sin(u)], axis=1)
    points = (middle + 0.25 * normal).astype(np.float32)
    # Trilinear: spacing^2 / 8 times the curvatures, 1 / .25 and 1 / .75, and the triangles' sag.
    assert np.abs(ring(points)).max() < 0.01 / 8.0 * (4.0 + 1.33) + 0.005
    assert (ring.gradient(points) * normal).sum(axis=1).min() > 0.8
    assert ring.slope == pytest.approx(3.0**0.5)


def test_outside_the_grid_it_is_a_lower_bound(ring):
    points = np.random.default_rng(4).normal(size=(2000, 3)).astype(np.float32) * 5.0
    true = of_torus(points)
    far = true > 0.5
    assert (ring(points)[far] <= true[far] + 0.005).all()
    # The distance to the grid, and the value there, at a right angle.
    assert (ring(points)[far] >= 0.7 * (true[far] - 0.1)).all()


def test_its_box_contains_it_and_the_margin(ring):
    low, high = ring.bounds()
    assert (np.array(low) <= (-1.25, -0.25, -1.25)).all()
    assert (np.array(high) >= (1.25, 0.25, 1.25)).all()
    assert (np.array(high) - low <= np.array((2.5, 0.5, 2.5)) + 6.5 * 0.1).all()


def test_every_operator_works_on_it(ring):
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (500, 3)).astype(np.float32)
    made = (ring.rotate(x=0.5).scale(0.5) | Sphere(0.3)).round(0.05).paint(matte("red"))
    assert made(points).shape == (500,)
    half = ring.translate(0.0, 1.0, 0.0)
    assert half(points) == pytest.approx(ring(points - np.array((0, 1, 0), np.float32)), abs=1e-5)


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl", "llvm", "glsl-330"])
def test_it_compiles_to_every_target_with_volumes(ring, target):
    assert len(compile(ring, target=target).text) > 200


def scene_of(ring: Shape) -> Scene:
    camera = Camera(position=(1.5, 1.8, 2.5), target=(0.0, 0.0, 0.0))
    return Scene(ring | Sphere(0.35), camera=camera)


def test_the_reference_draws_the_cpu_picture(ring):
    scene = scene_of(ring)
    cpu = scene.render(size=(32, 24), samples=1).array
    assert cpu[..., :3].std() > 0.05
    found = difference(scene.render(size=(32, 24), samples=1, device="reference").array, cpu)
    assert found.is_agreement, found


@pytest.mark.parametrize("target", TARGETS)
def test_drivers_draw_the_cpu_picture(ring, target):
    scene = scene_of(ring)
    found = difference(drawn(scene, target), scene.render(size=SIZE, samples=1).array)
    assert found.is_agreement, found


def test_a_page_carries_one_number_for_each_sample(ring):
    options = PageOptions(size=SIZE, views=("color",))
    made = payload(viewable(scene_of(ring)), options, packed=False)
    volumes = [r for r in made["resources"].values() if r["type"] == "Texture3D"]
    (volume,) = volumes
    x, y, z = ring.imported[0].samples
    assert volume["size"] == [x, y, z] and volume["grey"] and volume["format"] == "float32"
    assert len(volume["data"]) == -(-4 * x * y * z // 3) * 4


def test_a_file_is_found_beside_the_author_and_stands_up(tmp_path):
    points, triangles = box((1.0, 4.0, 2.0))
    for suffix in (".stl", ".3mf", ".ply", ".obj", ".glb"):
        write(tmp_path / f"a{suffix}", Sample(points + np.array((0.0, 2.0, 0.0)), triangles))
        part = Shape.from_mesh(tmp_path / f"a{suffix}", spacing=0.2, unit="mm")
        # 4 high, from 0 to 4, whatever the axes and the unit of the file are.
        places = np.array([(0.0, 3.8, 0.0), (0.0, 4.3, 0.0), (0.0, -0.3, 0.0), (0.0, 2.0, 0.9)])
        assert part(places) == pytest.approx([-0.2, 0.3, 0.3, -0.1], abs=1e-4)
    lying = Shape.from_mesh(tmp_path / "a.ply", spacing=0.2, up="z")
    assert lying(np.array([(0.0, 0.0, -3.8)])) == pytest.approx([-0.2], abs=1e-4)
    (tmp_path / "scene.py").write_text(
        "from distal import Shape\nshape = Shape.from_mesh('a.stl', spacing=0.25)\n"
    )
    code = f"import distal; print(distal.load({str(tmp_path / 'scene.py')!r}).imported[0])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path.parent
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("a.stl: 12 triangles, the mesh is closed; 9 x 21 x 13 samples")


def test_a_glb_is_in_meters_unless_a_unit_is_given(tmp_path):
    write(tmp_path / "a.glb", Sample(*box((200.0, 400.0, 100.0))))
    assert Shape.from_mesh(tmp_path / "a.glb").imported[0].volume == pytest.approx(0.008, rel=1e-5)
    in_cm = Shape.from_mesh(tmp_path / "a.glb", unit="cm")
    assert in_cm.imported[0].volume == pytest.approx(8000.0, rel=1e-5)


def test_what_is_rounded_off_is_measured():
    points, triangles = sphere(4)
    report = Shape.from_mesh(points, triangles, spacing=0.1).imported[0]
    assert (report.name, report.triangles, report.spacing) == ("arrays", 2048, 0.1)
    assert report.measured == 4096 and report.sign == "normals"
    assert 0.0 < report.mean < report.largest < 0.1**2 / 8.0 * 2.0 + 0.005
    assert report.volume == pytest.approx(4.0 * np.pi / 3.0, rel=0.01)
    assert "the surface is off by" in str(report)
    # The corner of a box is cut by trilinear interpolation, at most by 0.87 spacings.
    cut = Shape.from_mesh(*box(), spacing=0.13).imported[0]
    assert 0.01 < cut.largest < 0.87 * 0.13


def test_reports_survive_operators(ring):
    other = Shape.from_mesh(*box(), spacing=0.2)
    made = (ring.scale(2.0) | ring.rotate(x=1.0)) - other
    assert {r.triangles for r in made.imported} == {12, 2304} and len(made.imported) == 2
    assert Sphere(1.0).imported == ()


def warned(*arrays, **options) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Shape.from_mesh(*arrays, **options)
    assert all(w.filename == __file__ for w in caught)
    return [str(w.message) for w in caught]


def test_warnings_name_the_fix():
    points, triangles = sphere(3)
    assert warned(points, triangles, spacing=0.2) == []
    assert warned(points, triangles[:, ::-1], spacing=0.2) == [
        "'arrays' is inside out (its volume is -4.09): it was turned around; flip its normals in "
        "the file"
    ]
    assert warned(points, triangles[1:], spacing=0.2) == [
        "'arrays': the mesh is open, with 3 open edges: holes are closed where the winding number "
        "is 0.5; close them in the file, or give sign='unsigned' and .round(thickness) for a sheet"
    ]
    body, faces = box()
    plate = box((1.0, 1.0, 0.02))[0] + np.array((0.0, 0.0, 1.1))
    both = np.concatenate([body, plate]), np.concatenate([faces, faces + 8])
    share = (2.0 + 4 * 0.02) / (6.0 + 2.0 + 4 * 0.02)
    assert warned(*both, spacing=0.2) == [
        f"'arrays' has parts thinner than the samples are apart (0.2): {share:.1%} of its surface "
        "is lost; give spacing=0.1"
    ]
    assert warned(*both, spacing=0.015) == []


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (("none.stl",), {}, "error: cannot read 'none.stl': No such file or directory"),
        ((box()[0], [(0, 1, 8)]), {}, "error: a triangle names point 8, and there are 8 points"),
        (box(), {"sign": "up"}, "error: a sign is one of 'auto', 'normals', 'winding', 'unsigned'"),
        (box(), {"up": "x"}, "error: up is 'y' or 'z', not 'x'"),
        (box(), {"spacing": 0.0}, "error: a spacing is above 0, not 0"),
        (box(), {"spacing": "fine"}, "error: 'spacing' takes a number, not str 'fine'"),
        (box(), {"unit": "yard"}, "error: a unit is one of um, mm, cm, m, inch, ft, not 'yard'"),
    ],
)
def test_wrong_values_are_refused_at_the_line(arguments, options, message):
    with pytest.raises(SceneValueError) as caught:
        Shape.from_mesh(*arguments, **options)
    assert str(caught.value).startswith(message)
    assert re.search(r"test_mesh_shapes.py:\d+", str(caught.value))


def test_what_is_no_mesh_is_refused():
    with pytest.raises(SceneTypeError, match="a mesh is a file or two arrays, not int"):
        Shape.from_mesh(7)


def test_the_ways_to_find_the_inside_are_declared_once():
    assert mesh_shapes._SIGNS == SIGNS


def test_a_sheet_is_made_of_an_open_mesh():
    points = np.array([(-1.0, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)])
    sheet = Shape.from_mesh(points, [(0, 2, 1), (0, 3, 2)], spacing=0.1, sign="unsigned")
    plate = sheet.round(0.15)
    assert plate((0.0, 0.2, 0.0)) == pytest.approx(0.05, abs=0.01)
    assert plate((0.0, 0.0, 0.0)) < 0.0 < plate((1.5, 0.0, 0.0))


def test_a_file_that_did_not_change_is_computed_once(tmp_path, monkeypatch):
    write(tmp_path / "a.stl", Sample(*box()))
    first = Shape.from_mesh(tmp_path / "a.stl", spacing=0.2)
    monkeypatch.setattr(
        "distal.polygons.importing.read_mesh", lambda path, **_: pytest.fail("read")
    )
    assert Shape.from_mesh(tmp_path / "a.stl", spacing=0.2).imported == first.imported
    monkeypatch.undo()
    write(tmp_path / "a.stl", Sample(*box((2.0, 1.0, 1.0)), name="changed"))
    again = Shape.from_mesh(tmp_path / "a.stl", spacing=0.2)
    assert again.imported[0].volume != first.imported[0].volume
