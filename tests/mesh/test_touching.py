"""Solids that touch are one solid: no false warning, no finer cells, and what is said is true.

Each is meshed beside the same solid whose parts overlap, which has no faces inside.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from distal import Bolt, Box, Cylinder, Rectangle, Sphere, Torus, union
from distal.ir.types import VEC3
from distal.mesh import face_arithmetic
from distal.mesh.kernels import FieldKernels
from distal.mesh.outlines.layers import layer_places, layers_at
from distal.mesh.outlines.outlining import OutlineRequest
from distal.scene.tree.errors import SceneValueError
from tests.mesh.sample_solids import volume

SOUND = {"open_edges": 0, "pinched_points": 0, "intersections": 0}


def turned(shape: Any, seed: int) -> Any:
    """A shape turned and moved at random; seed 0 leaves it as it is."""
    if not seed:
        return shape
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    return shape.rotate(quaternion=tuple(quaternion)).translate(*rng.uniform(-1.0, 1.0, 3))


def half(shape: Any, side: float) -> Any:
    """What of a shape is on one side of the plane x = 0.13."""
    return shape & Box(4.0).translate(2.0 * side + 0.13, 0.0, 0.0)


BOX = Box(1.0, 1.3, 0.9)
RING = Torus(1.0, 0.3)
PLATE = Box(2.0, 0.3, 1.7)
CAVITY = Box(1.0) - Box(0.6)
# Solids whose parts touch, and the same solids of parts that overlap.
PAIRS = {
    "beside": (BOX | BOX.translate(1.0, 0.0, 0.0), Box(2.0, 1.3, 0.9).translate(0.5, 0.0, 0.0)),
    "row": (
        union(*(Box(0.1, 1.0, 0.8).translate(0.1 * i, 0.0, 0.0) for i in range(10))),
        Box(1.0, 1.0, 0.8).translate(0.45, 0.0, 0.0),
    ),
    "post": (
        PLATE | Cylinder(0.2, 1.0).translate(0.4, 0.65, 0.2),
        PLATE | Cylinder(0.2, 1.1).translate(0.4, 0.6, 0.2),
    ),
    "block": (
        PLATE | Box(0.5, 0.8, 1.7).translate(0.3, 0.55, 0.0),
        PLATE | Box(0.5, 0.9, 1.7).translate(0.3, 0.5, 0.0),
    ),
    "shaft": (
        Cylinder(0.5, 1.0) | Cylinder(0.3, 0.7).translate(0.0, 0.85, 0.0),
        Cylinder(0.5, 1.0) | Cylinder(0.3, 1.2).translate(0.0, 0.6, 0.0),
    ),
    "two halves": (half(Sphere(1.0), -1.0) | half(Sphere(1.0), 1.0), Sphere(1.0)),
    "half a ring": ((RING & Box(4.0).translate(2.0, 0.0, 0.0)).symmetry("x"), RING),
    "quarter of a ring": ((RING & Box(4.0).translate(2.0, 0.0, 2.0)).symmetry("xz"), RING),
    "symmetry across": (
        BOX.translate(0.5, 0.1, 0.0).symmetry(across=(1.0, 0.0, 0.0)),
        Box(2.0, 1.3, 0.9).translate(0.0, 0.1, 0.0),
    ),
    "pour hole": (
        CAVITY - Cylinder(0.15, 0.4).translate(0.0, 0.5, 0.0),
        CAVITY - Cylinder(0.15, 0.6).translate(0.0, 0.4, 0.0),
    ),
    "flush cut": (
        Box(2.0, 1.0, 1.0) - Box(1.0, 0.5, 0.5).translate(0.5, 0.25, 0.25),
        Box(2.0, 1.0, 1.0) - Box(1.2, 0.7, 0.7).translate(0.6, 0.35, 0.35),
    ),
    "flush bore": (PLATE - Cylinder(0.3, 0.3), PLATE - Cylinder(0.3, 1.0)),
}
PAIRS["put on"] = (
    PLATE | Cylinder(0.3, 1.0).rotate(y=0.3).on(PLATE),
    PLATE | Cylinder(0.3, 1.1).translate(0.0, 0.6, 0.0),
)


def samples_of(made: Any) -> Any:
    """The points of a mesh, and four places on each of its triangles."""
    corners = made.points[made.triangles]
    middle = corners.mean(axis=1)
    return np.concatenate([made.points, middle, *((middle + corners[:, i]) / 2 for i in range(3))])


@pytest.mark.sample(4, each="name")
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
@pytest.mark.parametrize("name", PAIRS)
def test_parts_that_touch_are_one_solid(name: str, seed: int) -> None:
    touching, whole = (turned(shape, seed) for shape in PAIRS[name])
    made, other = touching.mesh(check=True), whole.mesh()
    report = made.report
    assert not report["warnings"] and not report["lost"] and report["check"] == SOUND
    # Faces inside cost no finer cells; near their rims fewer points can be spared.
    assert report["spacing"] == pytest.approx(other.report["spacing"], rel=0.2)
    assert report["triangles_before"] < 1.8 * other.report["triangles_before"]
    assert len(made.triangles) < 3.0 * len(other.triangles)
    # The error is measured to the surface of the whole, not to the faces inside.
    error = float(np.abs(whole(samples_of(made))).max())
    assert error <= 1.05 * max(report["error"]["largest"], 1e-6)
    assert report["error"]["largest"] <= report["tolerance"]


@pytest.mark.parametrize(
    ("shape", "expected", "most"),
    [
        (Box(1.0) | Box(1.0).translate(1.0, 0.0, 0.0), 2.0, 570),
        (Box(2.0, 1.0, 1.0) - Box(1.0).translate(0.5, 0.0, 0.0), 1.0, 400),
    ],
)
def test_boxes_side_by_side_are_one_box(shape: Any, expected: float, most: int) -> None:
    made = shape.mesh()
    assert not made.report["warnings"]
    assert volume(made.points, made.triangles) == pytest.approx(expected, rel=1e-9)
    assert len(made.triangles) <= most


def pieces(made: Any) -> int:
    """How many parts of a mesh are not connected."""
    label = np.arange(len(made.points))
    a, b, c = made.triangles.T
    while True:
        before = label.copy()
        least = np.minimum(label[a], np.minimum(label[b], label[c]))
        for corner in (a, b, c):
            np.minimum.at(label, corner, least)
        if (label == before).all():
            return len(np.unique(label))


@pytest.mark.sample(4)
@pytest.mark.parametrize("seed", [0, 4])
@pytest.mark.parametrize("gap", [0.03, 0.01, 1e-3, 1e-5])
def test_a_gap_stays_a_gap(gap: float, seed: int) -> None:
    boxes = turned(Box(1.0) | Box(1.0).translate(1.0 + gap, 0.0, 0.0), seed)
    # It is open, or said.
    try:
        made = boxes.mesh()
    except SceneValueError as error:
        assert gap < 0.01 and f"are {gap:.2g} apart" in str(error)
        return
    assert pieces(made) == 2 or "is thinner than" in made.report["warnings"][0]
    assert pieces(made) == 2 or gap < 0.01


@pytest.mark.parametrize("skin", [1e-3, 1e-5])
def test_a_skin_that_a_cutter_leaves_is_there_or_said(skin: float) -> None:
    part = Box(2.0, 1.0, 1.0) - Box(1.0).translate(0.5 - skin, 0.0, 0.0)
    made = part.mesh(feature=0.1)
    # A plane of the lattice may happen to be in the skin: then it is in the mesh.
    is_there = made.points[:, 0].max() == pytest.approx(1.0)
    assert is_there or "is thinner than" in made.report["warnings"][0]


@pytest.mark.parametrize("seed", [0, 5])
def test_walls_go_on_behind_faces_that_touch(seed: int) -> None:
    slices = union(*(Box(0.25, 3.0, 2.0).translate(0.25 * i, 0.0, 0.0) for i in range(4)))
    found = turned(slices, seed).measure()
    assert found.volume.value == pytest.approx(6.0, abs=max(found.volume.error, 1e-9))
    assert found.wall.value == pytest.approx(1.0, rel=1e-6)
    assert found.gap is None and not found.warnings


def test_a_skin_without_a_thickness_closes_no_gap() -> None:
    # Two pockets that share a face: together they are one pocket, 1 wide.
    part = (
        Box(4.0)
        - Box(0.5, 6.0, 2.0).translate(0.25, 0, 0)
        - Box(0.5, 6.0, 2.0).translate(-0.25, 0, 0)
    )
    found = part.measure()
    assert found.gap.value == pytest.approx(1.0, rel=1e-6)
    assert found.wall.value == pytest.approx(1.0, rel=1e-6)


def test_the_depth_of_a_triangle_in_a_laminate_is_that_of_the_surface() -> None:
    # 200 slices: nowhere is a face farther than .005.
    slices = union(*(Box(0.01, 1.0, 1.0).translate(0.01 * i, 0.0, 0.0) for i in range(200)))
    kernels = FieldKernels(slices.node, {}, 0.0)
    corner = np.array([1.995, 0.5, 0.2])
    a, b, c = corner - (0.6, 0, 0), corner - (0.0, 0.6, 0.0), corner - (0.3, 0.3, 0.3)
    rows = [np.array([place]) for place in (a, b, c)]
    types = [(name, VEC3) for name in "abc"]
    ((largest, _, _),) = kernels.call(face_arithmetic.largest_miss, *rows, types=types)
    # The middle is .3 below both faces.
    assert 0.29 < largest < 1.0


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1])
def test_flat_shapes_that_touch_have_one_outline(angle: float) -> None:
    square = Rectangle(1.0, 1.0)
    row = union(*(square.translate(float(i), 0.0) for i in range(4))).rotate(angle)
    made = row.outline()
    assert not made.report["warnings"]
    assert [len(loop) for loop in made.loops] == [4]
    assert made.area == pytest.approx(4.0, rel=1e-6)


def test_a_bolt_of_the_library_has_no_false_warning() -> None:
    report = Bolt("M6", 20.0).mesh(tolerance=0.1, check=True).report
    assert not report["warnings"] and report["check"] == SOUND


def test_a_layer_in_the_plane_of_faces_that_touch_is_the_solid_above() -> None:
    part = Box(2.0, 0.3, 2.0).translate(0.0, 0.15, 0.0) | Box(1.0, 1.0, 0.5).translate(
        0.0, 0.8, 0.0
    )
    request = OutlineRequest()
    places = layer_places(part, 0.2, "y", request)
    assert places[1] == pytest.approx(0.3, abs=1e-12)
    areas = [
        layer.outline and layer.outline.area for layer in layers_at(part, places[:3], "y", request)
    ]
    assert areas == pytest.approx([4.0, 0.5, 0.5], rel=1e-6)
