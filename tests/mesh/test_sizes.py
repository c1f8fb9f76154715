"""Sizes as a machinist measures them: holes, shafts, volumes, and what the command prints."""

from __future__ import annotations

import json
import math
import re
import struct
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner

from distal import Box, CompileError, Cylinder, Sphere, Torus
from distal.cli.application import application
from distal.mesh.kernels import FieldKernels
from distal.mesh.meshing import MeshRequest, extent_of
from distal.mesh.surface_box import largest_side

SOUND = {"open_edges": 0, "pinched_points": 0, "intersections": 0}
HOLE = 2.2
DEGREES_5 = math.radians(5.0)
PLACES = ((-61.3, 27.1), (3.7, -44.9), (48.2, 52.6), (71.9, -12.3))


def section(mesh, axis, height):
    """The segments in which a plane across an axis meets the triangles, of shape (n, 2, 3)."""
    corners = mesh.points[mesh.triangles]
    above = corners[:, :, axis] > height
    corners = corners[above.any(axis=1) & ~above.all(axis=1)]
    found = []
    for triangle in corners:
        ends = []
        for a, b in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            if (a[axis] > height) != (b[axis] > height):
                ends.append(a + (b - a) * (height - a[axis]) / (b[axis] - a[axis]))
        found.append(ends)
    return np.array(found)


def inscribed(segments, center, reach):
    """The diameter of the largest circle about a place that no segment enters."""
    a, b = segments[:, 0], segments[:, 1]
    near = np.linalg.norm(0.5 * (a + b) - center, axis=1) < reach
    a, way = a[near], (b - a)[near]
    assert len(a) >= 6, "there is no hole"
    squares = np.maximum(np.einsum("ij,ij->i", way, way), 1e-30)
    share = np.clip(np.einsum("ij,ij->i", center - a, way) / squares, 0.0, 1.0)
    return 2.0 * float(np.linalg.norm(a + way * share[:, None] - center, axis=1).min())


def volume_of(mesh):
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def plate(side, thick=10.0):
    made = Box(side, thick, side)
    for x, z in PLACES:
        made -= Cylinder(0.5 * HOLE, 4.0 * thick).translate(x * side / 200, 0, z * side / 200)
    return made


FLOOR = ((-7, -5), (7, 5))


def case():
    """A case of 28 with a wall of 2, rounded, and screw holes in its floor."""
    made = Box(24, 8, 20).round(2.0) - Box(24, 10, 20).translate(0, 3, 0)
    for x, z in FLOOR:
        made -= Cylinder(0.5 * HOLE, 20.0).translate(x, -5, z)
    return made


@pytest.mark.sample(2)
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_holes_of_a_plate_measure_what_was_modelled(turn):
    shape = plate(200.0).rotate(y=turn)
    mesh = shape.mesh(angle=math.radians(10.0), check=True, colors=False)
    assert mesh.report["check"] == SOUND
    segments = section(mesh, 1, 0.123)
    for x, z in PLACES:
        center = np.array((x, z))
        c, s = math.cos(turn), math.sin(turn)
        at = np.array((c * x + s * z, 0.123, c * z - s * x))
        assert abs(inscribed(segments, at, 3.0) - HOLE) <= 0.02, center
    assert mesh.report["warnings"] == []


def test_holes_of_a_case_measure_what_was_modelled():
    # The tolerance is that of a case of 91: wide for a hole of this size.
    mesh = case().mesh(0.18, angle=math.radians(10.0), colors=False)
    segments = section(mesh, 1, -5.1)
    for x, z in FLOOR:
        assert abs(inscribed(segments, np.array((x, -5.1, z)), 3.0) - HOLE) <= 0.02


@pytest.mark.sample(2)
@pytest.mark.parametrize(("turn", "height"), [(0.0, 60.0), (0.0, 12.0), (0.5, 60.0)])
def test_a_shaft_has_its_size_and_its_volume(turn, height):
    mesh = Cylinder(15, height).rotate(y=turn).mesh(angle=DEGREES_5, colors=False)
    low, high = mesh.bounds
    assert high[0] - low[0] == pytest.approx(30.0, rel=1e-3)
    assert high[2] - low[2] == pytest.approx(30.0, rel=1e-3)
    assert volume_of(mesh) == pytest.approx(math.pi * 15**2 * height, rel=1e-3)


def test_a_socket_screw_has_its_volume():
    head, shank, socket = Cylinder(4.25, 5), Cylinder(2.5, 10), Cylinder(2.0, 5)
    screw = (head.translate(0, 2.5, 0) | shank.translate(0, -4.9, 0)) - socket.translate(0, 4.5, 0)
    mesh = screw.mesh(angle=DEGREES_5, check=True, colors=False)
    assert mesh.report["check"] == SOUND
    true = math.pi * (4.25**2 * 5 + 2.5**2 * 9.9 - 2.0**2 * 3)
    assert volume_of(mesh) == pytest.approx(true, rel=1e-3)
    assert mesh.report["volume"] == pytest.approx(volume_of(mesh), rel=1e-9)


@pytest.mark.parametrize("angle", [0.4, 0.2])
def test_no_triangle_turns_by_more_than_the_angle(angle):
    shape, tolerance = Torus(10.0, 3.0), 0.05
    mesh = shape.mesh(tolerance, angle=angle, check=True, colors=False)
    corners = mesh.points[mesh.triangles]
    ring = corners * (1, 0, 1)
    normals = corners - 10.0 * ring / np.linalg.norm(ring, axis=2, keepdims=True)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    cosines = np.einsum("tij,tij->ti", normals, np.roll(normals, 1, axis=1))
    turns = np.arccos(np.clip(cosines, -1.0, 1.0)).max(axis=1)
    # Normals inside, half as far apart, say what those at the corners are, but for third orders.
    assert turns.max() <= 1.1 * angle
    assert turns.max() > 0.5 * angle  # and not by far less
    assert mesh.report["check"] == SOUND and mesh.report["angle"] == angle


def test_a_tolerance_alone_sets_no_angle_and_flat_faces_need_none():
    ball = Sphere(10.0)
    assert ball.mesh(0.5).report["angle"] is None
    part = Box(20, 10, 30) - Box(5, 20, 5)
    assert len(part.mesh(0.06).triangles) == len(part.mesh(0.06, angle=0.02).triangles)


def test_radii_below_tolerances_are_left_out():
    rounded = Box(18, 18, 18).round(1.0)
    plain = len(rounded.mesh(1.4).triangles)
    coarse, fine = (len(rounded.mesh(t, angle=0.15).triangles) for t in (1.4, 0.3))
    assert plain <= coarse < 0.2 * fine


@pytest.mark.parametrize("angle", [0.0, -1.0, math.inf, True, "5"])
def test_an_angle_is_a_number_above_0(angle):
    with pytest.raises(CompileError, match="angle is an angle in radians above 0"):
        Sphere(1.0).mesh(angle=angle)


def test_meshes_with_an_angle_are_closed_and_free_of_intersections():
    shape = (Box(20, 10, 20).round(2.0) - Cylinder(3, 40)) | Sphere(6).translate(12, 0, 0)
    mesh = shape.mesh(angle=0.3, check=True, colors=False)
    assert mesh.report["check"] == SOUND


@pytest.mark.parametrize(
    "shape",
    [
        Box(10, 20, 30),
        Box(10, 20, 30).twist(0.05),
        Sphere(7.0),
        (Box(10, 2, 3) | Cylinder(1, 20)).rotate(x=0.7).rotate(x=-0.7),
    ],
    ids=["box", "twist", "ball", "turned"],
)
def test_the_size_of_a_solid_is_measured(shape):
    kernels = FieldKernels(shape.node, {}, 0.0)
    extent = extent_of(shape.node, MeshRequest())
    mesh = shape.mesh(0.3, colors=False)
    low, high = np.array(mesh.bounds)
    assert largest_side(kernels, extent) == pytest.approx(float((high - low).max()), rel=0.04)


def test_a_loose_box_changes_neither_tolerance_nor_size():
    plain = Box(10, 10, 10)
    loose = Box(10, 10, 10).twist(1e-9)  # the box of the cylinder around it
    reports = [shape.mesh(colors=False).report for shape in (plain, loose)]
    assert reports[1]["tolerance"] == pytest.approx(reports[0]["tolerance"], rel=0.02)
    assert reports[1]["size"] == pytest.approx([10, 10, 10], rel=1e-3)


PART = """\
from distal import Box, Cylinder
part = Box(20.0, 5.0, 40.0) - Cylinder(4.0, 20.0)
"""


def points_of_stl(path):
    data = path.read_bytes()
    (count,) = struct.unpack("<I", data[80:84])
    rows = np.frombuffer(data[84:], np.dtype([("n", "<f4", 12), ("rest", "<u2")]), count)["n"]
    return rows[:, 3:].reshape(-1, 3, 3).astype(float)


def points_of_3mf(path):
    with zipfile.ZipFile(path) as file:
        (name,) = (n for n in file.namelist() if n.endswith(".model"))
        root = ElementTree.fromstring(file.read(name))
    space = root.tag.split("}")[0] + "}"
    points = [[float(v.get(k)) for k in "xyz"] for v in root.iter(space + "vertex")]
    rows = [[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in root.iter(space + "triangle")]
    return np.array(points)[np.array(rows)]


@pytest.mark.parametrize(("suffix", "read"), [(".stl", points_of_stl), (".3mf", points_of_3mf)])
def test_the_command_prints_size_and_volume_of_the_file(tmp_path, monkeypatch, suffix, read):
    monkeypatch.chdir(tmp_path)
    Path("part.py").write_text(PART)
    done = CliRunner().invoke(application, ["mesh", "part.py:part", "-o", f"part{suffix}"])
    assert done.exit_code == 0
    first = done.stderr.splitlines()[0]
    corners = read(Path(f"part{suffix}"))
    points = corners.reshape(-1, 3)
    size = points.max(axis=0) - points.min(axis=0)
    assert f" {size[0]:.4g} x {size[1]:.4g} x {size[2]:.4g} mm, " in first
    assert [round(side) for side in size] == [20, 40, 5]  # z is up
    a, b, c = corners.transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert float(re.search(r", ([\d.]+) cubic mm$", first)[1]) == pytest.approx(volume, rel=1e-3)


def test_the_json_report_has_the_size_in_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("part.py").write_text(PART)
    for suffix, size in ((".stl", [20, 40, 5]), (".glb", [20, 5, 40])):
        arguments = ["mesh", "part.py:part", "-o", f"p{suffix}", "--angle", "15", "--json"]
        report = json.loads(CliRunner().invoke(application, arguments).stdout)
        assert report["size"] == pytest.approx(size, rel=1e-6)
        assert report["angle"] == pytest.approx(math.radians(15.0))
        assert report["volume"] == pytest.approx(4000 - math.pi * 80, rel=1e-2)
